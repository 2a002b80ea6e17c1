"""What a summary and a table say of many runs, by hand: each largest, least, median and count from runs whose
extremes lie in different conditions, and are not those of the means, the medians, the first or the last."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from meissner import scenes
from meissner.pool import Spread
from meissner.scenes.grip import run as of_cop_slip
from meissner.scenes.hand import run as of_hand
from meissner.scenes.hand import scene as of_hand_scene
from meissner.scenes.mesh import run as of_mesh
from meissner.scenes.rubber import run as of_rubber
from meissner.scenes.shear import judge as of_shear
from meissner.scenes.verdict import slips

NAMED = SimpleNamespace(name="x")


def held(**runs):
    """A Held of these runs; what is not given is 0."""
    count = len(next(iter(runs.values())))
    given = {key: np.zeros(count) for key in of_hand.KEYS} | {"dropped": np.zeros(count, bool)}
    given |= {key: np.array(values) for key, values in runs.items()}
    return of_hand.loop.Held(**given, trace=SimpleNamespace())


def test_the_summary_of_a_hand(monkeypatch):
    """Three conditions of three runs, two batches each. The dropped run's 9 mm count nowhere, nor does the
    last condition, which drops all; the condition with the largest slip has not the largest mean."""
    found = iter(
        [
            held(slip_mm=[0.1, 0.8], moved_mm=[0.3, 0.9], ratio=[1.1, 1.3], tightenings=[1, 2]),
            held(slip_mm=[0.0], moved_mm=[0.4], ratio=[1.2], faults=[16]),
            held(slip_mm=[0.5, 0.6], moved_mm=[1.4, 0.7], ratio=[1.5, 1.4], false_tightenings=[4, 8]),
            held(slip_mm=[9.0], moved_mm=[9.0], ratio=[9.0], dropped=[True], tightenings=[32]),
            held(slip_mm=[9.0, 8.0], moved_mm=[9.0, 9.0], ratio=[9.0, 9.0], dropped=[True, True]),
            held(slip_mm=[7.0], moved_mm=[9.0], ratio=[9.0], dropped=[True], faults=[64]),
        ]
    )
    asked = []
    monkeypatch.setattr(of_hand_scene, "AT_ONCE", 2)
    monkeypatch.setattr(
        of_hand.loop, "hold", lambda _, condition, seeds, __: asked.append((condition, *seeds)) or next(found)
    )
    scene = scenes.load("grip_disturb")
    scene = dataclasses.replace(scene, seeds=3, conditions=scene.conditions[:3])
    summary = of_hand.run(scene, "fixed", 5, False, Spread()).summary
    assert asked == [(one, *seeds) for one in scene.conditions for seeds in ((5, 6), (7,))]
    rate = summary["dropped_rate"]
    assert (rate["count"], rate["runs"], summary["runs"], summary["seeds"]) == (4, 9, 9, [5, 7])
    assert (summary["slip_mm_max"], summary["moved_mm_max"]) == (0.8, 1.4)
    assert summary["grip_ratio_mean"] == 1.45  # of the condition that has the largest mean
    counts = [summary[key] for key in ("tightenings", "false_tightenings", "cycles_with_fault")]
    assert counts == [35, 12, 80]
    rows = summary["conditions"]
    assert [row["dropped"] for row in rows] == [0, 1, 3]
    assert [row["slip_mm_max"] for row in rows] == [0.8, 0.6, None]
    assert [row["slip_mm_mean"] for row in rows] == [0.3, 0.55, None]


def pulled(delay_ms, lead_ms, off_deg, right=True, alarms=0):
    """A run's verdict of slip from four wires, or of rubber; without a delay, a miss."""
    missed = delay_ms is None or lead_ms <= 0
    known = {"onset_s": 0.1, "gross_s": 0.2, "flag_s": None, "direction_deg": 5.0, "octant_right": right}
    known |= {"crossing_s": None, "sliding_s": None, "contact_share_of_sliding": None}
    return known | {
        "delay_s": None if delay_ms is None else 1e-3 * delay_ms,
        "lead_s": None if lead_ms is None else 1e-3 * lead_ms,
        "missed": missed,
        "late": lead_ms is not None and lead_ms <= 0,
        "false_alarms": alarms,
        "direction_error_deg": off_deg,
        "contact_wrong_share": 0.25,
    }


