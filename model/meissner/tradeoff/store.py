"""Finished points on disk: one file each, written atomically once it is measured, so that an interrupted
sweep can continue. A point that another state of the package, or another NumPy or SciPy, measured is measured
again.
"""

import hashlib
import json
from functools import cache
from importlib.metadata import version
from pathlib import Path

from meissner.files import written

PACKAGE = Path(__file__).parents[1]


@cache
def revision():
    """Eight digits that change with the package's files and the versions of NumPy and SciPy."""
    found = hashlib.sha256("".join(version(name) for name in ("numpy", "scipy")).encode())
    for path in sorted([*PACKAGE.rglob("*.py"), *PACKAGE.rglob("*.toml")]):
        found.update(path.read_bytes())
    return found.hexdigest()[:8]


class Store:
    """The points in a folder."""

    def __init__(self, folder):
        self.folder = Path(folder) / "points"

    def _place(self, task):
        text = json.dumps(task.point, sort_keys=True)
        return self.folder / task.name / f"{hashlib.sha256(text.encode()).hexdigest()[:16]}.json"

    def read(self, task):
        """(figures, whether they are current); (None, False) without figures."""
        try:
            kept = json.loads(self._place(task).read_text("utf-8"))
            if kept["point"] != task.point or not {"cost", "error"} <= kept["found"].keys():
                return None, False
            return kept["found"], kept["of"] == revision()
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            return None, False  # missing or damaged: measured again

    def write(self, task, found):
        self._place(task).parent.mkdir(parents=True, exist_ok=True)
        entry = {"of": revision(), "point": task.point, "found": found}
        with written(self._place(task)) as file:
            file.write(json.dumps(entry).encode() + b"\n")
