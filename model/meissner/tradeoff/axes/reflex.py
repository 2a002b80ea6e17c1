"""The control cycle of the grip reflex, against how far a tugged glass slips through the fingers."""

from dataclasses import replace

import numpy as np
from msgspec import structs

from meissner import interval, scenes
from meissner.scenes.hand import loop
from meissner.scenes.hand.run import PARTS, statistics
from meissner.tradeoff.axis import Axis, Figure

SCENE = "grip_disturb"
KEYS = ("dropped", "slip_mm", "sag_mm", "ring_mm", "moved_mm", "tightenings", "false_tightenings")
KEYS += ("faults", "ratio", "tug_ratio")
FINE = {"count_mm": 2e-5, "down_mm": 0.5}  # lets the hand release by 0.02 mm/s even at 1 ms


def error(point):
    scene = scenes.load(SCENE)
    first = structs.replace(scene.conditions[0], name="swept", cycle_ms=point["cycle_ms"], **FINE)
    grip = scene.grip | {key: point[key] for key in ("step_share", "boost")}
    scene = replace(scene, grip=grip, conditions=(first,))
    held = loop.hold(scene, first, range(1, 1 + point["runs"]), PARTS["fixed"])
    found = {key: getattr(held, key) for key in KEYS}
    row = statistics(first, found)
    slips = np.where(found["dropped"], np.inf, found["slip_mm"])
    return {
        "dropped": interval.rate(row["dropped"], row["runs"]),
        "dropped_share": 100 * row["dropped"] / row["runs"],
        "slip_mm_max": row["slip_mm_max"],
        "slip_mm_mean": row["slip_mm_mean"],
        "slipped": interval.rate(int((slips > 0.001).sum()), row["runs"]),
        "moved_mm_max": row["moved_mm_max"],
        "grip_ratio": row["grip_ratio_mean"],
    }


def cost(point):
    return {"cycles_s": 1000 // point["cycle_ms"]}


AXES = (
    Axis(
        name="reflex",
        title="Control cycle of the grip reflex, three tugs at a glass",
        about="a cycle of 1, 2, 5 or 10 ms; a step is a share of the grip, at most 0.1, during tugs; "
        "during consecutive windows over it doubles boost times, at most 7",
        values={"cycle_ms": (1, 2, 5, 10), "step_share": (0.004, 0.008, 0.016), "boost": (0, 5)},
        quick={"cycle_ms": (2, 10), "step_share": (0.008,), "boost": (5,)},
        shipped={"cycle_ms": 10, "step_share": 0.008, "boost": 5},
        runs={"runs": (10, 4)},
        legal=lambda point: (
            point["cycle_ms"] in (1, 2, 5, 10)
            and 0 < point["step_share"] <= 0.1
            and point["boost"] in range(8)
        ),
        cost=cost,
        error=error,
        figures=(
            Figure("cycles_s", "control cycles", "1/s", judged=True),
            Figure("dropped_share", "runs that drop it", "%", judged=True),
            Figure("slip_mm_max", "slip, largest of the runs that hold", "mm", judged=True),
            Figure("grip_ratio", "grip over the least that friction allows", judged=True),
            Figure("slip_mm_mean", "slip, mean", "mm"),
            Figure("slipped", "slipped by more than a micrometre, or dropped"),
            Figure("dropped", "dropped, of all runs"),
            Figure("moved_mm_max", "moved, elastic sag too", "mm"),
        ),
        panels=(("cycles_s", "slip_mm_max"), ("cycles_s", "grip_ratio")),
    ),
)
