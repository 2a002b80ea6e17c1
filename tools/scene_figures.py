"""Run a scene on engine fixed in a process of its own, and print its summary and the files it rests on.

    python tools/scene_figures.py normal_force

The files: every module of model/meissner that the run imported and every other file that it read there.
"""

import json
import sys
import tempfile
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[1] / "model/meissner"
TIMES = ("seconds_taken", "samples_per_second", "saved")  # of this machine
opened = set()


def watch(event, arguments):
    if event == "open" and isinstance(arguments[0], str | Path):
        opened.add(Path(arguments[0]))


def main(name):
    sys.addaudithook(watch)
    from meissner import run, scenes

    with tempfile.TemporaryDirectory() as out:
        summary = run.run(scenes.load(name), "fixed", Path(out))
    files = {Path(path) for m in list(sys.modules.values()) if (path := getattr(m, "__file__", None))}
    files |= {
        path for path in opened if path.suffix not in (".py", ".pyc") and "__pycache__" not in str(path)
    }
    inside = {path.resolve() for path in files if path.resolve().is_relative_to(FOLDER) and path.is_file()}
    rests_on = sorted(str(path.relative_to(FOLDER.parents[1])) for path in inside)
    kept = {key: value for key, value in summary.items() if key not in TIMES}
    print(json.dumps({"summary": kept, "rests_on": rests_on}))


if __name__ == "__main__":
    main(sys.argv[1])
