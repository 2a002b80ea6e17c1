"""Steps common to every sensor's run: refuse waves without signals, write the results, align a table."""

import json
import time

import numpy as np

from meissner import engines
from meissner.files import written
from meissner.report import page
from meissner.scenes import saved
from meissner.scenes.parts import built, not_built
from meissner.scenes.sensor import answer
from meissner.scenes.verdict import verdict


def check_waves(engine, waves):
    """ValueError unless the engine exists, and has signals if ``waves`` is set."""
    engines.load(engine)
    if waves and engine != "rtl":
        raise ValueError("--waves requires --engine rtl: no other engine has signals")


def head(scene, engine, seed, seconds, samples, engine_s, differences, of):
    """The first entries of every summary.

    ``seconds``: simulated; ``samples``: processed in ``engine_s`` seconds of the engine; ``differences``:
    from the integer twins, for an engine that is compared with them; ``of``: has ``modelled`` and
    ``left_out``.
    """
    return {
        "scene": scene.name,
        "engine": engine,
        "seed": seed,
        "seconds_simulated": round(seconds, 3),
        "seconds_taken": None,
        "samples_per_second": round(samples / engine_s),
        "twin_mismatches": differences if engine in engines.VERILATED else None,
        "modelled": list(of.modelled),
        "left_out": list(of.left_out),
        "built": built(scene.features),
        "not_built": not_built(scene.features),
        "saved": saved.of(scene, engine),
    }


def finish(scene, summary, out, arrays, pictures, tables, began, hidden=()):
    """Write result.npz, report.html and summary.json; sets ``seconds_taken`` and ``files``.

    ``pictures``: (PNG path, condition, what is shown); the caption adds seed and engine to the condition.
    ``hidden``: keys of the summary that the report shows as tables, not in its list of facts.
    """
    summary["seconds_taken"] = round(time.perf_counter() - began, 3)
    with written(out / "result.npz") as file:
        np.savez_compressed(file, **arrays)
    there = {path.name for path in out.iterdir()}
    summary["files"] = sorted({*there, "report.html", "summary.json"})
    facts = {key: value for key, value in summary.items() if key not in (*hidden, "files", "saved")}
    if summary.get("saved"):
        row = {key: value for key, value in summary["saved"].items() if key != "full"}
        tables = {**tables, "Time saved compared with everything on": [row]}
    named = [
        (path, f"{condition}, seed {summary['seed']}, engine {summary['engine']}", shown)
        for path, condition, shown in pictures
    ]
    title = f"{scene.name}: {scene.title}"
    text = verdict(summary, answer(scene.sensor, summary))
    page.write_html(out / "report.html", facts, named, tables, title, text)
    with written(out / "summary.json") as file:
        file.write(json.dumps(summary, indent=2).encode() + b"\n")
    return summary


def table(rows):
    """Rows of equal keys as aligned columns, one line each."""
    columns = list(rows[0])
    cells = [columns, *([str(row[column]) for column in columns] for row in rows)]
    widths = [max(len(row[i]) for row in cells) for i in range(len(columns))]
    return ["  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths)).rstrip() for row in cells]
