"""Every block's netlist against its sources, and whether a reset makes it forget: proofs, no simulation.

    python tools/equivalence.py                     every block of rtl/rtl.f: ecp5, ice40, reset
    python tools/equivalence.py divide -k reset     one block, one kind of proof
    python tools/equivalence.py --record            the results into docs/trust/equivalence.json

A block's parameters are a set that its own tests build it with: the first, or the first that SETS asks for.
Exit code 1 if something is open that OPEN does not name, or if nothing ran. docs/equivalence.md has more.
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
from verify import benches, circuit, netlist_proof, record, reset_proof
from verify.reset_proof import Task

OUT = "build/equivalence"  # relative to ROOT: YoWASP sees nothing outside the directory it starts in
NAMES = {"ecp5": "ECP5", "ice40": "iCE40", "reset": "reset"}
KINDS = tuple(NAMES)
LIMIT_S = 60  # what closes takes less than half of it

# In place of the first set of a block's tests: small memories, as they become registers, but more than one of
# whatever there can be more than one of.
SETS = {
    "delay": "Depth=7",
    "frame_filter": "Channels=5",
    "frame_marker": "Rows=3 RowBeats=3",
    "frame_table": "Words=3",
    "sync": "Width=5",
    "compare": "Width=18",
    "constant_multiplier": "Constant=1023",
    "fifo": "Depth=16",
    "width_converter": "Columns=19",
    "adc_store": "Lanes=2",
    "scan_plan": "Rows=5",
    "scan_buffer": "Rows=5",
    "scan": "Rows=3",
    "scan_adc": "Rows=3 Columns=3",
    "health": "Columns=3",
    "health_report": "Lanes=2",
    "tare": "Columns=5",
    "calibration_table": "Rows=3",
    "calibration_grid": "Rows=6",
    "calibrate": "Rows=3",
    "haar": "Channels=3",
    "sliding_extremes": "Channels=3",
    "peak_to_peak": "Channels=3 Hop=4",
    "slip": "Channels=6",
    "channels": "Channels=3",
    "cop_accumulate": "Rows=5",
    "cop": "Rows=3",
    "cop_array": "Rows=5",
    "array": "Columns=2",
    "crc32": "Bits=8",
    "image_store": "Taxels=9",
    "packet": "Taxels=9",
    "cop_slip": "Lag=4",
}

# Whose source leaves something undefined that synthesis makes use of: words beside the end of a memory, bits
# beside that of a vector. They read 0 in both, else a proof would have to know that nobody reads them. And
# slip_serial, whose memory asks for block RAM.
DEFINED = {
    *("slip_serial", "frame_table", "scan_plan", "scan", "scan_adc", "scan_demod", "tare", "health"),
    *("calibration_table", "calibration_grid", "calibrate", "cop_array", "array", "core", "axis"),
}

# Whose netlists are proven around the blocks in them: these are boxes, proven by themselves.
CUT = {
    *("acquire", "scan", "scan_adc", "scan_demod", "health", "tare", "calibrate", "slip_path", "channels"),
    *("cop", "cop_array", "array", "cop4", "packet", "link", "core", "axis"),
}

# Not proven, {block: kinds}: docs/equivalence.md says why; of the last three lines: not run to its end.
OPEN = dict.fromkeys(
    (
        *("adc_single", "time_stamp", "am_demod", "scan_plan", "scan_buffer", "slip_serial"),
        *("packet_slip", "image_store", "axil"),
        *("scan", "scan_adc", "scan_demod", "health", "tare", "calibration_table", "calibrate"),
        *("calibration_grid", "slip_path", "channels", "cop", "cop_array", "array"),
        *("cop4", "packet", "link", "registers", "core", "axis"),
    ),
    ("reset",),
)

# What the reset proof takes for granted, and sets of its own: docs/equivalence.md says why.
RESET_SETS = {
    "channels": "Channels=1",
    "cop": "Rows=1",
    "cop_accumulate": "Rows=3 Lanes=1",
    "haar": "Channels=1 Mask=1",
    "peak_to_peak": "Channels=1 Span=32 Hop=32",
    "sliding_extremes": "Channels=1 Taps=2",
    "slip": "Channels=1",
}
REGION = ("first_row", "last_row", "first_beat", "last_beat", "interleave")
TASKS = {
    "sync": Task(clocks=2),
    "multiply": Task(clocks=2, ties={"enable_i": 1}),
    "crc32": Task(reset="clear_i"),
    "uart_rx": Task(clocks=3, held=3),
    **dict.fromkeys(("sliding_extremes", "peak_to_peak"), Task(framed=True)),
    "delay": Task(clocks=9, ties={"step_i": 1}),
    "frame_table": Task(clocks=2, reset="restart_i", alike=True),
    "adc_store": Task(ties={"begin_i": "!in_valid_i"}),
    "adc_spi": Task(qualifiers={"adc_mosi_o": "!adc_cs_n_o"}, joined=(("state_q", "!convert_o"),)),
    "adc_single": Task(qualifiers={"adc_mosi_o": "!adc_cs_n_o", "adc_sclk_o": "!adc_cs_n_o"}),
    "slip": Task(
        framed=True,
        joined=(("block.seen_valid", "!moved"), ("block.restart", "begun"), ("block.kept_state", "moved")),
    ),
    "cop_slip": Task(joined=(("seen_pair", "seen_valid"), ("size_pair", "size_valid"))),
    **dict.fromkeys(("channels", "acquire"), Task(qualifiers={"adc_mosi_o": "!adc_cs_n_o"})),
    "registers": Task(qualifiers=dict.fromkeys(("bus_rdata_o", "bus_error_o"), "bus_done_o")),
    "scan": Task(since={"group_o": "trigger_o"}),
    "time_stamp": Task(since={"time_o": "convert_i"}),
    "image_store": Task(since={"read_data_o": "read_valid_o"}),
    "scan_plan": Task(
        qualifiers={
            **dict.fromkeys(("switch_row_o", "switch_group_o"), "switch_o"),
            **dict.fromkeys((f"frame_{end}_o" for end in REGION), "!done_slip_o"),
        },
        since={"done_*": "trigger_o", "frame_*": "trigger_o"},
    ),
    "axil": Task(
        qualifiers={
            "s_axil_bresp": "s_axil_bvalid",
            "s_axil_rdata": "s_axil_rvalid",
            "s_axil_rresp": "s_axil_rvalid",
        }
    ),
    "spi_shift": Task(qualifiers={"spi_mosi_o": "!spi_cs_n_o", "data_o": "done_o word_o"}),
}


def parameters(blocks, asked):
    """{block: the set of its tests that its proofs use}; ``asked``: {block: what of a set decides}."""
    found = {}
    for run in benches.runs(*blocks):
        wanted = dict(pair.split("=") for pair in asked.get(run["block"], "").split())
        if wanted.items() <= run["parameters"].items():
            found.setdefault(run["block"], run["parameters"])
    if missing := [block for block in blocks if block not in found]:
        raise ValueError(
            f"the tests of {missing[0]} build nothing with {asked.get(missing[0], 'any parameters')}"
        )
    return found


def prove_netlists(block, chosen, families):
    """{family: result} of ``block`` with ``chosen`` parameters, as docs/trust/equivalence.json has them."""
    folder = f"{OUT}/{block}"
    result = {"parameters": spelt(chosen)}
    for defined in (True,) if block in DEFINED else (False, True):
        again = [family for family in families if not result.get(family, {}).get("proven")]
        try:
            bits = again and circuit.synthesise(block, chosen, folder, again, defined, cut=block in CUT)
        except ValueError as error:  # a memory that asks for block RAM
            result |= {family: {"proven": False, "error": str(error)} for family in again}
            continue
        for family, from_reset in product(again, (False, True)):
            if not result.get(family, {}).get("proven"):
                of = bits["source"], bits[family], folder, family, from_reset
                result[family] = said(lambda of=of: netlist_proof.prove(*of))
                result[family] |= {"defined": defined, "from_reset": from_reset}
                result[family] |= {"around": around} if (around := circuit.boxes(bits["source"])) else {}
    yield result


def source_of(block, chosen, folder, task):
    """The bits of a block's source, among frames where ``task`` says so."""
    source = circuit.synthesise(block, chosen, folder, ())["source"]
    if not task.framed:
        return source
    around = circuit.framed(block, source, int(chosen["Channels"]))
    return circuit.synthesise(block, chosen, folder, (), around=around)["source"]


