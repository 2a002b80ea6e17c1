"""Each metric of the scenes of resistive matrices: which fault changes it, by how much, and which metrics
stay unchanged."""

import dataclasses
import tomllib

import numpy as np
import pytest

from meissner import engines, scenes
from meissner.interval import words
from meissner.physics import fsr
from meissner.scenes.fsr import run
from meissner.scenes.fsr import scene as of_matrix
from meissner.scenes.timed import TimedEngine

COMMON = "scene engine seed seconds_simulated seconds_taken samples_per_second twin_mismatches modelled"
COMMON = {
    *COMMON.split(),
    "left_out",
    "built",
    "not_built",
    "runs",
    "seeds",
    "frames",
    "rows",
    "columns",
}
POSITION = {"position_error", "position_error_of_working_cells"}
LOAD = {"load_error", "load_error_of_working_cells"}
DEAD = {"dead", "dead_found", "dead_falsely", "dead_as_injected"}
EVEN = {"unevenness_before", "unevenness_after"}


def small(load_ohm=5000.0, min_load_n=1.0, driver_ohm=5.0):
    """The scene of 64×64 reduced to 12×10 cells: row 4 dead, cell (9, 7) stuck, 60 frames."""
    table = tomllib.loads(scenes.source("fsr_64x64"))
    table["array"] |= {"rows": 12, "columns": 10}
    table["cop"] = {"min_load_n": min_load_n}
    table["readout"] |= {"load_ohm": load_ohm, "driver_ohm": driver_ohm}
    table["world"] |= {"depth_pitches": 1.2}
    table["faults"] = [{"kind": "dead row", "row": 4}, {"kind": "stuck", "row": 9, "column": 7}]
    return scenes.build("small", table | {"rate_hz": 200})


def metrics(scene):
    """{metric: value; column of its table: values}, columns with "each" before their names; and the
    arrays."""
    found = run.run(scene, "fixed", 1)
    summary, arrays = found.summary, found.arrays
    found = {key: value for key, value in summary.items() if key not in COMMON | {"conditions"}}
    rows = summary["conditions"]
    return found | {f"each {key}": [row[key] for row in rows] for key in rows[0]}, arrays


@pytest.fixture(scope="module")
def unbroken():
    return metrics(small())[0]


@pytest.fixture
def turned(sound):
    """The metrics of a broken run, and the names of those that changed."""

    def again(scene=None):
        found, _ = metrics(scene or small())
        assert set(found) == set(sound)
        return found, {key for key in found if found[key] != sound[key]}

    return again


def readings(monkeypatch, break_it):
    """``break_it(total, x, y, valid)`` after the centre of pressure."""
    right, one = TimedEngine.cop, engines.COP_ONE

    def broken(*at):
        found = right(*at)
        total, x, y, valid = break_it(found["sum"], found["x"] / one, found["y"] / one, found["valid"])
        return found | {"sum": total, "x": x * one, "y": y * one, "valid": valid}

    monkeypatch.setattr(TimedEngine, "cop", broken)


def converted(monkeypatch, break_it):
    """``break_it(codes, part)`` of every part: "run" (60 frames), "calibration" (96), "even" (64)."""
    right = of_matrix.Sheet.codes
    parts = {60: "run", 96: "calibration", 64: "even"}

    def codes(world, siemens):
        return break_it(right(world, siemens), parts[len(siemens)])

    monkeypatch.setattr(of_matrix.Sheet, "codes", codes)


def test_a_shifted_centre(monkeypatch, turned):
    """Shifted by 0.06 and -0.08 of the half range: 0.05 of the range."""
    readings(monkeypatch, lambda total, x, y, valid: (total, x + 0.06, y - 0.08, valid))
    found, which = turned()
    assert which == POSITION
    assert found["position_error_of_working_cells"]["mean"] == pytest.approx(0.05, abs=0.005)


def test_a_mirrored_centre(monkeypatch, turned, sound):
    """The wrong sign of x: the error is |x| of the range, for a hand that leans to the left."""
    readings(monkeypatch, lambda total, x, y, valid: (total, -x, y, valid))
    found, which = turned()
    assert which == POSITION
    assert found["position_error"]["mean"] > 5 * sound["position_error"]["mean"]


def test_a_sum_that_is_a_tenth_too_large(monkeypatch, turned, sound):
    """Working cells read within 1 % of the truth, so 1.1 times their sum is 9 to 11 % high."""
    readings(monkeypatch, lambda total, x, y, valid: (total * 1.1, x, y, valid))
    found, which = turned()
    assert which == LOAD
    assert found["load_error_of_working_cells"]["mean"] == pytest.approx(0.1, abs=0.01)


