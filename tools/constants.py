"""The origin of each constant of the physics, and how far slip's headline figures depend on the chosen ones.

    python tools/constants.py --page                 write docs/constants.md from the modules and the record
    python tools/figures.py --record constants       measure the changes of ``CHANGES`` again (minutes)

Each module of meissner.physics states the origins of its constants: ORIGINS = {name: (kind, where, effect)}.
"""

import argparse
import importlib
import pkgutil
import re
from dataclasses import replace

import numpy as np

from meissner import physics, scenes
from meissner.builds import toolchain
from meissner.engines import fixed
from meissner.physics import rubber
from meissner.scenes.grip.run import judge as judge_held
from meissner.scenes.rubber.judge import judge
from meissner.scenes.slip_rates import rates
from meissner.tradeoff.changes import CHANGES, HELD_CHANGES, changed

PAGE = toolchain.ROOT / "docs/constants.md"
FORMATS = ("meissner.physics.cop4_config", "meissner.physics.cop4_registers")  # widths of registers
KINDS = ("published", "read off", "datasheet", "computed", "chosen")
SLIPS, PRESSES, HELD = "acrylic_slip", "normal_force", "cop_slip"
RUNS = 100


def constants(module):
    """{name: value} of a module's constants: numbers, and tables of them."""
    return {
        name: value
        for name, value in vars(module).items()
        if re.fullmatch(r"[A-Z][A-Z0-9_]*", name) and name != "ORIGINS" and _has_numbers(value)
    }


def _has_numbers(value):
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, (list, tuple, np.ndarray)):
        return any(map(_has_numbers, value))
    if hasattr(value, "__dataclass_fields__"):
        return any(_has_numbers(getattr(value, name)) for name in value.__dataclass_fields__)
    return isinstance(value, (int, float, np.number)) and not isinstance(value, bool)


def modules():
    """The modules of meissner.physics that have constants. Its packages are solvers and have none."""
    found = pkgutil.iter_modules(physics.__path__, "meissner.physics.")
    loaded = [importlib.import_module(one.name) for one in found if not one.ispkg]
    return [module for module in loaded if constants(module) and module.__name__ not in FORMATS]


def _verdicts(name, first=None):
    scene = scenes.load(name)
    if first is not None:
        scene = replace(scene, conditions=tuple(replace(c, first_event=first) for c in scene.conditions))
    config = scene.slip_config()
    for condition in scene.conditions:
        for seed in range(1, 1 + RUNS):
            recording = scenes.simulate(scene, condition, seed)
            state = fixed.watch(recording.codes[None], config).state[0]
            yield judge(recording, state, config)


def _row(change=None):
    """The figures with a change; without one, the figures as they are."""
    slips = list(_verdicts(SLIPS, change and change.first))
    presses = list(_verdicts(PRESSES)) if change is None or change.presses else None
    return _of(slips) | {"false_alarm": rates(slips + presses)["false_alarm_rate"] if presses else None}


def _of(verdicts):
    """The entries of a row, from the verdicts of runs with slips."""
    found = rates(verdicts)
    delays = [1e3 * one["delay_s"] for one in verdicts if one["delay_s"] is not None]
    return {
        "missed": found["missed_rate"],
        "false_alarm": found["false_alarm_rate"],
        "delay_ms": round(float(np.median(delays)), 3) if delays else None,
        "lead_ms": found["lead_ms_min"],
    }


def _held_row(change=None):
    """The same for the scene ``HELD``: slip from four wires, all pulls and grips."""
    scene = scenes.load(HELD)
    verdicts = []
    for condition in scene.conditions:
        for seed in range(1, 1 + scene.seeds):
            recording = scenes.simulate(scene, condition, seed)
            _, decisions = fixed.cop_slip(recording.codes, scene.config, scene.lag, scene.registers)
            verdicts.append(judge_held(recording, decisions))
    return _of(verdicts)


def _rows(changes, row):
    """A row for the unchanged constants, then one for each of ``changes``."""
    found = [{"name": "as they are", "value": None} | row()]
    for change in changes:
        with changed(change):
            found.append({"name": change.name, "value": change.value} | row(change))
    return found


def figures():
    """The record of ``CHANGES`` and of ``HELD_CHANGES``."""
    return {"runs": RUNS, "rows": _rows(CHANGES, _row), "held": _rows(HELD_CHANGES, _held_row)}


