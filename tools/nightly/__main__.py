"""Run the checks that take longer than `make test`, and hold the results against tb/limits.toml.

    make nightly                                       every kind on every block: hours
    make nightly KINDS="proofs faults" BLOCKS="skid haar"
    make nightly SINCE=HEAD~1                          what has changed since a commit, within 18 minutes

KINDS: proofs, netlists, faults, mutants, coverage, boards (whose BLOCKS are pairs, such as icebreaker-slip1).
Each result is written to build/evidence/<kind>.json at once, and build/evidence/index.html shows all.
Exit code 1: a limit is broken. 2: nothing was run, or an argument is wrong. 3: the time (MINUTES, 0: no end)
was not enough for all; the page names what was not reached.
"""

import argparse
import contextlib
import json
import os
import queue
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
import traceback
from concurrent import futures
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

from meissner.builds import toolchain
from meissner.builds.yowasp import warm_up
from nightly import benches, boards, cover, evidence, faults, limits, mutants, netlists, page, proofs, since

MODULES = {
    **{"proofs": proofs, "netlists": netlists, "faults": faults, "mutants": mutants},
    **{"coverage": cover, "boards": boards},
}
FOLDER = toolchain.BUILD / "evidence"
MINUTES = 18  # with SINCE
BROKEN, REFUSED, LATE = 1, 2, 3  # exit codes


@dataclass
class Check:
    """One kind of check of one block. ``facts``: its result; None if it was not reached."""

    kind: str
    block: str
    own: bool = True  # False: only a block inside it has changed
    seconds: float = 0.0
    cpu_s: float = 0.0
    facts: dict | None = None
    process: subprocess.Popen | None = field(default=None, repr=False)


def planned(kinds, blocks, ref):
    """(the checks to run, in order; the shared files among the changed ones)."""
    for block in benches.blocks():
        evidence.of(block, "")  # a wrong statement is refused before anything runs
    if ref is None:
        checks, shared = [Check(kind, name) for kind in kinds for name in MODULES[kind].blocks()], []
    else:
        found, shared = since.concerned(since.changed(ref), ref)
        offered = {kind: set(MODULES[kind].blocks()) for kind in kinds}
        checks = [Check(*key, own) for key, own in found.items() if key[1] in offered.get(key[0], ())]
        checks += [Check("boards", pair) for pair in boards.blocks() if "boards" in kinds and found]
    if blocks:
        checks = [check for check in checks if check.block in blocks]
    return sorted(
        checks, key=lambda check: (not check.own, list(MODULES).index(check.kind), size(check.block))
    ), shared


def size(block):
    """The number of blocks inside a block: the small ones first."""
    return len(benches.inner(block)) if block in benches.blocks() else sys.maxsize


def start(check, jobs):
    """Run a check in its own process group, so that all the tools it starts end with it."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    stem = FOLDER / f"{check.kind}-{check.block.replace('/', '-')}"
    stem.with_suffix(".out").unlink(missing_ok=True)
    command = [sys.executable, "-m", "nightly", "--one", check.kind, check.block, "--jobs", str(jobs)]
    paths = [str(toolchain.ROOT / "tools"), *filter(None, [os.environ.get("PYTHONPATH")])]
    began = time.monotonic()
    with stem.with_suffix(".log").open("w") as log:
        check.process = subprocess.Popen(
            [*command, "--out", str(stem.with_suffix(".out"))],
            env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
            cwd=toolchain.ROOT, stdout=log, stderr=subprocess.STDOUT, start_new_session=True,
        )  # fmt: skip
        _, _, used = os.wait4(check.process.pid, 0)
    stop(check.process)  # what it left behind
    check.seconds, check.cpu_s = time.monotonic() - began, used.ru_utime + used.ru_stime
    check.process, out = None, stem.with_suffix(".out")
    crashed = {"text": "", "broken": [f"ended without a result; see {stem.name}.log"]}
    return json.loads(out.read_text()) if out.exists() else crashed


def stop(process):
    """End a check with all that it has started."""
    with contextlib.suppress(ProcessLookupError):  # all of it has ended
        os.killpg(process.pid, signal.SIGKILL)


@contextlib.contextmanager
def interrupted_by(*signals):
    """These signals end the run as Ctrl-C does, with its checks."""
    kept = {one: signal.signal(one, lambda number, _: sys.exit(128 + number)) for one in signals}
    try:
        yield
    finally:
        for one, before in kept.items():
            signal.signal(one, before)


def one(kind, block, out, jobs):
    """The process of a check: write its facts."""
    try:
        facts = MODULES[kind].run(block, limits.Limits(), jobs)
    except Exception as error:  # any failure to run breaks the limit
        traceback.print_exc()
        facts = {"text": "", "broken": [f"could not run: {str(error).strip()[-2000:]}"]}
    with open(f"{out}.new", "w") as file:
        json.dump(facts, file, default=str)
    os.replace(f"{out}.new", out)


def run(checks, jobs, seconds, told):
    """Run the checks, ``jobs`` at a time, for at most so many seconds (None: to the end)."""
    waiting, late, lock = queue.SimpleQueue(), threading.Event(), threading.Lock()
    for check in checks:
        waiting.put(check)
    each = max(1, jobs // max(1, len(checks)))  # a single check may use all processors

    def work():
        while not late.is_set():
            try:
                check = waiting.get_nowait()
            except queue.Empty:
                return
            facts = start(check, each)
            with lock:
                if not late.is_set():
                    check.facts = facts
                    told(check)

    # A thread whose join is interrupted says that it has ended; a future does not.
    with ThreadPoolExecutor(jobs) as pool, interrupted_by(signal.SIGTERM, signal.SIGHUP):
        workers = [pool.submit(work) for _ in range(jobs)]
        try:
            futures.wait(workers, seconds)
        finally:  # also if the user interrupts
            late.set()
            while not all(worker.done() for worker in workers):
                for process in [check.process for check in checks if check.process]:
                    stop(process)
                time.sleep(0.1)
        for worker in workers:
            worker.result()


def write(checks, heading):
    """build/evidence/<kind>.json and index.html."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    rows = [
        {
            "kind": check.kind, "block": check.block, "own": check.own, "facts": check.facts,
            "seconds": round(check.seconds, 1), "cpu_s": round(check.cpu_s, 1),
        }
        for check in checks
    ]  # fmt: skip
    for kind in dict.fromkeys(row["kind"] for row in rows):
        own = [row for row in rows if row["kind"] == kind]
        (FOLDER / f"{kind}.json").write_text(json.dumps(heading | {"checks": own}, indent=1) + "\n")
    page.write(FOLDER / "index.html", heading, rows, limits.Limits())