# By condition: the latest flag is not in the run of the shortest lead; the last run of each is neither.
VERDICTS = [
    [pulled(4, 30, 2.0), pulled(19, 50, 9.0, right=False, alarms=3), pulled(7, 40, 4.0)],
    [pulled(6, 20, 31.0, right=False), pulled(None, None, None, alarms=1), pulled(8, 60, 1.0, right=False)],
    [pulled(5, 70, 3.0), pulled(5, 80, 3.0), pulled(5, 90, 3.0)],
]


def test_the_table_of_slips_from_four_wires():
    rows = [of_cop_slip._statistics(NAMED, verdicts) for verdicts in VERDICTS]
    assert [row["delay_ms_median"] for row in rows] == [7, 7, 5]
    assert [row["delay_ms_max"] for row in rows] == [19, 8, 5]
    assert [row["lead_ms_min"] for row in rows] == [30, 20, 70]
    assert [row["direction_error_deg_max"] for row in rows] == [9, 31, 3]
    assert [row["octants_wrong"] for row in rows] == [1, 2, 0]
    assert [(row["runs"], row["missed"], row["false_alarms"]) for row in rows] == [
        (3, 0, 3),
        (3, 1, 1),
        (3, 0, 0),
    ]
    none = of_cop_slip._statistics(NAMED, [VERDICTS[1][1]] * 2)
    for key in ("delay_ms_median", "delay_ms_max", "lead_ms_min", "direction_error_deg_max"):
        assert none[key] is None
    late = of_cop_slip._statistics(NAMED, [pulled(100, -3, 1.0), pulled(2, 95, 1.0)])
    assert (late["late"], late["missed"], late["lead_ms_min"]) == (1, 1, -3)


@pytest.mark.parametrize("of, name", [(of_cop_slip, "cop_slip"), (of_rubber, "slip_forces")])
def test_the_summary_of_slips(of, name, monkeypatch):
    """The verdicts above in place of the judge's, which the rubber's run asks twice: first of the core that
    knows its motion, whose false alarms alone count."""
    scene = scenes.load(name)
    scene = dataclasses.replace(scene, seeds=3, conditions=scene.conditions[:3])
    given = [verdict for verdicts in VERDICTS for verdict in verdicts]
    if of is of_rubber:
        given = [one for n, verdict in enumerate(given) for one in (verdict | {"false_alarms": n}, verdict)]
    given = iter(given)
    monkeypatch.setattr(of, "judge", lambda *_: next(given))
    summary = of.run(scene, "fixed", 2, False, Spread()).summary
    rates = [summary[key] for key in ("missed_rate", "false_alarm_rate")]
    assert [(rate["count"], rate["runs"]) for rate in rates] == [(1, 9), (2, 9)]
    counts = [summary[key] for key in ("missed", "late", "false_alarms", "lead_ms_min", "runs")]
    assert counts == [1, 0, 4, 20, 9] and summary["seeds"] == [2, 4] and next(given, None) is None
    if of is of_rubber:
        assert summary["false_alarms_masked"] == sum(range(9))
    else:
        assert summary["octants_wrong"] == 3
        assert summary["direction_error_deg"] == {"maximum": 31.0, "mean": pytest.approx(56 / 8)}
    assert of.answer(summary).startswith(
        "1 of 9 slips were missed; the others were detected at most 19 ms after "
    )
    assert "at least 20 ms before" in of.answer(summary)


