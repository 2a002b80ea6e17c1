"""Prove each block's netlist equal to its sources, and that a reset clears its earlier state; no simulation.

    python tools/equivalence.py                     every block of rtl/rtl.f: ecp5, ice40, reset
    python tools/equivalence.py divide -k reset     one block, one kind of proof
    python tools/equivalence.py --record            the results into docs/trust/equivalence.json

A block is built with the first parameter set of its own tests, or the first of the size that the tests state
(verify/evidence.py). Exit code 1 if a proof is open that the tests do not state as open, or if nothing ran.
docs/equivalence.md has more.
"""

import argparse
import contextlib
import multiprocessing
import operator
import resource
import signal
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import product
from threading import Lock

from meissner.builds.yowasp import ToolError, warm_up
from verify import benches, circuit, evidence, netlist_proof, record, reset_proof, sums
from verify.reset_proof import Task

OUT = "build/equivalence"  # relative to ROOT: YoWASP sees only files below its working directory
NAMES = {"ecp5": "ECP5", "ice40": "iCE40", "reset": "reset"}
KINDS = tuple(NAMES)
LIMIT_S = 60  # proofs that succeed take less than half of it


def asked(block, key):
    """What the block's tests state about these proofs under ``key`` (verify.evidence.KEYS), or None."""
    return evidence.of(block, "equivalence").get(key)


def task_of(block):
    """The assumptions of the block's reset proof; docs/equivalence.md gives the reasons."""
    return Task(**(asked(block, "reset") or {}))


def parameters(blocks, *keys):
    """{block: parameter set for its proofs}: the first one in its tests that has the stated size. The last of
    ``keys`` that the tests state gives the size."""
    found, sizes = {}, {}
    for block in blocks:
        stated = [asked(block, key) for key in keys]
        sizes[block] = next((size for size in reversed(stated) if size), {})
    for run in benches.runs(*blocks):
        if evidence.fits(sizes.get(run["block"], {}), run["parameters"]):
            found.setdefault(run["block"], run["parameters"])
    if missing := [block for block in blocks if block not in found]:
        wanted = spelt(sizes[missing[0]]) or "any parameters"
        raise ValueError(f"the tests of {missing[0]} build nothing with {wanted}")
    return found


def prove_netlists(block, chosen, families):
    """{family: result} of ``block`` with ``chosen`` parameters, as in docs/trust/equivalence.json."""
    folder = f"{OUT}/{block}"
    result = {"parameters": spelt(chosen)}
    slang = not asked(
        block, "yosys"
    )  # not a fallback where slang's proof fails: Yosys would misread the source alike on both sides
    for defined in (True,) if asked(block, "defined") else (False, True):
        again = [family for family in families if not result.get(family, {}).get("proven")]
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
                result[family] |= {"defined": defined, "from_reset": from_reset, "slang": slang}
                result[family] |= {"around": around} if (around := circuit.boxes(bits["source"])) else {}
    yield result


def source_of(block, chosen, folder, task):
    """The circuit of a block's source, wrapped to receive frames if ``task`` says so."""
    source = circuit.synthesise(block, chosen, folder, ())["source"]
    if not task.framed:
        return source
    around = circuit.framed(block, source, int(chosen["Channels"]))
    return circuit.synthesise(block, chosen, folder, (), around=around)["source"]


def prove_reset(block, chosen):
    """{"reset": result} of ``block`` with ``chosen`` parameters, as in docs/trust/equivalence.json."""
    task, folder = task_of(block), f"{OUT}/{block}/reset"
    source = source_of(block, chosen, folder, task)
    result = said(lambda: reset_proof.prove(source, task))
    if not result["proven"] and not task.alike:
        alike = said(lambda: reset_proof.prove(source, replace(task, alike=True)))
        if alike["proven"]:
            result, task = alike, replace(task, alike=True)
    yield {"reset": result | {"parameters": spelt(chosen), "alike": task.alike}}


def prove_clocks(block, chosen):
    """Yield {"reset": clocks after a reset without a difference} as they grow; memories start equal."""
    task = replace(task_of(block), alike=True)
    source = source_of(block, chosen, f"{OUT}/{block}/clocks", task)
    for differ, clocks in reset_proof.bounded(source, task):
        yield {"reset": {"clocks": clocks} | ({"then": sorted(differ)} if differ else {})}


def spelt(parameters):
    return " ".join(f"{name}={value}" for name, value in parameters.items())


def said(proof):
    """The result of a proof: the outputs that it leaves open, or the error, and its CPU seconds."""
    before = cpu_seconds()
    try:
        open_ones = proof()
        trouble = {"open": open_ones} if open_ones else {}
    except (ToolError, ValueError) as error:
        trouble = {"error": str(error)}
    return {"proven": not trouble, **trouble, "cpu_s": round(cpu_seconds() - before, 1)}


