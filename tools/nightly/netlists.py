"""Netlists: each block's netlist (ECP5, iCE40) is proven equal to its source, and a clock of reset to clear
its earlier state; no simulation.

A block is built with the first parameter set of its own tests, or the first of the size that the tests state
(evidence.py). tb/limits.toml names the proofs that are open; these are not tried.
"""

import multiprocessing
import resource
import signal
from dataclasses import replace
from itertools import product

from meissner.builds.yowasp import ToolError
from nightly import benches, circuit, evidence, netlist_proof, reset_proof
from nightly.reset_proof import Task

OUT = "build/netlists"  # relative to ROOT: YoWASP sees only files below its working directory
NAMES = {"ecp5": "ECP5", "ice40": "iCE40", "reset": "reset"}
LIMIT_S = 200  # CPU time of the netlists of a block, and of its reset; proofs that hold take half at most


def blocks():
    return benches.blocks()


def asked(block, key):
    """What the block's tests state about these proofs under ``key`` (evidence.KEYS), or None."""
    return evidence.of(block, "equivalence").get(key)


def task_of(block):
    """The assumptions of the block's reset proof; docs/verification.md gives the reasons."""
    return Task(**(asked(block, "reset") or {}))


def parameters(block, *keys):
    """The first parameter set in the block's tests with the size that the last stated one of ``keys`` has."""
    size = next((size for key in reversed(keys) if (size := asked(block, key))), {})
    for run in benches.runs(block):
        if run["block"] == block and evidence.fits(size, run["parameters"]):
            return run["parameters"]
    raise ValueError(f"the tests of {block} build nothing with {size or 'any parameters'}")


def prove_netlists(block, chosen):
    """{family: result} of ``block`` with ``chosen`` parameters."""
    folder, result = f"{OUT}/{block}", {}
    # Not a fallback where slang's proof fails: Yosys would misread the source alike on both sides.
    slang = not asked(block, "yosys")
    for defined in (True,) if asked(block, "defined") else (False, True):
        again = [family for family in circuit.FAMILIES if not result.get(family, {}).get("proven")]
        try:
            bits = again and circuit.synthesise(
                block, chosen, folder, again, defined, cut=bool(asked(block, "boxes")), slang=slang
            )
        except ValueError as error:  # a memory that must be block RAM
            result |= {family: {"proven": False, "error": str(error)} for family in again}
            continue
        for family, from_reset in product(again, (False, True)):
            if not result.get(family, {}).get("proven"):
                of = bits["source"], bits[family], folder, family, from_reset
                result[family] = said(lambda of=of: netlist_proof.prove(*of))
                result[family] |= {"around": around} if (around := circuit.boxes(bits["source"])) else {}
    return result


def prove_reset(block, chosen):
    """{"reset": result} of ``block`` with ``chosen`` parameters."""
    task, folder = task_of(block), f"{OUT}/{block}/reset"
    source = circuit.synthesise(block, chosen, folder, ())["source"]
    if task.framed:
        around = circuit.framed(block, source, int(chosen["Channels"]))
        source = circuit.synthesise(block, chosen, folder, (), around=around)["source"]
    result = said(lambda: reset_proof.prove(source, task))
    if not result["proven"] and not task.alike:
        result = said(lambda: reset_proof.prove(source, replace(task, alike=True)))
    return {"reset": result}


def said(proof):
    """The result of a proof: the outputs that it leaves open, or the error."""
    try:
        found = proof()
        return {"proven": not found} | ({"open": found} if found else {})
    except (ToolError, ValueError) as error:
        return {"proven": False, "error": str(error)}


def _alone(pipe, limit_s, prove, *asked):
    resource.setrlimit(resource.RLIMIT_CPU, (limit_s, limit_s + 5))  # for each tool it starts, too
    try:
        pipe.send(prove(*asked))
    except (ToolError, ValueError) as error:
        pipe.send({"error": str(error)})


def limited(limit_s, kinds, prove, *asked):
    """The result of ``prove`` for ``kinds``, in its own process within the CPU time limit."""
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    worker = context.Process(target=_alone, args=(there, limit_s, prove, *asked))
    worker.start()
    there.close()
    try:
        result = here.recv()
    except EOFError:
        worker.join()
        late = worker.exitcode == -signal.SIGXCPU
        result = {"error": f"not done within {limit_s} s of a processor" if late else "ended without a word"}
    worker.join()
    error = result.pop("error", "")
    return {kind: {"proven": False, "error": error} for kind in kinds} | result


def run(block, limits, jobs=1):
    """The facts of a block: {"ecp5", "ice40", "reset": result}."""
    excused = limits.open(block)
    found = {}
    if families := [family for family in circuit.FAMILIES if family not in excused]:
        chosen = parameters(block, "size")
        found |= limited(LIMIT_S, families, prove_netlists, block, chosen)
    if "reset" not in excused:
        chosen = parameters(block, "size", "reset_size")
        found |= limited(LIMIT_S, ["reset"], prove_reset, block, chosen)
    proven = [NAMES[kind] for kind, result in found.items() if result["proven"]]
    broken = [f"{NAMES[kind]} {word(result)}" for kind, result in found.items() if not result["proven"]]
    words = [f"{', '.join(proven)} proven" if proven else "", f"{' '.join(excused)} open" if excused else ""]
    return {"text": "; ".join(filter(None, words)), "broken": broken, "proofs": found}


def word(result):
    """Why a proof did not succeed, in a few words."""
    names = result.get("open", [])
    more = f" and {len(names) - 3} more" if len(names) > 3 else ""
    return f"open: {', '.join(names[:3])}{more}" if names else f"open: {result['error']}"