def prove_reset(block, chosen):
    """{"reset": result} of ``block`` with ``chosen`` parameters, as docs/trust/equivalence.json has it."""
    task, folder = TASKS.get(block, Task()), f"{OUT}/{block}/reset"
    source = source_of(block, chosen, folder, task)
    result = said(lambda: reset_proof.prove(source, task))
    if not result["proven"] and not task.alike:
        alike = said(lambda: reset_proof.prove(source, replace(task, alike=True)))
        if alike["proven"]:
            result, task = alike, replace(task, alike=True)
    yield {"reset": result | {"parameters": spelt(chosen), "alike": task.alike}}


def prove_clocks(block, chosen):
    """{"reset": how many clocks after a reset nothing differs}, again and again; memories begin alike."""
    task = replace(TASKS.get(block, Task()), alike=True)
    source = source_of(block, chosen, f"{OUT}/{block}/clocks", task)
    for differ, clocks in reset_proof.bounded(source, task):
        yield {"reset": {"clocks": clocks} | ({"then": sorted(differ)} if differ else {})}


def spelt(parameters):
    return " ".join(f"{name}={value}" for name, value in parameters.items())


def said(proof):
    """What came of a proof: the outputs it leaves open, if any, or the trouble; and its CPU seconds."""
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
    resource.setrlimit(resource.RLIMIT_CPU, (limit_s, limit_s + 5))  # of each of its tools too
    try:
        for told in prove(*asked):
            pipe.send(told)
    except (ToolError, ValueError) as error:
        pipe.send({"error": str(error)})


def limited(limit_s, kinds, prove, *asked):
    """What ``prove`` says last of ``kinds``, in a process of its own that may take so much processor time."""
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
    """A kind's result in a few words."""
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
    ecp5, ice40, reset = (sum(e.get(kind, {}).get("proven", False) for e in entries) for kind in KINDS)
    of = len(benches.blocks())
    return f"netlist = RTL proven for {ecp5} (ECP5) and {ice40} (iCE40) of {of} blocks, reset for {reset}"


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
    if refusal := benches.unknown(options.blocks):
        parser.exit(2, f"equivalence: {refusal}\n")
    warm_up()
    kinds = options.kind or KINDS
    blocks = options.blocks or benches.blocks()
    sets, of_reset = parameters(blocks, SETS), parameters(blocks, SETS | RESET_SETS)
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
        if not result[kind]["proven"] and kind not in OPEN.get(block, ())
    ]
    proven = sum(result[kind]["proven"] for result in results for kind in kinds)
    print("\n".join([f"{proven} of {len(results) * len(kinds)} proven", *wrong]))
    sys.exit(bool(wrong) or not proven)


if __name__ == "__main__":
    main()
