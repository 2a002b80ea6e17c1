"""The sensitivity axis: unpublished constants of the physics, changed one at a time, and the conclusions of
the slip figures that survive each change."""

from contextlib import nullcontext
from dataclasses import replace

import numpy as np
from msgspec import structs

from meissner import scenes
from meissner.tradeoff.axes import slip
from meissner.tradeoff.axis import Axis, Figure
from meissner.tradeoff.changes import CHANGES, changed

AS_THEY_ARE = "as they are"
NAMES = {f"{one.name} {one.value:.5g}": one for one in CHANGES}
OTHERS = {"level_2": {"level": 2}, "window_16": {"window": 16}, "sliding": {"kind": "sliding"}}
CONCLUSIONS = (
    Figure("none_missed", "no slip is missed"),
    Figure("no_false_alarm", "no run has a false alarm"),
    Figure("leads_100_ms", "half of the flags lead by 100 ms or more"),
    Figure("level_1", "level 1 flags sooner than level 2"),
    Figure("window_64", "a window of 64 flags no later than one of 16"),
    Figure("sliding_sooner", "a sliding window flags no later than a tumbling one"),
    Figure("sliding_little", "and gains less than a quarter of the delay"),
)


def _recorded(name, point, change):
    """slip.recorded with ``change`` applied."""
    if change is None or change.first is None or name != slip.SLIPS:
        with changed(change) if change else nullcontext():
            return slip.recorded(name, point)
    scene, found = slip.scene_of(name, point), []
    conditions = tuple(structs.replace(one, first_event=change.first) for one in scene.conditions)
    scene = replace(scene, conditions=conditions)
    for number in range(point["runs"]):
        one = scenes.simulate(scene, 0, 1 + number)
        found.append((one.codes.astype(np.int32), (one.onset_s, one.gross_s)))
    return found


def error(point):
    change = NAMES.get(point["change"])
    given = slip.SHIPPED | {"runs": point["runs"]}
    slips, presses = (_recorded(name, given, change) for name in (slip.SLIPS, slip.PRESSES))

    def of(other=None):
        detector = given | (OTHERS[other] if other else {})
        both = zip((slip.SLIPS, slip.PRESSES), (slips, presses if other is None else []))
        return [list(slip.verdicts(name, detector, records)) for name, records in both]

    found = slip.figures(*of())
    delays = {other: _delay(of(other)[0]) for other in OTHERS}
    usual = np.inf if found["delay_ms_mean"] is None else found["delay_ms_mean"]
    return {
        **{key: found[key] for key in ("missed", "late", "false_alarm", "delay_ms", "lead_ms_median")},
        "lead_ms_min": found["lead_ms_min"],
        "none_missed": found["missed"]["count"] == 0,
        "no_false_alarm": found["false_alarm"]["count"] == 0,
        "leads_100_ms": found["lead_ms_median"] is not None and found["lead_ms_median"] >= 100,
        "level_1": bool(usual < delays["level_2"]),
        "window_64": bool(usual <= delays["window_16"]),
        "sliding_sooner": bool(delays["sliding"] <= usual),
        "sliding_little": bool(delays["sliding"] > 0.75 * usual),
    }


def _delay(verdicts):
    """Mean delay from onset to flag in ms; infinite if a slip has no flag."""
    delays = [np.inf if one["delay_s"] is None else 1e3 * one["delay_s"] for one in verdicts]
    return float(np.mean(delays))


def cost(_point):
    return {}


AXES = (
    Axis(
        name="constants",
        title="Constants of the physics that nobody published",
        about="each is changed alone; the detector has its shipped settings",
        values={"change": (AS_THEY_ARE, *NAMES)},
        shipped={"change": AS_THEY_ARE},
        runs={"runs": (100, 10)},
        cost=cost,
        error=error,
        conclusions=tuple(figure.key for figure in CONCLUSIONS),
        figures=(
            *CONCLUSIONS,
            Figure("missed", "missed, late ones too"),
            Figure("late", "of these late", "runs"),
            Figure("false_alarm", "with a false alarm"),
            Figure("delay_ms", "onset to flag, median", "ms"),
            Figure("lead_ms_median", "flag to slip of the whole contact, median", "ms"),
            Figure("lead_ms_min", "the same, least", "ms"),
        ),
    ),
)
