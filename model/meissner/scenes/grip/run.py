"""Running a scene of an object held on the four-wire sensor: each condition and seed, against the truth."""

from functools import partial

import numpy as np

from meissner import engines, scenes
from meissner.engines.features import function
from meissner.physics.grip import FULL_SCALE_V
from meissner.report.words import fact
from meissner.scenes.errors import errors, percent, summarise
from meissner.scenes.grip import pictures as report_cop_slip
from meissner.scenes.grip.scene import Pull
from meissner.scenes.results import Picture, Result, head, table
from meissner.scenes.slip_rates import rates
from meissner.scenes.slip_rates import tell as tell_rates
from meissner.scenes.timed import each, mismatches
from meissner.scenes.verdict import slips
from meissner.twins.cop.cop_slip import octants

TABLES = {"Conditions": "conditions"}
WAVES = True
AFTER_S = 0.02  # length of waves.vcd after the flag
BEFORE_S = 0.02  # rest before the onset: the baseline of load drop and move

SHOWN = "load output, position output and forces over time, with the pull's beginning, the flag and the move"


def judge(recording, decisions):
    """Compare the decisions of one run with the truth; seconds, degrees, None where there is none.

    ``flag_s``: the first rise of the flag at or after the onset; ``missed``: a slip without a flag before
    the object moves; ``late``: a slip whose flag comes when the object moves or later; it also counts as
    missed and has a ``lead_s`` of 0 or less; ``false_alarms``: rises before the onset, or all where nothing
    is pulled; ``direction_deg``: the reported direction of the slip at the flag, -180 .. 180;
    ``direction_error_deg``: its difference from the truth.
    """
    held, rate_hz = recording.held, recording.scene.rate_hz
    rises = np.flatnonzero(decisions.raised)
    if held.onset_s is None:
        early, flag = len(rises), None
    else:
        early = int((rises < held.onset_s * rate_hz - 1e-6).sum())
        flag = int(rises[early]) if early < len(rises) else None
    verdict = {
        "onset_s": held.onset_s,
        "gross_s": held.gross_s,
        "flag_s": None if flag is None else flag / rate_hz,
        "delay_s": None if flag is None else flag / rate_hz - held.onset_s,
        "lead_s": None if flag is None else held.gross_s - flag / rate_hz,
        "missed": held.onset_s is not None and (flag is None or flag / rate_hz >= held.gross_s),
        "late": flag is not None and flag / rate_hz >= held.gross_s,
        "false_alarms": early,
        **dict.fromkeys(("direction_deg", "direction_error_deg", "octant_right")),
    }
    if flag is not None:
        way = float(np.degrees(np.arctan2(decisions.dy[flag], decisions.dx[flag])))
        true_deg = recording.condition.direction_deg
        along = np.deg2rad(true_deg)
        octant = int(octants(*np.rint(1e6 * np.array([np.cos(along), np.sin(along)]))))
        verdict["direction_deg"] = way
        verdict["direction_error_deg"] = abs((way - true_deg + 180) % 360 - 180)
        verdict["octant_right"] = octant == int(decisions.octant[flag])
    return verdict


def published(recording, x, y, load):
    """The quantities with published numbers, before the object moves; None where nothing is pulled.

    ``load_drop``: fall of the reported load, as a share of the load before the onset; ``grip_rise_n``: rise
    of the true grip meanwhile; ``move_v``: move of the position output along the pull, 4 V at the edge.
    """
    held, rate_hz = recording.held, recording.scene.rate_hz
    if held.onset_s is None:
        return None
    onset, gross = (int(np.ceil(s * rate_hz)) for s in (held.onset_s, held.gross_s))
    rest = slice(onset - max(1, round(BEFORE_S * rate_hz)), onset)
    along = np.deg2rad(recording.condition.direction_deg)
    place = x * np.cos(along) + y * np.sin(along)
    return {
        "load_drop": 1 - load[onset:gross].min() / load[rest].mean(),
        "grip_rise_n": held.grip_n[gross - 1] - held.grip_n[onset - 1],
        "move_v": FULL_SCALE_V * (place[gross - 1] - place[rest].mean()),
    }


def _statistics(condition, verdicts):
    """One row of the table of conditions."""

    def of(key, scale=1.0):
        return np.array([v[key] for v in verdicts if v[key] is not None]) * scale

    row = {
        "condition": condition.name,
        "runs": len(verdicts),
        **{key: sum(v[key] for v in verdicts) for key in ("missed", "late", "false_alarms")},
    }
    delays, leads, ways = of("delay_s", 1e3), of("lead_s", 1e3), of("direction_error_deg")
    found = len(delays) > 0
    return row | {
        "delay_ms_median": round(float(np.median(delays)), 3) if found else None,
        "delay_ms_max": round(float(delays.max()), 3) if found else None,
        "lead_ms_min": round(float(leads.min()), 3) if found else None,
        "direction_error_deg_max": round(float(ways.max()), 2) if found else None,
        "octants_wrong": sum(v["octant_right"] is False for v in verdicts),
    }


def _summary(values):
    """``summarise`` of the values that are not None."""
    return summarise(np.array([value for value in values if value is not None], dtype=float))


def _one(scene, core, place, number, shown):
    """(verdict, published quantities, errors, what is shown) of a condition's run with a seed."""
    recording = scenes.simulate(scene, scene.conditions[place], number)
    found, decisions = core.cop_slip(recording.codes, scene.config, scene.lag, scene.registers)
    x, y = found.x / engines.COP_ONE, found.y / engines.COP_ONE
    load = found.load * scene.config.load_lsb_n
    position, of_load = errors(x, y, load, found.pressed, recording.load, recording.x, recording.y)
    _, of_felt = errors(x, y, load, found.pressed, recording.held.felt_n, recording.x, recording.y)
    wrong = position, of_load[found.pressed], of_felt[found.pressed]
    seen = (recording, found, decisions) if shown else None
    return judge(recording, decisions), published(recording, x, y, load), wrong, seen


