"""Each block of rtl/ with two or more parameters, read by Verilator at the ends of all of them, pair by pair.

tb/extremes/parameters.toml has the ends; a block that it does not name is read at the least and the largest
values that its own tests build. A set of parameters either reads without a warning (but of bits
that are not used), or a check of the RTL refuses it with its sentence (``$fatal`` in gen_check_...). A pair
that is refused beside some values is tried beside others; each end has to be taken at least once.
"""

import re
import subprocess
import tomllib
from collections import Counter
from itertools import combinations
from random import Random

from meissner.builds import toolchain
from verify import benches
from verify.pairs import covering

ENDS = toolchain.ROOT / "tb/extremes/parameters.toml"
# Read by their rows of tb/extremes/*.py, with the sizes that their cases have.
BY_ROWS = (
    *("constant_multiplier", "multiply", "divide", "ratio", "hypot", "log2", "exp2", "haar", "shear_speed"),
    *("cop_accumulate", "cop_divide", "cop4", "cop_slip", "tare"),
)
AGAIN = 2  # times that a refused pair is tried again: beside values that were taken, beside the defaults
DRAWN = 60  # sets that are drawn for an end that none has taken
REFUSAL = re.compile(r"%Warning-USERFATAL: [^\n]*\bmsn_\w+: ")


def parameters(block):
    """Names of the parameters of msn_<block>."""
    path = next(path for path in toolchain.sources() if path.stem == f"msn_{block}")
    text = re.sub(r"//.*", "", path.read_text("utf-8"))
    head = re.search(rf"module msn_{block}\b(.*?)\)\s*\(\s*(?:input|output)", text, re.DOTALL)
    return re.findall(r"\bparameter\b[^=;]*?(\w+)\s*=", head[1]) if head and "#(" in head[1] else []


def sets(block):
    """The sets of parameters that the block's own tests build, without words such as Resets."""
    own = [run["parameters"] for run in benches.runs(block) if run["block"] == block]
    return [{name: int(value) for name, value in one.items() if "'" not in str(value)} for one in own]


def built(block):
    """{parameter: its least and largest value in what the block's own tests build}."""
    values = {}
    for one in sets(block):
        for name, value in one.items():
            values.setdefault(name, set()).add(value)
    return {name: sorted({min(given), max(given)}) for name, given in values.items()}


def ends():
    """{block: {parameter: values}} of every block with two parameters that no row of the extremes reads."""
    table = tomllib.loads(ENDS.read_text("utf-8"))
    for block in benches.blocks():
        known = parameters(block)
        if block in table and (unknown := set(table[block]) - set(known)):
            raise ValueError(f"{ENDS.name}: msn_{block} has no parameter {', '.join(sorted(unknown))}")
        if len(known) > 1 and block not in table and block not in BY_ROWS:
            table[block] = built(block)
    return table


def read(block, values, source=None):
    """What Verilator says of the block with those parameters, "" if it takes them; does a check refuse?"""
    files = [*map(str, toolchain.sources_of(f"msn_{block}"))] if source is None else [str(source)]
    command = ["verilator", "--lint-only", "--quiet", "-Wall", "-Wno-UNUSED"]
    command += [str(toolchain.ROOT / "rtl/verilator.vlt"), *files, "--top-module", f"msn_{block}"]
    command += [f"-G{name}={value}" for name, value in values.items()]
    done = subprocess.run(command, env=toolchain.environment(), capture_output=True, text=True)
    said = (done.stdout + done.stderr).strip()
    return said, bool(done.returncode and REFUSAL.search(said))


def _pairs(values):
    return set(combinations(sorted(values.items()), 2))


def elaborate(block, seed=1, source=None, ends_of=None):
    """{"taken", "refused": sets of parameters, "apart": pairs that were never taken, "finding": ""}."""
    axes, draw = ends_of or ends()[block], Random(seed)
    waiting, fits = covering(axes, seed=seed, tries=10), [{}]
    fits += [] if source else sets(block)  # what goes together only by several parameters, is in some of them
    given = len(fits)
    taken, tried, again, refused = set(), set(), Counter(), 0
    while waiting:
        values = waiting.pop()
        said, refuses = read(block, values, source)
        if said and not refuses:
            problem = f"{values}: {said[:300]}"
            return {"taken": len(fits) - given, "refused": refused, "apart": 0, "finding": problem}
        if said:
            refused += 1
            tried |= _pairs(values)
        else:
            fits.append(values)
            taken |= _pairs(values)
        lacking = [pair for pair in sorted(tried) if pair not in taken and again[pair] < AGAIN]
        if not waiting and lacking:
            pair = min(lacking, key=lambda one: again[one])
            waiting.append(({} if again[pair] else draw.choice(fits)) | dict(pair))
            again[pair] += 1
        elif not waiting:
            seen = {one for pair in taken for one in pair}
            alone = [(name, value) for name in axes for value in axes[name] if (name, value) not in seen]
            if alone := [one for one in alone if again[one] < DRAWN]:
                drawn = {name: draw.choice(axes[name]) for name in axes}
                again[alone[0]] += 1
                waiting.append((draw.choice(fits) if again[alone[0]] % 2 else drawn) | dict(alone[:1]))
    alone = {one for pair in taken for one in pair}
    never = [f"{name} = {value}" for name in axes for value in axes[name] if (name, value) not in alone]
    finding = f"never taken: {', '.join(never)}" if never else ""
    apart = len({pair for pair in tried if pair not in taken})
    return {"taken": len(fits) - given, "refused": refused, "apart": apart, "finding": finding}