def test_a_row_that_broke_without_being_injected(monkeypatch, turned):
    """Row 7 broken too: 10 more cells are found dead, of the 109 that should work."""
    right = fsr.break_cells

    def more(siemens, *at):
        siemens = right(siemens, *at)
        siemens[:, 7] = 0.0
        return siemens

    monkeypatch.setattr(fsr, "break_cells", more)
    found, which = turned()
    assert (DEAD - {"dead_found"}) | POSITION | LOAD <= which and "dead_found" not in which
    assert found["dead"] == 21 and not found["dead_as_injected"]
    assert found["dead_falsely"]["count"] == 10
    assert found["load_error_of_working_cells"]["mean"] > 0.03


def test_a_fault_that_the_calibration_does_not_see(monkeypatch, turned):
    """The stuck cell follows its force after all: 10 of 11 found; 58.7 to 99.8 % (Clopper-Pearson)."""
    monkeypatch.setattr(fsr, "stick", lambda codes, *_: codes)
    found, which = turned()
    assert DEAD - {"dead_falsely"} <= which and "dead_falsely" not in which
    assert found["dead"] == 10 and not found["dead_as_injected"]
    assert words(found["dead_found"], "cells") == "10 of 11 cells (90.9 %, 95 % interval 58.7 to 99.8 %)"


def test_a_cell_that_dies_after_the_calibration(monkeypatch, turned, sound):
    """The most pressed cell dies in the run alone: it stays undetected, and load and position err by its
    share."""

    def dying(codes, part):
        if part == "run":
            row, column = np.unravel_index(codes.mean(axis=0).argmax(), codes.shape[1:])
            codes[:, row, column] = 0
        return codes

    converted(monkeypatch, dying)
    found, which = turned()
    assert which == POSITION | LOAD
    for key in ("position_error_of_working_cells", "load_error_of_working_cells"):
        assert found[key]["mean"] > 2 * sound[key]["mean"]


def test_a_load_that_is_too_small_for_a_position(turned, sound):
    """With a least load of 12 N, as many frames are counted as a plain loop counts."""
    scene = small(min_load_n=12.0)
    _, arrays = metrics(scene)
    counted = sum(
        1 for load_n, true_n in zip(arrays["load_n"], arrays["true_load_n"]) if 0 < load_n < 12 < 99 * true_n
    )
    found, which = turned(scene)
    assert "below_min_load" in which and which <= POSITION | LOAD | {"below_min_load"}
    assert 5 < found["below_min_load"] == counted < 60


def test_a_column_whose_amplifier_gains_a_tenth(monkeypatch, turned):
    """Under the even press only. Codes include the rest level, 1 of 15 µS: 1.1067 over a mean of 1.0108."""

    def louder(codes, part):
        if part == "even":
            codes[:, :, 3] = np.rint(codes[:, :, 3] * 1.1)
        return codes

    converted(monkeypatch, louder)
    found, which = turned()
    assert which <= EVEN and "unevenness_after" in which
    assert found["unevenness_after"] == pytest.approx(1.1067 / 1.0108 - 1, abs=0.004)


def test_cells_that_differ_three_times_as_much(turned, sound):
    """Unevenness grows before the calibration and hardly after it."""
    scene = small()
    scene = dataclasses.replace(scene, material=dataclasses.replace(scene.material, spread=0.24))
    found, which = turned(scene)
    assert which >= EVEN
    assert found["unevenness_before"] == pytest.approx(3 * sound["unevenness_before"], rel=0.05)
    assert found["unevenness_after"] < 0.01


def test_columns_that_are_not_held(monkeypatch, turned, sound):
    """An amplifier that holds its column through 500 ohms instead of half an ohm lets ghosts in."""
    held = property(lambda way: 1 / (500.0 if way.circuit == "zero potential" else way.load_ohm))
    monkeypatch.setattr(fsr.Readout, "column_siemens", held)
    found, which = turned()
    assert "each ghost" in which and not which & {"each circuit", "each unselected"}
    assert sound["each ghost"][:2] == [0, 0] and min(found["each ghost"][:2]) > 0.001
    assert found["each ghost"][2:] == sound["each ghost"][2:]


def test_drivers_that_sag(turned, sound):
    """200 ohms instead of 5: the cells of a row share its driver, and read less the more of them are
    pressed."""
    found, which = turned(small(driver_ohm=200.0))
    assert "each pressed_spread" in which
    assert min(found["each pressed_spread"][:2]) > 10 * max(sound["each pressed_spread"][:2])


def test_a_converter_at_its_end(turned):
    """Twelve kilohms at each column lift the largest presses above 3.3 V."""
    found, which = turned(small(load_ohm=12000.0))
    assert "over_range" in which and found["over_range"] > 0


def test_a_scene_without_faults_has_no_cells_to_find():
    found, _ = metrics(scenes.load("fsr_3x3"))
    assert found["dead_found"] is None and found["dead_as_injected"]
    assert words(found["dead_falsely"], "cells") == "0 of 9 cells (0 %, 95 % interval 0 to 33.6 %)"