def cpu_seconds():
    usages = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def _alone(pipe, limit_s, prove, *asked):
    resource.setrlimit(resource.RLIMIT_CPU, (limit_s, limit_s + 5))  # for each tool it starts, too
    try:
        for told in prove(*asked):
            pipe.send(told)
    except (ToolError, ValueError) as error:
        pipe.send({"error": str(error)})


def limited(limit_s, kinds, prove, *asked):
    """The last result that ``prove`` yields for ``kinds`` in its own process within the CPU time limit."""
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    worker = context.Process(target=_alone, args=(there, limit_s, prove, *asked))
    worker.start()
    there.close()
    result = {}
    with contextlib.suppress(EOFError):
        while True:
            result = here.recv()
    worker.join()
    if not result:
        late = worker.exitcode == -signal.SIGXCPU
        result = {"error": f"not done within {limit_s} s of a processor" if late else "ended without a word"}
    error = result.pop("error", "")
    return {kind: {"proven": False, "error": error} for kind in kinds} | result


def word(result):
    """The result of one kind of proof in a few words."""
    if result["proven"]:
        return "proven"
    if result.get("clocks"):
        return f"to {result['clocks']} clocks after it"
    names = result.get("open", [])
    more = f" and {len(names) - 3} more" if len(names) > 3 else ""
    return f"open: {', '.join(names[:3])}{more}" if names else f"open: {result['error']}"


def summary(entry):
    """The text of a block's cell in docs/trust.md."""
    words = {kind: word(entry[kind]) for kind in KINDS if kind in entry}
    proven = [
        NAMES[kind] + " around its blocks" * ("around" in entry[kind])
        for kind, text in words.items()
        if text == "proven"
    ]
    others = [f"{NAMES[kind]} {text}" for kind, text in words.items() if text != "proven"]
    return "; ".join([*([f"{', '.join(proven)} proven"] if proven else []), *others])


def total(entries):
    of = sums.netlists(entries)
    blocks = len(benches.blocks())
    said = (
        f"netlist = RTL proven for {of.ecp5} (ECP5) and {of.ice40} (iCE40) of {blocks} blocks, {of.slang} of"
    )
    return f"{said} them as slang reads the RTL, reset for {of.reset}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("blocks", nargs="*", metavar="BLOCK", help="names without msn_; default: all")
    parser.add_argument("-k", "--kind", choices=KINDS, action="append", help="default: all")
    parser.add_argument("-j", "--jobs", type=int, default=1)
    parser.add_argument(
        "-l",
        "--limit",
        type=int,
        default=LIMIT_S,
        help="seconds of a processor that a block's netlists, and its reset, may take",
    )
    parser.add_argument("--record", action="store_true", help="into docs/trust/equivalence.json")
    options = parser.parse_args()
    if refusal := evidence.refusal(options.blocks):
        parser.exit(2, f"equivalence: {refusal}\n")
    warm_up()
    kinds = options.kind or KINDS
    blocks = options.blocks or benches.blocks()
    sets, of_reset = parameters(blocks, "size"), parameters(blocks, "size", "reset_size")
    families = [kind for kind in kinds if kind != "reset"]
    lock = Lock()

    def job(block):
        began = time.monotonic()
        result = {}
        if families:
            result |= limited(options.limit, families, prove_netlists, block, sets[block], families)
        if "reset" in kinds:
            result |= limited(options.limit, ["reset"], prove_reset, block, of_reset[block])
            if not result["reset"]["proven"]:
                clocks = limited(options.limit, ["reset"], prove_clocks, block, of_reset[block])
                result["reset"] |= {
                    key: clocks["reset"][key] for key in ("clocks", "then") if key in clocks["reset"]
                }
        with lock:
            print(f"{block}: {summary(result)}; {time.monotonic() - began:.0f} s", flush=True)
            if options.record:
                own = {block: result}, summary, total, operator.or_, benches.blocks()
                record.merge("equivalence", "make equivalence", *own)
        return result

    with ThreadPoolExecutor(options.jobs) as pool:
        results = list(pool.map(job, blocks))
    wrong = [
        f"{block}: {NAMES[kind]} {word(result[kind])}"
        for block, result in zip(blocks, results)
        for kind in kinds
        if not result[kind]["proven"] and kind not in (asked(block, "open") or ())
    ]
    proven = sum(result[kind]["proven"] for result in results for kind in kinds)
    print("\n".join([f"{proven} of {len(results) * len(kinds)} proven", *wrong]))
    sys.exit(bool(wrong) or not proven)


if __name__ == "__main__":
    main()