def run(scene, engine, seed, waves, spread):
    """The Result of every condition with its seeds."""
    settings = scene.config, scene.lag, scene.registers
    seeds = range(seed, seed + scene.seeds)
    verdicts = {condition: [] for condition in scene.conditions}
    tasks = [(at, number, number == seed) for at in range(len(verdicts)) for number in seeds]
    core, every = each(scene, engine, _one, tasks, spread)
    for (at, *_), (verdict, *_) in zip(tasks, every):
        verdicts[scene.conditions[at]].append(verdict)
    _, facts, wrong, seen = zip(*every)
    wrong_place, wrong_load, wrong_felt = map(np.concatenate, zip(*wrong))
    samples = len(wrong_place)
    shown = dict(zip(scene.conditions, filter(None, seen)))

    rows = [_statistics(condition, verdicts[condition]) for condition in scene.conditions]
    every = [verdict for verdict, *_ in every]
    first = verdicts[scene.conditions[0]][0]
    recording, *told = shown[scene.conditions[0]]
    if waves:  # the shown run, until shortly after its flag
        flag_s = recording.time_s[-1] if first["flag_s"] is None else first["flag_s"]
        part = slice(0, round((flag_s + AFTER_S) * scene.rate_hz))
        seen = function(engine, "cop_slip")(recording.codes[part], *settings, waves)
        core.differences += mismatches(seen, tuple(tuple(array[part] for array in one) for one in told))
    summary = {
        **head(scene, core, seed, samples / scene.rate_hz, recording.modelled),
        **{key: first[key] for key in ("onset_s", "flag_s", "delay_s", "gross_s", "direction_deg")},
        **{key: sum(row[key] for row in rows) for key in ("missed", "late", "false_alarms")},
        **rates(every),
        "direction_error_deg": _summary([verdict["direction_error_deg"] for verdict in every]),
        "octants_wrong": sum(row["octants_wrong"] for row in rows),
        "position_error": summarise(wrong_place),
        "load_error": summarise(wrong_load),
        "load_error_without_shear": summarise(wrong_felt),
        **{
            key: _summary([fact and fact[key] for fact in facts])
            for key in ("load_drop", "grip_rise_n", "move_v")
        },
        "runs": len(every),
        "seeds": [seeds[0], seeds[-1]],
        "conditions": rows,
    }
    arrays = {}
    for index, one in enumerate(shown.values()):
        arrays |= {f"c{index}_{name}": values for name, values in _arrays(*one).items()}
    ways = [
        (condition.direction_deg, verdict["direction_deg"])
        for condition in scene.conditions
        if isinstance(condition, Pull)
        for verdict in verdicts[condition]
    ]
    pulled = "; ".join(condition.name for condition in scene.conditions if isinstance(condition, Pull))
    draw = partial(report_cop_slip.draw_ways, scene, ways)
    pictures = [Picture("", draw, pulled, "the reported direction of each slip beside the true one")]
    for number, (condition, one) in enumerate(shown.items(), 1):
        draw = partial(report_cop_slip.draw, *one, verdicts[condition][0])
        pictures.append(Picture(f"_{number}", draw, condition.name, SHOWN))
    return Result(summary, arrays, pictures)


def _arrays(recording, found, decisions):
    """The arrays of one run for result.npz."""
    held = recording.held
    return {
        "time_s": recording.time_s,
        "codes": recording.codes,
        **{name: getattr(found, name) for name in ("x", "y", "load")},
        "valid": found.pressed,
        **{name: getattr(decisions, name) for name in ("slip", "raised", "dx", "dy", "octant")},
        "true_load": recording.load,
        "true_x": recording.x,
        "true_y": recording.y,
        "felt_load": held.felt_n,
        "tension_n": held.tension_n,
        "slip_mm": held.slip_mm,
    }


def tell(summary):
    def mean(key, scale=1.0):
        return "none" if summary[key] is None else f"{scale * summary[key]['mean']:.3g}"

    shown = "no slip"
    if summary["onset_s"] is not None:
        shown = f"pulled from {summary['onset_s']:.3f} s, moving at {summary['gross_s']:.4f} s"
    flag = "no flag" if summary["flag_s"] is None else f"flag at {summary['flag_s']:.3f} s"
    return [
        f"shown run (seed {summary['seed']}): {shown}, {flag}",
        *tell_rates(summary),
        f"before the object moves, in the mean: load output down by {mean('load_drop', 100)} % (published: "
        f"50 and 65 %), grip up by {mean('grip_rise_n')} N (0.2 N), position moved by {mean('move_v')} V of "
        f"±{FULL_SCALE_V:g} V (0.05 V)",
        f"direction of slip: mean error {mean('direction_error_deg')} degrees, "
        f"{summary['octants_wrong']} in the wrong octant",
        f"position error, of the range -1 to 1: {percent(summary['position_error'])}",
        f"load error: {percent(summary['load_error'])}; against what the sheared rubber shows: "
        f"{percent(summary['load_error_without_shear'])}",
        "",
        *table(summary["conditions"]),
    ]


def answer(summary):
    """The sentence about a run: its slips, and their direction."""
    text = slips(summary, "the pull began", "the object moved")
    if summary["direction_error_deg"] is None:
        return text
    worst = fact("direction_error_deg", summary["direction_error_deg"]["maximum"])
    return f"{text[:-1]}; the reported direction is at most {worst} off."
