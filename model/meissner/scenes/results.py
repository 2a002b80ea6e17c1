"""Steps common to every sensor's run: the first entries of a summary, and what a run writes."""

import json
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from meissner import engines
from meissner.files import written
from meissner.report import page
from meissner.scenes.base import left_out
from meissner.scenes.features import built, not_built
from meissner.scenes.sensor import runner
from meissner.scenes.verdict import verdict
from meissner.terminal import columns


@dataclass(frozen=True)
class Picture:
    """A picture to be drawn: ``draw`` writes the file of the path that it is given.

    ``end``: of the file's name after the scene's; ``condition``, ``shown``: for the caption; ``kind``: png
    or, for an animation, gif.
    """

    end: str
    draw: Callable[[Path], Any]
    condition: str
    shown: str
    kind: str = "png"


@dataclass(frozen=True)
class Result:
    """What a run found: ``arrays`` of result.npz, ``files`` {name: content} beside it."""

    summary: dict[str, Any]
    arrays: dict[str, Any]
    pictures: list[Picture]
    files: dict[str, bytes] = field(default_factory=dict)


def check(scene, engine, waves=False):
    """ValueError unless the engine exists and, if ``waves`` is set, records signals of this scene."""
    engines.load(engine)
    if waves and not runner(scene.sensor).WAVES:
        raise ValueError(f"--waves is not available for {scene.name}: its engines record no signals")
    if waves and engine != "rtl":
        raise ValueError("--waves requires --engine rtl: no other engine has signals")


def head(scene, core, seed, seconds, modelled):
    """The first entries of every summary.

    ``core``: the TimedEngine (meissner.scenes.timed) that ran; ``seconds``: simulated; ``modelled``: parts of
    the physics.
    """
    return {
        "scene": scene.name,
        "engine": core.engine,
        "seed": seed,
        "seconds_simulated": round(seconds, 3),
        "seconds_taken": None,
        "samples_per_second": round(core.samples / core.taken_s),
        "twin_mismatches": core.differences if core.engine in engines.VERILATED else None,
        "modelled": list(modelled),
        "left_out": list(left_out(scene, modelled)),
        "built": built(scene.features),
        "not_built": not_built(scene.features),
    }


def write(scene, result, out, began):
    """Draw and write a Result; the summary, with ``seconds_taken`` and ``files``."""
    own, summary = runner(scene.sensor), result.summary
    for name, content in result.files.items():
        with written(out / name) as file:
            file.write(content)
    pictures = []
    for picture in result.pictures:
        path = out / f"{scene.name}{picture.end}.{picture.kind}"
        picture.draw(path)
        condition = f"{picture.condition}, seed {summary['seed']}, engine {summary['engine']}"
        pictures.append((path, condition, picture.shown))
    summary["seconds_taken"] = round(time.perf_counter() - began, 3)
    with written(out / "result.npz") as file:
        np.savez_compressed(file, **result.arrays)
    there = {path.name for path in out.iterdir()}
    summary["files"] = sorted({*there, "report.html", "summary.json"})
    facts = {key: value for key, value in summary.items() if key not in (*own.TABLES.values(), "files")}
    tables = {name: summary.get(key) or [] for name, key in own.TABLES.items()}
    tables = {name: [rows] if isinstance(rows, dict) else rows for name, rows in tables.items()}
    title = f"{scene.name}: {scene.title}"
    text = verdict(summary, own.answer(summary))
    page.write_html(out / "report.html", facts, pictures, tables, title, text)
    with written(out / "summary.json") as file:
        file.write(json.dumps(summary, indent=2).encode() + b"\n")
    return summary


def numbered(draws, first=""):
    """Pictures of (draw, condition, shown): the first ends in ``first``, the others in _2, _3, ..."""
    ends = (first, *(f"_{place}" for place in range(2, len(draws) + 1)))
    return [Picture(end, *draw) for end, draw in zip(ends, draws)]


def table(rows):
    """Rows of equal keys as aligned columns, one line each; None, of nothing to count, as a dash."""
    return columns([list(rows[0]), *([row[key] for key in rows[0]] for row in rows)])
