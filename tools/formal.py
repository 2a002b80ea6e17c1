"""Proofs of the blocks: `make formal`, and what they are worth: `make formal-mutants`.

python tools/formal.py                   every proof at every shipped parameter set, two solvers
python tools/formal.py fifo divide       those of blocks or proofs by name
python tools/formal.py --quick           the quickest, at the defaults
python tools/formal.py --record          and what came of them into docs/trust/formal.json
python tools/formal.py --list            the proofs, their kind and their parameter sets
python tools/formal.py --mutants 50      break each block so often: does its proof fail?
python tools/formal.py --table           docs/formal.md's table, from docs/trust/formal.json
"""

import argparse
import json
import sys
import time
from concurrent.futures import ThreadPoolExecutor

from meissner import yowasp
from meissner.trust import formal, formal_mutants

RECORD = yowasp.ROOT / "docs/trust/formal.json"


def words(parameters):
    return " ".join(f"{key}={value if value < 2**32 else '...'}" for key, value in parameters.items()) or "-"


def line(result):
    """One line of a Result, and one for each thing wrong."""
    total, said = sum(result.seconds.values()), "FAILED" if result.wrong else "ok"
    head = f"{result.proof.name:16} {result.proof.kind:9} {said:6} {total:6.1f} s  "
    text = f"{head}{words(result.parameters)} ({', '.join(result.where)})"
    return "\n".join([text, *(f"    {wrong}" for wrong in result.wrong)])


def chosen(names, quick):
    """The proofs that ``names`` name, themselves or by their block; all without a name."""
    table = formal.proofs()
    blocks = {proof.block for proof in table.values()}
    unknown = [name for name in names if name not in table and name not in blocks]
    if unknown:
        raise ValueError(f"no proof or block is called {unknown[0]}; there are: {', '.join(table)}")
    found = [p for p in table.values() if not names or p.name in names or p.block in names]
    return [proof for proof in found if proof.quick or not quick]


def record(rows):
    """Merge {(block, proof): row} into docs/trust/formal.json."""
    RECORD.parent.mkdir(exist_ok=True)
    blocks = json.loads(RECORD.read_text())["blocks"] if RECORD.exists() else {}
    for (block, name), row in rows.items():
        entry = blocks.setdefault(block, {}).setdefault("proofs", {})
        entry[name] = entry.get(name, {}) | row
    known = {proof.block: [] for proof in formal.proofs().values()}
    blocks = {block: blocks[block] for block in sorted(blocks) if block in known}
    for entry in blocks.values():
        kinds = ", ".join(row.get("kind", "?") for row in entry["proofs"].values())
        counts = [row["mutants"] for row in entry["proofs"].values() if "mutants" in row]
        seen = sum(row["found"] + row["broken"] for row in counts)
        of = sum(row["of"] - row["equivalent"] for row in counts)
        entry["summary"] = kinds + (f"; {seen} of {of} mutants" if counts else "")
    proofs = [row for entry in blocks.values() for row in entry["proofs"].values() if "sets" in row]
    unbounded = sum(row["kind"].startswith("k") for row in proofs)
    total = f"{unbounded} unbounded proofs, two solvers each"
    text = {"command": "make formal", "date": time.strftime("%Y-%m-%d"), "total": total, "blocks": blocks}
    RECORD.write_text(json.dumps(text, indent=1) + "\n")


def table():
    """docs/formal.md's table as Markdown."""
    rows = ["| proof | says | kind | sets | yices, s | z3, s | mutants seen |", "|---" * 7 + "|"]
    listed = formal.proofs()
    for entry in json.loads(RECORD.read_text())["blocks"].values():
        for name, row in entry["proofs"].items():
            seen = row.get("mutants")
            of = f"{seen['found'] + seen['broken']} of {seen['of'] - seen['equivalent']}" if seen else ""
            times = row["seconds"]
            says = listed[name].says.replace("|", "\\|")
            cells = [name, says, row["kind"], row["sets"], times["yices"], times["z3"], of]
            rows.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(rows)


def run(proofs, jobs, quick):
    """Prove all; returns (the exit code, what to record)."""
    tasks = []
    for proof in proofs:
        sets = [({}, ["default"])] if quick else formal.sets(proof)
        tasks += [(proof, parameters, where, index) for index, (parameters, where) in enumerate(sets)]
    begun, results = time.monotonic(), []
    with ThreadPoolExecutor(jobs) as pool:
        for future in [pool.submit(formal.prove, *task) for task in tasks]:
            results.append(future.result())
            print(line(results[-1]), flush=True)
    failed = [result for result in results if result.wrong]
    unbounded = sum(proof.k > 0 for proof in proofs)
    print(
        f"formal: {len(proofs)} proofs ({unbounded} unbounded) at {len(results)} parameter sets, "
        f"{len(failed)} failed, {time.monotonic() - begun:.0f} s"
    )
    rows = {}
    for proof in proofs:
        own = [result for result in results if result.proof == proof]
        if own and not any(result.wrong for result in own):
            seconds = {s: round(sum(r.seconds[s] for r in own), 1) for s in proof.solvers}
            row = {"kind": proof.kind, "sets": len(own), "seconds": seconds}
            rows[proof.block, proof.name] = row
    return (1 if failed or not results else 0), rows


def run_mutants(proofs, count, jobs):
    """Break each block ``count`` times under its proof; returns (exit code, what to record)."""
    rows = {}
    for proof in proofs:
        begun = time.monotonic()
        parameters = proof.mutants_at or formal.sets(proof)[0][0]
        found = formal_mutants.mutate(proof, dict(parameters), count, jobs)
        passed = found.pop("passed")
        rows[proof.block, proof.name] = {"mutants": found | {"passed": passed}}
        print(
            f"{proof.name:16} {found['found']} with a run from reset, {found['broken']} without, of "
            f"{found['of'] - found['equivalent']} ({found['equivalent']} more are equivalent), "
            f"{time.monotonic() - begun:.0f} s",
            *(f"    passed: {mutant}" for mutant in passed),
            sep="\n",
            flush=True,
        )
    return (0 if rows else 1), rows


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
    except ValueError as error:
        print(f"formal: {error}", file=sys.stderr)
        return 2
    yowasp.warm_up()
    if given.list:
        for proof in proofs:
            for parameters, where in formal.sets(proof):
                print(f"{proof.name:16} {proof.kind:9} {words(parameters)} ({', '.join(where)})")
        return 0
    if given.mutants:
        code, rows = run_mutants(proofs, given.mutants, given.jobs)
    else:
        code, rows = run(proofs, given.jobs, given.quick)
    if given.record and rows:
        record(rows)
    return code


if __name__ == "__main__":
    sys.exit(main())
