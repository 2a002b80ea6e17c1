"""msn_cop_array, samples to centre of pressure, against its model: calibration per taxel and row times
column, one to eight lanes; forces to a second follower; exact clocks within 16, the same in every frame; gaps
and stalls; masks; damaged frames give no result and are counted, all complete frames around them give theirs;
calibrations swapped; resets."""

import random

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.cop.cop_array import CopArray, latency

FIELDS = ["x~", "y~", "load", "pressed"]
IDLE = {"tap_ready_i": 1, "cfg_write_i": 0, "cfg_write_row_i": 0, "cfg_swap_i": 0, "cfg_min_load_i": 2}


def setting(dut, *names):
    return [getattr(dut, name).value.to_unsigned() for name in names]


def twin_of(dut):
    rows, columns, lanes, fraction, row_column = setting(
        dut, "Rows", "Columns", "Lanes", "FractionBits", "RowColumn"
    )
    kinds = {"gain_shift": setting(dut, "GainShift")[0], "row_column": bool(row_column)}
    return CopArray(rows, columns, lanes, fraction, min_load=2, **kinds)


async def calibrate(dut, twin, rng):
    """Write a bank of offsets and gains around 1, with every sixth entry of any size, and swap banks."""
    table = twin.calibrate.table
    entries = [(False, word, lane) for word in range(table._beats.shape[2]) for lane in range(table.lanes)]
    entries += [(True, row, 0) for row in range(table.rows) if table.row_column]
    for of_row, word, lane in entries:
        offset, gain = int(rng.integers(-300, 900)), int(rng.integers(3000, 5000))
        if rng.random() < 1 / 6:
            offset, gain = int(rng.integers(*bench.width(table.offset_bits))), int(rng.integers(1 << 16))
        dut.cfg_word_i.value, dut.cfg_gain_i.value = word, gain
        dut.cfg_offset_i.value = offset & ((1 << table.offset_bits) - 1)
        dut.cfg_write_i.value, dut.cfg_write_row_i.value = 0 if of_row else 1 << lane, int(of_row)
        if of_row:
            table.write_row(word, offset, gain)
        else:
            table.write(word, offset, gain, lane)
        await bench.RisingEdge(dut.clk_i)
    dut.cfg_write_i.value = dut.cfg_write_row_i.value = 0
    dut.cfg_swap_i.value = 1
    await bench.RisingEdge(dut.clk_i)
    dut.cfg_swap_i.value = 0
    twin.calibrate.swap()


def samples(rng, twin, count):
    """Frames with a press somewhere: samples and masks [count, rows, columns]."""
    shape = (count, twin.rows, twin.columns)
    raw = rng.integers(-400, 1300, shape) + rng.integers(0, 60000, shape) * (rng.random(shape) < 0.1)
    raw = np.where(rng.random(shape) < 0.02, rng.integers(-65536, 65536, shape), raw)
    return raw, rng.random(shape) < 0.1


def beats_of(twin, raw, mask):
    table = twin.calibrate.table
    return bench.unnumbered(bench.lane_beats(raw, table.lanes, 17, surplus=65535, mask=mask))


def results(values):
    return [dict(zip(("x", "y", "load", "pressed"), map(int, frame))) for frame in values]


async def second_follower(dut, pause, taken):
    """Takes forces from the tap, with stalls: (lanes, masks, row's last, last) of each beat."""
    lanes = setting(dut, "Lanes")[0]
    while True:
        ready = not pause()
        dut.tap_ready_i.value = int(ready)
        await bench.ReadOnly()
        if ready and dut.tap_valid_o.value == 1:
            forces = bench.lane_values(bench.read(dut.tap_data_o), lanes, 16)
            masks = bench.lane_values(bench.read(dut.tap_mask_o), lanes, 1)
            taken.append((forces, masks, bench.read(dut.tap_row_last_o), bench.read(dut.tap_last_o)))
        await bench.RisingEdge(dut.clk_i)


