"""Proofs of the blocks: `make formal`.

python tools/formal.py                   every proof at every shipped parameter set, two solvers
python tools/formal.py fifo divide       those of blocks or proofs by name
python tools/formal.py --quick           the few quickest
python tools/formal.py --record          and write what came of them into docs/trust/formal.json
python tools/formal.py --list            the proofs, their kind and their parameter sets
python tools/formal.py --mutants 50      break each block so often: does its proof fail?
"""

import argparse
import sys
import time
from concurrent.futures import ThreadPoolExecutor

from meissner import yowasp
from meissner.trust import formal


def words(parameters):
    return " ".join(f"{key}={value if value < 2**32 else '...'}" for key, value in parameters.items()) or "-"


def line(result):
    """One line of a Result."""
    total = sum(result.seconds.values())
    head = f"{result.proof.name:18} {result.proof.kind:20} {'ok' if not result.wrong else 'FAILED':6} {total:6.1f} s  "
    text = f"{head}{words(result.parameters)} ({', '.join(result.where)})"
    return "\n".join([text, *(f"    {wrong}" for wrong in result.wrong)])


def chosen(names, quick):
    table = formal.proofs()
    blocks = {proof.block for proof in table.values()}
    unknown = [name for name in names if name not in table and name not in blocks]
    if unknown:
        raise ValueError(f"no proof or block is called {unknown[0]}; there are: {', '.join(table)}")
    found = [p for p in table.values() if not names or p.name in names or p.block in names]
    return [proof for proof in found if proof.quick or not quick]


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", metavar="BLOCK")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--record", action="store_true")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()
    try:
        proofs = chosen(given.names, given.quick)
    except ValueError as error:
        print(error, file=sys.stderr)
        return 2
    yowasp.warm_up()
    begun = time.monotonic()
    tasks = [
        (proof, parameters, where, index)
        for proof in proofs
        for index, (parameters, where) in enumerate(formal.sets(proof))
    ]
    if given.list:
        for proof, parameters, where, _ in tasks:
            print(f"{proof.name:18} {proof.kind:20} {words(parameters)} ({', '.join(where)})")
        return 0
    with ThreadPoolExecutor(given.jobs) as pool:
        running = [pool.submit(formal.prove, *task) for task in tasks]
        results = []
        for future in running:
            results.append(future.result())
            print(line(results[-1]), flush=True)
    failed = [result for result in results if result.wrong]
    unbounded = {result.proof.name for result in results if result.proof.k}
    print(
        f"formal: {len(proofs)} proofs ({len(unbounded)} unbounded) at {len(results)} parameter sets, "
        f"{len(failed)} failed, {time.monotonic() - begun:.0f} s"
    )
    return 1 if failed or not results else 0


if __name__ == "__main__":
    sys.exit(main())
