"""Tests of each block and solver at and beyond the ends of its range, against exact arithmetic.

A row is a function in tb/extremes/<stage>.py:

    @row("divide", {"": "1/2 LSB"}, ends="refused beyond 1")
    def divide(see):
        see.near(got, exact, where)

``see`` compares the results of a twin or solver with exact numbers (int, Fraction, mpmath's mpf), keeps the
worst error and its place, and raises Outside if an error exceeds its bound or a result is NaN or infinite.
Exact numbers come from tb/reference/exact.py and the files next to it, which import nothing from the twins.
Rows are separate files, not entries of EVIDENCE: they are code, and five other kinds of evidence rest on a
block's tests, so a new case there would make that evidence stale.
"""

import importlib.util
import math
import random
import re
import subprocess
import sys
import time
import traceback
import warnings
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache

import mpmath
import numpy as np

from meissner.builds import toolchain
from nightly import benches, evidence
from verify import revision
from verify.pairs import covering

FOLDER = toolchain.ROOT / "tb/extremes"
TOPS = {  # blocks without a stated reference, since they only join others
    "core": "joins registers, a sensor, slip_chain, grip and core_link",
    "axis": "joins core and axil",
    "shear_speeds": "joins frame_filter and shear_speed; its counters turn over by contract (docs/link.md)",
    "actuate": "joins finger_health, grip and pwm; its counters turn over by contract (docs/link.md)",
}
EXAMPLES = {False: 40, True: 2000}  # hypothesis examples, short and long form
WIDEST = 110  # characters shown of a place


class Outside(AssertionError):
    """An error beyond its bound, a result that is not a number, or a case that should have been refused."""


@dataclass(frozen=True)
class Row:
    """``bounds``: {quantity: bound}, ``ends``: behaviour beyond the range, ``rtl``: tests that drive the RTL
    there, ``files``: a solver's files (a block has its sources)."""

    name: str
    bounds: dict
    body: object
    ends: str = ""
    rtl: tuple = ()
    files: tuple = ()
    source: str = ""

    def limit(self, part):
        """The number at the beginning of a bound; None if each case has its own bound."""
        found = re.match(r"\d+(/\d+)?(\.\d+)?(e-?\d+)?(?=\s|$)", self.bounds[part])
        return Fraction(found[0]) if found else None

    @property
    def error(self):
        """The error line for the block's header."""
        words = []
        for part, bound in self.bounds.items():
            bound = "none" if self.limit(part) == 0 else f"at most {bound}"
            words.append(f"{bound} of {part}" if part else bound)
        return f"Error: {'; '.join(words)} (docs/extremes.md)."


ROWS = {}


def row(name, bounds, ends="", rtl=(), files=()):
    """Declare the row of a block, or of a solver if ``files`` are given."""

    def declare(body):
        if name in ROWS:
            raise ValueError(f"two rows are called {name}")
        source = f"tb/extremes/{body.__globals__['__name__'].removeprefix('extremes_')}.py"
        ROWS[name] = Row(name, bounds, body, ends, tuple(rtl), tuple(files), source)
        return body

    return declare


@cache
def rows():
    """{name: Row} from all files: blocks in the order of rtl/rtl.f, then the solvers."""
    ROWS.clear()
    for path in sorted(FOLDER.glob("*.py")):
        if path.stem.startswith(("test_", "_")):
            continue
        spec = importlib.util.spec_from_file_location(f"extremes_{path.stem}", path)
        module = importlib.util.module_from_spec(spec)
        sys.modules[spec.name] = module
        spec.loader.exec_module(module)
    blocks = benches.blocks()
    order = sorted(ROWS, key=lambda name: (blocks.index(name) if name in blocks else len(blocks), name))
    return {name: ROWS[name] for name in order}


