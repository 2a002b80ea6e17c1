"""msn_cop, sums and division together, against its model: corner-case and random frames of every size class,
also mirrored, which must mirror the result exactly; gaps and stalls; exact clocks, the same in every frame;
frames so short that the divider must keep up; damage, reset in mid-frame. The 1 ms: test_cop_budget."""

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.common.divide import steps
from meissner.twins.cop.cop import cop, latency

FIELDS = ["x~", "y~", "load", "pressed"]


def parameters(dut):
    names = ("Rows", "Columns", "Lanes", "FractionBits", "BitsPerClock")
    return [getattr(dut, name).value.to_unsigned() for name in names]


def clocks_stated(dut):
    _, _, lanes, fraction_bits, bits_per_clock = parameters(dut)
    return latency(lanes, fraction_bits, bits_per_clock)


def taxels(dut):
    rows, columns, *_ = parameters(dut)
    return rows * columns


def small(dut):
    return taxels(dut) <= 10**5


def expected_of(forces, fraction_bits, min_load):
    x, y, load, pressed = cop(forces, fraction_bits, min_load)
    results = zip(x.tolist(), y.tolist(), load.tolist(), map(int, pressed))
    return [dict(zip(("x", "y", "load", "pressed"), result)) for result in results]


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    await bench.turn_over(dut, "damaged_o", wraps=False)


@bench.applies(small)
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.4])
async def matches_model_and_mirrors(dut, stall_rate):
    """Each frame flipped left-right and top-bottom: the same load, with x or y negated."""
    rows, columns, lanes, fraction_bits, _ = parameters(dut)
    await bench.start(dut, cfg_min_load_i=2)
    forces = bench.force_frames(np.random.default_rng(bench.SEED), rows, columns)
    if rows * columns > 1000:
        forces = forces[[1, 3, 8, 12, -2, -1]]
    forces = np.stack([forces, forces[:, :, ::-1], forces[:, ::-1, :]], axis=1).reshape(-1, rows, columns)
    pauses = bench.gaps_and_stalls(stall_rate)
    got = await bench.stream(dut, bench.force_beats(forces, lanes), FIELDS, *pauses)
    assert got == expected_of(forces, fraction_bits, min_load=2)
    for plain, flipped, upturned in zip(got[0::3], got[1::3], got[2::3]):
        assert (flipped["x"], flipped["y"]) == (-plain["x"], plain["y"])
        assert (upturned["x"], upturned["y"]) == (plain["x"], -plain["y"])


@bench.applies(lambda dut: not small(dut), long=True)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def large_array_matches_model(dut):
    rows, columns, lanes, fraction_bits, _ = parameters(dut)
    rng = np.random.default_rng(bench.SEED)
    await bench.start(dut)
    corner = np.full((rows, columns), 65535)
    corner[0, 0] = 1
    few = np.zeros((rows, columns), int)
    few[rng.integers(rows, size=48), rng.integers(columns, size=48)] = rng.integers(1, 65536, 48)
    for frame in (few, corner, few):
        gate = int(frame.sum())
        dut.cfg_min_load_i.value = gate
        result, waited = await bench.force_frame(dut, frame, lanes, FIELDS)
        assert result == expected_of(frame[None], fraction_bits, gate)[0]
        assert result["pressed"]
        assert waited == clocks_stated(dut)


@bench.applies(small)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def clocks_are_the_same_in_every_frame(dut):
    """Frames back to back, a beat every clock: no stall, and the same latency for every result. If frames are
    shorter than the period of the divider, the input stalls and nothing is lost."""
    rows, columns, lanes, fraction_bits, bits_per_clock = parameters(dut)
    await bench.start(dut, cfg_min_load_i=1, out_ready_i=1)
    forces = bench.force_frames(np.random.default_rng(bench.SEED), rows, columns)[-8:]
    beats = bench.force_beats(forces, lanes)
    length = len(beats) // len(forces)
    keeps_up = length >= steps(fraction_bits, bits_per_clock) + 1
    ends, seen = [], []
    sent = clock = 0
    while len(seen) < len(forces):
        offer = sent < len(beats)
        dut.in_valid_i.value = int(offer)
        beat = beats[min(sent, len(beats) - 1)]
        bench.offer(dut, beat)
        await bench.ReadOnly()
        ready = dut.in_ready_o.value == 1
        assert ready or not keeps_up, f"waits at clock {clock}"
        if dut.out_valid_o.value == 1:
            seen.append(clock)
        if offer and ready and beat["last"]:
            ends.append(clock)
        sent += int(offer and ready)
        clock += 1
        await bench.RisingEdge(dut.clk_i)
    if keeps_up:
        assert [after - before for before, after in zip(ends, seen)] == [clocks_stated(dut)] * len(forces)


@bench.applies(small)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def survives_damage_and_resets(dut):
    """A frame without its end, a reset in the middle of the next, then complete frames: only these give
    results."""
    rows, columns, lanes, fraction_bits, _ = parameters(dut)
    forces = bench.force_frames(np.random.default_rng(bench.SEED), rows, columns)[-3:]
    beats = bench.force_beats(forces, lanes)
    length = len(beats) // 3
    await bench.start(dut, cfg_min_load_i=1)
    expected = expected_of(forces, fraction_bits, min_load=1)
    lost = [beat | {"last": False} for beat in beats[:length]]
    got = await bench.stream(dut, bench.placed(lost + beats, rows, length // rows), FIELDS)
    assert got == expected[1:]  # the damaged frame ends with the next frame's end, so that frame is lost
    assert bench.read(dut.damaged_o) == 1
    await bench.stream(dut, beats[: length + length // 2], FIELDS, drain=0)
    await bench.reset(dut)
    assert await bench.stream(dut, beats, FIELDS) == expected
    assert bench.read(dut.damaged_o) == 0


EVIDENCE = {
    "equivalence": {"size": {"Rows": 3}, "reset_size": {"Rows": 1}, "boxes": True},
    "faults": {"size": {"Rows": 3}, "settle": 4},
    "icarus": {"runs": {"Lanes": 1}},
}


@pytest.mark.parametrize(
    "rows, columns, lanes, fraction_bits, bits_per_clock",
    [
        (64, 64, 1, 14, 2),
        (3, 3, 1, 14, 2),  # nine beats: exactly as long as a division
        pytest.param(2, 2, 2, 20, 1, marks=pytest.mark.long),
        (9, 1, 1, 4, 2),
        (1, 9, 4, 14, 2),  # three beats, the last with one column
        (4, 17, 5, 14, 2),
        (1, 1, 1, 14, 2),  # shorter than a division: the input stalls
        (1024, 1024, 8, 14, 1),
    ],
)
def test_cop(rows, columns, lanes, fraction_bits, bits_per_clock):
    size = {"Rows": rows, "Columns": columns, "Lanes": lanes, "FractionBits": fraction_bits}
    bench.run("cop", "cop", size | {"BitsPerClock": bits_per_clock})


def test_stated_latency():
    assert latency(lanes=1, fraction_bits=14, bits_per_clock=2) == 11
    assert latency(lanes=8, fraction_bits=14, bits_per_clock=1) == 21
    assert [latency(lanes) for lanes in (2, 3, 4, 5, 6, 7, 8, 16)] == [12, 13, 13, 14, 14, 14, 14, 15]
