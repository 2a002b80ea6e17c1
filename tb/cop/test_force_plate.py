"""msn_cop_divide on a recorded force plate: a person stands on it for 32 s, eyes open and closed, 1 kHz. The
plate reports force, moments and its own centre of pressure, all as decimals, so that the integers here are
exactly what was recorded. The twin, msn_divide's twin and the RTL are compared with exact rationals, and
these with the plate. Skipped with a message if the recordings are absent. docs/cop.md has the results: run
with -s."""

import csv
from fractions import Fraction

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.common.divide import divide
from meissner.twins.cop.cop import cop_divide
from published.recordings import find

NAMES = ("eyesOpen_1", "eyesClosed_1")
SIDE = 128  # an array whose load is wide enough for micronewtons: 30 bits
# Metres between coordinates -1 and +1. It makes Mx = 127 (-My) / WIDTH a whole number of micronewton metres.
WIDTH = Fraction(254, 1000)
RTL_SAMPLES = 600
FIELDS = ["x~", "y~", "load", "pressed"]


def micro(text):
    """A decimal of six digits as an integer number of millionths."""
    assert len(text.partition(".")[2]) == 6, text
    return int(text.replace(".", ""))


def plate():
    """S (micronewtons), Mx, My of the array that stands for the plate; the plate's own x, y (micrometres);
    [n] each.

    The centre of a wrench on the plate's surface is (-My, Mx) / Fz.
    """
    rows = []
    for name in NAMES:
        with open(find(f"acuna/{name}.csv"), newline="") as file:
            rows += [
                [micro(row[key]) for key in ("Fz", "Mx", "My", "CoPx", "CoPy")]
                for row in csv.DictReader(file)
            ]
    force, about_x, about_y, x, y = np.array(rows, dtype=np.int64).T
    span = (SIDE - 1) / WIDTH
    assert span.denominator == 1
    return force, -about_y * int(span), about_x * int(span), x, y


@pytest.fixture(scope="module")
def measured():
    try:
        return plate()
    except ValueError as absent:
        pytest.skip(str(absent))


def nearest(value):
    """Integer nearest to a fraction, ties away from zero: the definition, in exact rationals."""
    whole = int(abs(value) + Fraction(1, 2))
    return whole if value >= 0 else -whole


@pytest.mark.parametrize("fraction_bits", [14, 20])
def test_twin_against_fractions_and_the_plate(measured, fraction_bits):
    force, mx, my, *own = measured
    assert len(force) == 64000 and force.min() > 8e8
    x, y, pressed = cop_divide(force, mx, my, SIDE, SIDE, fraction_bits)
    assert pressed.all()
    one = 1 << fraction_bits
    for got, moment, recorded, axis in ((x, mx, own[0], "x"), (y, my, own[1], "y")):
        assert np.array_equal(got, divide(moment, (SIDE - 1) * force, fraction_bits))
        ratios = zip(moment.tolist(), force.tolist())
        assert got.tolist() == [nearest(Fraction(m * one, (SIDE - 1) * f)) for m, f in ratios]
        metres = float(WIDTH) / one * got
        off = np.abs(metres * 1e6 - recorded)
        # The plate's centre is rounded to a micrometre, ours to a step; the rest is rounding of its other
        # decimals.
        assert off.max() <= 0.5 + 0.5 * float(WIDTH) * 1e6 / one + 1e-3
        print(
            f"Q2.{fraction_bits} {axis}: {np.ptp(recorded) / 1e3:.1f} mm of travel, "
            f"off the plate's own centre by {off.mean():.3f} um in the mean, {off.max():.3f} um at most"
        )


def chosen(force, mx, my):
    """Samples for the RTL: the extremes of each number, then some from the entire recording."""
    ends = [index for values in (force, mx, my) for index in (values.argmin(), values.argmax())]
    return [*ends, *np.linspace(0, len(force) - 1, RTL_SAMPLES - len(ends)).astype(int)]


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.4])
async def matches_fractions(dut, stall_rate):
    fraction_bits = dut.FractionBits.value.to_unsigned()
    force, mx, my, *_ = plate()
    some = chosen(force, mx, my)
    beats = [dict(zip(("sum", "mx", "my"), map(int, (force[k], mx[k], my[k])))) for k in some]
    await bench.start(dut, cfg_min_load_i=1)
    pauses = bench.gaps_and_stalls(stall_rate)
    got = await bench.stream(dut, beats, FIELDS, *pauses)
    assert len(got) == RTL_SAMPLES
    for beat, result in zip(beats, got):
        x, y = (nearest(Fraction(beat[m] << fraction_bits, (SIDE - 1) * beat["sum"])) for m in ("mx", "my"))
        assert result == {"x": x, "y": y, "load": beat["sum"], "pressed": 1}, beat


@pytest.mark.parametrize("fraction_bits, bits_per_clock", [(14, 2), (20, 1)])
def test_rtl(measured, fraction_bits, bits_per_clock):
    size = {"Rows": SIDE, "Columns": SIDE, "FractionBits": fraction_bits, "BitsPerClock": bits_per_clock}
    bench.run("cop", "cop_divide", size, module="test_force_plate")


def test_absence_is_a_plain_sentence(tmp_path, monkeypatch):
    monkeypatch.setenv("MEISSNER_DATA", str(tmp_path))
    with pytest.raises(ValueError, match=r"acuna/eyesOpen_1\.csv are not in .MEISSNER_DATA: nothing was"):
        plate()
