"""Two cores of the greatest sizes with samples on the stream, against numbers worked out by hand: an array of
1024 x 1024 taxels, eight columns a beat, and 2100 channels with the highest wavelet level.

The array gets one frame in which every force saturates, and frames whose few forces add up to loads of known
bits: the load has 36 bits and a taxel's number 20, and each bit changes. Three taxels jump, are reported
blinking in the next frame and are masked from then on; each is reported again on request. The channels slip
with full-scale details of 20 bits and with random samples; incomplete frames are counted and give no
decision. Run by test_core.py.
"""

from fractions import Fraction

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge, Timer

import bench
from core import pins
from meissner.twins.link.registers import RESET_BITS, reset_word

# The array. The gain is 1.5; codes of 60000 and more saturate the force, at 65535.
SIDE, LANES, BEATS = 1024, 8, 1024 * 1024 // 8
QUIET = 45_000  # a step from here to 0 or to 65535 is neither a move nor a jump
ARRAY_SETTINGS = {
    **{"calibrate.preset": 6144, "cop.min_load": 1, "health.band": 45_000, "health.jump": 50_000},
    **{"health.still": 0, "health.rail": 0, "health.blink": 16},
}
JUMPING = (0x0F0F0, 0x55555, 0xAAAAA)
# The channels. Contact is never lost, and each window of two details may slip.
CHANNELS, GROUP = 2100, 8
CHANNELS_SETTINGS = {
    **{"slip.threshold": 1000, "slip.gross_threshold": 0xFFFFF, "slip.contact_level": -524_288},
    **{"slip.release_level": -524_288, "slip.hold": 0, "slip.refractory": 0, "slip.blank": 0},
}
ARRAY = {"Array": 1, "Rows": SIDE, "Columns": SIDE, "Converters": LANES, "Health": 1, "Slip": 0}
MOST = {"Channels": CHANNELS, "Level": 3, "Window": 2 * GROUP, "Hop": 2 * GROUP}
COMMON = {"ClkKhz": 4000, "Uart": 0, "Statistics": 0}
BUILDS = {
    name: build | COMMON | {"Resets": f"{RESET_BITS}'h{reset_word(settings):x}"}
    for name, build, settings in (("array", ARRAY, ARRAY_SETTINGS), ("channels", MOST, CHANNELS_SETTINGS))
}
SLIPPING = (0, 1, 2, 4, 8, 16, 32, 64, 128, 256, 341, 512, 682, 1024, 1365, 2048, 2099)


def number(dut, name):
    return getattr(dut, name).value.to_unsigned()


async def begin(dut):
    dut.in_id_i.value, dut.in_data_i.value, dut.in_last_i.value = 0, 0, 0
    host, _ = await pins.begin(dut, lambda dut: None)
    return host


