"""Small blocks of the front end against literals worked out by hand from their pages and headers."""

from fractions import Fraction

import numpy as np
import pytest

from meissner.twins.frontend import adc_store, timing
from meissner.twins.frontend.acquire import Acquire
from meissner.twins.frontend.adc_single import AdcSingle
from meissner.twins.frontend.adc_spi import (
    AD7606,
    AD7606C,
    MAX11123,
    MAX11124,
    MAX11125,
    MAX11131,
    MCP3208,
    AdcSpi,
)
from meissner.twins.frontend.am_demod import references
from meissner.twins.frontend.scan_plan import ScanPlan, Settings
from meissner.twins.frontend.timing import time_stamps

CODES = {  # code: (sample, over-range), by docs/adc.md
    MCP3208: {0: (0, 1), 1: (1, 0), 2047: (2047, 0), 2048: (2048, 0), 4094: (4094, 0), 4095: (4095, 1)},
    AD7606: {
        0x7FFF: (32767, 1),
        0x7FFE: (32766, 0),
        0x8000: (-32768, 1),
        0x8001: (-32767, 0),
        0xFFFF: (-1, 0),
    },
    AD7606C: {0x7FFF: (32767, 1), 0x7FFD: (32765, 0), 0x8000: (-32768, 1), 0xFFFE: (-2, 0)},
    MAX11123: {0: (0, 1), 1: (1, 0), 128: (128, 0), 254: (254, 0), 255: (255, 1)},
    MAX11124: {0: (0, 1), 1: (1, 0), 1022: (1022, 0), 1023: (1023, 1)},
    MAX11125: {0: (0, 1), 4094: (4094, 0), 4095: (4095, 1)},
    MAX11131: {0: (0, 1), 2: (2, 0), 4093: (4093, 0), 4095: (4095, 1)},
}


@pytest.mark.parametrize("part", CODES, ids=lambda part: part.name)
def test_samples_by_hand(part):
    codes, expected = list(CODES[part]), list(CODES[part].values())
    twins = [AdcSpi(part), Acquire(part)] + ([AdcSingle()] if part is MCP3208 else [])
    for twin in twins:
        data, over = twin.samples(codes)
        assert list(zip(np.asarray(data).tolist(), np.asarray(over, int).tolist())) == expected
    data, over = adc_store.samples(codes, part.data_bits, 17, part in (AD7606, AD7606C))
    assert list(zip(data.tolist(), over.astype(int).tolist())) == expected


def test_bursts_by_hand():
    """The first trigger is a clock after the start; a start ends a running burst from the next clock on."""
    assert timing.triggers([10], 3, 5, 100) == [11, 16, 21]
    assert timing.triggers([10], 3, 5, 21) == [11, 16]
    assert timing.triggers([10, 16], 3, 5, 100) == [11, 16, 17, 22, 27]
    assert timing.triggers([10, 15], 3, 5, 100) == [11, 16, 21, 26]
    assert timing.triggers([10], 1, 9, 100) == [11]
    assert timing.samples(skip=3, periods=5, samples_per_period=8) == 43


def test_time_stamps_by_hand():
    """For each frame, the last convert start before its first sample was offered; one in the same clock is
    too late. Read during the next conversion, the last one before its read began."""
    convert, sample, last = (1, 0, 0, 0, 0), (0, 1, 0, 0, 0), (0, 1, 1, 1, 0)
    waits = (0, 1, 0, 1, 0)  # the last sample, not taken yet
    idle, both, read = (0, 0, 0, 0, 0), (1, 1, 1, 1, 0), (0, 0, 0, 0, 1)
    clocks = [idle, convert, idle, sample, waits, last, convert, convert, waits, both, last, last]
    #         0     1        2     3       4      5     6        7        8      9     10    11
    assert time_stamps(clocks) == [1, 7, 9, 9]
    converts_and_reads, last_and_read = (1, 0, 0, 0, 1), (0, 1, 1, 1, 1)
    clocks = [convert, read, convert, last, converts_and_reads, last, last_and_read, convert, last]
    #         0        1     2        3     4                   5     6              7        8
    assert time_stamps(clocks, read_during=True) == [0, 2, 2, 4]


