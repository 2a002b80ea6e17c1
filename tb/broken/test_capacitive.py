"""Each metric of the capacitive scenes: which fault changes it, by how much, and which metrics stay exactly
equal.

A fault that draws no random number leaves every sample's noise unchanged, so metrics that it does not affect
are equal to the last digit.
"""

import dataclasses
import types

import numpy as np
import pytest

from meissner import engines, scenes
from meissner.physics import capacitive
from meissner.scenes.capacitive import judge, run
from meissner.scenes.capacitive import scene as of_pad
from meissner.scenes.timed import TimedEngine

NAMES = {kind: f"capacitive_{kind}" for kind in ("crosstalk", "cell", "select", "shapes")}
FRAMES = 30
COMMON = "scene engine seed seconds_simulated seconds_taken samples_per_second twin_mismatches modelled"
COMMON = {
    *COMMON.split(),
    "each column",
    "each press_g",
    "left_out",
    "built",
    "not_built",
    "runs",
    "seeds",
    "frames",
}
EVEN = {"unevenness_before", "unevenness_codes_as_they_are", "unevenness_calibrated_by_probe"}
EVEN |= {"unevenness_after"}
LEFT = {"left_after_release_g", "left_after_rest_g"}
PRESSES = {"mean_g", "off_share", "off_share_second_order", "deviation_g", "of_the_mean"}
PRESSES = {f"each {key}" for key in PRESSES}
CYCLES = {"unloading_above_loading_g", "off_the_line_g", "low_at_full_g", "low_at_full_second_order_g"}


def scene_of(kind, **world):
    """The scene, with fewer frames of each object."""
    scene = scenes.load(NAMES[kind])
    fewer = {"frames": FRAMES} if kind == "shapes" else {}
    return dataclasses.replace(scene, world=scene.world | fewer | world)


def metrics(scene):
    """{metric: value; column of its table: values}, columns with "each" before their names."""
    summary = run.run(scene, "fixed", 1).summary
    found = {key: value for key, value in summary.items() if key not in COMMON | {"conditions"}}
    rows = summary["conditions"]
    columns = {f"each {key}": [row[key] for row in rows] for key in rows[0]}
    return found | {key: values for key, values in columns.items() if key not in COMMON}


@pytest.fixture(scope="module", autouse=True)
def fewer_frames():
    with pytest.MonkeyPatch.context() as patch:
        for module in (of_pad, judge):
            patch.setattr(module, "CALIBRATION_FRAMES", 3)
        yield


@pytest.fixture(scope="module")
def unbroken(fewer_frames):
    """The metrics before anything is broken."""
    return {kind: metrics(scene_of(kind)) for kind in NAMES}


@pytest.fixture
def turned(sound):
    """The metrics of a broken run, and the names of those that changed."""

    def again(kind, scene=None):
        found, was = metrics(scene or scene_of(kind)), sound[kind]
        assert set(found) == set(was)
        return found, {key for key in found if found[key] != was[key]}

    return again


def amplitudes(monkeypatch, break_it):
    """``break_it(codes, samples)`` after the demodulator."""
    right = engines.demodulate
    monkeypatch.setattr(engines, "demodulate", lambda x, *at: break_it(right(x, *at), x))


def forces(monkeypatch, break_it):
    """``break_it(forces)`` after the calibration."""
    right = engines.calibrate
    monkeypatch.setattr(engines, "calibrate", lambda *at: break_it(right(*at)))


def readings(monkeypatch, break_it):
    """``break_it(total, x, y, valid)`` after the centre of pressure."""
    right, one = TimedEngine.cop, engines.COP_ONE

    def broken(*at):
        found = right(*at)
        total, x, y, valid = break_it(found["sum"], found["x"] / one, found["y"] / one, found["valid"])
        return found | {"sum": total, "x": x * one, "y": y * one, "valid": valid}

    monkeypatch.setattr(TimedEngine, "cop", broken)


def test_a_demodulator_with_a_gain_error(monkeypatch, turned, sound):
    """2 % too much: 0.2 V of 9.96 V (G = 500, no other cell); an output 0.99 % low becomes 1.0 % high."""
    amplitudes(monkeypatch, lambda codes, _: np.rint(codes * 1.02).astype(codes.dtype))
    found, which = turned("crosstalk")
    assert which == {"difference_from_eq18_v", "each output_v", "each low_by"}
    assert sound["crosstalk"]["difference_from_eq18_v"] < 0.002
    assert found["difference_from_eq18_v"] == pytest.approx(0.02 * 10 * 500 / 502, abs=2e-3)
    assert found["each low_by"][0] == pytest.approx(1 - 1.02 * 200 / 202, abs=2e-4)


