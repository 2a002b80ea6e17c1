"""``meissner run``: a scene through an engine into a folder of results."""

import json
import tempfile
from pathlib import Path

from meissner.scenes.sensor import runner


def check(scene, engine, waves=False):
    """ValueError with one sentence if this engine cannot run the scene."""
    runner(scene.sensor).check(scene, engine, waves)


def run(scene, engine, out, seed=1, waves=False, progress=lambda runs: runs):
    """Run a scene; write results to ``out``; return the summary.

    They replace the results of an earlier run when all are written, so no picture of another scene stays.
    """
    check(scene, engine, waves)
    out = Path(out)
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
    """The lines to print of a summary, besides title, engine, modelled and left out."""
    return runner(scene.sensor).tell(summary)
