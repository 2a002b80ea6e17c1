"""Prove the blocks' properties (`make formal`), and test the proofs with mutants (`make formal-mutants`).

python tools/formal.py                   every proof at every shipped parameter set, with two solvers
python tools/formal.py fifo divide       the proofs of these blocks, or with these names
python tools/formal.py --quick           the quickest proofs, at the default parameters
python tools/formal.py --record          also record the results in docs/trust/formal.json
python tools/formal.py --list            list the proofs, their kinds and parameter sets
python tools/formal.py --mutants 50      break each block in 50 places and check that its proof fails
python tools/formal.py --table           print docs/formal.md's table from docs/trust/formal.json
"""

import argparse
import json
import resource
import sys
import time
from concurrent.futures import ThreadPoolExecutor

from meissner.builds import yowasp
from verify import formal, formal_mutants, record


def words(parameters):
    return " ".join(f"{key}={value if value < 2**32 else '...'}" for key, value in parameters.items()) or "-"


def line(result):
    """One line for a Result, and one for each failure."""
    total, said = sum(result.seconds.values()), "FAILED" if result.wrong else "ok"
    head = f"{result.proof.name:16} {result.proof.kind:9} {said:6} {total:6.1f} s  "
    text = f"{head}{words(result.parameters)} ({', '.join(result.where)})"
    return "\n".join([text, *(f"    {wrong}" for wrong in result.wrong)])


def chosen(names, quick):
    """The proofs that ``names`` select, by proof or block name, in that order; all if there are no names."""
    table = formal.proofs()
    blocks = {proof.block for proof in table.values()}
    unknown = [name for name in names if name not in table and name not in blocks]
    if unknown:
        raise ValueError(f"no proof or block is called {unknown[0]}; there are: {', '.join(table)}")
    named = [p for name in names for p in table.values() if name in (p.name, p.block)]
    found = list({p.name: p for p in named or table.values()}.values())
    return [proof for proof in found if proof.quick or not quick]


def joined(before, facts):
    """A block's recorded proofs, updated with the new results."""
    listed, known = formal.proofs(), before.get("proofs", {})
    kept = {name: row for name, row in known.items() if name in listed}
    fresh = {name: kept.get(name, {}) | row for name, row in facts["proofs"].items()}
    return facts | {"proofs": kept | fresh}


def held(rows):
    """The rows of proofs that were run and held."""
    return [row for row in rows if "sets" in row and not row["failed"]]


def summary(facts):
    """The text of a block's cell in docs/trust.md."""
    rows = facts["proofs"].values()
    words = [", ".join(row["kind"] for row in held(rows))]
    words += [f"{name} failed" for name, row in facts["proofs"].items() if row.get("failed")]
    counts = [row["mutants"] for row in rows if "mutants" in row]
    if counts:
        seen = sum(row["found"] + row["broken"] for row in counts)
        words.append(f"{seen} of {sum(row['of'] - row['equivalent'] for row in counts)} mutants")
    return "; ".join(filter(None, words))


def total(entries):
    rows = held(row for entry in entries for row in entry["proofs"].values())
    unbounded = sum(row["kind"].startswith("k") for row in rows)
    return f"{unbounded} unbounded proofs, two solvers each"


def keep(proof, row):
    """Merge the result of ``proof`` into docs/trust/formal.json."""
    listed = {proof.block for proof in formal.proofs().values()}
    blocks = {proof.block: {"proofs": {proof.name: row}}}
    record.merge("formal", "make formal", blocks, summary, total, joined, listed)


