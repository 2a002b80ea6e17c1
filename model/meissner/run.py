"""``meissner run``: run a scene on an engine and write a folder of results."""

import json
import tempfile
from pathlib import Path

from meissner.scenes import saved
from meissner.scenes.parts import check_memory
from meissner.scenes.sensor import runner


def check(scene, engine, waves=False):
    """ValueError with one sentence if this engine or this machine cannot run the scene."""
    runner(scene.sensor).check(scene, engine, waves)
    check_memory(scene)


def full(scene, engine, seed=1, progress=lambda runs: runs):
    """The cost of a simulated second of the scene, and of one with everything on (meissner.scenes.full)."""
    from meissner.scenes import full  # here: a run without the comparison loads no other sensor

    parts = full.everything(engine, progress, seed)
    return saved.compared(full.cost(scene, engine, seed=seed), sum(parts.values())) | {
        "engine": engine,
        "full": parts,
    }


def run(scene, engine, out, seed=1, waves=False, progress=lambda runs: runs, compared=None):
    """Run a scene; write results to ``out``; return the summary, with ``compared`` (``full``) if it is given.

    The results replace those of an earlier run only when all are written, so no old picture remains.
    """
    check(scene, engine, waves)
    out = Path(out)
    with saved.measured(compared):
        return _run(scene, engine, out, seed, waves, progress)


def _run(scene, engine, out, seed, waves, progress):
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out, prefix=".run-") as folder:
        summary = runner(scene.sensor).run(scene, engine, Path(folder), seed, waves, progress)
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
    """The lines to print of a summary, after title, engine, modelled and left out."""
    return runner(scene.sensor).tell(summary)
