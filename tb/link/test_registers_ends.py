"""Settings saturate if they are wider than the build's registers, checked by literal values: at reset,
written as a word and byte by byte, as read back and as the core gets them. A build with all bits of the map
keeps them.
"""

import cocotb
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
import members
from meissner.twins.link.registers import RESET_BITS, Registers, reset_word

# Bits of a detail, a time, a load and an offset. Limits: 2^18 - 1 = 262143, 2^17 = 131072, 2^11 - 1 = 2047,
# 2^22 - 1 = 4194303, 2^15 = 32768.
FEW = {"DetailBits": 18, "TimerBits": 11, "LoadBits": 22, "OffsetBits": 16}
LEVELS = {131_072: 131_071, 262_144: 131_071, 393_216: 131_071}  # each bit above the limit
LEVELS |= {-262_144: -131_072, -393_216: -131_072, -524_288: -131_072}
ENDS = {  # address, and {written value: value that the core gets}
    "slip_threshold": (0x200, {262_142: 262_142, 262_143: 262_143, 262_144: 262_143, 262_444: 262_143}),
    "slip_gross_threshold": (0x204, {300: 300, 262_143: 262_143, 262_144: 262_143, 1_048_575: 262_143}),
    "slip_keep_threshold": (0x228, {262_141: 262_141, 262_143: 262_143, 262_145: 262_143, 524_288: 262_143}),
    "slip_contact_level": (0x208, LEVELS | {131_071: 131_071, 524_287: 131_071, -131_072: -131_072}),
    "slip_release_level": (0x20C, LEVELS | {-131_071: -131_071, -131_073: -131_072, -1: -1}),
    "slip_hold": (0x214, {2047: 2047, 2048: 2047, 65_535: 2047, 2046: 2046}),
    "slip_refractory": (0x218, {2046: 2046, 2047: 2047, 2048: 2047, 4096: 2047}),
    "slip_blank": (0x21C, {2045: 2045, 2048: 2047, 2047: 2047, 32_768: 2047}),
    "calibrate_offset": (0x508, {32_767: 32_767, 32_768: 32_767, -32_768: -32_768, -32_769: -32_768}),
    "cop_min_load": (0x600, {4_194_303: 4_194_303, 0x40_0000: 4_194_303, 2**32 - 1: 4_194_303, 7: 7}),
}
BITS = {0x208: 20, 0x20C: 20, 0x508: 17}  # widths of the signed registers
RESETS = {
    **{"slip.threshold": 262_444, "slip.contact_level": 131_072, "slip.release_level": -131_073},
    **{"slip.hold": 2048, "cop.min_load": 0x40_0000, "calibrate.offset": -40_000, "slip.blank": 2049},
    "slip.refractory": 2050,
}
HELD = {
    **{"slip_threshold": 262_143, "slip_contact_level": 131_071, "slip_release_level": -131_072},
    **{"slip_hold": 2047, "cop_min_load": 4_194_303, "calibrate_offset": -32_768, "slip_blank": 2047},
    "slip_refractory": 2047,
}


async def begin(dut):
    """Reset; returns whether the build has the few bits."""
    inputs = {
        port._name: 0 for port in dut if port._name.endswith("_i") and port._name not in ("clk_i", "rst_i")
    }
    await bench.start(dut, **inputs)
    widths = {name: getattr(dut, name).value.to_unsigned() for name in FEW}
    full = {"DetailBits": 20, "TimerBits": 16, "LoadBits": 32, "OffsetBits": 17}
    assert widths in (FEW, full)
    return widths == FEW


async def access(dut, write, address, data=0, strobe=15):
    """Perform an access; return its data."""
    dut.bus_valid_i.value, dut.bus_write_i.value, dut.bus_strobe_i.value = 1, write, strobe
    dut.bus_address_i.value, dut.bus_wdata_i.value = address, data & 0xFFFF_FFFF
    await RisingEdge(dut.clk_i)
    dut.bus_valid_i.value = 0
    await RisingEdge(dut.clk_i)
    await ReadOnly()
    assert (dut.bus_done_o.value, dut.bus_error_o.value) == (1, 0)
    data = bench.read(dut.bus_rdata_o)
    await RisingEdge(dut.clk_i)
    return data