def test_stray_capacitance_that_nobody_counted(monkeypatch, turned, sound):
    """10 pF more on every line: 10·200/(212 + Cu) V."""

    def leaky(cell_f, others_f, *at, **named):
        return capacitive.output_v(cell_f, others_f + 10e-12, *at, **named)

    there = types.SimpleNamespace(**vars(capacitive) | {"output_v": leaky})
    monkeypatch.setattr(of_pad, "capacitive", there)
    found, which = turned("crosstalk")
    assert which == {"difference_from_eq18_v", "each output_v", "each low_by"}
    assert found["each output_v"] == pytest.approx(
        [2000 / (212 + pf) for pf in (0, 10, 20, 40, 60, 80)], abs=2e-3
    )
    # The largest difference is at G = 10 with no other cell: 100/12 V against 100/22.
    assert found["difference_from_eq18_v"] == pytest.approx(100 / 12 - 100 / 22, abs=2e-3)


def test_another_reference_capacitor(monkeypatch, turned, sound):
    """2 pF: half the output; the gain for 80 pF and 10 % is 9·(1 + 81/2) = 373.5, not 738."""
    monkeypatch.setattr(capacitive, "REF_F", 2e-12)
    monkeypatch.setattr(capacitive.output_v, "__defaults__", (10.0, 2e-12, 200e3, np.inf, np.inf))
    found, which = turned("crosstalk")
    assert which == set(sound["crosstalk"]) - {"each unselected_pf", "over_range"}
    assert found["ideal_v"] == 5.0 and found["difference_from_eq18_v"] < 0.002
    gains = ("each gain_for_10_percent", "each gain_for_5_percent", "each gain_for_1_percent")
    assert [found[key][-1] for key in gains] == pytest.approx([373.5, 788.5, 4108.5], abs=0.5)
    assert found["each low_by"][-1] == pytest.approx(83 / 483, abs=2e-4)
    assert found["each low_by_with_lagging_gain"][-1] == pytest.approx(1 - 400 / np.hypot(400, 83), abs=1e-5)


def test_a_converter_that_clips(turned, sound):
    """10 V of carrier, sampled at 7.6 and 6.4 V, and a converter range of 7 V."""
    scene = scene_of("crosstalk")
    clipped = dataclasses.replace(scene, adc=dataclasses.replace(scene.adc, low_v=-7.0, high_v=7.0))
    found, which = turned("crosstalk", clipped)
    assert "over_range" in which and sound["crosstalk"]["over_range"] == 0 < found["over_range"]


def test_rubber_that_answers_at_once(monkeypatch, turned, sound):
    """Without creep the top of a cycle is as low as a settled press, and there is no sag, no droop and no
    residue."""
    monkeypatch.setattr(capacitive, "CREEP", ())
    found, which = turned("cell")
    assert which == CYCLES | LEFT | {"sag_of_hold"}
    assert found["low_at_full_g"] == pytest.approx(found["low_settled_g"], abs=2 * found["noise_g"] / 2)
    assert abs(found["low_at_full_second_order_g"]) < 1.5 < sound["cell"]["low_at_full_second_order_g"]
    assert abs(found["sag_of_hold"]) < 0.01 < 0.04 < sound["cell"]["sag_of_hold"]
    assert abs(found["unloading_above_loading_g"]) < 0.3 < 1.0 < sound["cell"]["unloading_above_loading_g"]
    assert (
        abs(found["left_after_release_g"]) < 3 * found["noise_g"] and abs(found["left_after_rest_g"]) < 0.75
    )


def test_rubber_that_never_comes_back(monkeypatch, turned, sound):
    """No recovery: 2, 2 and 3·(1 - exp(-3)) % of 100 g remain for good, at 1.16 of the line's slope 8.0 g."""
    monkeypatch.setattr(capacitive, "EXPANDING", 1e9)
    found, which = turned("cell")
    assert {"left_after_rest_g"} <= which <= CYCLES | LEFT | {"sag_of_hold"}
    assert found["left_after_rest_g"] == pytest.approx(1.16 * (4 + 3 * (1 - np.exp(-3))), abs=0.75)
    assert sound["cell"]["left_after_rest_g"] < 3.2