def table():
    """docs/formal.md's table as Markdown."""
    names = ["proof", "says", "kind", "sets", *(f"{solver}, s" for solver in formal.SOLVERS), "mutants seen"]
    rows = [f"| {' | '.join(names)} |", "|---" * len(names) + "|"]
    listed = formal.proofs()
    for entry in json.loads((record.FOLDER / "formal.json").read_text())["blocks"].values():
        for name, row in entry["proofs"].items():
            seen = row.get("mutants")
            of = f"{seen['found'] + seen['broken']} of {seen['of'] - seen['equivalent']}" if seen else ""
            seconds = [row.get("seconds", {}).get(solver, "") for solver in formal.SOLVERS]
            says = listed[name].says.replace("|", "\\|")
            cells = [name, says, row.get("kind", ""), row.get("sets", ""), *seconds, of]
            rows.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(rows)


def run(proofs, jobs, quick, told):
    """Run all proofs and pass each result to ``told``. Returns the exit code."""
    tasks = []
    for proof in proofs:
        sets = [({}, ["default"])] if quick else formal.sets(proof)
        tasks.append((proof, [(proof, *each, index) for index, each in enumerate(sets)]))
    begun, before, count, failed = time.monotonic(), cpu_seconds(), 0, 0
    with ThreadPoolExecutor(jobs) as pool:
        waiting = [(proof, [pool.submit(formal.prove, *task) for task in own]) for proof, own in tasks]
        for proof, futures in waiting:
            results = []
            for future in futures:
                results.append(future.result())
                print(line(results[-1]), flush=True)
            wrong = sum(bool(result.wrong) for result in results)
            count, failed = count + len(results), failed + wrong
            seconds = {s: round(sum(r.seconds.get(s, 0) for r in results), 1) for s in proof.solvers}
            told(proof, {"kind": proof.kind, "sets": len(results), "failed": wrong, "seconds": seconds})
    unbounded = sum(proof.k > 0 for proof in proofs)
    print(
        f"formal: {len(proofs)} proofs ({unbounded} unbounded) at {count} parameter sets, {failed} failed, "
        f"{time.monotonic() - begun:.0f} s, {cpu_seconds() - before:.0f} s of processors"
    )
    return 1 if failed or not count else 0


def cpu_seconds():
    """CPU seconds of all child processes that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def run_mutants(proofs, count, jobs, told):
    """Break each block in ``count`` places under its proof and pass each result to ``told``.

    Returns the exit code.
    """
    failed = not proofs
    for proof in proofs:
        begun = time.monotonic()
        parameters = proof.mutants_at or formal.sets(proof)[0][0]
        try:
            found = formal_mutants.mutate(proof, dict(parameters), count, jobs)
        except yowasp.ToolError as error:
            print(f"{proof.name:16} FAILED {error}", flush=True)
            failed = True
            continue
        told(proof, {"mutants": found})
        print(
            f"{proof.name:16} {found['found']} with a run from reset, {found['broken']} without, of "
            f"{found['of'] - found['equivalent']} ({found['equivalent']} more are equivalent), "
            f"{time.monotonic() - begun:.0f} s",
            *(f"    passed: {mutant}" for mutant in found["passed"]),
            sep="\n",
            flush=True,
        )
    return int(failed)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", metavar="BLOCK")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--record", action="store_true")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--table", action="store_true")
    parser.add_argument("--mutants", type=int, metavar="N")
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()
    if given.table:
        print(table())
        return 0
    try:
        proofs = chosen(given.names, given.quick)
        if given.mutants is not None and not 1 <= given.mutants <= 500:
            raise ValueError(f"--mutants {given.mutants} must lie in 1 .. 500")
        if given.quick and given.record:
            raise ValueError("what --quick proves is not recorded")
    except ValueError as error:
        print(f"formal: {error}", file=sys.stderr)
        return 2
    yowasp.warm_up()
    if given.list:
        for proof in proofs:
            for parameters, where in formal.sets(proof):
                print(f"{proof.name:16} {proof.kind:9} {words(parameters)} ({', '.join(where)})")
        return 0
    told = keep if given.record else lambda proof, row: None
    if given.mutants:
        return run_mutants(proofs, given.mutants, given.jobs, told)
    return run(proofs, given.jobs, given.quick, told)


if __name__ == "__main__":
    sys.exit(main())