def force(code):
    """1.5 times the code, ties up, saturated."""
    return min(65535, (3 * code + 1) // 2)


def cop_of(forces):
    """(x, y, load, pressed) of {taxel: force}: docs/cop.md in exact rationals."""
    load = sum(forces.values())
    x = sum((2 * (taxel % SIDE) - (SIDE - 1)) * f for taxel, f in forces.items())
    y = sum(((SIDE - 1) - 2 * (taxel // SIDE)) * f for taxel, f in forces.items())
    parts = [Fraction(moment * 16384, (SIDE - 1) * load) for moment in (x, y)]
    return *(int(abs(part) + Fraction(1, 2)) * (1 if part > 0 else -1) for part in parts), load, 1


async def frame_of(dut, host, codes, rest):
    """Send a frame: ``codes`` {taxel: code}, all others ``rest``; the clock in which its first beat is taken.

    After its first beat, the frame must not be stalled.
    """
    beats, whole = {}, sum(rest << 17 * lane for lane in range(LANES))
    for taxel, code in codes.items():
        beat, lane = divmod(taxel, LANES)
        beats[beat] = beats.get(beat, whole) & ~(0x1FFFF << 17 * lane) | code << 17 * lane
    dut.in_valid_i.value, dut.in_id_i.value, dut.in_data_i.value = 1, 0, beats.get(0, whole)
    await ReadOnly()
    while dut.in_ready_o.value != 1:
        await RisingEdge(dut.clk_i)
        await ReadOnly()
    at, falls = host.clock(), []

    async def watch():
        await FallingEdge(dut.in_ready_o)
        falls.append(bench.read(dut.in_id_i))

    watching = cocotb.start_soon(watch())
    await RisingEdge(dut.clk_i)
    ident, data = dut.in_id_i, dut.in_data_i
    for beat in range(1, BEATS):
        ident.value = beat
        if beat in beats or beat - 1 in beats:
            data.value = beats.get(beat, whole)
        if beat == BEATS - 1:
            dut.in_last_i.value = 1
        await RisingEdge(dut.clk_i)
    assert not falls, f"held up at {falls}"
    watching.cancel()
    dut.in_valid_i.value = dut.in_last_i.value = 0
    await pins.rest(dut, 3000)
    return at


@bench.applies(lambda dut: number(dut, "Array"))
@cocotb.test(timeout_time=1, timeout_unit="sec")
async def every_bit_of_the_largest_array(dut):
    host = await begin(dut)
    await Timer(pins.PERIOD_NS * (BEATS + 100), "ns")
    await RisingEdge(dut.clk_i)
    assert await host.read("core.size") == [SIDE << 16 | SIDE]
    low = dict.fromkeys(JUMPING, 14_000)  # 51535 lower
    few = dict.fromkeys((3, 1030, 9999, 500_000), 65_535)
    many = few | dict.fromkeys((80, 1107, 10_076, 500_077, 900_077, 1_048_575), 65_535)
    frames = [
        (dict.fromkeys(JUMPING, 65_535), QUIET),
        (low, 0),
        (low | few | {40: 16_255, 777_777: 1}, 0),
        (low | many | {40: 29_132, 777_777: 1}, 0),
    ]
    pressed = [{taxel: force(code) for taxel, code in codes.items()} for codes, _ in frames]
    for taxel in JUMPING:
        del pressed[3][taxel]
    cops = [(0, 0, 65_535 << 20, 1), *map(cop_of, pressed[1:])]
    assert [load for _, _, load, _ in cops] == [0xF_FFF0_0000, 63_000, 0x5_5555, 0xA_AAAA]
    times = []
    for n, (codes, rest) in enumerate(frames):
        if n == 3:
            await host.write(health__report=1)
        times.append(await frame_of(dut, host, codes, rest))
    found = host.of_kind(pins.COP)
    assert [pins.cop_of(packet) for packet in found] == cops
    assert [packet.time for packet in found] == times
    reports = host.of_kind(pins.HEALTH)
    assert [pins.health_of(packet) for packet in reports] == [(taxel, 4) for taxel in JUMPING] * 2
    # Each report comes when its taxel passes: in the frame after the jump, and in the frame after a request.
    for place, packet in enumerate(reports):
        since = packet.time - times[2 + place // 3] - JUMPING[place % 3] // LANES
        assert 0 < since < 60, since
    assert await host.read("health.dead", "health.railed", "health.blinking") == [0, 0, 3]
    # Every bit of the counters: up to all taxels, 2^20.
    sources = {
        f"health.{kind}": getattr(dut.gen_array.u_sensor.u_forces.gen_health.u_health, f"{kind}_count")
        for kind in ("dead", "railed", "blinking")
    }
    for turn in (0, 1, 0):
        values = pins.put(sources, turn)
        assert await host.read(*sources) == list(values.values())
    assert {len(source) for source in sources.values()} == {21}


def scene():
    """Samples [16, channels]: two details of eight each. Most channels are constant, each at its own
    value."""
    rng = np.random.default_rng(bench.SEED)
    codes = np.repeat((np.arange(CHANNELS) * 61 % 131_072 - 65_536)[None], 2 * GROUP, axis=0)
    codes[:, list(SLIPPING)] = rng.integers(-65_536, 65_536, (2 * GROUP, len(SLIPPING)))
    greatest = [65_535] * 4 + [-65_536] * 8 + [65_535] * 4
    codes[:, 682] = greatest
    codes[:, 1365] = [-1 - code for code in greatest]
    return codes


def slips(codes):
    """(channel, peak-to-peak, incipient) of the channels whose two details differ by more than 1000."""
    found = []
    for channel in range(CHANNELS):
        x = codes[:, channel].tolist()
        details = [sum(x[at : at + 4]) - sum(x[at + 4 : at + 8]) for at in (0, 8)]
        if abs(details[0] - details[1]) > 1000:
            found.append((channel, abs(details[0] - details[1]), 2))
    return found


async def send(dut, host, ids, values):
    """Send the samples of a frame; return the clock in which the first one is taken."""
    at = None
    for place, (ident, value) in enumerate(zip(ids, values)):
        dut.in_valid_i.value, dut.in_id_i.value = 1, int(ident)
        dut.in_data_i.value = int(value) & 0x1FFFF
        dut.in_last_i.value = int(place == len(ids) - 1)
        await ReadOnly()
        while dut.in_ready_o.value != 1:
            await RisingEdge(dut.clk_i)
            await ReadOnly()
        at = host.clock() if at is None else at
        await RisingEdge(dut.clk_i)
    dut.in_valid_i.value = dut.in_last_i.value = 0
    return at


@bench.applies(lambda dut: not number(dut, "Array"))
@cocotb.test(timeout_time=1, timeout_unit="sec")
async def every_bit_of_the_most_samples(dut):
    host, codes = await begin(dut), scene()
    expected = slips(codes)
    assert [channel for channel, *_ in expected] == list(SLIPPING)
    assert {p2p for channel, p2p, _ in expected if channel in (682, 1365)} == {8 * 131_071}
    whole = range(CHANNELS)
    times = [await send(dut, host, whole, frame) for frame in codes]
    await pins.rest(dut, 3000)
    found = host.of_kind(pins.SLIP)
    assert [pins.slip_of(packet) for packet in found] == expected
    assert {packet.time for packet in found} == {times[-1]}
    # A frame too short and one with a channel twice: both are counted, and their samples close no window.
    assert await host.read("slip.damaged", "slip.blanked") == [0, 0]
    await send(dut, host, range(700), [0] * 700)
    await send(dut, host, [0, 1, 1, *range(2, CHANNELS)], [0] * (CHANNELS + 1))
    await pins.rest(dut, 3000)
    assert await host.read("slip.damaged", "slip.blanked") == [2, 0]
    assert host.of_kind(pins.SLIP) == found