def test_noise_three_times_as_loud(turned, sound):
    scene = scene_of("cell")
    loud = dataclasses.replace(scene, adc=dataclasses.replace(scene.adc, noise_v=0.18))
    found, _ = turned("cell", loud)
    assert found["noise_g"] == pytest.approx(3 * sound["cell"]["noise_g"], rel=0.1)


def test_a_core_that_gives_nine_tenths_of_the_force(monkeypatch, turned, sound):
    """After the calibration: 0.9·(150 - low) at the top; the second-order term is fitted to the reduced
    force."""
    forces(monkeypatch, lambda f: (f * 0.9).astype(f.dtype))
    found, which = turned("cell")
    was = sound["cell"]
    for key in ("low_at_full_g", "low_settled_g"):
        assert found[key] == pytest.approx(150 - 0.9 * (150 - was[key]), abs=0.01)
    assert found["settled_off_g"] == found["low_settled_g"]
    for key in ("off_the_line_g", "unloading_above_loading_g", "each mean_g", "each deviation_g"):
        assert found[key] == pytest.approx(0.9 * np.array(was[key]), rel=2e-3)
    assert found["each off_share"] == pytest.approx(0.9 * (1 + np.array(was["each off_share"])) - 1, abs=2e-3)
    assert found["each of_the_mean"] == pytest.approx(was["each of_the_mean"], rel=1e-2)
    assert {"noise_g", "calibration_residual_g", *LEFT}.isdisjoint(which)
    for key in ("settled_off_second_order_g", "low_at_full_second_order_g", "each off_share_second_order"):
        assert found[key] == pytest.approx(was[key], abs=0.02)


def test_a_cell_that_bends_twice_as_much(monkeypatch, turned, sound):
    """Rubber of half the modulus: the line's error grows everywhere, and the second-order term removes it."""
    monkeypatch.setattr(capacitive, "MODULUS_MPA", 0.5)
    found, _ = turned("cell")
    for key in (
        "off_the_line_g",
        "low_settled_g",
        "settled_off_g",
        "reads_0_below_g",
        "calibration_residual_g",
    ):
        assert found[key] > 1.5 * sound["cell"][key], key
    assert found["settled_off_second_order_g"] < 1.0


def test_a_straight_cell(monkeypatch, turned, sound):
    """No curvature and no creep: only noise and the amplifier's loss remain."""
    monkeypatch.setattr(capacitive, "capacitance_ratio", lambda f, s=1.0: 1 + 0.2 * np.asarray(f) / s)
    monkeypatch.setattr(capacitive, "CREEP", ())
    found, _ = turned("cell")
    for key in ("off_the_line_g", "low_at_full_g", "low_settled_g", "settled_off_g", "reads_0_below_g"):
        assert abs(found[key]) < 1.75, key
    # F is 0 below zero force, where the line through the curve is negative: that is no deviation.
    assert found["calibration_residual_g"] < 1.4 < 2.2 < sound["cell"]["calibration_residual_g"]


def test_a_cell_that_stops_half_way(monkeypatch, turned, sound):
    """The cell stops at 0.7 N on its tab, 89 g of the probe: no parabola fits a kink, so the second-order
    term errs too."""
    monkeypatch.setattr(capacitive, "capacitance_ratio", lambda f, s=1.0: 1 + 0.2 * np.minimum(f, 0.7))
    found, _ = turned("cell")
    assert found["settled_off_second_order_g"] > 10 > sound["cell"]["settled_off_second_order_g"]
    assert found["low_at_full_second_order_g"] > 15 > sound["cell"]["low_at_full_second_order_g"]


def test_a_probe_that_is_placed_badly(turned, sound):
    """Three times the placement error: lower and more scattered readings. With none, presses differ by noise
    alone."""
    was = sound["cell"]
    found, which = turned("cell", scene_of("cell", placement_mm=0.45))
    assert which == PRESSES
    assert (
        found["each mean_g"][-1] < was["each mean_g"][-1] - 8
        and found["each deviation_g"][-1] > 3 * was["each deviation_g"][-1]
    )
    found, which = turned("cell", scene_of("cell", placement_mm=0.0))
    assert which == PRESSES
    assert found["each deviation_g"] == pytest.approx([found["noise_g"]] * 5, rel=0.6)
    assert found["each of_the_mean"][-1] < 0.012 < was["each of_the_mean"][-1]
    assert abs(found["each off_share_second_order"][-1]) < 0.01 < abs(was["each off_share_second_order"][-1])


