"""A hand's scene over more seeds than `meissner run` draws: the table of its conditions.

    python tools/grip.py grip_pour --runs 1000 --condition 0

A condition is named by its number; without one, all are run.
"""

import argparse
import dataclasses
import sys

from meissner import interval, scenes
from meissner.scenes.hand import loop
from meissner.scenes.hand.run import AT_ONCE, PARTS, joined, statistics
from meissner.scenes.results import table


def rows(scene, runs, which, engine="fixed", first=1):
    """A row of each condition, of seeds ``first`` on; ``which``: numbers of conditions."""
    for condition in (scene.conditions[number] for number in which):
        batches = [range(at, min(at + AT_ONCE, first + runs)) for at in range(first, first + runs, AT_ONCE)]
        held = [loop.hold(scene, condition, seeds, PARTS[engine]) for seeds in batches]
        yield statistics(condition, joined(held))


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", choices=scenes.names("hand"))
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--condition", type=int, help="its number, from 0 on (all)")
    parser.add_argument("--engine", choices=list(PARTS), default="fixed")
    parser.add_argument(
        "--set", nargs="*", default=[], metavar="KEY=VALUE", help="of the condition, in place"
    )
    args = parser.parse_args(arguments)
    scene = scenes.load(args.scene)
    changes = {key: float(value) for key, _, value in (one.partition("=") for one in args.set)}
    changed = tuple(dataclasses.replace(condition, **changes) for condition in scene.conditions)
    scene = dataclasses.replace(scene, conditions=changed)
    which = range(len(changed)) if args.condition is None else [args.condition]
    found = list(rows(scene, args.runs, which, args.engine))
    print("\n".join(table(found)))
    count = sum(row["dropped"] for row in found)
    print("dropped:", interval.words(interval.rate(count, sum(row["runs"] for row in found))))


if __name__ == "__main__":
    sys.exit(main())
