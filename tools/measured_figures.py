"""Measure one figure of docs/results.md in its own process; print its summary and the files it rests on.

    python tools/measured_figures.py normal_force     a scene, on engine fixed
    python tools/measured_figures.py soak             an entry of TOOLS

These files are every Python module of the repository that was imported, every other file in model/ that was
read, and the RTL of the top module that ran, with all modules below it.
"""

import importlib
import json
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TIMES = ("seconds_taken", "samples_per_second", "saved")  # depend on the machine
SAVED = "model/meissner/scenes/saved.json"  # the source of ``saved``
# Figure: the module in tools/ whose function ``figures`` measures it, and the RTL top that it runs.
TOOLS = {
    "constants": ("constants", None),
    "grip": ("grip", None),
    "engines": ("bench_engines", "msn_core"),
    "jitter": ("jitter", "msn_core"),
    "mesh": ("mesh_figures", None),
    "recordings": ("recordings", "msn_core"),
    "soak": ("soak_link", "msn_link"),
}
opened = set()


def watch(event, arguments):
    if event == "open" and isinstance(arguments[0], str | Path):
        opened.add(Path(arguments[0]))


def scene(name):
    from meissner import run, scenes

    with tempfile.TemporaryDirectory() as out:
        summary = run.run(scenes.load(name), "fixed", Path(out))
    return {key: value for key, value in summary.items() if key not in TIMES}


def rests_on(top):
    """Files of the repository, as sorted names; not tools/verify/, which only tracks staleness, nor SAVED."""
    from meissner.builds import toolchain

    modules = {Path(path) for m in list(sys.modules.values()) if (path := getattr(m, "__file__", None))}
    read = {path for path in opened if path.suffix not in (".py", ".pyc") and "__pycache__" not in str(path)}
    inside = {
        path
        for path in (path.resolve() for path in modules | read)
        if path.is_relative_to(ROOT / "model") or (path in modules and path.is_relative_to(ROOT / "tools"))
    }
    inside |= set(toolchain.sources_of(top)) if top else set()
    names = {str(path.relative_to(ROOT)) for path in inside if path.is_file()}
    names = {name for name in names if not name.startswith("tools/verify/") and name != SAVED}
    return sorted(names - {str(Path(__file__).resolve().relative_to(ROOT))})


def main(name):
    sys.addaudithook(watch)
    module, top = TOOLS.get(name, (None, None))
    summary = importlib.import_module(module).figures() if module else scene(name)
    print(json.dumps({"summary": summary, "rests_on": rests_on(top)}))


if __name__ == "__main__":
    main(sys.argv[1])