def test_a_thicker_cover(monkeypatch, turned, sound):
    monkeypatch.setattr(capacitive, "COVER_MM", 2.4)
    found, _ = turned("select")
    was = sound["select"]
    assert found["neighbour_at_a_centre"] > 10 * was["neighbour_at_a_centre"]
    assert min(found["each width_at_half_mm"]) > max(was["each width_at_half_mm"]) + 0.5
    assert found["peaks_apart_mm"] == pytest.approx(1.9, abs=0.03)  # wider, not shifted


def test_a_tab_that_is_not_where_it_should_be(monkeypatch, turned, sound):
    """The middle tab 0.3 mm to the right: 2.2 mm from one, 1.6 mm from the other; the mean distance is
    unchanged."""
    right = of_pad.on_tabs

    def displaced(x_mm, y_mm, force_n):
        found = np.array(right(x_mm, y_mm, force_n))
        found[..., 3] = right(np.asarray(x_mm) - 0.3, y_mm, force_n)[..., 3]
        return found

    first = (of_pad.SIDE - 3) // 2
    assert first + 1 == 3
    steps = of_pad._select
    monkeypatch.setattr(
        of_pad,
        "_KINDS",
        of_pad._KINDS
        | {"select": lambda *at: [monkeypatch.setattr(of_pad, "on_tabs", displaced), steps(*at)][1]},
    )
    found, which = turned("select")
    assert (found["peaks_apart_from_mm"], found["peaks_apart_to_mm"]) == pytest.approx((1.6, 2.2), abs=0.03)
    assert found["peaks_apart_mm"] == pytest.approx(1.9, abs=0.01)
    assert found["each peak_mm"][1] - sound["select"]["each peak_mm"][1] == pytest.approx(0.3, abs=0.02)
    assert "each centre_mm" not in which


def test_a_table_that_moves_too_far(monkeypatch, turned, sound):
    """Steps of 0.11 mm instead of 0.1: on the table's scale the peaks are 1.9/1.1 = 1.727 mm apart."""
    scene = scene_of("select")
    right = of_pad.on_tabs
    left = of_pad.cell_mm(3, 2)[0] - capacitive.PITCH_MM
    monkeypatch.setattr(
        of_pad,
        "_KINDS",
        {
            "select": lambda world, _: {
                "steps": world.part(
                    right(left + 0.11 * np.arange(58), of_pad.cell_mm(3, 0)[1], np.full(58, 0.980665)),
                    np.full(58, 0.980665),
                )
            }
        },
    )
    found, _ = turned("select", scene)
    assert found["peaks_apart_mm"] == pytest.approx(1.9 / 1.1, abs=0.02)


def test_a_core_that_gives_nine_tenths_over_three_cells(monkeypatch, turned, sound):
    forces(monkeypatch, lambda f: (f * 0.9).astype(f.dtype))
    found, which = turned("select")
    assert "each height_g" in which and found["each height_g"] == pytest.approx(
        0.9 * np.array(sound["select"]["each height_g"]), rel=1e-3
    )
    for key in ("peaks_apart_mm", "neighbour_at_a_centre", "each peak_mm", "each width_at_half_mm"):
        assert found[key] == pytest.approx(sound["select"][key], rel=1e-2)


def test_a_shifted_centre(monkeypatch, turned, sound):
    """Shifted by 0.06 and -0.08 of the half range: 0.05 of the range."""
    readings(monkeypatch, lambda total, x, y, valid: (total, x + 0.06, y - 0.08, valid))
    found, which = turned("shapes")
    assert which == {"position_error", "each position_error"}
    assert found["position_error"]["mean"] == pytest.approx(0.05, abs=0.003)


def test_a_mirrored_centre(monkeypatch, turned, sound):
    """The wrong sign of y: the error is the distance from the middle. The edge lies 0.95 mm above it: 1/7 of
    the half."""
    readings(monkeypatch, lambda total, x, y, valid: (total, x, -y, valid))
    found, which = turned("shapes")
    assert which == {"position_error", "each position_error"}
    assert found["each position_error"][0] == pytest.approx(1 / 7, abs=0.01)


