"""The package's layers and the imports between them."""

import ast
from functools import cache

from meissner.builds.toolchain import ROOT

MODEL = ROOT / "model"
# From the lowest layer up: each imports only from itself and lower layers. A name is a module or a package.
LAYERS = [
    *(
        "arrays",
        "names",
        "terminal",
        "interval",
        "tables",
        "files",
        "pool",
        "builds.cached_files",
        "builds.objcache",
        "builds.toolchain",
    ),
    *("twins", "inputs", "physics", "readers", "calibration", "second_order", "fit_rubber"),
    *("forest", "sense", "builds", "engines"),
    *("forest.forest", "forest.reduce", "forest.command", "forest.process"),
    *("rope", "report", "scenes", "run"),
    *("host", "budget", "tradeoff", "process", "threshold", "parser", "completion", "cli"),
]


@cache
def modules():
    """{name below meissner: path}."""
    found = {}
    for path in sorted(MODEL.glob("meissner/**/*.py")):
        parts = path.relative_to(MODEL / "meissner").with_suffix("").parts
        name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        if name:
            found[name] = path
    return found


def layer(module):
    """A module's index in LAYERS, by the longest name that matches it or a parent; None if none matches."""
    fits = [name for name in LAYERS if module == name or module.startswith(f"{name}.")]
    return LAYERS.index(max(fits, key=len)) if fits else None


def _for_types(node):
    return isinstance(node, ast.If) and getattr(node.test, "id", None) == "TYPE_CHECKING"


@cache
def imports(types=True):
    """{module: set of the modules that it imports}, including imports inside functions; ``types``: and those
    that only a type checker reads."""
    known, found = modules(), {}
    for module, path in known.items():
        found[module] = set()
        tree = ast.parse(path.read_text("utf-8"))
        if not types:
            tree.body = [node for node in tree.body if not _for_types(node)]
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "meissner":
                package = node.module.removeprefix("meissner").lstrip(".")
                for alias in node.names:
                    whole = f"{package}.{alias.name}".lstrip(".")
                    other = whole if whole in known else package
                    if other and other != module:
                        found[module].add(other)
    return found
