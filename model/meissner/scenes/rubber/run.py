"""Running a slip scene: every condition and seed through an engine, compared with the ground truth."""

from functools import partial

import numpy as np

from meissner import engines, scenes
from meissner.engines.features import function
from meissner.scenes.results import Picture, Result, head, table
from meissner.scenes.rubber import pictures as report
from meissner.scenes.rubber.judge import COUNTS, contact_share, contact_wrong, judge, statistics
from meissner.scenes.slip_rates import rates
from meissner.scenes.slip_rates import tell as tell_rates
from meissner.scenes.timed import each, mismatches
from meissner.scenes.verdict import slips as answer
from meissner.twins.slip.slip_path import details

__all__ = ["TABLES", "WAVES", "answer", "run", "tell"]

TABLES = {"Conditions": "conditions", "At the converter's pins": "pins"}
WAVES = True
SHOWN = (
    "the sensor's voltage, its Haar detail, the peak to peak over the window with the threshold, the state "
    "and the forces over time; left the whole run, right its shaded part"
)


def _table(rows):
    """The rows, each with the keys of all: a condition without a flag has no delays."""
    keys = dict.fromkeys(key for row in rows for key in row)
    return [{key: row.get(key) for key in keys} for row in rows]


def _one(scene, core, place, number, shown):
    """(verdict, seconds, what is shown) of a condition's run with a seed."""
    recording, config = scenes.simulate(scene, scene.conditions[place], number), scene.slip_config()
    # A core that knows no motion, and one that is given its own motion.
    watched, masked = (
        core.watch(recording.codes[None], config, moving) for moving in (None, recording.moving)
    )
    alarms = judge(recording, masked.state[0], config)["false_alarms"]
    verdict = judge(recording, watched.state[0], config) | {"false_alarms_masked": alarms}
    return verdict, len(recording.time_s) / scene.rate_hz, (recording, watched, masked) if shown else None


def run(scene, engine, seed, waves, spread):
    """The Result of every condition of a slip scene with its seeds."""
    config, seeds = scene.slip_config(), range(seed, seed + scene.seeds)
    arrays, shown, simulated = {}, {}, 0.0
    verdicts = {condition: [] for condition in scene.conditions}
    tasks = [(at, number, number == seed) for at in range(len(verdicts)) for number in seeds]
    core, found = each(scene, engine, _one, tasks, spread)
    for (at, *_), (verdict, seconds, seen) in zip(tasks, found):
        condition = scene.conditions[at]
        verdicts[condition].append(verdict)
        simulated += seconds
        if seen is not None:
            shown[condition] = seen
    pins = None
    if engine in engines.VERILATED:
        recording, _, masked = shown[scene.conditions[0]]
        pins = function(engine, "watch_pins")(recording, config, waves=waves)
        core.differences += mismatches(pins.watched, masked)

    rows = _table([statistics(condition, verdicts[condition]) for condition in scene.conditions])
    every = [verdict for condition in scene.conditions for verdict in verdicts[condition]]
    first = verdicts[scene.conditions[0]][0]
    summary = {
        **head(scene, core, seed, simulated, shown[scene.conditions[0]][0].modelled),
        **{key: first[key] for key in ("onset_s", "crossing_s", "flag_s", "delay_s", "gross_s")},
        **{key: sum(row[key] for row in rows) for key in COUNTS},
        **rates(every),
        "contact_share_of_sliding": contact_share(every),
        "contact_wrong_share": contact_wrong(every),
        "runs": len(tasks),
        "seeds": [seeds[0], seeds[-1]],
        "conditions": rows,
        "pins": None if pins is None else pins.facts,
    }
    pictures = []
    for index, (condition, (recording, watched, _)) in enumerate(shown.items()):
        draw = partial(_draw, recording, watched, config, verdicts[condition][0])
        end = f"_{index + 1}" if len(shown) > 1 else ""
        pictures.append(Picture(end, draw, condition.name, SHOWN))
        arrays |= _arrays(recording, watched, config, f"c{index}_" if len(shown) > 1 else "")
    return Result(summary, arrays, pictures)


def _milliseconds(seconds):
    return "none" if seconds is None else f"{seconds * 1e3:.2f} ms"


def _seconds(value):
    return "none" if value is None else f"{value:.4f} s"


def tell(summary):
    lines = []
    if summary["pins"]:
        pins = summary["pins"]
        lines.append(
            f"at the pins of the {pins['adc']}: {pins['frames']} frames in {pins['clocks']} clocks; "
            f"decision {pins['decision_us']:.2f} us after convert start"
        )
    if summary["onset_s"] is None:
        flags = f"{summary['false_alarms']} in all runs" if summary["false_alarms"] else "no flag in any run"
        lines.append(f"nothing slips here, so each flag is a false alarm: {flags}")
    else:
        lines.append(
            f"shown run (seed {summary['seed']}): onset at {_seconds(summary['onset_s'])}, flag at "
            f"{_seconds(summary['flag_s'])}, delay {_milliseconds(summary['delay_s'])}"
        )
    lines += tell_rates(summary)
    if summary["false_alarms_masked"] != summary["false_alarms"]:
        lines.append(f"if the core knows its own motion: {summary['false_alarms_masked']} false alarms")
    share = summary["contact_share_of_sliding"]
    if share is not None:
        lines.append(
            f"while the whole contact slid, the state was contact for {100 * share:.2f} % of the time"
        )
    wrong = 100 * summary["contact_wrong_share"]
    lines.append(f"state and truth disagree on whether the plate presses in {wrong:.3g} % of the time")
    return [*lines, "", *table(summary["conditions"])]


def _arrays(recording, watched, config, prefix):
    """The arrays of one run for result.npz."""
    kept = {
        "time_s": recording.time_s,
        "codes": recording.codes,
        "normal_n": recording.normal_n,
        "tension_n": recording.tension_n,
        "p2p": watched.p2p[0],
        "state": watched.state[0],
        "over": watched.over[0],
        "threshold": np.int64(config.threshold),
    }
    return {prefix + name: values for name, values in kept.items()}


def _draw(recording, watched, config, verdict, path):
    detail, _ = details(recording.codes[None], config)
    group = 1 << config.level
    volts = recording.scene.adc.lsb_v / 2 ** (config.level / 2)  # per code of the unnormalised detail
    report.draw_slip(
        path,
        recording,
        detail_time_s=((np.arange(detail.shape[1]) + 1) * group - 1) / recording.scene.rate_hz,
        detail_v=detail[0] * volts,
        p2p_v=watched.p2p[0] * volts,
        state=watched.state[0],
        threshold_v=recording.scene.slip.threshold_p2p_v,
        flag_s=verdict["flag_s"],
    )