def test_a_sum_that_is_a_tenth_too_large(monkeypatch, turned, sound):
    readings(monkeypatch, lambda total, x, y, valid: (total * 1.1, x, y, valid))
    found, which = turned("shapes")
    assert which == {"load_error", "each reported_g"}
    assert found["each reported_g"] == pytest.approx(
        1.1 * np.array(sound["shapes"]["each reported_g"]), rel=1e-3
    )
    assert found["load_error"]["mean"] > 0.08


def test_a_cell_that_dies_after_the_calibration(monkeypatch, turned, sound):
    """It reads 0 under the even press: the largest possible deviation from the mean."""

    def dying(codes, samples):
        codes = np.array(codes)
        if len(samples) == FRAMES:  # only in the run, not in the calibrations
            codes[:, 2, 2] = 0
        return codes

    amplitudes(monkeypatch, dying)
    found, which = turned("shapes")
    assert EVEN | {"load_error", "position_error", "load_error_second_order"} <= which
    assert found["unevenness_calibrated_by_probe"] == pytest.approx(1.0, abs=0.02)
    assert found["unevenness_after"] == pytest.approx(1.0)


def test_columns_with_other_amplifiers(monkeypatch, turned, sound):
    """The calibration removes differences between columns: unevenness grows before it and hardly after it."""
    was = sound["shapes"]
    monkeypatch.setattr(capacitive, "COLUMN_SPREAD", 0.2)
    found, _ = turned("shapes")
    assert found["unevenness_before"] > 1.5 * was["unevenness_before"]
    assert found["unevenness_codes_as_they_are"] > 1.5 * was["unevenness_codes_as_they_are"]
    assert found["unevenness_after"] < 0.01


def test_parts_that_are_all_alike(monkeypatch, turned, sound):
    for name in ("COLUMN_SPREAD", "PLATE_SPREAD", "STIFFNESS_SPREAD"):
        monkeypatch.setattr(capacitive, name, 0.0)
    found, _ = turned("shapes")
    assert found["unevenness_before"] < 0.01 and found["unevenness_codes_as_they_are"] < 0.005
    assert found["unevenness_calibrated_by_probe"] == pytest.approx(
        0.075, abs=0.01
    )  # due to the cover, not the parts


def test_a_probe_that_presses_one_cell_alone(monkeypatch, turned, sound):
    monkeypatch.setattr(capacitive, "COVER_MM", 0.1)
    found, _ = turned("shapes")
    assert (
        found["unevenness_calibrated_by_probe"]
        < 0.02
        < 0.05
        < sound["shapes"]["unevenness_calibrated_by_probe"]
    )


def test_a_cell_whose_stiffness_differs_more(monkeypatch, turned, sound):
    """Four times the spread: the curves differ by more than their straight lines, which the calibration
    removes."""
    monkeypatch.setattr(capacitive, "STIFFNESS_SPREAD", 0.16)
    found, _ = turned("shapes")
    assert found["unevenness_after"] > 2 * sound["shapes"]["unevenness_after"]


def test_objects_pressed_twice_as_hard(turned, sound):
    """Truth and readings double, except for the curvature: the scene applies the pressure that it states."""
    found, which = turned("shapes", scene_of("shapes", pressure_g_mm2=60.0))
    assert "each shape" not in which and EVEN.isdisjoint(which)
    assert found["each load_g"] == pytest.approx(2 * np.array(sound["shapes"]["each load_g"]), rel=1e-3)
    assert min(np.array(found["each largest_cell_g"]) / sound["shapes"]["each largest_cell_g"]) > 1.5


def test_amplifiers_that_gain_a_tenth_after_the_calibration(monkeypatch, turned, sound):
    """A tenth of the 1900 codes at rest is a third of the response to 100 g: every load is far too high, with
    and without the second-order term."""

    def drifted(codes, samples):
        return np.rint(codes * (1.1 if len(samples) == FRAMES else 1.0)).astype(codes.dtype)

    amplitudes(monkeypatch, drifted)
    found, which = turned("shapes")
    assert {"load_error", "load_error_second_order", "each second_order_g", "each largest_cell_g"} <= which
    assert found["load_error"]["mean"] > 0.5 and found["load_error_second_order"]["mean"] > 0.5
