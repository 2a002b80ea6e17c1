"""The axes: each exists and is complete, each point can be repeated by its command, figures by hand or by
another method."""

import json
import shlex
from fractions import Fraction

import numpy as np
import pytest

from meissner import cli, scenes
from meissner.builds import config
from meissner.engines import fixed
from meissner.scenes.rubber.judge import judge
from meissner.tradeoff import area, sweep, table, worker
from meissner.tradeoff.axes import constants, cop4, divider, slip
from meissner.tradeoff.points import command_of, point_of, text_of

EVERY = list(table.every().values())


@pytest.mark.parametrize("axis", EVERY, ids=lambda axis: axis.name)
def test_every_point_is_repeated_by_its_command(axis):
    for quick in (False, True):
        points = axis.points(quick)
        assert len({json.dumps(point) for point in points}) == len(points)
        assert sum(axis.is_shipped(point) for point in points) == 1
        for point in points:
            assert point_of(axis, shlex.split(text_of(point))) == point
            assert command_of(axis, point).startswith(f"meissner tradeoff --axis {axis.name} --point ")
    assert len(axis.points(True)) <= len(axis.points())


@pytest.mark.parametrize("name", ["divider", "cop4", "shear", "demod", "lanes"])
def test_a_point_has_the_figures_that_its_axis_names(name):
    axis = table.named(name)
    point = next(point for point in axis.points(True) if axis.is_shipped(point))
    found, again = worker.answers(axis.error.__module__, name, [point, point])
    assert {*found["found"]["cost"], *found["found"]["error"]} == {figure.key for figure in axis.figures}
    assert again == found


def test_the_division_errs_by_half_a_step_at_most_and_nearly_that():
    """0.5 / 2^F of a range from -1 to 1 is 25 / 2^F per cent of it; exact quotients as fractions."""
    for bits, clocks in ((4, (8, 6)), (14, (18, 11)), (20, (24, 14))):
        for per_clock, expected in zip((1, 2), clocks):
            point = {"fraction_bits": bits, "bits_per_clock": per_clock, "frames": 300}
            found = divider.error(point)
            assert 0.9 * 25 / 2**bits < found["position"] <= 25 / 2**bits + 1e-12
            assert divider.cost(point)["clocks"] == expected
    total, moment = 7, 100  # x = 100/(63 7) = 0.2267..; in Q2.4 that is 3.628, so 4/16
    x, _, _ = divider.cop_divide([total], [moment], [0], 64, 64, 4)
    assert x[0] == 4 and abs(Fraction(4, 16) - Fraction(100, 441)) < Fraction(1, 32)


@pytest.mark.parametrize(("R0_ohm", "bound"), [(10000.0, 1.79), (1000.0, 0.311)])
def test_a_larger_resistor_costs_position(R0_ohm, bound):
    """docs/cop4.md's exact bounds for 41x41, 10 ohms, 16 bits, no gain and no noise: the measured errors come
    close to them."""
    point = {"side": 41, "r_ohm": 10.0, "R0_ohm": R0_ohm, "bits": 16, "noise_mv": 0.0, "gain": 1}
    found = cop4.error(point)["position_most"]
    assert 0.6 * bound < found <= bound * 1.003


@pytest.mark.parametrize("gain, bits", [(1, 16), (1, 20), (4, 16)])
def test_the_converter_s_noise_is_in_the_error(gain, bits):
    """The position's rms error to first order, by hand from x = Cx (E1 - E3)/N, N = 2V0 - E1 - E3: an
    electrode errs by e, steps of q/sqrt(12) and noise together, so x by hypot(Cx + x, Cx - x) e/N or, with
    amplified differences, by hypot(Cx/gain, sqrt(2) x) e/N. The larger of x and y, rms over all places, with
    up to half of the square clipped at the edges and 4 % for a thousand draws."""
    point = table.named("cop4").shipped | {"gain": gain, "bits": bits}
    mesh, *_, answer = cop4._solved(7, 100.0, 1000.0)
    volts, C = 15.75 / 5.0, mesh.Cx  # at the electrodes, of a volt at the converter
    e = np.hypot(2 * 15.75 / 2**bits / np.sqrt(12), 0.117e-3 * volts) / (answer.current * mesh.R0)
    squares = []
    for at in (answer.x, answer.y):
        error = e * (np.hypot(C + at, C - at) if gain == 1 else np.hypot(C / gain, np.sqrt(2) * at))
        squares.append([np.mean(error**2 * np.where(np.abs(at) > 0.99, part, 1)) for part in (0.5, 1)])
    least, most = 50 * np.sqrt(np.max(squares, axis=0))
    found = cop4.error(point)
    assert 0.96 * least < found["position"] < 1.04 * most
    assert 2.5 * found["position"] < found["position_most"] < 5 * found["position"]
    assert cop4.error(point | {"noise_mv": 0.0})["position"] < 0.7 * found["position"]


