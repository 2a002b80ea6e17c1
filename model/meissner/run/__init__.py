"""``meissner run``: a scene through an engine into a folder of results.

Each sensor has a module here with ``run(scene, engine, out, seed, waves, progress)``, which writes its
results and returns the summary, and ``tell(summary)``, the lines that the command prints about it.
"""

import json
import tempfile
import time
from importlib import import_module
from pathlib import Path

import numpy as np

from meissner import engines, report_page
from meissner.files import written
from meissner.run.verdict import verdict

_MODULES = {"rubber": "slip", "array": "cop", "grip": "cop_slip"}  # the others have the sensor's name


def _module(scene):
    return import_module(f"meissner.run.{_MODULES.get(scene.sensor, scene.sensor)}")


def check(scene, engine, waves=False):
    """ValueError with one sentence if this engine cannot run the scene."""
    _module(scene).check(scene, engine, waves)


def check_waves(engine, waves):
    """ValueError unless the engine exists, and has signals if ``waves`` are wanted."""
    engines.load(engine)
    if waves and engine != "rtl":
        raise ValueError("--waves needs the rtl engine: only it has signals")


def run(scene, engine, out, seed=1, waves=False, progress=lambda runs: runs):
    """Run a scene; write results to ``out``; return the summary.

    They replace the results of an earlier run when all are written, so no picture of another scene stays.
    """
    check(scene, engine, waves)
    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out, prefix=".run-") as folder:
        summary = _module(scene).run(scene, engine, Path(folder), seed, waves, progress)
        for name in _earlier(out):
            (out / name).unlink(missing_ok=True)
        for path in Path(folder).iterdir():
            path.replace(out / path.name)
    return summary


def _earlier(out):
    """Names of the files that an earlier run left in ``out``, as its summary lists them."""
    try:
        names = json.loads((out / "summary.json").read_text("utf-8"))["files"]
        return [name for name in names if Path(name).name == name and (out / name).is_file()]
    except (OSError, ValueError, TypeError, KeyError):
        return []


def tell(scene, summary):
    """The lines to print of a summary, besides title, engine, modelled and left out."""
    return _module(scene).tell(summary)


def finish(scene, summary, out, arrays, pictures, tables, began, hidden=()):
    """Write result.npz, report.html and summary.json; sets ``seconds_taken`` and ``files``.

    ``pictures``: (PNG path, condition, what is shown); the caption adds seed and engine to the condition.
    ``hidden``: keys of the summary that the report shows as tables instead.
    """
    summary["seconds_taken"] = round(time.perf_counter() - began, 3)
    with written(out / "result.npz") as file:
        np.savez_compressed(file, **arrays)
    there = {path.name for path in out.iterdir()}
    summary["files"] = sorted({*there, "report.html", "summary.json"})
    facts = {key: value for key, value in summary.items() if key not in (*hidden, "files")}
    named = [
        (path, f"{condition}, seed {summary['seed']}, engine {summary['engine']}", shown)
        for path, condition, shown in pictures
    ]
    title = f"{scene.name}: {scene.title}"
    report_page.write_html(out / "report.html", facts, named, tables, title, verdict(summary))
    with written(out / "summary.json") as file:
        file.write(json.dumps(summary, indent=2).encode() + b"\n")
    return summary


def table(rows):
    """Rows of equal keys as aligned columns, one line each."""
    columns = list(rows[0])
    cells = [columns, *([str(row[column]) for column in columns] for row in rows)]
    widths = [max(len(row[i]) for row in cells) for i in range(len(columns))]
    return ["  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths)).rstrip() for row in cells]
