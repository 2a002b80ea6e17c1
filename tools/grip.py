"""A hand's scene over more seeds than `meissner run` draws: the table of its conditions.

    python tools/grip.py grip_pour --runs 1000 --condition 0
    python tools/grip.py grip_release --first 1001 --set slip.threshold_share=0.008 step_mm=0.02

A condition is named by its number; without one, all are run. Settings are chosen on seeds 1001 on; what is
reported is of seeds 1 on.
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


def changed(scene, settings):
    """The scene with ``settings``, KEY=VALUE: of its conditions, or with a dot of its tables slip and grip."""
    for key, _, value in (one.partition("=") for one in settings):
        name, _, inner = key.rpartition(".")
        if name:
            scene = dataclasses.replace(scene, **{name: getattr(scene, name) | {inner: float(value)}})
        else:
            all_of = (dataclasses.replace(condition, **{key: float(value)}) for condition in scene.conditions)
            scene = dataclasses.replace(scene, conditions=tuple(all_of))
    return scene


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", choices=scenes.names("hand"))
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--first", type=int, default=1, help="the first seed (1)")
    parser.add_argument("--condition", type=int, help="its number, from 0 on (all)")
    parser.add_argument("--engine", choices=list(PARTS), default="fixed")
    parser.add_argument("--set", nargs="*", default=[], metavar="KEY=VALUE", help="in place of the scene's")
    args = parser.parse_args(arguments)
    scene = changed(scenes.load(args.scene), args.set)
    which = range(len(scene.conditions)) if args.condition is None else [args.condition]
    found = list(rows(scene, args.runs, which, args.engine, args.first))
    print("\n".join(table(found)))
    count = sum(row["dropped"] for row in found)
    print("dropped:", interval.words(interval.rate(count, sum(row["runs"] for row in found))))


if __name__ == "__main__":
    sys.exit(main())