def test_the_shipped_slip_point_is_what_the_scene_s_judge_says():
    """Four slips and four presses, one by one, with the scenes' own settings and converter."""
    point = slip.SHIPPED | {"runs": 4}
    found = slip.error(point)
    delays, leads, missed, alarmed = [], [], 0, 0
    for name in ("acrylic_slip", "normal_force"):
        scene = scenes.load(name)
        for number in range(4):
            kinds = len(scene.conditions)
            run = scenes.simulate(scene, number % kinds, 1 + number // kinds)
            states = fixed.watch(run.codes[None], scene.slip_config()).state[0]
            verdict = judge(run, states, scene.slip_config())
            missed += verdict["missed"]
            alarmed += verdict["false_alarms"] > 0
            if verdict["delay_s"] is not None:
                delays.append(1e3 * verdict["delay_s"])
                leads.append(1e3 * verdict["lead_s"])
    assert len(delays) == 4
    assert (found["missed"]["count"], found["false_alarm"]["count"]) == (missed, alarmed)
    assert (found["missed"]["runs"], found["false_alarm"]["runs"]) == (4, 8)
    assert found["delay_ms"] == np.median(delays) and found["delay_ms_mean"] == np.mean(delays)
    assert found["lead_ms_min"] == min(leads)


def test_a_flag_at_the_slip_of_the_whole_contact_is_a_miss():
    """A flag one sample before the slip, at it, after it; a rise before the onset is a false alarm and not a
    flag."""
    for rises, expected in (
        ([0.999], (False, False, 0)),
        ([1.0], (True, True, 0)),
        ([1.001], (True, True, 0)),
        ([0.4, 0.7], (False, False, 1)),
        ([0.4], (True, False, 1)),
        ([], (True, False, 0)),
    ):
        found = slip.flagged(np.array(rises), 0.5, 1.0)
        assert (found["missed"], found["late"], found["false_alarms"]) == expected, rises
    assert slip.flagged(np.array([0.1, 0.2]), None, None)["false_alarms"] == 2


def test_the_figures_of_runs_by_hand():
    """Four slips: flags after 10 and 30 ms, a late one after 80 ms, none; one false alarm in a slip, three in
    a press."""

    def slipped(delay_ms, lead_ms, early=0):
        flag = delay_ms is not None
        seconds = {"delay_s": delay_ms / 1e3 if flag else None, "lead_s": lead_ms / 1e3 if flag else None}
        late = flag and lead_ms <= 0
        return seconds | {"missed": late or not flag, "late": late, "false_alarms": early}

    slips = [slipped(10, 40), slipped(30, 20, 1), slipped(80, -30), slipped(None, None)]
    presses = [slipped(None, None, 3) | {"missed": False}, slipped(None, None) | {"missed": False}]
    found = slip.figures(slips, presses)
    assert (found["missed"]["count"], found["missed"]["runs"], found["late"]) == (2, 4, 1)
    assert (found["false_alarm"]["count"], found["false_alarm"]["runs"]) == (2, 6)
    assert found["wrong"] == pytest.approx(100 * (2 / 4 + 2 / 6), abs=1e-3)
    assert (found["delay_ms"], found["delay_ms_mean"], found["lead_ms_min"]) == (30, 40, -30)
    nothing = slip.figures([slipped(None, None)], [])
    assert nothing["delay_ms"] is None and nothing["lead_ms_min"] is None
    assert nothing["missed"]["low"] == pytest.approx(0.025), "exact: 0.05 / 2 of one run"


def test_too_few_bits_are_noticed():
    """With 8 bits a code is as large as the threshold, so noise alone raises flags; with 12 bits it raises
    none."""
    coarse, usual = (slip.error(slip.SHIPPED | {"bits": bits, "runs": 4}) for bits in (8, 12))
    assert coarse["false_alarm"]["count"] > 4 and usual["false_alarm"]["count"] == 0


def test_what_a_channel_keeps():
    """docs/slip.md: one maximum and minimum, two of each, or 31 of each; a detail of 12-bit samples has 14
    bits."""
    for kind, words in (("tumbling", 2), ("half", 4), ("sliding", 62)):
        assert slip.cost(slip.SHIPPED | {"kind": kind})["state_bits"] == 14 * words
    clocks = [slip.cost(slip.SHIPPED | {"kind": kind})["clocks"] for kind in ("tumbling", "half", "sliding")]
    assert clocks == [6, 7, 8]


def test_a_change_that_matters_turns_a_conclusion():
    """Three runs: with events a quarter as large no slip is found in time; with the original size all are."""
    usual, quiet = (
        constants.error({"change": change, "runs": 3}) for change in ("as they are", "EVENT_SHARE 0.003375")
    )
    assert usual["none_missed"] and usual["leads_100_ms"] and not quiet["none_missed"]
    assert constants.error({"change": "as they are", "runs": 3}) == usual, "the change has ended"
    early = constants.error({"change": "first event 0.12", "runs": 3})
    assert early["lead_ms_min"] > 4 * usual["lead_ms_min"] > 0 > quiet["lead_ms_min"]


def test_shipped_points_are_the_named_configurations():
    """slip1, cop4 and array64 have the values that the axes call shipped."""
    slip1, four, array = (config.load(name) for name in ("slip1", "cop4", "array64"))
    assert (slip1.slip.level, slip1.slip.window, slip1.slip.hop) == (1, 64, 64)
    assert (slip1.part.data_bits, slip1.adc.rate_hz) == (12, 10000)
    shipped = table.named("cop4").shipped
    mesh = four.cop4.mesh
    assert (mesh.m, mesh.r, mesh.R0, four.part.data_bits) == tuple(
        shipped[key] for key in ("side", "r_ohm", "R0_ohm", "bits")
    )
    shipped = table.named("lanes").shipped
    found = (array.adc.part.lower(), array.adc.converters, array.adc.channels, array.sensor.rows)
    assert found == tuple(shipped[key] for key in ("adc", "converters", "inputs", "side"))


def test_areas_are_those_that_are_recorded(tmp_path, monkeypatch):
    """A figure that was not measured is an error that names the command, before any point is measured."""
    path = tmp_path / "fmax.json"
    kept = {"a ecp5": {"area": {"lut": 12}, "mhz_worst": 99.5}}
    path.write_text(json.dumps({"version": "0.1.0", "figures": kept}))
    monkeypatch.setattr(area, "BLOCKS", path)
    assert area.placed("a", "ecp5") == {"lut": 12, "mhz": 99.5}
    for entry, target in (("a", "up5k"), ("b", "ecp5")):
        with pytest.raises(
            ValueError, match=rf"no figures of {entry} on {target}; `make fmax FMAX=.*'{entry}'"
        ):
            area.placed(entry, target)
    with pytest.raises(ValueError, match="slip-64"):
        sweep.run([table.named("slip")], tmp_path / "out", quick=True)
    monkeypatch.setattr(area, "BLOCKS", tmp_path / "none.json")
    with pytest.raises(ValueError, match=r"none\.json is missing; `make fmax"):
        area.placed("a", "ecp5")


def test_every_point_with_a_placed_block_has_its_figures():
    """The recorded file serves every axis."""
    for axis in EVERY:
        for point in axis.points() if axis.placed else ():
            if entry := axis.placed(point):
                assert area.placed(*entry)["lut"] > 0


def test_a_point_is_printed(capsys):
    cli.main(["tradeoff", "--axis", "divider", "--point", "fraction_bits=4", "frames=50"])
    found = json.loads(capsys.readouterr().out)
    assert found["point"] == {"fraction_bits": 4, "bits_per_clock": 2, "frames": 50}
    assert found["cost"]["clocks"] == 6
