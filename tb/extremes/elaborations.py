"""Elaborate each block of rtl/ with two or more parameters in Verilator with every pair of parameter ends.

tb/extremes/parameters.toml lists the ends; a block that it does not list uses the least and largest values in
its own tests. A parameter set must either elaborate without a warning (except for unused bits), or be refused
by a check of the RTL (``$fatal`` in gen_check_...). A pair that is refused together with some values is tried
with others; each end must be accepted at least once.
"""

import re
import subprocess
import tomllib
from collections import Counter
from itertools import combinations
from random import Random

from extremes.pairs import covering
from meissner.builds import toolchain
from nightly import benches

ENDS = toolchain.ROOT / "tb/extremes/parameters.toml"
# Elaborated by their rows in tb/extremes/*.py, with the sizes of the rows' cases.
BY_ROWS = (
    *("constant_multiplier", "multiply", "divide", "ratio", "hypot", "log2", "exp2", "haar", "shear_speed"),
    *("cop_accumulate", "cop_divide", "cop4", "cop_slip", "tare"),
)
AGAIN = 2  # retries of a refused pair: with accepted values, then with the defaults
DRAWN = 60  # random sets for an end that no set was accepted with
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
    """{parameter: its least and largest value in the block's own tests}."""
    values = {}
    for one in sets(block):
        for name, value in one.items():
            values.setdefault(name, set()).add(value)
    return {name: sorted({min(given), max(given)}) for name, given in values.items()}


def named():
    """The blocks that parameters.toml lists."""
    return tomllib.loads(ENDS.read_text("utf-8"))


def ends():
    """{block: {parameter: values}} of every block with two or more parameters without a row that does it."""
    table = named()
    for block in benches.blocks():
        known = parameters(block)
        if block in table and (unknown := set(table[block]) - set(known)):
            raise ValueError(f"{ENDS.name}: msn_{block} has no parameter {', '.join(sorted(unknown))}")
        if len(known) > 1 and block not in table and block not in BY_ROWS:
            table[block] = built(block)
    return table


def read(block, values, source=None):
    """(Verilator's message for the block with these parameters, "" if accepted; whether a check refused)."""
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
    """{"taken", "refused": numbers of sets, "apart": number of pairs never accepted, "finding": ""}."""
    axes, draw = ends_of or ends()[block], Random(seed)
    waiting, fits = covering(axes, seed=seed, tries=10), [{}]
    fits += [] if source else sets(block)  # they have the combinations that need several matching parameters
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