async def commit(dut):
    for level in (1, 0):
        dut.commit_i.value = level
        await RisingEdge(dut.clk_i)
    await ReadOnly()


def shown(dut, name):
    """The value that the core gets, signed if the register is."""
    value = members.of(members.CFG, bench.read(dut.cfg_o))[name]
    return bench.as_signed(value, BITS[ENDS[name][0]]) if ENDS[name][0] in BITS else value


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def reset_values_are_held_at_the_ends(dut):
    few = await begin(dut)
    await ReadOnly()
    kept = {name.replace(".", "_"): value for name, value in RESETS.items()}
    for name, expected in (HELD if few else kept).items():
        assert shown(dut, name) == expected, name
    await RisingEdge(dut.clk_i)
    assert await access(dut, 0, 0x200) == (262_143 if few else 262_444)
    assert await access(dut, 0, 0x20C) == 2**20 - (131_072 if few else 131_073)
    assert await access(dut, 0, 0x508) == 2**17 - (32_768 if few else 40_000)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def written_values_are_held_at_the_ends(dut):
    few = await begin(dut)
    for name, (address, values) in ENDS.items():
        for written, held in values.items():
            expected = held if few else written
            await access(dut, 1, address, written)
            await commit(dut)
            assert shown(dut, name) == expected, (name, written)
            await RisingEdge(dut.clk_i)
            mask = (1 << BITS.get(address, 32)) - 1
            assert await access(dut, 0, address) == expected & mask, (name, written)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_wide_setting_keeps_its_bytes(dut):
    """0x01234 written over 0xFFFFF from the highest byte on: saturated in between, exact after the last
    byte."""
    few = await begin(dut)
    await access(dut, 1, 0x200, 0xF_FFFF)
    steps = (
        (8, 0, 0xF_FFFF),
        (4, 0, 0x0_FFFF),
        (2, 0x1200, 0x0_12FF),
        (1, 0x34, 0x0_1234),
        (4, 0x0A_0000, 0xA_1234),
    )
    for strobe, data, written in steps:
        await access(dut, 1, 0x200, data, strobe)
        expected = 262_143 if few and written > 262_143 else written
        assert await access(dut, 0, 0x200) == expected
        await commit(dut)
        assert shown(dut, "slip_threshold") == expected
        await RisingEdge(dut.clk_i)


@pytest.mark.parametrize("widths", [{}, FEW], ids=["full", "few"])
def test_settings_are_held_at_the_ends_of_the_build(widths):
    word = f"{RESET_BITS}'h{reset_word(RESETS):x}"
    bench.run("link", "registers", widths | {"Resets": word}, module="test_registers_ends")


@pytest.mark.parametrize(
    "values, sentence",
    [
        ({"slip.threshold": 262_144}, "slip.threshold = 262144 must lie in 0 .. 262143"),
        ({"slip.contact_level": 131_072}, "slip.contact_level = 131072 must lie in -131072 .. 131071"),
        ({"slip.release_level": -131_073}, "slip.release_level = -131073 must lie in -131072 .. 131071"),
        ({"slip.hold": 2048}, "slip.hold = 2048 must lie in 0 .. 2047"),
        ({"cop.min_load": 4_194_304}, "cop.min_load = 4194304 must lie in 0 .. 4194303"),
        ({"calibrate.offset": 32_768}, "calibrate.offset = 32768 must lie in -32768 .. 32767"),
    ],
)
def test_reset_values_wider_than_the_build_are_refused(values, sentence):
    widths = {"detail": 18, "timer": 11, "load": 22, "offset": 16}
    with pytest.raises(ValueError, match=sentence):
        reset_word(values, widths)
    ((name, value),) = values.items()
    assert reset_word({name: value + (1 if value < 0 else -1)}, widths) > 0


@pytest.mark.parametrize("name, bits", [("detail", 21), ("timer", 17), ("load", 33), ("offset", 0)])
def test_widths_that_the_map_has_not_are_refused(name, bits):
    assert f"{name.capitalize()}Bits = {bits}" in bench.refuses(
        "registers", {f"{name.capitalize()}Bits": bits}
    )
    with pytest.raises(ValueError, match=f"{name} = {bits}"):
        Registers(widths={name: bits})
