"""``meissner run``: run a scene on an engine and write a folder of results."""

import json
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from meissner import pool
from meissner.scenes import results
from meissner.scenes.sensor import runner, sensor

ROOM = 0.8  # share of the free memory that a scene may need
MOST_RUNS = 100_000


def free_bytes():
    """Memory that this machine can give without swapping; None if unknown."""
    try:
        for line in Path("/proc/meminfo").read_text("ascii").splitlines():
            if line.startswith("MemAvailable:"):
                return int(line.split()[1]) * 1024
    except OSError:
        pass
    return None


def check(scene, engine, waves=False):
    """The number of tasks that fit in the memory together; ValueError with one sentence if this engine or
    this machine cannot run the scene.

    The memory is judged by the shapes of the scene's largest arrays.
    """
    results.check(scene, engine, waves)
    own = runner(scene.sensor)
    if hasattr(own, "check"):
        own.check(scene)
    needs, what = sensor(scene.sensor).memory(scene)
    free = free_bytes()
    if free is not None and needs > ROOM * free:
        raise ValueError(
            f"scene {scene.name}: {what} need about {needs / 1e9:.3g} GB, but this machine has "
            f"{free / 1e9:.1f} GB free: reduce them, or use a larger machine"
        )
    return pool.MOST if free is None else max(1, int(ROOM * free / max(needs, 1)))


def with_runs(scene, runs):
    """The scene with ``runs`` seeds of each condition; None: with its own number."""
    if runs is None:
        return scene
    if not hasattr(scene, "seeds"):
        raise ValueError(f"runs = {runs}: scene {scene.name} runs once, without seeds to repeat")
    if not 1 <= runs <= MOST_RUNS:
        raise ValueError(f"runs = {runs} must lie in 1 .. {MOST_RUNS}")
    return replace(scene, seeds=runs)


def run(scene, engine, out, seed=1, waves=False, progress=iter, jobs=1):
    """Run a scene; write results to ``out``; return the summary.

    Its conditions and seeds spread over ``jobs`` processes, whose number changes nothing in the results.
    The results replace those of an earlier run only when all are written, so no old picture remains.
    """
    spread = pool.Spread(progress, min(jobs, check(scene, engine, waves)))
    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out, prefix=".run-") as folder:
        began, folder = time.perf_counter(), Path(folder)
        recorded = folder / "waves.vcd" if waves else None
        result = runner(scene.sensor).run(scene, engine, seed, recorded, spread)
        summary = results.write(scene, result, folder, began)
        for name in _earlier(out):
            (out / name).unlink(missing_ok=True)
        for path in folder.iterdir():
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