def most_missed(row):
    return 2 * row["missed"]["count"] > row["missed"]["runs"]


def ranges(rows):
    """(least, greatest) median delay, and the same of the least lead; rows that miss most slips left out."""
    rows = [row for row in rows if not most_missed(row)]
    delays, leads = [row["delay_ms"] for row in rows], [row["lead_ms"] for row in rows]
    return (min(delays), max(delays)), (min(leads), max(leads))


def text_of(value):
    """A constant's value for a cell; a table is shown by its size."""
    if isinstance(value, (dict, list, tuple, np.ndarray)) and len(str(value)) > 60:
        return f"table of {len(value)}"
    if isinstance(value, (float, np.floating)):
        return f"{value:.6g}"
    return str(value).replace("|", "\\|").replace("\n", " ")


def changes_table(changes, rows):
    """The table of ``changes`` as Markdown, from the recorded rows."""
    lines = [
        "| constant | instead of | value | missed | with a false alarm | delay, median | lead, least |",
        "|---|---|---|---|---|---|---|",
    ]
    present = {change.name: change.module for change in changes}
    for row in rows:
        usual = ""
        if row["name"] in present:
            usual = text_of(getattr(present[row["name"]], row["name"], rubber.ONSET_RATIO))

        def share(found):
            return f"{found['count']} of {found['runs']}" if found else "–"

        delay, lead = (
            f"{row[key]:.1f} ms" if row[key] is not None else "–" for key in ("delay_ms", "lead_ms")
        )
        value = "" if row["value"] is None else text_of(row["value"])
        alarms = share(row["false_alarm"])
        lines.append(
            f"| {row['name']} | {usual} | {value} | {share(row['missed'])} | {alarms} | {delay} | {lead} |"
        )
    return "\n".join(lines)


HEAD = """# Constants of the physics

`python tools/constants.py --page` writes this page from `ORIGINS` of the modules in `model/meissner/physics`.
Each constant is *published* (a paper prints it), *read off* a figure or a sentence of a paper, from a
*datasheet*, *computed* from others, or *chosen*. A scene's figures are only as good as its chosen constants;
the last column states which figures depend on a constant.

## How the slip figures depend on constants

`python tools/figures.py --record constants` changes one constant at a time{stale}.
Missed slips, delay and lead are from {runs} runs of `acrylic_slip`. False alarms are from these runs and
{presses} runs of `normal_force`, for constants that affect them. The delay is the median time from the first
partial slip to the flag, over all flags. The lead is the shortest time from the flag to the slip of the whole
contact; it is negative if a flag is late. A flag that is not raised before that slip is a miss.
"""
HELD_HEAD = """The same for `cop_slip`, slip from four wires: {pulls} pulls and {grips} runs with grip alone.
The delay starts at the beginning of the pull, the lead ends when the object moves. The median is over all
pulls, fast and slow.
"""


def page(summary, stale=False):
    """The page's text."""
    head = HEAD.format(
        runs=summary["runs"],
        presses=2 * summary["runs"],
        stale="; what it rests on has changed since: **stale**" if stale else "",
    )
    pulls, of = summary["held"][0]["missed"]["runs"], summary["held"][0]["false_alarm"]["runs"]
    parts = [head, changes_table(CHANGES, summary["rows"])]
    parts += [HELD_HEAD.format(pulls=pulls, grips=of - pulls), changes_table(HELD_CHANGES, summary["held"])]
    for module in modules():
        name = module.__name__.removeprefix("meissner.physics.")
        rows = ["| constant | value | from | where | what it does |", "|---|---|---|---|---|"]
        values, origins = constants(module), getattr(module, "ORIGINS", {})
        for key, value in values.items():
            kind, where, effect = (str(cell).replace("|", "\\|") for cell in origins[key])
            rows.append(f"| {key} | {text_of(value)} | {kind} | {where} | {effect} |")
        parts.append(f"## {name}\n\n" + "\n".join(rows))
    return "\n\n".join(part.strip() for part in parts) + "\n"


def main():
    import figures as figures_page

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--page", action="store_true", required=True, help="write docs/constants.md")
    parser.parse_args()
    records = figures_page.Records()
    PAGE.write_text(page(records.printed["constants"]["summary"], records.stale("constants")), "utf-8")


if __name__ == "__main__":
    main()