def test_the_answer_takes_the_worst_condition():
    """The largest delay of all, not of the medians; the shortest lead is in a third condition."""
    rows = [
        {"runs": 2, "missed": 0, "delay_ms_median": 9.0, "delay_ms_max": 11.0, "lead_ms_min": 30.0},
        {"runs": 2, "missed": 0, "delay_ms_median": 3.0, "delay_ms_max": 25.0, "lead_ms_min": 40.0},
        {"runs": 2, "missed": 0, "delay_ms_median": 4.0, "delay_ms_max": 4.5, "lead_ms_min": 20.0},
        {"runs": 2, "missed": 0, "delay_ms_median": 8.0, "delay_ms_max": 8.5, "lead_ms_min": 35.0},
    ]
    told = slips({"conditions": rows, "runs": 8, "missed": 0, "false_alarms": 0}, "it", "that")
    assert told == (
        "All 8 slips were detected at most 25 ms after it and at least 20 ms before that, without a false "
        "alarm."
    )


def test_the_table_of_stick_slips():
    """The shortest of each lead lies in another run; a run that has none leaves it to the others."""
    runs = [
        {"gross_s": 2.0, "change_s": 1.2, "slope_flag_s": 1.90, "lead_s": 0.30, "missed": False},
        {"gross_s": 2.5, "change_s": 2.0, "slope_flag_s": 2.30, "lead_s": 0.05, "missed": False},
        {"gross_s": 3.0, "change_s": 2.1, "slope_flag_s": 2.85, "lead_s": 0.40, "missed": True},
        {"gross_s": 3.0, "change_s": None, "slope_flag_s": None, "lead_s": None, "missed": True},
    ]
    counted = [(3, 2, 1, 0.5), (5, 1, 4, 1.0), (8, 8, 0, 2.0), (0, 0, 2, 0.5)]
    for run, (sticks, seen, elsewhere, slid_s) in zip(runs, counted):
        run |= {"stick_slips": sticks, "found": seen, "elsewhere": elsewhere, "slid_s": slid_s, "late": False}
        run |= {"onset_s": 1.0, "false_alarms": 0, "rms_before": 2.0 * slid_s, "rms_sliding": 6.0 * slid_s}
    row = of_shear._stick(runs)
    assert (row["lead_ms_min"], row["change_lead_ms_min"], row["slope_lead_ms_min"]) == (50, 500, 100)
    assert (row["missed"], row["slope_missed"], row["stick_slips_found_share"]) == (2, 1, 11 / 16)
    assert (row["elsewhere_per_s"], row["rms_before_v_s"], row["rms_sliding_v_s"]) == (7 / 4, 2.0, 6.0)
    none = of_shear._stick([runs[3]])
    assert none["lead_ms_min"] is none["change_lead_ms_min"] is none["slope_lead_ms_min"] is None
    assert none["stick_slips_found_share"] is None


def test_the_bounds_of_a_mesh_are_the_worst_of_all_samples():
    """Position: half the range's 2; load: a share of its own, and of a sample that is valid."""
    of = lambda x, y, load, bound, valid, condition: SimpleNamespace(
        bound=SimpleNamespace(x=np.array(x), y=np.array(y), load=np.array(bound)),
        **{"load": np.array(load), "valid": np.array(valid), "condition": np.array(condition)},
    )
    solutions = [
        of(
            [1.0, 6.0, 2.0],
            [1.0, 2.0, 3.0],
            [2.0, 8.0, 4.0],
            [1.0, 2.0, 9.0],
            [True, True, False],
            [3.0, 1.0],
        ),
        of([1.0, 1.0], [8.0, 2.0], [5.0, 2.0], [1.0, 0.4], [True, True], [2.0, 7.0]),
        of([1.0, 2.0], [1.0, 1.0], [5.0, 2.0], [1.0, 0.4], [True, True], [2.0, 5.0]),
    ]
    found = of_mesh.certified([SimpleNamespace(solution=one) for one in solutions])
    assert found == {"position": 4.0, "load": 0.5, "condition": 7.0}
