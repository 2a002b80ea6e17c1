"""Four electrodes at the pins of an AD7606: each setting of cop4 and cop_slip, written through its register,
changes what it should and nothing else. No two settings have the same value; the results are those of the
formulas in docs/cop4.md and docs/mesh.md in exact rationals, and each limit is met exactly and missed by one.
Each packet has the clock of its CONVST edge, also while the host stalls; each counter has its own value."""

from fractions import Fraction

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge

import bench
from core import pins
from core.wires import SEEN
from parts.ad7606 import Ad7606

PERIOD = 523
LAG = 3
SETTINGS = {
    **{"rail": 60000, "kx": 70001, "shift_x": 15, "ky": 90007, "shift_y": 14, "kf": 100003, "shift_load": 9},
    **{"p0": 30011, "p1": -17003, "p2": 25013, "p3": -11027, "p4": 21001, "p5": -13009},
    **{"min_load": 2003, "top": 30000, "idle": 26000, "busy": 24000, "imbalance": 1500},
}
SLIP = {"drop": 77, "move": 901, "min_load": 4003, "hold": 2, "refractory": 5}
ONE = (22000, -20100, 20000, -21200)
TWO = (19500, -20700, 21800, -19400)
OPEN = (26000, -24500, 23900, -24900)  # E1 exactly idle, E3 busy
OPEN_LOW = (24600, -26101, 24400, -24001)  # E2, mirrored, idle; E4 exactly busy
FULL = (30000, -25999, 24001, -28000)  # E1 exactly at the top, E3 with too little current to call E1 open
FREE = (29900, -29850, 29890, -29890)  # hardly any current: nothing presses
UNEVEN = (22000, -20100, 20000, -20400)  # M - N is exactly 1500
LESS = (25500, -24600, 24500, -25400)  # as ONE, but with less load and further along y
SAMPLES = [ONE, TWO, OPEN, OPEN_LOW, FULL, UNEVEN]


def nearest(value):
    """Ties away from zero."""
    size = int(abs(value) + Fraction(1, 2))
    return size if value >= 0 else -size


def held(value, low=-1):
    return min(max(value, Fraction(low)), Fraction(1))


def result_of(sample, s):
    """(x, y, load, pressed) of one sample with settings ``s``."""
    e1, e2, e3, e4 = sample
    n, m, d = s["rail"] - e1 - e3, s["rail"] + e2 + e4, e1 + e3 - e2 - e4
    assert n > 0 and m > 0 and d > 0
    x = nearest(16384 * held(Fraction(s["kx"] * (e1 - e3), n << s["shift_x"])))
    y = nearest(16384 * held(Fraction(s["ky"] * (e2 - e4), m << s["shift_y"])))
    xx, yy = x * x >> 12, y * y >> 12
    along = s["p1"] + (s["p3"] * xx + s["p4"] * yy >> 16)
    across = s["p2"] + (s["p5"] * yy >> 16)
    p = s["p0"] + (xx * along + yy * across >> 16)
    den = (d << 8 + s["shift_load"]) - n * p
    load = min(nearest(65536 * held(Fraction(s["kf"] * n, den), 0)), 65535) if den > 0 else 65535
    upper = (e1, -1 - e2, e3, -1 - e4)
    fault = any(e >= s["top"] or e <= -s["top"] - 1 for e in sample) or abs(m - n) > s["imbalance"]
    for own, partner in ((0, 2), (2, 0), (1, 3), (3, 1)):
        fault |= upper[own] >= s["idle"] and upper[partner] <= s["busy"]
    pressed = int(load > 0 and load >= s["min_load"] and not fault)
    return x * pressed, y * pressed, load, pressed