def verdict(checks):
    """(exit code, one sentence) of some checks."""
    broken = [check for check in checks if check.facts and check.facts["broken"]]
    left = [check for check in checks if check.facts is None]
    if not len(checks) - len(left):
        return REFUSED, "nothing was run"
    said = f"{len(checks) - len(left)} checks run, {len(broken)} break a limit, {len(left)} not reached"
    return (BROKEN if broken else LATE if left else 0), said


def tell(check):
    """Print a check's result."""
    broken = check.facts["broken"]
    print(
        f"{check.kind:9} {check.block:20} {'BROKEN' if broken else 'ok':6} {check.seconds:6.0f} s  "
        f"{check.facts['text']}",
        *(f"    {line}" for line in broken),
        sep="\n",
        flush=True,
    )


def main():
    parser = argparse.ArgumentParser(
        prog="nightly", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("blocks", nargs="*", metavar="BLOCK", help="names without msn_; default: all")
    parser.add_argument("--kinds", nargs="+", metavar="KIND", default=[])
    parser.add_argument("--since", metavar="REF")
    parser.add_argument("--minutes", type=float)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--one", nargs=2, help=argparse.SUPPRESS)
    parser.add_argument("--out", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.one:
        one(*given.one, given.out, given.jobs)
        return 0
    kinds = given.kinds or [kind for kind in MODULES if kind != "boards" or not given.since]
    if unknown := [kind for kind in kinds if kind not in MODULES]:
        parser.exit(REFUSED, f"nightly: no kind is called {unknown[0]}; there are {', '.join(MODULES)}\n")
    known = {name for kind in kinds for name in MODULES[kind].blocks()}
    if unknown := [block for block in given.blocks if block not in known]:
        parser.exit(REFUSED, f"nightly: there is no {unknown[0]} in {', '.join(kinds)}\n")
    try:
        limits.Limits()
        checks, shared = planned(kinds, given.blocks, given.since)
    except ValueError as error:
        parser.exit(REFUSED, f"nightly: {error}\n")
    if not checks:
        parser.exit(REFUSED, f"nightly: nothing to run; {page.untouched(shared)}\n")
    warm_up()
    shutil.rmtree(FOLDER, ignore_errors=True)  # it holds one run
    minutes = given.minutes if given.minutes is not None else MINUTES if given.since else 0
    heading = page.heading(kinds, given.blocks, given.since, shared)
    last = [check for check in checks if check.block == cover.SHARED]  # it reads what the others counted
    begun = time.monotonic()
    for part in ([check for check in checks if check not in last], last):
        rest = 60 * minutes - (time.monotonic() - begun) if minutes else None
        if rest is None or rest > 0:
            run(part, given.jobs, rest, lambda check: (tell(check), write(checks, heading)))
    write(checks, heading)
    code, said = verdict(checks)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = used.ru_utime + used.ru_stime
    print(f"nightly: {said}; {time.monotonic() - begun:.0f} s, {cpu:.0f} s of processors")
    for check in [check for check in checks if check.facts is None]:
        print(f"not reached: {check.kind} of {check.block}")
    if shared:
        print(page.untouched(shared))
    print(f"see {(FOLDER / 'index.html').relative_to(toolchain.ROOT)}")
    return code


if __name__ == "__main__":
    sys.exit(main())
