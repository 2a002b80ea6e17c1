"""msn_array with frames on the stream, eight lanes wide, against numbers worked out by hand: 3 rows of 16
columns.

Each lane's taxel is made dead, railed and blinking in turn, alone and beside taxels that are not, and must be
reported in the frame that docs/array.md states. Frames too short and too long must be counted and give no
result; those after them must be right. Run by test_array.py.
"""

from fractions import Fraction

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge

import bench

ROWS, COLUMNS, LANES = 3, 16, 8
BUILD = {"Part": 0, "Rows": ROWS, "Columns": COLUMNS, "Converters": LANES, "Tare": 0, "Tap": 1}
LIMITS = {"band": 29, "jump": 60, "low": 50, "high": 900, "over_range_enable": 0, "edges": 0}
ZERO = 100 + 7 * np.arange(ROWS * COLUMNS).reshape(ROWS, COLUMNS)


class Stream:
    """Sends frames; ``sent``: frames since a clear; ``events``: [(frame, beat, dead, railed, blinking)]."""

    async def begin(self, dut):
        self.dut, self.events, self.results, self.forces = dut, [], [], []
        self.sent = self.total = 0
        given = {
            port._name: 0
            for port in dut
            if port._name.startswith(("cfg_", "in_", "adc_")) and "_i" in port._name
        }
        given |= {f"cfg_{name}_i": value for name, value in (LIMITS | {"min_load": 1, "gain": 4096}).items()}
        given |= {"now_i": 0, "busy_i": 0, "tap_ready_i": 1, "event_ready_i": 1}
        await bench.start(dut, **given)
        dut.out_ready_i.value = 1
        dut.cfg_write_i.value = 0xFF
        for word in range(ROWS * COLUMNS // LANES):
            dut.cfg_word_i.value = word
            await RisingEdge(dut.clk_i)
        dut.cfg_write_i.value, dut.cfg_swap_i.value = 0, 1
        await RisingEdge(dut.clk_i)
        dut.cfg_swap_i.value = 0
        await bench.clocks(dut, 8)
        cocotb.start_soon(self.watch())
        return self

    async def watch(self):
        dut, tapped = self.dut, []
        read = lambda name: bench.read(getattr(dut, name))
        while True:
            await FallingEdge(dut.clk_i)
            if read("event_valid_o"):
                kinds = ("id", "dead", "railed", "blinking")
                self.events.append((self.sent, *(read(f"event_{kind}_o") for kind in kinds)))
            if read("tap_valid_o"):
                masks = bench.lane_values(read("tap_mask_o"), LANES, 1)
                tapped += zip(bench.lane_values(read("tap_data_o"), LANES, 16), masks)
                if read("tap_last_o"):
                    self.forces.append(tapped)
                    tapped = []
            if read("out_valid_o"):
                x, y = (bench.as_signed(read(f"out_{name}_o"), len(dut.out_x_o)) for name in "xy")
                self.results.append((x, y, read("out_load_o"), read("out_pressed_o")))

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
            await bench.clocks(dut, 60)
            self.sent, self.total = self.sent + 1, self.total + 1

    async def clear(self, **limits):
        for name, value in ({"still": 0, "rail": 0, "blink": 0} | limits).items():
            getattr(self.dut, f"cfg_{name}_i").value = value
        self.dut.cfg_clear_i.value = 1
        await RisingEdge(self.dut.clk_i)
        self.dut.cfg_clear_i.value = 0
        await bench.clocks(self.dut, 4)
        self.events, self.sent = [], 0


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
        chosen, bits = in_row_1(lanes), sum(1 << lane for lane in lanes)
        # Dead: constant while all others go up and down.
        await stream.clear(still=20)
        await stream.send(*(ZERO + 30 * (n % 2) * (1 - chosen) for n in range(8)))
        assert stream.events == [(6, 2, bits, 0, 0), (6, 3, bits, 0, 0)]
        assert [bench.read(getattr(dut, f"{kind}_o")) for kind in ("dead", "railed", "blinking")] == [
            2 * len(lanes),
            0,
            0,
        ]
        # Railed: at a limit in frames 0, 16, .. since reset; a neighbour one code off the limit is not
        # railed.
        await stream.clear(rail=1)
        ends = np.where(chosen, np.where(np.arange(COLUMNS) < 8, 900, 50), np.clip(ZERO, 51, 899))
        ends[0, 1], ends[2, 9] = 899, 51
        judged = -stream.total % 16
        assert 0 < judged < 16
        await stream.send(*[ends] * 16)
        assert stream.events == [(judged, 2, 0, bits, 0), (judged, 3, 0, bits, 0)]
        assert bench.read(dut.railed_o) == 2 * len(lanes)
        # Blinking: jumps while nothing around it moves.
        apart = in_row_1(lanes[:1]) * (np.arange(COLUMNS) < 8) + in_row_1(lanes[-1:]) * (
            np.arange(COLUMNS) > 7
        )
        await stream.clear(blink=32)
        await stream.send(*(ZERO + 61 * (n % 2) * apart for n in range(5)))
        assert stream.events == [(3, 2, 0, 0, 1 << lanes[0]), (3, 3, 0, 0, 1 << lanes[-1])]
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
    assert bench.read(dut.damaged_o) == 5
    await bench.reset(dut)
    await bench.clocks(dut, 1)
    assert bench.read(dut.damaged_o) == 0