def octant_of(dx, dy):
    """Counter-clockwise from +x in steps of 45 degrees, limits at 53/128; no move here lies on a limit."""
    size, other = max(abs(dx), abs(dy)), min(abs(dx), abs(dy))
    if 128 * other > 53 * size:
        return {(1, 1): 1, (-1, 1): 3, (-1, -1): 5, (1, -1): 7}[dx // abs(dx), dy // abs(dy)]
    return (0 if dx > 0 else 4) if abs(dx) > abs(dy) else (2 if dy > 0 else 6)


def slips_since_reset(scene, done):
    """(events {sample: octant}, (slip_o, touched_o) after each sample) of the last pass of ``scene``;
    ``done``: (number of samples, settings) of every pass since reset."""
    results, events, flags, slipping, quiet, deaf = [], {}, [], False, 0, 0
    for count, s in done:
        events, flags = {}, []
        for n in range(count):
            x, y, load, pressed = result_of(scene[n], SETTINGS)
            results.append((x, y, load, pressed))
            over = False
            if len(results) > LAG:
                old_x, old_y, old, old_pressed = results[-1 - LAG]
                over = bool(pressed and old_pressed and old >= s["min_load"])
                over = over and (old - load) * 256 > s["drop"] * old
                over = over and max(abs(x - old_x), abs(y - old_y)) >= s["move"]
            if slipping:
                quiet = 0 if over else quiet + 1
                if quiet > s["hold"]:
                    slipping, deaf = False, s["refractory"]
            elif deaf:
                deaf -= 1
            elif over:
                slipping, quiet = True, 0
                events[n] = octant_of(x - old_x, y - old_y)
            flags.append((int(slipping), int(slipping or pressed)))
    return events, flags


class Core:
    """Batches of conversions: their CoP packets, events and flags."""

    async def begin(self, dut):
        self.dut, self.codes, self.count = dut, [], 0

        def part(dut):
            ports = (dut.adc_miso_i, dut.adc_convst_o, dut.adc_busy_i, dut.adc_reset_o, self.code)
            return Ad7606(dut.adc_cs_n_o, dut.adc_sclk_o, *ports, conversion_ns=3995)

        self.host, self.part = await pins.begin(dut, part)
        self.starts = pins.Edges(self.host, dut.adc_convst_o)
        await self.host.write(adc__period=PERIOD)
        await self.host.set({f"cop4.{name}": value for name, value in SETTINGS.items()})
        await self.host.set({f"cop_slip.{name}": value for name, value in SLIP.items()})
        await bench.clocks(dut, 100)
        return self

    def code(self, channel, _):
        """All eight inputs of a conversion."""
        sample = self.codes[min(len(self.part.frames), len(self.codes) - 1)]
        return (sample[channel] if channel < 4 else 32767) & 0xFFFF

    async def convert(self, samples, period=PERIOD):
        """Convert ``samples``; returns their (CoP packets, slip packets, convert starts, (slip_o, touched_o)
        after each)."""
        first, before, flags = len(self.host.packets), len(self.starts.at), []
        self.codes = [None] * len(self.part.frames) + list(samples)
        await self.host.write(adc__period=period, adc__enable=1)
        for n in range(len(samples)):
            while len(self.starts.at) <= before + n:
                await bench.clocks(self.dut, 1)
            if n == len(samples) - 1:
                await self.host.write(adc__enable=0)
            await pins.rest(self.dut, period - 20)
            flags.append((bench.read(self.dut.slip_o), bench.read(self.dut.touched_o)))
        await pins.rest(self.dut, PERIOD)
        cops, slips = self.host.of_kind(pins.COP, first), self.host.of_kind(pins.SLIP, first)
        return cops, slips, self.starts.at[before:], flags


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def each_setting_of_cop4_changes_its_own_result(dut):
    core = await Core().begin(dut)
    load = result_of(ONE, SETTINGS)[2]
    changes = [{}, {"rail": 60011}, {"kx": 70101}, {"shift_x": 13}, {"ky": 90001}, {"shift_y": 12}]
    changes += [{"kf": 99991}, {"shift_load": 10}]
    changes += [{f"p{n}": SETTINGS[f"p{n}"] ^ 0x1555} for n in range(6)]
    changes += [{"min_load": load}, {"min_load": load + 1}, {"top": 30001}]
    changes += [{"idle": 26001}, {"busy": 23999}, {"imbalance": 1499}]
    results = set()
    for change in changes:
        await core.host.set({f"cop4.{name}": value for name, value in change.items()})
        await bench.clocks(dut, 100)
        cops, _, starts, _ = await core.convert(SAMPLES)
        expected = [result_of(sample, SETTINGS | change) for sample in SAMPLES]
        assert [pins.cop_of(packet) for packet in cops] == expected, change
        assert [packet.time for packet in cops] == starts
        assert bench.read(dut.pressed_o) == expected[-1][3], change
        results.add(tuple(expected))
        await core.host.set({f"cop4.{name}": SETTINGS[name] for name in change})
    assert len(results) == len(changes) - 1, (
        "two changes look alike"
    )  # a least load equal to the load changes nothing


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def each_setting_of_cop_slip_changes_its_own_flag(dut):
    """The load halves and recovers, twice: the second time within the refractory time of the first."""
    core = await Core().begin(dut)
    scene = [ONE] * 4 + [LESS] * 4 + [ONE] * 6 + [LESS] * 6
    (x, y, old, _), (less_x, less_y, less, _) = result_of(ONE, SETTINGS), result_of(LESS, SETTINGS)
    move, drop = max(abs(less_x - x), abs(less_y - y)), (old - less) * 256 // old
    changes = [{}, {"drop": drop}, {"drop": drop + 1}, {"move": move}, {"move": move + 1}]
    changes += [{"min_load": old}, {"min_load": old + 1}, {"hold": 3}, {"refractory": 4}]
    done, outcomes = [], []
    for change in changes:
        await core.host.set({f"cop_slip.{name}": value for name, value in change.items()})
        await bench.clocks(dut, 100)
        _, slips, starts, flags = await core.convert(scene)
        # Earlier passes still have an effect: all since reset are computed, each with its settings.
        done.append((len(scene), SLIP | change))
        events, wanted = slips_since_reset(scene, done)
        assert flags == wanted, change
        assert [pins.slip_of(packet) for packet in slips] == [
            (65535, octant, 2) for octant in events.values()
        ]
        assert [packet.time for packet in slips] == [starts[n] for n in events], change
        outcomes.append((tuple(events), tuple(wanted)))
        await core.host.set({f"cop_slip.{name}": SLIP[name] for name in change})
    for which in (2, 4, 6):
        assert outcomes[which][0] == (), "a limit passed by one is no limit"
        assert outcomes[which - 1][0] != ()


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def touched_while_something_presses_or_slips(dut):
    core = await Core().begin(dut)
    scene = [FREE, ONE, FREE, FREE, ONE, ONE, ONE, ONE, LESS, FREE, FREE, FREE, ONE, FREE]
    _, slips, starts, flags = await core.convert(scene)
    events, wanted = slips_since_reset(scene, [(len(scene), SLIP)])
    assert flags == wanted and len(slips) == len(events) == 1
    assert wanted == [(0, k) for k in (0, 1, 0, 0, 1, 1, 1, 1)] + [(1, 1)] * 3 + [(0, k) for k in (0, 1, 0)]
    # The packets say the same: none, contact, incipient; one for each change.
    states = [2 * slip or touched for slip, touched in wanted]
    changes = [
        (starts[n], 65535, *pair) for n, pair in enumerate(zip([0, *states], states)) if len({*pair}) > 1
    ]
    assert pins.changes_of(core.host.packets) == changes and len(changes) == 7
    await core.host.write(link__states=1)
    await pins.rest(dut, 200)
    assert [q.payload.hex() for q in core.host.of_kind(pins.STATES)] == ["ffff01000000"]
    await core.host.write(link__events=0b00100)
    first = len(core.host.packets)
    await core.convert(scene)
    assert [change[1:] for change in pins.changes_of(core.host.packets[first:])] == [(65535, 1, 2)]
    await core.host.write(link__events=31)
    await core.convert([ONE])
    await core.host.write(link__states=1)
    await pins.rest(dut, 200)
    assert [q.payload.hex() for q in core.host.of_kind(pins.STATES)][1:] == ["ffff01000100"]


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def packets_keep_their_converts_time_while_the_host_stalls(dut):
    """It stalls for four frames: the packet being sent is kept, and of the others the newest is sent next."""
    core = await Core().begin(dut)
    samples = [ONE, TWO, LESS, UNEVEN, ONE, TWO]
    held = cocotb.start_soon(hold_after_the_first_byte(dut, 4 * PERIOD))
    cops, _, starts, _ = await core.convert(samples)
    await held
    results = [result_of(sample, SETTINGS) for sample in samples]
    assert [packet.time for packet in cops] == [starts[0], starts[4], starts[5]]
    assert [pins.cop_of(packet) for packet in cops] == [results[0], results[4], results[5]]
    assert await core.host.read("link.cop_dropped", "link.packets") == [3, len(core.host.packets)]
    assert (starts[1] - starts[0], starts[5] - starts[4]) == (PERIOD, PERIOD)


async def hold_after_the_first_byte(dut, clocks):
    await RisingEdge(dut.out_valid_o)
    dut.out_ready_i.value = 0
    await pins.rest(dut, clocks)
    dut.out_ready_i.value = 1


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def what_goes_wrong_is_counted_where_it_belongs(dut):
    """5 samples over range, 3 conversions without an answer, 7 ticks too early: no other counter changes."""
    core = await Core().begin(dut)
    counters = ("adc.dropped", "adc.overrun", "adc.timeout", "adc.mistagged", "adc.over_range")
    most, least = 32767, -32768
    await core.convert([(most, least, 32766, least), (most, 5, -32767, least), ONE])
    assert await core.host.read(*counters) == [0, 0, 0, 0, 5]
    core.part.hold_busy(0)
    cops, *_ = await core.convert([ONE] * 3, period=3000)
    core.part.hold_busy(None)
    assert not cops and await core.host.read(*counters) == [0, 0, 3, 0, 5]
    _, _, starts, _ = await core.convert([ONE] * 8, period=100)
    assert set(np.diff(starts)) == {200}, "a frame of 4 channels takes more than one period and less than two"
    assert await core.host.read(*counters) == [0, 7, 3, 0, 5]
    found = await core.host.statistics()
    assert found == {0: 0, 1: 7, 2: 3, 3: 0, 4: 0, 5: 0, 6: 0, 7: 0, 8: 0}


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def each_counter_has_its_own_register_and_statistic(dut):
    """Every bit, by values put where they are counted."""
    core = await Core().begin(dut)
    await pins.says_what_it_is(core.host, "adc cop4 cop_slip link", 1, 4)
    await bench.clocks(dut, 40)
    spi = dut.gen_cop4.u_sensor.u_channels.u_acquire.gen_adc.u_adc_spi
    sources = {
        **{f"adc.{name}": getattr(spi, f"{name}_o") for name in ("dropped", "overrun", "timeout")},
        **{f"adc.{name}": getattr(spi, f"{name}_o") for name in ("mistagged", "over_range")},
        "cop_damaged": dut.gen_cop4.u_sensor.u_electrodes.damaged_o,
        "link.cop_dropped": dut.u_link.gen_packets.u_packet.cop_dropped_o,
        "link.changes_lost": dut.u_link.gen_changes.u_changes.lost_o,
    }
    await pins.counters_are_their_own(
        core.host,
        sources,
        {"adc.dropped": 0, "adc.overrun": 1, "adc.timeout": 2, "cop_damaged": 5, "link.changes_lost": 8},
    )


def test_settings_cop4():
    build = {"Adc": 2, "ClkKhz": 4000, "Channels": 4, "Slip": 0, "Cop4": 1, "Correct": 1, "CopSlip": 1}
    build |= {"Lag": LAG, "Uart": 0, "SlipDepth": 2, "StatisticBits": 10}
    bench.run("core", "core", build, module="test_settings_cop4", inside=SEEN)
