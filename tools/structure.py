"""The package's layers and the imports between them: docs/structure.png.

python tools/structure.py             print the number of imports between layers
python tools/structure.py --page      also draw the picture
"""

import argparse
import ast
from collections import Counter
from functools import cache

from meissner.builds.toolchain import ROOT

MODEL = ROOT / "model"
# From the lowest layer up: each imports only from itself and lower layers. A name is a module or a package.
LAYERS = [
    *("names", "plain", "interval", "tables", "files", "builds.kept", "builds.objcache", "builds.toolchain"),
    *("twins", "inputs", "physics", "calibration", "second_order", "fit_rubber"),
    *("sense", "builds", "engines", "report", "scenes", "run"),
    *("host", "budget", "tradeoff", "process", "parser", "cli"),
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


@cache
def imports():
    """{module: set of the modules that it imports}, including imports inside functions."""
    known, found = modules(), {}
    for module, path in known.items():
        found[module] = set()
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "meissner":
                package = node.module.removeprefix("meissner").lstrip(".")
                for alias in node.names:
                    whole = f"{package}.{alias.name}".lstrip(".")
                    other = whole if whole in known else package
                    if other and other != module:
                        found[module].add(other)
    return found


def between():
    """Counter of imports between layers, by the names (from, to)."""
    return Counter(
        (LAYERS[layer(module)], LAYERS[layer(other)])
        for module, others in imports().items()
        for other in others
        if layer(module) != layer(other)
    )


def draw(path):
    """Draw the layers from the lowest up, and a line for each pair, as wide as the number of imports."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 8), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    sizes = Counter(LAYERS[layer(module)] for module in modules())
    for place, name in enumerate(LAYERS):
        axes.text(0, place, f"{name}", ha="right", va="center", fontsize=10, family="monospace")
        axes.text(0.15, place, str(sizes[name]), ha="left", va="center", fontsize=8, color="0.4")
    for (source, target), count in between().items():
        a, b = LAYERS.index(source), LAYERS.index(target)
        bend = 0.5 + 0.28 * abs(a - b)
        axes.annotate(
            "",
            (0.75, b),
            (0.75, a),
            arrowprops={
                "arrowstyle": "-|>",
                "connectionstyle": f"arc3,rad={-0.9 if a > b else 0.9}",
                "linewidth": min(4, 0.4 + count / 8),
                "color": "tab:blue" if a > b else "tab:red",
                "alpha": 0.55,
            },
        )
        axes.plot(0.75 + bend / 2, (a + b) / 2, alpha=0)
    axes.set(xlim=(-4, 6.5), ylim=(-0.7, len(LAYERS) - 0.3))
    axes.set_title("model/meissner: layers, their modules, who imports whom", fontsize=10)
    axes.axis("off")
    figure.savefig(path, dpi=120)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--page", action="store_true", help="draw docs/structure.png")
    if parser.parse_args().page:
        draw(ROOT / "docs/structure.png")
    for (source, target), count in sorted(between().items(), key=lambda item: -item[1]):
        print(f"{source:>18} -> {target:<18} {count}")


if __name__ == "__main__":
    main()
