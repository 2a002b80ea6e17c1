"""msn_sensor_array with frames on the stream, eight lanes wide, against numbers worked out by hand: 3 rows of
16 columns.

Each lane's taxel is made dead, railed and blinking in turn, alone and beside taxels that are not, and must be
reported in the frame that docs/array.md states. Frames too short and too long must be counted and give no
result; those after them must be right. Run by test_sensor_array.py.
"""

from fractions import Fraction

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge

import bench
import members

ROWS, COLUMNS, LANES = 3, 16, 8
BUILD = {"Rows": ROWS, "Columns": COLUMNS, "Converters": LANES, "Health": 1}
LIMITS = {"health_band": 29, "health_jump": 60, "health_low": 50, "health_high": 900}
DEAD, RAILED, BLINKING = 1, 2, 4  # docs/link.md
ZERO = 100 + 7 * np.arange(ROWS * COLUMNS).reshape(ROWS, COLUMNS)


class Stream:
    """Sends frames; ``sent``: frames since a clear; ``reports``: [(frame, taxel, faults)]."""

    async def begin(self, dut):
        self.dut, self.reports, self.results, self.forces = dut, [], [], []
        self.sent = self.total = 0
        # The preset gain is 1.0.
        self.settings = members.Settings(dut, "cfg", **LIMITS, calibrate_preset=4096, cop_min_load=1)
        given = {f"{name}_i": 0 for name in ("now", "pending", "busy", "adc_miso", "adc_busy")}
        await bench.start(dut, sample_ready_i=1, health_ready_i=1, **given)
        await bench.clocks(dut, 20)
        cocotb.start_soon(self.watch())
        return self

    async def watch(self):
        dut, taken = self.dut, []
        read = lambda name: bench.read(getattr(dut, name))
        while True:
            await FallingEdge(dut.clk_i)
            if read("health_valid_o"):
                report = members.of("health", read("health_o"))
                self.reports.append((self.sent, report["id"], report["faults"]))
            if read("sample_valid_o"):
                taken.append((read("sample_data_o"), read("sample_mask_o")))
                if read("sample_last_o"):
                    self.forces.append(taken)
                    taken = []
            if read("cop_valid_o"):
                cop = members.of("cop", read("cop_o"))
                self.results.append(
                    (*(bench.as_signed(cop[k], 24) for k in "xy"), cop["load"], cop["pressed"])
                )

    async def send(self, *frames, ends=None):
        """``ends``: how many beats of each frame are sent, the last one marked."""
        dut = self.dut
        for frame in frames:
            words = np.asarray(frame).reshape(-1, LANES)
            for beat in range(ends or len(words)):
                dut.in_valid_i.value, dut.in_id_i.value = 1, beat % len(words)
                dut.in_data_i.value = bench.lane_word(words[beat % len(words)], 17)
                dut.in_last_i.value = int(beat + 1 == (ends or len(words)))
                await ReadOnly()
                while dut.in_ready_o.value != 1:
                    await RisingEdge(dut.clk_i)
                    await ReadOnly()
                await RisingEdge(dut.clk_i)
            dut.in_valid_i.value = 0
            await bench.clocks(dut, 90)
            self.sent, self.total = self.sent + 1, self.total + 1

    async def clear(self, **limits):
        given = {"still": 0, "rail": 0, "blink": 0} | limits
        self.settings.put(**{f"health_{name}": value for name, value in given.items()})
        await self.settings.pulse(self.dut.clk_i, health_clear=1)
        await bench.clocks(self.dut, 4)
        self.reports, self.sent = [], 0

    def status(self, name):
        return members.of("status", bench.read(self.dut.status_o))[name]


def result_of(forces):
    """(x, y, load, pressed) by docs/cop.md, in exact rationals."""
    i, j = np.indices(forces.shape)
    load = int(forces.sum())
    x = Fraction(int(((2 * j - (COLUMNS - 1)) * forces).sum()) * 16384, (COLUMNS - 1) * load)
    y = Fraction(int((((ROWS - 1) - 2 * i) * forces).sum()) * 16384, (ROWS - 1) * load)
    return *(int(abs(part) + Fraction(1, 2)) * (1 if part > 0 else -1) for part in (x, y)), load, 1


def in_row_1(lanes):
    """1 in these columns of the middle row and in those eight to the right, else 0."""
    chosen = np.zeros((ROWS, COLUMNS), dtype=int)
    chosen[1, [*lanes, *(lane + 8 for lane in lanes)]] = 1
    return chosen


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def each_lane_has_its_own_faults(dut):
    """In the middle row, where a taxel has neighbours above and below."""
    stream = await Stream().begin(dut)
    for lanes in ((0, 2, 4, 6), (1, 3, 5, 7), (2, 5), (0, 3, 7)):
        chosen, both = in_row_1(lanes), [COLUMNS + lane for lane in (*lanes, *(lane + 8 for lane in lanes))]
        # Dead: constant while all others go up and down.
        await stream.clear(still=20)
        await stream.send(*(ZERO + 30 * (n % 2) * (1 - chosen) for n in range(8)))
        assert stream.reports == [(6, taxel, DEAD) for taxel in both]
        counts = [stream.status(f"health_{kind}") for kind in ("dead", "railed", "blinking")]
        assert counts == [2 * len(lanes), 0, 0]
        # Railed: at a limit in frames 0, 16, .. since reset; a neighbour one code off the limit is not
        # railed.
        await stream.clear(rail=1)
        ends = np.where(chosen, np.where(np.arange(COLUMNS) < 8, 900, 50), np.clip(ZERO, 51, 899))
        ends[0, 1], ends[2, 9] = 899, 51
        judged = -stream.total % 16
        assert 0 < judged < 16
        await stream.send(*[ends] * 16)
        assert stream.reports == [(judged, taxel, RAILED) for taxel in both]
        assert stream.status("health_railed") == 2 * len(lanes)
        # Blinking: jumps while nothing around it moves.
        apart = in_row_1(lanes[:1]) * (np.arange(COLUMNS) < 8) + in_row_1(lanes[-1:]) * (
            np.arange(COLUMNS) > 7
        )
        await stream.clear(blink=32)
        await stream.send(*(ZERO + 61 * (n % 2) * apart for n in range(5)))
        assert stream.reports == [(3, COLUMNS + taxel, BLINKING) for taxel in (lanes[0], 8 + lanes[-1])]
        # From then on masked: its force is 0 and its load does not count.
        last = np.where(apart, 0, ZERO)
        assert stream.forces[-1] == list(zip(last.ravel().tolist(), apart.ravel().tolist()))
        assert stream.results[-1] == result_of(last)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def frames_that_are_not_whole_are_counted(dut):
    stream = await Stream().begin(dut)
    wanted = []
    for n, ends in enumerate((None, 5, 1, None, 7, 11, None, 3, None)):
        await stream.send(ZERO + 3 * n, ends=ends)
        if ends is None:
            wanted.append(result_of(ZERO + 3 * n))
        assert stream.results == wanted, n
    assert stream.status("cop_damaged") == 5
    await bench.reset(dut)
    await bench.clocks(dut, 1)
    assert stream.status("cop_damaged") == 0
