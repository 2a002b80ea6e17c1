"""Blocks and solvers at and beyond the ends of their ranges, against exact arithmetic.

    @row("divide", {"": "1/2 LSB"})
    def divide(see):
        see.near(got, exact, where)

``see`` compares the results of a twin or solver with exact numbers (int, Fraction, mpmath's mpf), keeps the
worst error and its place, and raises Outside if an error exceeds its bound or a result is NaN or infinite.
Exact numbers come from tb/reference/exact.py and the files next to it, which import nothing from the twins.

`make extremes` runs the long form of all rows and prints their table.
"""

import argparse
import importlib
import math
import random
import re
import sys
import warnings
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from pathlib import Path

import mpmath
import numpy as np

from extremes.pairs import covering
from meissner.builds import toolchain

WIDEST = 110  # characters shown of a place


class Outside(AssertionError):
    """An error beyond its bound, a result that is not a number, or a case that should have been refused."""


@dataclass(frozen=True)
class Row:
    """``bounds``: {quantity: bound}."""

    name: str
    bounds: dict
    body: object

    def limit(self, part):
        """The number at the beginning of a bound; None if each case has its own bound."""
        found = re.match(r"\d+(/\d+)?(\.\d+)?(e-?\d+)?(?=\s|$)", self.bounds[part])
        return Fraction(found[0]) if found else None


ROWS = {}


def row(name, bounds):
    """Declare the row of a block or a solver."""

    def declare(body):
        ROWS[name] = Row(name, bounds, body)
        return body

    return declare


@cache
def rows():
    """{name: Row} from all files: blocks in the order of rtl/rtl.f, then the solvers."""
    for path in sorted(Path(__file__).parent.glob("*.py")):
        if "\n@row(" in path.read_text("utf-8"):
            importlib.import_module(f"extremes.{path.stem}")
    blocks = [path.stem.removeprefix("msn_") for path in toolchain.sources()]
    order = sorted(ROWS, key=lambda name: (blocks.index(name) if name in blocks else len(blocks), name))
    return {name: ROWS[name] for name in order}


def exactly(number):
    """Any number as a Fraction, without rounding; Outside for NaN and infinity."""
    if isinstance(number, mpmath.mpf):
        if not mpmath.isfinite(number):
            raise Outside(f"{number} is no number")
        sign, man, exp, _ = number._mpf_
        return (-1) ** sign * Fraction(int(man)) * Fraction(2) ** exp
    if isinstance(number, float | np.floating):
        if not math.isfinite(number):
            raise Outside(f"{number} is no number")
        return Fraction(float(number))
    return number if isinstance(number, Fraction) else Fraction(int(number))


@dataclass
class Worst:
    error: Fraction = Fraction(0)
    limit: Fraction = Fraction(0)
    share: Fraction = Fraction(-1)  # error / bound
    where: str = ""


@dataclass
class See:
    """Collects the results of a row's body."""

    row: Row
    long: bool = False
    seed: int = 1
    cases: int = 0
    worst: dict = field(default_factory=dict)

    def __post_init__(self):
        self.random = random.Random(self.seed)

    def near(self, got, exact, where, part="", limit=None):
        """``got`` must lie within the bound (or ``limit``) of the ``exact`` number."""
        self.cases += 1
        limit = self.row.limit(part) if limit is None else exactly(limit)
        try:
            error = abs(exactly(got) - exactly(exact))
        except (Outside, ValueError, OverflowError, TypeError) as problem:
            raise Outside(f"{part or self.row.name}: {problem}, at {_place(where)}") from None
        share = error / limit if limit else Fraction(2 if error else 0)
        worst = self.worst.setdefault(part, Worst())
        if share > worst.share:
            self.worst[part] = Worst(error, limit, share, _place(where))
        if error > limit:
            raise Outside(
                f"{part or self.row.name}: {_plain(got)} is {float(error):.6g} off {_plain(exact)}, "
                f"bound {float(limit):.6g}, at {_place(where)}"
            )

    def between(self, got, exact, below, above, where, part=""):
        """Like ``near``, with a different bound for results below and above the exact number."""
        try:
            low = exactly(got) < exactly(exact)
        except (Outside, ValueError, OverflowError, TypeError):
            low = False  # near reports the error
        self.near(got, exact, where, part, below if low else above)

    def same(self, got, wanted, where, part=""):
        """Numbers, words or lists must be equal."""
        self.cases += 1
        self.worst.setdefault(part, Worst(where=_place(where)))
        if got != wanted:
            self.worst[part] = Worst(Fraction(1), Fraction(0), Fraction(2), _place(where))
            raise Outside(f"{part or self.row.name}: {got!r} is not {wanted!r}, at {_place(where)}"[:600])

    def refused(self, call, *given, **named):
        """The call must raise ValueError, since its arguments are out of range."""
        self.cases += 1
        try:
            call(*given, **named)
        except ValueError:
            return
        raise Outside(f"{getattr(call, '__name__', call)}({given}, {named}) was not refused")

    def some(self, cases, step):
        """All cases; in the short form every ``step``-th."""
        return cases if self.long else list(cases)[::step]

    def covering(self, allowed=lambda **row: True, **axes):
        """Combinations of parameters that contain each pair of values."""
        found = covering(axes, allowed, self.seed)
        if not found:
            raise Outside("no combination of the parameters is allowed")
        return found


def _plain(number):
    if isinstance(number, Fraction):
        return str(number) if number.denominator == 1 else f"{float(number):.9g}"
    return str(number)


def _place(where):
    words = where() if callable(where) else where
    words = words if isinstance(words, str) else repr(words)
    return words if len(words) <= WIDEST else words[: WIDEST - 3] + "..."


def run(name, long=False, seed=1):
    """The See of a row that has run; AssertionError if it compared nothing. Warnings are errors, too."""
    see = See(rows()[name], long, seed)
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        see.row.body(see)
    assert see.cases and set(see.worst) == set(see.row.bounds), f"{name}: {see.cases} cases"
    return see


def lines(name):
    """The lines of a row in the table, in its long form."""
    try:
        see = run(name, long=True)
    except Exception as problem:
        return [f"| `{name}` | **{type(problem).__name__}: {problem}** | | |"]
    found = []
    for part, bound in see.row.bounds.items():
        worst = see.worst[part]
        own = see.row.limit(part) == worst.limit
        there = "" if own else f" ({float(worst.limit):.3g} there)"
        cells = [f"`{name}` {part}".strip(), f"{float(worst.error):.3g}", worst.where, f"{bound}{there}"]
        found.append(" | ".join(" ".join(cell.split()).replace("|", "\\|") for cell in cells))
    return [f"| {text} |" for text in found]


def table(names=(), jobs=2):
    """The worst error of each row, where it is, and its bound, in Markdown."""
    with ProcessPoolExecutor(jobs) as pool:
        found = [line for some in pool.map(lines, names or rows()) for line in some]
    return "\n".join(["| block or solver | worst error | where | bound |", "|---" * 4 + "|", *found])


def main():
    parser = argparse.ArgumentParser(description=table.__doc__)
    parser.add_argument("rows", nargs="*", metavar="ROW", help=", ".join(rows()))
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()
    if unknown := [name for name in given.rows if name not in rows()]:
        parser.exit(2, f"extremes: there is no row {unknown[0]}\n")
    print(found := table(given.rows, given.jobs))
    sys.exit("**" in found)