def check_tap(taken, forces, mask):
    """The tap must have given all of ``forces`` and ``mask`` [frames, rows, columns], row by row, with their
    marks."""
    frames, rows, columns = forces.shape
    taken = iter(taken)
    for frame, row in np.ndindex(frames, rows):
        seen, masks, row_ends, ends = [], [], [], []
        while len(seen) < columns:
            values, flags, row_last, last = next(taken)
            seen, masks = seen + list(values), masks + list(flags)
            row_ends, ends = [*row_ends, row_last], [*ends, last]
        assert seen[:columns] == forces[frame, row].tolist()
        assert masks[:columns] == mask[frame, row].astype(int).tolist()
        assert row_ends == [0] * (len(ends) - 1) + [1]
        assert ends == [0] * (len(ends) - 1) + [row == rows - 1]
    assert not list(taken)


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    await bench.turn_over(dut, "damaged_o", wraps=False)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.4])
async def matches_model(dut, stall_rate):
    twin, rng = twin_of(dut), np.random.default_rng(bench.SEED)
    await bench.start(dut, **IDLE)
    pauses, taken = bench.gaps_and_stalls(stall_rate), []
    cocotb.start_soon(second_follower(dut, bench.pauses(1.5 * stall_rate, "second follower"), taken))
    for _ in range(2):
        await calibrate(dut, twin, rng)
        raw, mask = samples(rng, twin, 4 if twin.rows > 30 else 20)
        got = await bench.stream(dut, beats_of(twin, raw, mask), FIELDS, *pauses)
        forces = twin.calibrate.next(raw, mask)
        assert got == results(zip(*twin.of_forces(forces)))
        if dut.Tap.value:
            check_tap(taken, forces, mask)
            taken.clear()
        assert taken == []
    assert bench.read(dut.damaged_o) == 0


