"""msn_pin_shift with models of the drivers at its pins, which refuse what their sheet forbids: each slot's
outputs by the page's words, latched Lead clocks after the slot begins and at no other time; chains, sizes
that fill no driver; off_i blanks in the next clock; a restart after any of its clocks."""

import random

import cocotb
import pytest

import bench
from parts.hv507 import Hv507

REST = {
    "in_valid_i": 0,
    "in_level_i": 0,
    "in_last_i": 0,
    "running_i": 0,
    "off_i": 0,
    "begin_i": 0,
    "step_i": 0,
}
REST |= {"slot_i": 0, "busy_i": 0}
SIZES = [  # the second with three drivers a chain; the last at the full clock of the drivers, in true time
    {"Pins": 7, "AmplitudeBits": 1, "ClkKhz": 10_000, "SclkKhz": 5_000},
    {"Pins": 259, "Chains": 2, "AmplitudeBits": 1, "ClkKhz": 20_000, "SclkKhz": 10_000, "Direction": 0},
    {"Pins": 100, "AmplitudeBits": 4, "ClkKhz": 100_000},
]


def sizes(dut):
    read = lambda name: getattr(dut, name).value.to_unsigned()
    pins, chains = read("Pins"), read("Chains")
    each = -(-pins // chains)
    bits = -(-each // 64) * 64
    half = -(-read("ClkKhz") // (2 * read("SclkKhz")))
    return pins, chains, each, bits, pins + bits // 8 * 9 * 2 * half + 48


def parts(dut, report=None):
    _, chains, _, bits, _ = sizes(dut)
    lines = (dut.hv_clk_o, dut.hv_le_o, dut.hv_bl_o, dut.hv_pol_o)
    true = dut.ClkKhz.value.to_unsigned() == 100_000  # the bench's clock is 10 ns
    report = (
        report
        if true
        else lambda violation: None if str(violation)[:2] == "t_" else Hv507.fail(None, violation)
    )
    return [Hv507(dut.hv_data_o, *lines, bits // 64, lane, report=report) for lane in range(chains)]


def shown(drivers, pins, each):
    """Levels of the pins by the outputs of the chains; the outputs without a pin must be low."""
    levels = [level for chain in drivers for level in chain.outputs[:each]]
    assert not any(level for chain in drivers for level in chain.outputs[each:]) and not any(levels[pins:])
    return levels[:pins]


async def levels_in(dut, levels):
    for place, level in enumerate(levels):
        dut.in_valid_i.value, dut.in_level_i.value = 1, level
        dut.in_last_i.value = place == len(levels) - 1
        await bench.RisingEdge(dut.clk_i)
    dut.in_valid_i.value = dut.in_last_i.value = 0


async def step(dut, slot, levels=None):
    """Begin a slot, a period if ``levels`` are given: they come while busy_i."""
    dut.step_i.value, dut.slot_i.value, dut.begin_i.value = 1, slot, levels is not None
    await bench.RisingEdge(dut.clk_i)
    dut.step_i.value, dut.begin_i.value, dut.slot_i.value = 0, 0, ~slot & 1
    if levels is not None:
        dut.busy_i.value = 1
        await levels_in(dut, levels)
        dut.busy_i.value = 0


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def shows_each_slot_at_its_time(dut):
    pins, _, each, _, lead = sizes(dut)
    top, opens = (1 << dut.AmplitudeBits.value.to_unsigned()) - 1, dut.ClkKhz.value.to_unsigned() // 10_000
    draw = random.Random(bench.SEED)
    await bench.start(dut, **REST)
    drivers, frames = parts(dut), [[draw.randint(0, top) for _ in range(pins)] for _ in range(2)]
    frames += [[top] * pins, [0] * pins]
    dut.running_i.value = 1
    first = True
    for levels in frames[: 2 if pins == 100 else 4]:
        for slot in range(2 * top + 2) if pins < 100 else (0, 1, top, top + 1, 2 * top + 1):
            started = cocotb.start_soon(step(dut, slot, levels if slot == 0 else None))
            for clock in range(lead + 30):
                await bench.ReadOnly()
                assert bench.high(dut.wrap_o) == (slot == 0 and clock == lead)
                assert bench.high(dut.hv_le_o) == (lead <= clock < lead + opens), clock
                if clock > lead + 12:
                    assert bench.high(dut.hv_bl_o)
                    expected = [int(level > 0 and slot <= level) for level in levels]
                    assert shown(drivers, pins, each) == expected, slot
                elif first and clock <= lead:
                    assert not bench.high(dut.hv_bl_o) and not any(shown(drivers, pins, each))
                await bench.RisingEdge(dut.clk_i)
            await started
            first = False


@bench.applies(lambda dut: dut.Pins.value.to_unsigned() < 100)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def is_off_from_the_next_clock_on(dut):
    """In any clock of a load, of its latch and after it. A restart loads all anew."""
    pins, _, each, _, lead = sizes(dut)
    await bench.start(dut, **REST)
    drivers, draw = parts(dut), random.Random(bench.SEED)
    top = (1 << dut.AmplitudeBits.value.to_unsigned()) - 1
    edges = [*range(lead - 2, lead + 4), *(draw.randint(0, lead) for _ in range(20))]
    for last in edges:
        dut.running_i.value = 1
        await step(dut, 0, [top] * pins)
        await bench.clocks(dut, lead + 10)
        assert sum(shown(drivers, pins, each)) == pins
        await step(dut, 1)
        await bench.clocks(dut, last)
        dut.off_i.value = 1
        await bench.RisingEdge(dut.clk_i)
        dut.off_i.value = dut.running_i.value = 0
        await bench.ReadOnly()
        assert not bench.high(dut.hv_bl_o) and not bench.high(dut.hv_le_o)
        await bench.RisingEdge(dut.clk_i)
        assert not any(shown(drivers, pins, each))
        for _ in range(200):
            await bench.ReadOnly()
            ended = not bench.high(dut.busy_o)
            await bench.RisingEdge(dut.clk_i)
            if ended:
                break
        else:
            raise AssertionError("a load does not end")


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rests_in_reset(dut):
    await bench.inputs_in_reset(dut, "hv_clk_o", "hv_le_o", "hv_bl_o", "wrap_o", "busy_o")
    assert bench.high(dut.hv_pol_o) and bench.high(dut.hv_dir_o) == bench.high(dut.Direction)


EVIDENCE = {
    "equivalence": {"size": {"Pins": 7, "AmplitudeBits": 1, "ClkKhz": 10_000, "SclkKhz": 5_000}},
    "mutants": {"unsolved": True},
    # Each slot's load mends the last, and a period's levels those of the one before, of two slots here.
    "faults": {
        "size": {"Pins": 7, "AmplitudeBits": 1},
        "settle": 4,
        "driver": {"frame": "step_i", "rows": 14000},
    },
}


@pytest.mark.parametrize("parameters", [*SIZES[:2], pytest.param(SIZES[2], marks=pytest.mark.long)])
def test_pin_shift(parameters):
    bench.run("actuate", "pin_shift", parameters)


def test_refuses_illegal_parameters():
    for wrong in ({"Pins": 1}, {"Chains": 9}, {"AmplitudeBits": 0}, {"SclkKhz": 0}, {"Pins": 5, "Chains": 4}):
        name, number = next(iter(wrong.items()))
        assert f"{name} = {number}" in bench.refuses("pin_shift", wrong)
