"""The origin of each constant of the physics, and how far slip's headline figures depend on the chosen ones:
docs/constants.md, measured by `make figures FIGURES="constants"` in minutes.

Each module of meissner.physics states the origins of its constants: ORIGINS = {name: (kind, where, effect)}.
"""

import importlib
import pkgutil
import re
from contextlib import nullcontext

import numpy as np

from meissner import physics, scenes
from meissner.builds import toolchain
from meissner.engines import fixed
from meissner.scenes.grip.run import judge
from meissner.scenes.slip_rates import rates
from meissner.tradeoff.changes import HELD_CHANGES, changed

PAGE = toolchain.ROOT / "docs/constants.md"
FORMATS = ("meissner.physics.cop4_config", "meissner.physics.cop4_registers")  # widths of registers
KINDS = ("published", "read off", "datasheet", "computed", "chosen")
HELD = "cop_slip"


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


def row(change=None):
    """The figures of slip from four wires, all pulls and grips, with a change; without one, as they are."""
    scene, verdicts = scenes.load(HELD), []
    with changed(change) if change else nullcontext():
        for condition in scene.conditions:
            for seed in range(1, 1 + scene.seeds):
                recording = scenes.simulate(scene, condition, seed)
                _, decisions = fixed.cop_slip(recording.codes, scene.config, scene.lag, scene.registers)
                verdicts.append(judge(recording, decisions))
    found = rates(verdicts)
    delays = [1e3 * one["delay_s"] for one in verdicts if one["delay_s"] is not None]
    return {
        "missed": found["missed_rate"],
        "false_alarm": found["false_alarm_rate"],
        "delay_ms": float(np.median(delays)) if delays else None,
        "lead_ms": found["lead_ms_min"],
    }


def text_of(value):
    """A constant's value for a cell; a table is shown by its size."""
    if isinstance(value, (dict, list, tuple, np.ndarray)) and len(str(value)) > 60:
        return f"table of {len(value)}"
    if isinstance(value, (float, np.floating)):
        return f"{value:.6g}"
    return str(value).replace("|", "\\|").replace("\n", " ")


def changes_table(rows):
    """The table of HELD_CHANGES as Markdown; ``rows``: that of the unchanged constants, then one for each."""
    lines = [
        "| constant | instead of | value | missed | with a false alarm | delay, median | lead, least |",
        "|---|---|---|---|---|---|---|",
    ]
    for change, found in zip((None, *HELD_CHANGES), rows, strict=True):
        cells = ["as they are", "", ""]
        if change:
            cells = [change.name, text_of(getattr(change.module, change.name)), text_of(change.value)]
        cells += [f"{found[key]['count']} of {found[key]['runs']}" for key in ("missed", "false_alarm")]
        cells += [
            f"{found[key]:.1f} ms" if found[key] is not None else "–" for key in ("delay_ms", "lead_ms")
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


HEAD = """# Constants of the physics

{heading}

`make figures FIGURES="constants"` writes this page from `ORIGINS` of the modules in `model/meissner/physics`.
Each constant is *published* (a paper prints it), *read off* a figure or a sentence of a paper, from a
*datasheet*, *computed* from others, or *chosen*. A scene's figures are only as good as its chosen constants;
the last column states which figures depend on a constant.

## How the slip figures depend on constants

One constant is changed at a time. [tradeoff.md](tradeoff.md#constants-of-the-physics-that-nobody-published)
has the changes for `acrylic_slip`. Here are those for `cop_slip`, slip from four wires: {pulls} pulls and
{grips} runs with grip alone. The delay starts at the beginning of the pull, the lead ends when the object
moves. The median is over all pulls, fast and slow.
"""


def page(rows, heading):
    """The page's text; ``rows``: those of ``changes_table``."""
    pulls, of = rows[0]["missed"]["runs"], rows[0]["false_alarm"]["runs"]
    parts = [HEAD.format(heading=heading, pulls=pulls, grips=of - pulls), changes_table(rows)]
    for module in modules():
        name = module.__name__.removeprefix("meissner.physics.")
        lines = ["| constant | value | from | where | what it does |", "|---|---|---|---|---|"]
        values, origins = constants(module), getattr(module, "ORIGINS", {})
        for key, value in values.items():
            kind, where, effect = (str(cell).replace("|", "\\|") for cell in origins[key])
            lines.append(f"| {key} | {text_of(value)} | {kind} | {where} | {effect} |")
        parts.append(f"## {name}\n\n" + "\n".join(lines))
    return "\n\n".join(part.strip() for part in parts) + "\n"


def write(heading):
    """Measure and write the page; returns its path."""
    PAGE.write_text(page([row(change) for change in (None, *HELD_CHANGES)], heading), "utf-8")
    return str(PAGE.relative_to(toolchain.ROOT))