def test_references_of_a_carrier_by_hand():
    """docs/demod.md: N = 4: 1, 0; 8: 5, 2; 16: 5, 1 and 4, 3; within 0.2 of a cosine of amplitude 1."""
    quarter = {4: [1, 0], 8: [5, 2, -2, -5], 16: [5, 4, 3, 1, -1, -3, -4, -5]}
    for count, half in quarter.items():
        cosine = [*half, *(-value for value in half)]
        i, q = references(count).tolist()
        assert i == cosine
        assert q == [cosine[(k - count // 4) % count] for k in range(count)]
        turn = np.cos(2 * np.pi * (np.arange(count) + (count > 4) / 2) / count)
        size = max(cosine) / turn.max()
        assert np.abs(np.array(cosine) / size - turn).max() < 0.2


@pytest.mark.parametrize("rows, columns, lanes, channels", [(3, 7, 1, 2), (5, 30, 2, 8), (4, 3, 8, 1)])
def test_places_of_a_scan_by_their_columns(rows, columns, lanes, channels):
    """column = (group channels + channel) lanes + lane: only groups that contain a column are scanned."""
    plan = ScanPlan(rows, columns, lanes, channels)
    groups = sorted({column // lanes // channels for column in range(columns)})
    assert plan.places() == [(row, group) for row in range(rows) for group in groups]
    order = [*range(0, rows, 2), *range(1, rows, 2)]
    assert plan.places(interleave=True) == [(row, group) for row in order for group in groups]


@pytest.mark.parametrize(
    "count, rows",
    [(1, [0]), (2, [0, 1]), (3, [0, 2, 1]), (6, [0, 2, 4, 1, 3, 5]), (7, [0, 2, 4, 6, 1, 3, 5])],
)
def test_every_second_row_by_hand(count, rows):
    assert ScanPlan(count, 2, 1, 2).places(interleave=True) == [(row, 0) for row in rows]


def test_a_scan_by_hand():
    """2 x 5 with two inputs: three groups a row. Slots: 20 clocks at settle 4, 30 + 1 + 3 at settle 30."""
    plan = ScanPlan(2, 5, 1, 2, hold=3, cycle=20)
    done, overrun = plan.schedule(Settings(settle=4), 4 + 7 * 20)
    assert [(c.switch, c.trigger, c.row, c.group, c.first) for c in done] == [
        (4, 9, 0, 0, True),
        (24, 29, 0, 1, False),
        (44, 49, 0, 2, False),
        (64, 69, 1, 0, False),
        (84, 89, 1, 1, False),
        (104, 109, 1, 2, False),
        (124, 129, 0, 0, True),
    ]
    assert (overrun, plan.slot(4), plan.slot(16), plan.slot(17), plan.slot(30)) == (0, 20, 20, 21, 34)
    # Ticks at 4, 134, 264 for frames of 120 clocks; at a period of 60 every second tick comes during a frame.
    done, overrun = plan.schedule(Settings(settle=4, period=130), 300)
    assert [c.switch for c in done if c.first] == [4, 134, 264] and overrun == 0
    done, overrun = plan.schedule(Settings(settle=4, period=60), 310)
    assert [c.switch for c in done if c.first] == [4, 124, 244] and overrun == 3
    # The last switch of a frame from 4 on is at 104: a tick at 106 is too early, one at 107 waits.
    done, overrun = plan.schedule(Settings(settle=4, period=102), 330)
    assert [c.switch for c in done if c.first] == [4, 208] and overrun == 2
    done, overrun = plan.schedule(Settings(settle=4, period=103), 330)
    assert [c.switch for c in done if c.first] == [4, 124, 313] and overrun == 1


def test_a_half_of_a_bit_is_no_clock_short():
    """docs/adc.md, the table of configurations: half bit, first and last sample, shortest period."""
    rows = {
        (MCP3208, 1, 1, 12_000, 2_000): (3, 114, 114, 121),
        (MCP3208, 8, 1, 25_000, 1_000): (13, 494, 4134, 4161),
        (MCP3208, 8, 1, 48_000, 2_000): (12, 456, 3816, 3841),
        (MAX11123, 8, 1, 25_000, 16_000): (1, 313, 320, 321),
        (MAX11125, 8, 1, 100_000, 16_000): (4, 1252, 1259, 1261),
        (MAX11131, 8, 1, 100_000, 48_000): (2, 626, 633, 634),  # 9 · 70 - 4, then 8 samples
    }
    for (part, channels, lanes, clk, sclk), (half, first, last, period) in rows.items():
        twin = AdcSpi(part, channels=channels, lanes=lanes, clk_khz=clk, sclk_khz=sclk)
        assert (twin.half, twin.latencies()[0], twin.latencies()[-1]) == (half, first, last)
        assert twin.minimum_period() == period
        assert Fraction(clk, 2 * half) <= sclk


@pytest.mark.parametrize(
    "part, channels, lanes, clk, sclk, cycle, hold",
    [
        # 8 frames of 20 bits of 26 clocks, plus one; the last channel is sampled at its sixth falling edge
        (MCP3208, 8, 1, 25_000, 1_000, 4161, 7 * 520 + 12 * 13 + 1),
        (MCP3208, 1, 1, 12_000, 2_000, 121, 12 * 3 + 1),
        # 4.2 us are 105 clocks, seen after one; 3, 129 bits of 2 clocks; the watchdog's 256 + 8 + 4 are fewer
        (AD7606, 8, 1, 25_000, 14_500, 106 + 3 + 258, 2),
        # 65 bits on each of two lanes: now the watchdog needs more
        (AD7606, 8, 2, 25_000, 14_500, 268, 2),
        (AD7606, 8, 2, 100_000, 14_500, 1036, 4),  # 8.4 us are 840 clocks, so 1024; 25 ns are three, plus one
        # 0.7 us are 70 clocks, seen after one; 3, 17 bits of 4 clocks for each of four words
        (AD7606C, 8, 2, 100_000, 60_000, 71 + 3 + 4 * 68, 4),
        # one word: the watchdog's 1.4 us are 140 clocks, so 256
        (AD7606C, 8, 8, 100_000, 60_000, 256 + 8 + 4, 4),
        (AD7606C, 8, 1, 25_000, 60_000, 18 + 3 + 8 * 34, 2),
        # 5.6 clocks; two words of 17 bits but the last one's rest, then five more samples
        (AD7606C, 7, 4, 8_000, 60_000, 6 + 3 + 2 * 34 - 2 + 5, 2),
        # 9 frames of 17.5 bits of 2 clocks, 8 samples, and 4 more for a lost one
        (MAX11125, 8, 1, 25_000, 16_000, 9 * 35 + 8 + 4, 8 * 35 + 1),
        (MAX11131, 8, 1, 100_000, 48_000, 9 * 70 + 8 + 4, 8 * 70 + 1),
        (MAX11123, 3, 1, 100_000, 16_000, 4 * 140 + 3 + 4, 3 * 140 + 1),
    ],
)
def test_clocks_between_triggers_by_hand(part, channels, lanes, clk, sclk, cycle, hold):
    """From trigger to trigger, and from convert start until the lines may change: docs/adc.md,
    msn_adc_pkg."""
    twin = AdcSpi(part, channels=channels, lanes=lanes, clk_khz=clk, sclk_khz=sclk)
    assert (twin.cycle_clocks(), twin.hold_clocks()) == (cycle, hold)


def read_during_fits(slot, half, words, extra, clk_khz, least, most, rests):
    """docs/adc.md in nanoseconds: whether a frame's read ends in time for the next conversion, for the
    longest and the shortest conversion after one another. A fall of BUSY at an edge may be seen there.
    ``rests``: CS is high for a bit between words."""
    clock = Fraction(1_000_000, clk_khz)
    for first, second in ((least, least), (most, least), (least, most), (most, most)):
        for late in (0, 1):
            seen = lambda ns, late: (ns // clock) if late or ns % clock else ns // clock - 1
            start = seen(first, 1) + 2  # the clock before CS falls; BUSY passes two registers
            ends = start + 1 + 2 * half * (16 * words + rests * (words - 1))  # CS rises
            begins = slot + seen(second, late) + 2  # of the next read
            if slot * clock + second - ends * clock < 25 or ends + 2 * half - 1 >= begins:
                return False
            # Two registers behind the last word, samples of more lanes one by one; the next tick is in Idle.
            if ends + extra > begins or slot - 1 <= start:
                return False
    return True


@pytest.mark.parametrize(
    "part, channels, lanes, clk, sclk, half, cycle, after",
    [
        # 4.2 us are 420 clocks, 3 to CS; 64 bits of 8 clocks, a rest of 8; of these 344 + 2 may overlap BUSY
        (AD7606, 8, 2, 100_000, 14_500, 4, 420 + 3 + 520 - 346, 1036),
        (AD7606, 8, 2, 100_000, 17_000, 3, 500, 1036),  # 5 us: the transfer, 390 clocks, needs 467
        # 64 bits of 2 clocks, 3425 ns are 85: 151; the last of 4 + 4 samples leaves as the next read begins
        (AD7606, 8, 2, 25_000, 14_500, 1, 105 - 86 + 128 + 1 + 4, 268),
        (AD7606, 8, 1, 25_000, 14_500, 1, 105 + 3 + 256 - 85, 367),
        (AD7606, 5, 2, 50_000, 17_000, 2, 210 + 3 + 256 + 4 - 174, 521),
        (AD7606, 3, 1, 8_000, 14_500, 1, 33 + 3 + 96 + 2 - 29, 135),
        (AD7606, 1, 1, 20_000, 14_500, 1, 100, 261),  # 5 us
        # 500 to 700 ns, words of 17 bits but for the last rest: 4 of 68 clocks less 475 ns; 2 of 136 less 51.
        (AD7606C, 8, 2, 100_000, 60_000, 2, 70 + 3 + 268 - 47, 346),
        (AD7606C, 7, 4, 100_000, 16_000, 4, 70 + 3 + 272 - 51, 346),
        (AD7606C, 8, 8, 25_000, 60_000, 1, 17 - 12 + 32 + 1 + 7, 76),  # the last of 1 + 7 samples
        (AD7606C, 8, 8, 100_000, 60_000, 2, 100, 268),  # 1 us
    ],
)
def test_a_read_during_a_conversion_ends_in_time(part, channels, lanes, clk, sclk, half, cycle, after):
    """The greater of cycle and transfer in place of their sum: no clock less will do, unless it is the part's
    own cycle."""
    least, most, own, rests = (3450, 4200, 5000, 0) if part is AD7606 else (500, 700, 1000, 1)
    sizes = {"part": part, "channels": channels, "lanes": lanes, "clk_khz": clk, "sclk_khz": sclk}
    twin = AdcSpi(**sizes, read_during=True)
    assert (twin.half, twin.cycle_clocks(), AdcSpi(**sizes).cycle_clocks()) == (half, cycle, after)
    words = 8 // lanes if lanes > 1 else channels
    given = half, words, (channels - words if lanes > 1 else 0), clk, least, most, rests
    assert read_during_fits(cycle, *given)
    assert Fraction(cycle * 1_000_000, clk) == own or not read_during_fits(cycle - 1, *given)
    assert twin.latencies() == AdcSpi(**sizes).latencies()  # from BUSY on nothing changes
    # It is given up 3 clocks after the longest conversion; a sample comes after the turn to its conversion.
    assert twin.watch_clocks == most * clk // 1_000_000 + 4 < cycle
    assert twin.overlap_clocks() == min(twin.watch_clocks, least * clk // 1_000_000 + 2 + 32 * half)