def without():
    """{block: why it has no row}: it moves data or joins blocks; ValueError if it computes and has no row."""
    found = {}
    for block in benches.blocks():
        if block in rows():
            continue
        stated = evidence.of(block, "reference")
        why = TOPS.get(block) or next((f"{k} {stated[k]}" for k in ("moves", "joins") if k in stated), None)
        if why is None:
            raise ValueError(f"msn_{block} computes, and no file of tb/extremes has a row for it")
        found[block] = why
    return found


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
    pairs: int = 0
    worst: dict = field(default_factory=dict)

    def __post_init__(self):
        self.random = random.Random(self.seed)
        self.numpy = np.random.default_rng(self.seed)

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

    def all_near(self, gots, exacts, wheres, part="", limit=None):
        gots, exacts = list(gots), list(exacts)
        if not len(gots) == len(exacts) == len(wheres) or not gots:
            raise Outside(f"{len(gots)} results for {len(exacts)} exact numbers, of {len(wheres)} cases")
        for got, exact, where in zip(gots, exacts, wheres):
            self.near(got, exact, where, part, limit)

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

    def given(self, check, **strategies):
        """Run ``check`` with arguments drawn by hypothesis; the smallest failing ones are reported."""
        from hypothesis import HealthCheck, Phase, Verbosity, given, seed, settings

        phases = (Phase.explicit, Phase.generate, Phase.target, Phase.shrink)
        drawn = settings(
            max_examples=EXAMPLES[self.long],
            database=None,
            deadline=None,
            phases=phases,
            verbosity=Verbosity.quiet,
            suppress_health_check=list(HealthCheck),
        )
        seed(self.seed)(drawn(given(**strategies)(check)))()

    def elaborates(self, block, sizes):
        """In the long form, Verilator reads the RTL in each of ``sizes`` {parameter: value} without a
        warning, except for unused bits: no width is wrong, and no size is refused that the twin accepts."""
        if not self.long or not toolchain.sources_of(f"msn_{block}"):
            return
        base = ["verilator", "--lint-only", "--quiet", "-Wall", "-Wno-UNUSED"]
        base += [str(toolchain.ROOT / "rtl/verilator.vlt")]
        base += [*map(str, toolchain.sources_of(f"msn_{block}")), "--top-module", f"msn_{block}"]
        for size in sizes:
            command = [*base, *(f"-G{name}={int(value)}" for name, value in size.items())]
            done = subprocess.run(command, env=toolchain.environment(), capture_output=True, text=True)
            self.cases += 1
            if done.returncode or done.stderr.strip():
                raise Outside(f"msn_{block} with {size}: {(done.stdout + done.stderr).strip()[:300]}")

    def some(self, cases, step):
        """All cases; in the short form every ``step``-th."""
        return cases if self.long else list(cases)[::step]

    def covering(self, allowed=lambda **row: True, **axes):
        """Combinations of parameters that contain each pair of values (verify.pairs)."""
        found = covering(axes, allowed, self.seed)
        if not found:
            raise Outside("no combination of the parameters is allowed")
        self.pairs += len(found)
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
    """The facts of a row: worst errors, cases, finding (empty if it passes). Warnings are findings, too."""
    see, began, finding = See(rows()[name], long, seed), time.process_time(), ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            see.row.body(see)
        if not see.cases or set(see.worst) != set(see.row.bounds):
            finding = f"{see.cases} cases, and no number for {sorted(set(see.row.bounds) - set(see.worst))}"
    except Exception as problem:
        line = traceback.extract_tb(problem.__traceback__)[-1]
        known = isinstance(problem, Outside)
        finding = (
            str(problem) if known else f"{type(problem).__name__}: {problem}, {line.filename}:{line.lineno}"
        )
    worst = {
        part: {"error": float(w.error), "bound": float(w.limit), "where": w.where}
        for part, w in see.worst.items()
    }
    facts = {"worst": worst, "cases": see.cases, "pairs": see.pairs, "finding": finding}
    return facts | {"seconds": round(time.process_time() - began, 2)}


@cache
def digest(name):
    """Eight digits that change with what a row rests on: sources, twin, the row's file, references."""
    found = rows()[name]
    files = {found.source, "tools/verify/extremes.py", "tools/verify/pairs.py", *found.files}
    files |= {
        str(path.relative_to(toolchain.ROOT)) for path in revision.imports(toolchain.ROOT / found.source)
    }
    if name in benches.blocks():
        files |= {str(p.relative_to(toolchain.ROOT)) for p in toolchain.sources_of(f"msn_{name}")}
        stage = benches.stage_of(name)
        files |= {f"model/meissner/twins/{stage}/{name}.py"}
    return revision.of_files(sorted(files), "extremes")
