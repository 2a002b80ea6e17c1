"""msn_calibrate_taxels against its model, and the model against exact fractions: all lane counts, 1 x 1 to
256 x 256; gain 0 and full, offsets at both ends and above every sample, samples at both ends; gaps and
stalls; masks; calibrations swapped while frames pass; damage; resets; exact clocks."""

from fractions import Fraction
from math import floor

import cocotb
import numpy as np
import pytest

import bench
from frontend import calibrate_streams as streams
from meissner.twins.frontend.calibrate_taxels import LATENCY, CalibrateTaxels, forces


def twin_of(dut):
    return CalibrateTaxels(*streams.values_of(dut))


def length_of(dut):
    """Beats of a frame."""
    return streams.size_of(twin_of(dut))[3]


@bench.applies(lambda dut, stall_rate: not stall_rate or length_of(dut) <= 20000)
@cocotb.test(timeout_time=50, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5])
async def matches_model(dut, stall_rate):
    await streams.matches_model(dut, twin_of(dut), stall_rate)


@bench.applies(lambda dut: length_of(dut) <= 500)
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.4])
async def no_frame_mixes_two_calibrations(dut, stall_rate):
    await streams.no_frame_mixes_two_calibrations(dut, twin_of(dut), twin_of(dut), stall_rate)


@bench.applies(lambda dut: length_of(dut) <= 5000)
@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.4])
async def frames_behind_damaged_ones_are_right(dut, stall_rate):
    await streams.frames_behind_damaged_ones_are_right(dut, twin_of(dut), stall_rate)


@bench.applies(lambda dut: length_of(dut) <= 500)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    await streams.forgets_what_a_reset_interrupts(dut, twin_of(dut))


@bench.applies(lambda dut: length_of(dut) <= 500)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def keeps_accepted_beats_while_the_output_is_stalled(dut):
    await streams.keeps_accepted_beats_while_the_output_is_stalled(dut, twin_of(dut))


@bench.applies(lambda dut: length_of(dut) <= 5000)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def clocks_are_as_stated_and_frames_never_wait(dut):
    await streams.clocks_are_as_stated_and_frames_never_wait(dut, twin_of(dut), LATENCY)


EVIDENCE = {
    "reference": {
        "against": "`Fraction`",
        "test": "tb/frontend/test_calibrate_taxels.py::test_model_against_fractions",
    },
    "equivalence": {"size": {"Rows": 3}, "defined": True, "boxes": True, "open": ["reset"]},
    "mutants": {"sets": [1]},
    "faults": {
        "size": {"Rows": 3},
        "settle": 3,
        # The table, the bank in use and whether one is loaded keep a fault until they are written again.
        "driver": {"kept": "memory bank loaded cfg_swapping"},
    },
}


@pytest.mark.parametrize(
    "rows, columns, lanes, sample_bits, gain_shift, offset",
    [
        (1, 1, 1, 17, 12, 1),
        (3, 3, 2, 17, 1, 1),
        (4, 7, 2, 18, 16, 0),
        (64, 64, 1, 17, 12, 1),
        pytest.param(256, 256, 4, 17, 12, 1, marks=pytest.mark.long),
    ],
)
def test_calibrate_taxels(rows, columns, lanes, sample_bits, gain_shift, offset):
    size = {"Rows": rows, "Columns": columns, "Lanes": lanes, "SampleBits": sample_bits}
    bench.run("frontend", "calibrate_taxels", size | {"GainShift": gain_shift, "Offset": offset})


def test_model_against_fractions():
    """The formula in exact arithmetic, at the ends of every range, near ties and at random."""
    rng = np.random.default_rng(bench.SEED)
    for shift in (1, 12, 16):
        top = (1 << 16) - 1
        raw = np.r_[[-65536, 65535, 0, 1, -1, 7], rng.integers(-65536, 65536, 400)]
        offset = np.r_[[65535, -65536, 0, 0, 0, 6], rng.integers(-65536, 65536, 400)]
        gain = np.r_[[top, top, top, 1 << (shift - 1), 1 << (shift - 1), 0], rng.integers(0, top + 1, 400)]
        gain[-100:] = 1 << (shift - 1)  # exactly a half whenever raw - offset is odd
        got = forces(raw, offset, gain, shift)
        for r, o, g, f in zip(raw.tolist(), offset.tolist(), gain.tolist(), got.tolist()):
            exact = floor(Fraction((r - o) * g, 1 << shift) + Fraction(1, 2))
            assert f == min(max(exact, 0), 65535)


def test_model_in_frames_and_beats():
    """``next`` for complete frames and ``beat`` for each beat give the same."""
    rng = np.random.default_rng(1)
    twin = CalibrateTaxels(3, 5, 2)
    for entry in streams.calibrations(twin.table, rng):
        twin.table.write(*entry[1:2], *entry[3:], entry[2])
    raw = rng.integers(-999, 9999, (2, 3, 5))
    mask = rng.random((3, 5)) < 0.3
    whole = twin.process(raw, mask)
    assert whole.any() and not whole[:, mask].any()
    beats = streams.expected_of(twin, bench.lane_beats(raw, 2, 17, mask=np.broadcast_to(mask, raw.shape)))
    lanes = np.array([bench.lane_values(beat["data"], 2, 16) for beat in beats])
    assert np.array_equal(lanes.reshape(2, 3, 6)[:, :, :5], whole)


def test_refuses_illegal_parameters():
    assert "GainShift = 0" in bench.refuses("calibrate_taxels", {"GainShift": 0})
    assert "GainShift = 17" in bench.refuses("calibrate_taxels", {"GainShift": 17})
    for kinds, message in (
        ({"gain_shift": 0}, "gain_shift = 0"),
        ({"gain_shift": 17}, "gain_shift = 17"),
        ({"lanes": 3}, "lanes = 3"),
        ({"sample_bits": 18}, "sample_bits = 18 must be at most 17"),
        ({"sample_bits": 19, "offset": False}, "sample_bits = 19 must be at most 18"),
    ):
        with pytest.raises(ValueError, match=message):
            CalibrateTaxels(4, 4, **kinds)
