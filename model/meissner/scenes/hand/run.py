"""Running a hand's scene in closed loop: each condition with its seeds; drops, slip and grip."""

import time
from dataclasses import fields
from functools import partial
from types import SimpleNamespace

import numpy as np

from meissner import interval
from meissner.report.words import number
from meissner.scenes.hand import loop, pictures
from meissner.scenes.hand.scene import batches, modelled
from meissner.scenes.results import Picture, Result, head, table
from meissner.scenes.verdict import count
from meissner.twins.actuate.grip import Grip

TABLES = {"Conditions": "conditions"}
WAVES = False  # its cores record no signals

SHOWN = (
    "grip force and the least that holds the object, the Haar detail of both fingers, and the object's "
    "downward displacement"
)
# An engine's part of the loop; both have the reflex in integers (docs/grip_scenes.md explains it).
PARTS = {"fixed": (loop.FixedSlip, Grip), "float": (loop.FloatSlip, Grip)}
PARTS |= {"rtl": loop.Cores, "gate": loop.Netlists}
KEYS = tuple(field.name for field in fields(loop.Held) if field.name not in ("trace", "mismatches"))
WITHIN = 1.2  # times the least grip that friction allows: the target of the hold


def statistics(condition, found):
    """A row of the table of conditions; ``found``: {key: [runs]} of a condition's runs."""
    kept = ~found["dropped"]

    def of(key, pick):
        return round(float(pick(found[key][kept])), 4) if kept.any() else None

    tugs = "tug_ratio" if not np.isnan(found["tug_ratio"]).any() else None
    dropped = interval.rate(int(found["dropped"].sum()), len(kept))
    return {
        "condition": condition.name,
        "runs": len(kept),
        "dropped": dropped["count"],
        "dropped_interval": [dropped["low"], dropped["high"]],
        "grip_ratio_mean": of("ratio", np.mean),
        "grip_ratio_max": of("ratio", np.max),
        "runs_above_ratio": int((found["ratio"][kept] > WITHIN).sum()),
        "tug_ratio_mean": of(tugs, np.mean) if tugs else None,
        "tug_ratio_min": of(tugs, np.min) if tugs else None,
        "moved_mm_max": of("moved_mm", np.max),
        "sag_mm_max": of("sag_mm", np.max),
        "ring_mm_max": of("ring_mm", np.max),
        "slip_mm_mean": of("slip_mm", np.mean),
        "slip_mm_max": of("slip_mm", np.max),
        "tightenings": int(found["tightenings"].sum()),
        "false_tightenings": int(found["false_tightenings"].sum()),
        "cycles_with_fault": int(found["faults"].sum()),
    }


def joined(helds):
    """{key: [runs]} from the Helds of a condition."""
    return {key: np.concatenate([getattr(held, key) for held in helds]) for key in KEYS}


def _one(scene, engine, task):
    """(seconds taken, Held) of a condition's runs with these seeds."""
    began, (place, seeds) = time.perf_counter(), task
    held = loop.hold(scene, scene.conditions[place], seeds, PARTS[engine])
    return time.perf_counter() - began, held


def run(scene, engine, seed, waves, spread):
    """The Result of every condition with its seeds."""
    helds = {condition: [] for condition in scene.conditions}
    tasks = [
        (place, batch)
        for place, condition in enumerate(scene.conditions)
        for batch in batches(condition, range(seed, seed + scene.seeds))
    ]
    taken_s, found = zip(*spread.map(partial(_one, scene, engine), tasks))
    for (place, _), held in zip(tasks, found):
        helds[scene.conditions[place]].append(held)
    found = {condition: joined(several) for condition, several in helds.items()}
    rows = [statistics(condition, found[condition]) for condition in scene.conditions]
    runs = sum(row["runs"] for row in rows)
    kept = [row for row in rows if row["grip_ratio_mean"] is not None]
    simulated = sum(row["runs"] * scene.duration_s(one) for row, one in zip(rows, scene.conditions))
    compared = [held.mismatches for several in helds.values() for held in several]
    core = SimpleNamespace(  # as TimedEngine: here the hand's physics are within the time, too
        engine=engine,
        samples=2 * simulated * scene.rate_hz,
        taken_s=sum(taken_s),
        differences=None if compared[0] is None else int(np.concatenate(compared).sum()),
    )
    summary = {
        **head(scene, core, seed, simulated, modelled(scene)),
        "dropped_rate": interval.rate(sum(row["dropped"] for row in rows), runs),
        "tightenings": sum(row["tightenings"] for row in rows),
        "false_tightenings": sum(row["false_tightenings"] for row in rows),
        "cycles_with_fault": sum(row["cycles_with_fault"] for row in rows),
        "grip_ratio_mean": max((row["grip_ratio_mean"] for row in kept), default=None),
        "moved_mm_max": max((row["moved_mm_max"] for row in kept), default=None),
        "slip_mm_max": max((row["slip_mm_max"] for row in kept), default=None),
        "runs": runs,
        "seeds": [seed, seed + scene.seeds - 1],
        "conditions": rows,
    }
    shown, arrays = [], {}
    for index, condition in enumerate(scene.conditions):
        trace = helds[condition][0].trace
        draw = partial(pictures.draw, scene, condition, seed, trace)
        shown.append(Picture(f"_{index + 1}", draw, condition.name, SHOWN))
        arrays |= {f"c{index}_{name}": values for name, values in vars(trace).items()}
        arrays |= {f"c{index}_runs_{name}": values for name, values in found[condition].items()}
    return Result(summary, arrays, shown)


def tell(summary):
    first, last = summary["seeds"]
    lines = [
        f"{summary['runs']} runs, seeds {first} to {last} of each condition",
        f"dropped: {interval.words(summary['dropped_rate'])}",
        f"tightened {summary['tightenings']} times, {summary['false_tightenings']} of them without an event",
    ]
    if summary["grip_ratio_mean"] is not None:
        lines.append(
            f"runs that hold: grip at most {summary['grip_ratio_mean']:.3f} times the least that "
            f"friction allows, in the mean of a condition; the object moved by at most "
            f"{summary['moved_mm_max']:.3f} mm, of which slip at most {summary['slip_mm_max']:.4f} mm"
        )
    return [*lines, "", *table(summary["conditions"])]


def answer(summary):
    """The sentence about the runs: drops, and the grip of those that held."""
    rate, runs = summary["dropped_rate"], count(summary["runs"], "run")
    if rate["count"] == rate["runs"]:
        return f"The object was dropped in every one of {runs}."
    text = (
        "Nothing was dropped" if not rate["count"] else f"The object was dropped in {number(rate['count'])}"
    )
    return (
        f"{text} {'in' if not rate['count'] else 'of'} {runs} (95 % interval up to "
        f"{number(100 * rate['high'])} %); the grip was at most {number(summary['grip_ratio_mean'])} times "
        f"the least grip that friction allows, in the mean of a condition, while the object slipped by at "
        f"most {number(summary['slip_mm_max'])} mm."
    )
