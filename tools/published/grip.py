"""Run a hand's scene over more seeds than `meissner run` does, and print a row for each condition.

    python tools/published/grip.py grip_pour --runs 1000 --condition 0
    python tools/published/grip.py grip_release --first 1001 --set slip.threshold_share=0.007 step_mm=0.02
    python tools/published/grip.py grip_pour --runs 1000 --record    record in docs/grip.json, then write the page
    python tools/published/grip.py --page                            write docs/grip_scenes.md from docs/grip.json

--condition takes a number; without it, all conditions run. Settings are chosen on seeds from 1001 on; records
use seeds from 1 on.
"""

import argparse
import dataclasses
import json
import sys

from meissner import interval, scenes
from meissner.builds import toolchain
from meissner.scenes.hand import loop
from meissner.scenes.hand.run import AT_ONCE, PARTS, joined, statistics
from meissner.scenes.results import table
from verify import revision

RECORD, PAGE = toolchain.ROOT / "docs/grip.json", toolchain.ROOT / "docs/grip_scenes.md"
MODEL = "model/meissner"
RESTS_ON = (
    *(f"{MODEL}/scenes/hand/{name}.py" for name in ("host", "loop", "scene")),
    f"{MODEL}/twins/actuate/grip.py",
    *(f"{MODEL}/physics/{name}.py" for name in ("adc", "hand", "plate", "rubber", "slide", "stepped")),
    *(f"{MODEL}/twins/slip/{name}.py" for name in ("haar", "peak_to_peak")),
)
LIGHT_RUNS = 20
HEAD = (
    "| scene, condition | runs | dropped (95 % interval) | ratio, mean / largest | runs above 1.2 "
    "| way at most | sag / rings / slip at most | tightenings, false |"
)


def rows(scene, runs, number, engine="fixed", first=1):
    """Yield the row of a condition after each batch of seeds from ``first`` on; the last row covers all."""
    condition, held = scene.conditions[number], []
    for at in range(first, first + runs, AT_ONCE):
        seeds = range(at, min(at + AT_ONCE, first + runs))
        held.append(loop.hold(scene, condition, seeds, PARTS[engine]))
        yield statistics(condition, joined(held))


def figures():
    """The short form for docs/results.md: the first condition of both pouring scenes, 20 seeds each."""
    return {
        name: next(rows(scenes.load(name), LIGHT_RUNS, 0)) | {"condition": None}
        for name in ("grip_pour", "grip_water")
    }


def changed(scene, settings):
    """The scene with ``settings`` KEY=VALUE of its conditions, or with a dot, of its table slip or grip."""
    for key, _, value in (one.partition("=") for one in settings):
        name, _, inner = key.rpartition(".")
        if name:
            scene = dataclasses.replace(scene, **{name: getattr(scene, name) | {inner: json.loads(value)}})
        else:
            all_of = (dataclasses.replace(condition, **{key: float(value)}) for condition in scene.conditions)
            scene = dataclasses.replace(scene, conditions=tuple(all_of))
    return scene


def digest(name):
    """The digest of what a scene's rows rest on."""
    return revision.of_files([*RESTS_ON, f"{MODEL}/scenes/hand/{name}.toml"], "scenes")


def record(name, found, of):
    """Record the rows ``found`` of a scene with digest ``of``; drop rows of conditions that are gone."""
    kept = json.loads(RECORD.read_text()) if RECORD.exists() else {}
    conditions = [condition.name for condition in scenes.load(name).conditions]
    own = {row["condition"]: row for row in kept.get(name, [])}
    own |= {row["condition"]: {"of": of} | row for row in found}
    kept[name] = [own[condition] for condition in conditions if condition in own]
    RECORD.write_text(json.dumps(dict(sorted(kept.items())), ensure_ascii=False, indent=1) + "\n")


def cells(name, row):
    """A row of the page's table."""
    low, high = row["dropped_interval"]
    dropped = f"0 (at most {100 * high:.3g} %)"
    if row["dropped"]:
        dropped = f"**{row['dropped']}** ({100 * low:.3g} to {100 * high:.3g} %)"
    stale = "" if row["of"] == digest(name) else " (stale)"
    mm = " / ".join(f"{row[f'{part}_mm_max']:.3f}" for part in ("sag", "ring", "slip"))
    return [
        f"{name}, {row['condition'].removeprefix('first event at ')}{stale}",
        *(str(row["runs"]), dropped, f"{row['grip_ratio_mean']:.3f} / {row['grip_ratio_max']:.2f}"),
        *(str(row["runs_above_ratio"]), f"{row['moved_mm_max']:.3f} mm", f"{mm} mm"),
        f"{row['tightenings'] / row['runs']:.0f}, {row['false_tightenings'] / row['runs']:.2g} a run",
    ]


def page(text, kept):
    """The page's ``text`` with its table filled from ``kept``."""
    before, _, rest = text.partition(HEAD)
    after = rest.partition("\n\n")[2]
    lines = [HEAD, "|" + "---|" * HEAD.count(" | ") + "---|"]
    lines += ["| " + " | ".join(cells(name, row)) + " |" for name, found in kept.items() for row in found]
    return before + "\n".join(lines) + "\n\n" + after


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", nargs="?", choices=scenes.names("hand"))
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--first", type=int, default=1, help="the first seed (1)")
    parser.add_argument("--condition", type=int, help="its number, from 0 on (all)")
    parser.add_argument("--engine", choices=list(PARTS), default="fixed")
    parser.add_argument("--set", nargs="*", default=[], metavar="KEY=VALUE", help="in place of the scene's")
    parser.add_argument("--record", action="store_true", help="keep the rows in docs/grip.json")
    parser.add_argument("--page", action="store_true", help="write docs/grip_scenes.md's table")
    args = parser.parse_args(arguments)
    if not (args.scene or args.page):
        parser.error("a scene is needed, or --page")
    if args.record and (args.set or args.first != 1 or args.engine != "fixed"):
        parser.error("--record is of the scene as it is, seeds 1 on, engine fixed")
    if args.scene:
        scene = changed(scenes.load(args.scene), args.set)
        which = range(len(scene.conditions)) if args.condition is None else [args.condition]
        found, of = [], digest(args.scene)
        for number in which:
            for row in rows(scene, args.runs, number, args.engine, args.first):
                if args.record:  # after each batch, so that a long run that is interrupted keeps its rows
                    record(args.scene, [row], of)
            found.append(row)
        print("\n".join(table(found)))
        count = sum(row["dropped"] for row in found)
        print("dropped:", interval.words(interval.rate(count, sum(row["runs"] for row in found))))
    if args.page or args.record:
        PAGE.write_text(page(PAGE.read_text("utf-8"), json.loads(RECORD.read_text("utf-8"))), "utf-8")


if __name__ == "__main__":
    sys.exit(main())
