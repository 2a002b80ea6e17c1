"""Running a scene of a rope: its pulls through the fingertip and an engine, judged by kind."""

from functools import partial

from meissner import interval
from meissner.scenes.errors import percent
from meissner.scenes.results import Result, head, numbered, table
from meissner.scenes.rope.judge import KINDS
from meissner.scenes.rope.scene import modelled, simulate_all
from meissner.scenes.timed import TimedEngine
from meissner.scenes.verdict import count, position_and_load

TABLES = {"Conditions": "conditions"}
WAVES = False
SHOWN = {
    "draw_pull": "nine sensors, the load cell's slip and the forest's alarms; first run of each condition",
    "draw_cop": "path of the reported centre, numbered every 150 steps",
    "draw_sensors": "the nine sensors less their values with the rope grasped; slip by the load cell",
    "draw_steps": "difference of s_1 between successive steps in one section",
}


def run(scene, engine, seed, waves=None, spread=None):
    """The Result of every condition with its seeds; one fingertip, that of the first seed."""
    core, seeds = TimedEngine(engine, scene.features), range(seed, seed + scene.seeds)
    recordings = simulate_all(scene, seeds, seed)
    found, arrays, rows, drawings = KINDS[scene.kind](scene, core, recordings, seed)
    every = [one for of in recordings for one in of]
    frames = sum(len(one.codes) for one in every)
    summary = {
        **head(scene, core, seed, frames / scene.rate_hz, modelled(scene)),
        "over_range": sum(one.over_range for one in every),
        **found,
        "runs": len(every),
        "seeds": [seeds[0], seeds[-1]],
        "frames": frames,
        "conditions": rows,
    }
    drawn = [(partial(draw, scene, **what), scene.title, SHOWN[draw.__name__]) for draw, what in drawings]
    return Result(summary, {"time_s": every[0].time_s, **arrays}, numbered(drawn))


def tell(summary):
    first, last = summary["seeds"]
    lines = [f"{summary['runs']} runs, seeds {first} to {last} of each condition"]
    if "missed" in summary:
        lines.append(
            f"{summary['trees']} trees, trained on {summary['trained_on']} sections of simulated pulls"
        )
        for key, word, of in (
            ("missed_rate", "slips missed", "sections"),
            ("false_alarm_rate", "sections without slip with an alarm", "sections"),
        ):
            if summary[key]:
                lines.append(f"{word}: {interval.words(summary[key], of)}")
        if summary["apart_ms"] is not None:
            lines.append(
                f"first alarm from t_s: {summary['apart_ms']:+.1f} ± {summary['apart_ms_deviation']:.1f} ms"
            )
    if "position_error" in summary:
        lines += [
            f"position error, of the range -1 to 1: {percent(summary['position_error'])}",
            f"load error: {percent(summary['load_error'])}",
        ]
    return [*lines, "", *table(summary["conditions"])]


def answer(summary):
    """The sentence about a run."""
    rows = summary["conditions"]
    if "missed" in summary:
        slips, quiet = (sum(row[key] for row in rows) for key in ("slipping_sections", "quiet_sections"))
        apart = summary["apart_ms"]
        after = (
            ""
            if apart is None
            else f"; the first alarm is {apart:+.1f} ms after the load cell's, in the mean"
        )
        return (
            f"The forest missed {summary['missed']} of {count(slips, 'slip')}, with an alarm in "
            f"{summary['false_alarms']} of {count(quiet, 'section')} without slip{after}."
        )
    if "position_error" in summary:
        follows = ", ".join(f"{100 * row['y_follows']:.0f} % ({row['condition']})" for row in rows)
        return f"The centre follows the rope by {follows}. {position_and_load(summary)}"
    rows = sorted((row for row in rows if row["slipping_sections"]), key=lambda row: row["oscillation"])
    if not rows:
        return "The rope does not slip."
    least, most = rows[0], rows[-1]
    return (
        f"While the rope slips, sensor 1 changes between frames by {least['oscillation']:.1f} codes rms "
        f"({least['condition']}) to {most['oscillation']:.1f} ({most['condition']})."
    )
