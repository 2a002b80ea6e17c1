"""Finished points on disk: one file each, written atomically once it is measured, so that an interrupted
sweep can continue.

A file carries the digest of everything its figures rest on: the axis's module with its imports from this
package, the scenes, and the versions of NumPy and SciPy. Comments of Python do not count. A point with
another digest is measured again.
"""

import ast
import hashlib
import json
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from meissner.files import written

PACKAGE = Path(__file__).parents[1]


def _path(module):
    spec = find_spec(module)
    return Path(spec.origin) if spec and spec.origin else None


@cache
def _names(path):
    """Names that a file imports from this package, as possible modules; also imports inside functions."""
    found = []
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            found += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
        elif isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
    return [name for name in found if name.split(".")[0] == "meissner"]


@cache
def _file(name):
    """The file of a module of this package; None if the name is not a module but defined in one."""
    path = PACKAGE.joinpath(*name.split(".")[1:])
    files = (path / "__init__.py", path.with_suffix(".py"))
    return next((file for file in files if file.is_file()), None)


@cache
def rests_on(module):
    """The files that an axis's module depends on, including itself, sorted."""
    first = _path(module)
    found, waiting = set(), [first]
    while waiting:
        path = waiting.pop()
        if path in found or path is None:
            continue
        found.add(path)
        waiting += [_file(name) for name in _names(path)]
        if path == PACKAGE / "scenes/sensor.py":  # it imports sensors by name
            waiting += (PACKAGE / "scenes").rglob("*.py")
    if PACKAGE / "scenes/sensor.py" in found:
        found |= {*(PACKAGE / "scenes").rglob("*.toml")}
    return sorted(found)


@cache
def _unread(path):
    """The content of a file; of a Python file without comments and docstrings."""
    text = path.read_text("utf-8")
    if path.suffix != ".py":
        return text.encode()
    tree = ast.parse(text)
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list) and body and isinstance(body[0], ast.Expr):
            said = body[0].value
            if isinstance(said, ast.Constant) and isinstance(said.value, str):
                said.value = ""
    return ast.dump(tree).encode()


@cache
def revision(module):
    """Eight digits that change with everything that the figures of the axes in ``module`` rest on."""
    parts = [_unread(path) for path in rests_on(module)]
    parts += [f"{name}=={version(name)}".encode() for name in ("numpy", "scipy")]
    return hashlib.sha256(b"\n".join(parts)).hexdigest()[:8]


class Store:
    """The points in a folder."""

    def __init__(self, folder):
        self.folder = Path(folder) / "points"

    def _place(self, task):
        text = json.dumps(task.point, sort_keys=True)
        return self.folder / task.name / f"{hashlib.sha256(text.encode()).hexdigest()[:16]}.json"

    def begin(self, names):
        """Make the folders of these axes; remove the temporary files of interrupted writes."""
        for name in names:
            (self.folder / name).mkdir(parents=True, exist_ok=True)
            for left in (self.folder / name).glob(".*.json.*"):
                with suppress(OSError):
                    left.unlink()

    def read(self, task):
        """(figures, whether they are current); (None, False) without figures."""
        try:
            kept = json.loads(self._place(task).read_text("utf-8"))
            if kept["point"] != task.point or not {"cost", "error"} <= kept["found"].keys():
                return None, False
            return kept["found"], kept["of"] == revision(task.where)
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            return None, False  # missing or damaged: measured again

    def write(self, task, found):
        entry = {"of": revision(task.where), "point": task.point, "found": found}
        with written(self._place(task)) as file:
            file.write(json.dumps(entry).encode() + b"\n")