@bench.applies(lambda dut: twin_of(dut).rows <= 30)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def loses_nothing_while_nobody_takes_results(dut):
    twin, rng = twin_of(dut), np.random.default_rng(bench.SEED)
    await bench.start(dut, **IDLE)
    await calibrate(dut, twin, rng)
    raw, mask = samples(rng, twin, 7)
    beats = beats_of(twin, raw, mask)
    sent = await bench.taken(dut, beats)
    assert len(beats) * 3 / 7 < sent < len(beats)
    assert await bench.stream(dut, beats[sent:], FIELDS) == results(zip(*twin.next(raw, mask)))


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_load_counts_from_the_gate_on(dut):
    """The gate (minimum load) equal to a frame's own load, and one above it."""
    twin, rng = twin_of(dut), np.random.default_rng(bench.SEED)
    await bench.start(dut, **IDLE)
    await calibrate(dut, twin, rng)
    raw, mask = samples(rng, twin, 2 if twin.rows > 30 else 8)
    raw[0], mask[0] = 65535, False  # a load with bits set over the full width
    for frame, load in enumerate(twin.next(raw, mask)[2].tolist()):
        for gate in (load, load + 1):
            dut.cfg_min_load_i.value = twin.min_load = gate
            one = raw[frame : frame + 1], mask[frame : frame + 1]
            expected = results(zip(*twin.next(*one)))
            assert await bench.stream(dut, beats_of(twin, *one), FIELDS, count=1) == expected
            assert expected[0]["pressed"] == (gate == load > 0)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def clocks_are_as_stated(dut):
    """Each frame alone, and all back to back if they are long enough for the divider."""
    twin, rng = twin_of(dut), np.random.default_rng(bench.SEED)
    await bench.start(dut, out_ready_i=1, **IDLE)
    await calibrate(dut, twin, rng)
    await bench.clocks(dut, 6)
    lanes, fraction, per_clock, row_column = setting(
        dut, "Lanes", "FractionBits", "BitsPerClock", "RowColumn"
    )
    stated = latency(lanes, fraction, per_clock, bool(row_column))
    if (twin.rows, twin.columns, lanes, fraction) == (64, 64, 1, 14):
        assert stated <= 16
    raw, mask = samples(rng, twin, 3)
    beats = beats_of(twin, raw, mask)
    ends, seen = [], []
    for clock in range(len(beats) + stated + 2):
        dut.in_valid_i.value = int(clock < len(beats))
        bench.offer(dut, beats[min(clock, len(beats) - 1)])
        await bench.ReadOnly()
        if clock < len(beats):
            assert dut.in_ready_o.value == 1, f"waits at clock {clock}"
            if beats[clock]["last"]:
                ends.append(clock)
        if dut.out_valid_o.value == 1:
            seen.append(clock)
        await bench.RisingEdge(dut.clk_i)
    assert [after - before for before, after in zip(ends, seen)] == [stated] * 3


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.4])
async def no_damaged_frame_gives_a_result(dut, stall_rate):
    """Complete frames between damaged ones all give results; the counter counts all others."""
    twin, rng = twin_of(dut), np.random.default_rng(bench.SEED)
    await bench.start(dut, **IDLE)
    await calibrate(dut, twin, rng)
    raw, mask = samples(rng, twin, 6 if twin.rows > 30 else 60)
    lanes = twin.calibrate.table.lanes
    whole = bench.lane_beats(raw, lanes, 17, surplus=65535, mask=mask)
    length = len(whole) // len(raw)
    beats = bench.damage(whole, length, random.Random(bench.SEED + 1))
    beats = bench.placed(beats, twin.rows, length // twin.rows)
    expected = []
    for beat in beats:
        data = np.array(bench.lane_values(beat["data"], lanes, 17, signed=True))
        masked = np.array(bench.lane_values(beat["mask"], lanes, 1), bool)
        expected.append(twin.beat(data, beat["id"], beat["last"], masked, beat["fits"]))
    expected = results(result for result in expected if result)
    pauses = bench.gaps_and_stalls(stall_rate)
    assert await bench.stream(dut, bench.unnumbered(beats), FIELDS, *pauses) == expected
    assert bench.read(dut.damaged_o) == twin.damaged > 0
    assert len(expected) == sum(beat["last"] for beat in beats) - twin.damaged


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    twin, rng = twin_of(dut), np.random.default_rng(bench.SEED)
    await bench.start(dut, **IDLE)
    for cut in (0.2, 0.5, 1.4):
        raw, mask = samples(rng, twin, 2)
        beats = beats_of(twin, raw, mask)
        await calibrate(dut, twin, rng)
        await bench.stream(dut, beats[: int(cut * len(beats) / 2)], FIELDS, drain=0)
        await bench.reset(dut)
        twin.reset()
        await calibrate(dut, twin, rng)
        assert await bench.stream(dut, beats, FIELDS) == results(zip(*twin.next(raw, mask)))
        assert bench.read(dut.damaged_o) == 0


EVIDENCE = {
    "reference": {
        "against": "`centre` of forces rounded as `Fraction`",
        "test": "tb/cop/test_cop_reference.py::test_cop_array_is_the_centre_of_rounded_forces",
    },
    "equivalence": {"size": {"Rows": 5}, "defined": True, "boxes": True, "open": ["reset"]},
    "faults": {
        "size": {"Rows": 5},
        "settle": 4,
        # The tables, the bank in use and whether one is loaded keep a fault until they are written again.
        "driver": {"kept": "memory gains offsets rows bank loaded cfg_swapping"},
    },
    "icarus": {"runs": {"Lanes": 1}},
}


@pytest.mark.parametrize(
    "rows, columns, lanes, gain_shift, row_column, tap",
    [(64, 64, 1, 12, 0, 0), (32, 32, 1, 12, 0, 0), (5, 19, 2, 12, 0, 1), (24, 61, 8, 24, 1, 0)],
)
def test_cop_array(rows, columns, lanes, gain_shift, row_column, tap):
    size = {"Rows": rows, "Columns": columns, "Lanes": lanes, "Tap": tap}
    bench.run("cop", "cop_array", size | {"GainShift": gain_shift, "RowColumn": row_column})


def test_a_uniform_press_is_uniform_after_calibration_only():
    """Gains spread by 30 %: the image of a uniform press is uniform within 1 % if calibrated, and not
    otherwise."""
    rng = np.random.default_rng(3)
    gain, zero = rng.uniform(0.7, 1.3, (16, 16)), rng.integers(100, 900, (16, 16))
    raw = np.rint(zero + 8000 * gain).astype(np.int64)
    twin = CopArray(16, 16)
    for word, (offset, factor) in enumerate(zip(zero.ravel(), np.rint(4096 / gain).astype(int).ravel())):
        twin.calibrate.table.write(word, offset, factor)
    x, y, load, _ = twin.process(raw)
    image = twin.calibrate.next(raw)
    assert np.ptp(raw) / raw.mean() > 0.3
    assert np.ptp(image) / image.mean() < 0.01
    assert max(abs(int(x)), abs(int(y))) <= 3 and abs(load / (256 * 8000) - 1) < 0.01


def test_stated_latency():
    assert latency() == 14
    assert latency(lanes=8, bits_per_clock=1, row_column=True) == 36
