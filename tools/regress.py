"""Run blocks in random legal sizes, each with several seeds of random stimulus, against their own tests.

    python tools/regress.py [SEEDS] [--seed N] [--jobs N] [--scheduler ADDRESS] [--record] [BLOCK ...]
    python tools/regress.py --seed N --only BLOCK NAME=VALUE ...        one size again, as a failure prints it

SEEDS: the total number of runs, 200 by default, one seed each; a random size gets STIMULI of them. A failure
is reduced to the smallest size that still fails and reported with the command that repeats it. With
--scheduler the workers of that Dask scheduler do the runs, in the same folder.
"""

import argparse
import itertools
import sys
from concurrent.futures import ThreadPoolExecutor, as_completed

from nightly import evidence
from verify import record, regress


def one(block, given, seed):
    size = {name: int(value) for name, value in (text.split("=") for text in given)}
    told = regress.test(block, regress.build(block, [size]), 0, seed)
    print(told or f"{block} {size}, seed {seed}: passes")
    return told is not None


def spread(given):
    """Pieces of work: (block, [(size, stimulus seeds)]), small enough that every worker gets some."""
    names = given.blocks or regress.blocks()
    share = [given.runs // len(names) + (n < given.runs % len(names)) for n in range(len(names))]
    pieces = []
    for name, count in zip(names, share):
        sizes = regress.sizes(name, -(-count // regress.STIMULI), given.seed) if count else []
        seeds = range(1000 * given.seed, 1000 * given.seed + count)
        work = [(size, seeds[n :: len(sizes)]) for n, size in enumerate(sizes)]
        for at in range(0, len(work), regress.TOGETHER):
            pieces.append((name, work[at : at + regress.TOGETHER]))
    return pieces


def results(pieces, given):
    if given.scheduler:
        try:
            from dask.distributed import Client
            from dask.distributed import as_completed as done
        except ImportError:
            sys.exit("regress: --scheduler needs Dask: pip install distributed")
        try:
            client = Client(given.scheduler, timeout="20s")
        except (OSError, ValueError) as problem:
            sys.exit(f"regress: no scheduler answers at {given.scheduler}: {problem}")
        with client:
            waiting = {client.submit(regress.some, *piece, pure=False): piece for piece in pieces}
            for future in done(waiting):
                yield waiting[future][0], future.result()
        return
    with ThreadPoolExecutor(given.jobs) as pool:
        waiting = {pool.submit(regress.some, *piece): piece for piece in pieces}
        for future in as_completed(waiting):
            yield waiting[future][0], future.result()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("runs", nargs="?", type=int, default=200, metavar="SEEDS")
    parser.add_argument("blocks", nargs="*", metavar="BLOCK")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--scheduler", metavar="ADDRESS")
    parser.add_argument("--record", action="store_true", help="into docs/trust/regress.json")
    parser.add_argument("--only", nargs="+", metavar=("BLOCK", "NAME=VALUE"))
    given = parser.parse_args()
    if given.only:
        sys.exit(one(given.only[0], given.only[1:], given.seed))
    fixed = [name for name in given.blocks if name not in regress.blocks()]
    if refusal := evidence.refusal(given.blocks) or (fixed and f"the tests of {fixed[0]} have no SPACE"):
        parser.exit(2, f"regress: {refusal}\n")
    passed, failed, pieces = {}, [], spread(given)
    waiting = [block for block, _ in pieces]
    for block, told in results(pieces, given):
        bad = [(size, seed, why) for size, seed, why in told if why]
        sizes = len({str(size) for size, _, _ in told})
        facts = passed.setdefault(block, {"runs": 0, "sizes": 0})
        facts["runs"] += len(told) - len(bad)
        facts["sizes"] += sizes
        print(f"{block:20} {len(told):4} runs in {sizes} sizes, {len(bad)} failed", flush=True)
        failed += [(block, *each) for each in bad]
        waiting.remove(block)
        if given.record and block not in waiting and not any(block == each[0] for each in failed):
            words = f"make regress SEEDS={given.runs}"
            record.merge("regress", words, {block: facts}, regress.summary, regress.total)
    for block, size, seed, why in itertools.islice(failed, 3):
        small = regress.smallest(block, size, seed)
        print(f"{why}\n{block} {size}, seed {seed}\nagain: {regress.command(block, size, seed)}")
        print(f"smallest: {regress.command(block, small, seed)}")
    total = sum(facts["runs"] for facts in passed.values())
    print(f"{total} runs of {len(passed)} blocks pass, {len(failed)} fail")
    if failed or not total:
        sys.exit("regress: " + (f"{len(failed)} failed" if failed else "nothing ran"))


if __name__ == "__main__":
    main()
