"""Run a hand's scene over more seeds than `meissner run` does, and print a row for each condition.

    python tools/published/grip.py grip_pour --runs 1000 --condition 0
    python tools/published/grip.py grip_release --first 1001 --set slip.threshold_quiet=2 step_mm=0.02
    python tools/published/grip.py margins --runs 8      materials, events, thresholds, rates, tugs, constants

--condition takes a number; without it, all conditions run. Settings are chosen on seeds from 1001 on; the
page docs/grip_scenes.md has seeds from 1 on (`make figures FIGURES="grip_scenes"`).
"""

import argparse
import dataclasses
import json

from msgspec import structs

from meissner import interval, scenes
from meissner.builds import toolchain
from meissner.physics import plate, rubber, stepped
from meissner.scenes.hand import loop
from meissner.scenes.hand.run import PARTS, joined, statistics
from meissner.scenes.hand.scene import batches
from meissner.scenes.results import table

PAGE = toolchain.ROOT / "docs/grip_scenes.md"
BEGIN = "<!-- from here on measured: make figures -->"
END = "<!-- measured to here -->"
RUNS = 8  # of each cell of the page; a quarter where the control cycle is 1 ms, which takes ten times as long
SHORT = {  # duration of their runs, and where the hold begins: disturb's tugs end at 8 s
    **{"grip_pour": (30.0, 20.0), "grip_water": (15.0, 11.0)},
    **{"grip_disturb": (30.0, 20.0), "grip_release": (60.0, 30.0)},
}
EVENTS = (1.0, 0.7, 0.5)  # times the size of every event
FIXED, LAW = {"threshold_quiet": 0.0}, {"threshold_quiet": 0.0, "threshold_p2p_share": 0.016}
OWED = (  # one constant that nobody published at a time
    *((rubber, "GROSS_SHARE", value) for value in (25.0, 5.0)),
    *((rubber, "SLIDING_SHARE", value) for value in (1.0, 0.25)),
    *((plate, "RIPPLE_N", value * plate.RIPPLE_N) for value in (2.0, 4.0)),
    *((stepped, "HEAL_S", value) for value in (0.02, 0.5)),
)


def rows(scene, runs, number, engine="fixed", first=1):
    """Yield the row of a condition after each batch of seeds from ``first`` on; the last row covers all."""
    condition, held = scene.conditions[number], []
    for seeds in batches(condition, range(first, first + runs)):
        held.append(loop.hold(scene, condition, seeds, PARTS[engine]))
        yield statistics(condition, joined(held))


def changed(scene, settings):
    """The scene with ``settings`` KEY=VALUE of its conditions, or with a dot, of its table slip or grip."""
    for key, _, value in (one.partition("=") for one in settings):
        name, _, inner = key.rpartition(".")
        if name:
            scene = dataclasses.replace(scene, **{name: getattr(scene, name) | {inner: json.loads(value)}})
        else:
            value = value if key == "material" else float(value)
            all_of = (structs.replace(condition, **{key: value}) for condition in scene.conditions)
            scene = dataclasses.replace(scene, conditions=tuple(all_of))
    return scene


def cell(name, runs, slip=None, world=None, which=0, **changes):
    """A cell of the margins: dropped, mean ratio and largest slip of a condition of the scene, changed."""
    scene, (lasts_s, from_s) = scenes.load(name), SHORT[name]
    condition = structs.replace(scene.conditions[which], **{"duration_s": lasts_s} | changes)
    world = scene.world | {"hold_from_s": from_s} | (world or {})
    scene = dataclasses.replace(scene, slip=scene.slip | (slip or {}), world=world, conditions=(condition,))
    found = statistics(condition, joined([loop.hold(scene, condition, range(1, 1 + runs), PARTS["fixed"])]))
    if found["dropped"] == runs:
        return f"**all {runs}**"
    dropped = f"**{found['dropped']}**" if found["dropped"] else "0"
    return f"{dropped}; {found['grip_ratio_mean']:.2f}, {found['slip_mm_max']:.2f} mm"


def head(*names):
    return ["", "| " + " | ".join(names) + " |", "|" + "---|" * len(names)]


def conditions(runs):
    """Yield the lines of the table of the scenes as they are."""
    yield from head("scene", "0.875", "0.5", "0.12", f"0.875, 1 ms, {runs // 4} runs", "0.875, whole scene")
    for name in SHORT:
        scene = scenes.load(name)
        found = [cell(name, runs, first_event=event) for event in (0.875, 0.5, 0.12)]
        fine = next(k for k, one in enumerate(scene.conditions) if one.cycle_ms == 1)
        found.append(cell(name, runs // 4, which=fine))
        whole = {"hold_from_s": scene.world["hold_from_s"]}
        found.append(cell(name, runs, world=whole, duration_s=scene.world["duration_s"]))
        yield "| " + " | ".join([name, *found]) + " |"


def margins(runs):
    """Yield each line of the tables of what holds and what falls, in Markdown."""
    yield f"Dropped of {runs} runs; mean ratio and largest slip of those that hold."
    yield from conditions(runs)
    yield from head("scene", "material", *(f"events × {size:g}" for size in EVENTS))
    for name in SHORT:
        for material in plate.MATERIALS:
            found = [cell(name, runs, material=material, events=size) for size in EVENTS]
            yield "| " + " | ".join([name, material, *found]) + " |"
    yield from head("scene", "material, events", "quiet sensor's", "0.02 V, published", "law of Vc")
    for name in ("grip_pour", "grip_water", "grip_disturb"):
        for material, size in (("acrylic", 1.0), ("acrylic", 0.5), ("paper", 1.0), ("paper", 0.5)):
            found = [cell(name, runs, slip, material=material, events=size) for slip in ({}, FIXED, LAW)]
            yield "| " + " | ".join([name, f"{material}, × {size:g}", *found]) + " |"
    yield from head("pour rate", "grip_pour, acrylic", "paper", "grip_water, acrylic", "paper")
    for rate in (0.01, 0.02, 0.04, 0.08):
        found = [
            cell(name, runs, world={"pour_kg_s": rate}, material=material)
            for name in ("grip_pour", "grip_water")
            for material in ("acrylic", "paper")
        ]
        yield "| " + " | ".join([f"{1e3 * rate:g} g/s", *found]) + " |"
    yield from head("one tug within 0.4 s", *plate.MATERIALS)
    for newtons in (0.4, 0.8, 1.2, 1.6, 2.0):
        world = {"tugs": [(2.0, 0.4, newtons)]}
        found = [cell("grip_disturb", runs, world=world, material=material) for material in plate.MATERIALS]
        yield "| " + " | ".join([f"{newtons:g} N", *found]) + " |"
    yield from head("constant", "instead of", "value", "grip_pour", "grip_disturb", "grip_disturb, paper")
    for module, key, value in OWED:
        usual = getattr(module, key)
        setattr(module, key, value)
        heal = {"heal_s": value} if key == "HEAL_S" else {}
        found = [cell(name, runs, **heal) for name in ("grip_pour", "grip_disturb")]
        found.append(cell("grip_disturb", runs, material="paper", **heal))
        setattr(module, key, usual)
        yield "| " + " | ".join([key, f"{usual:g}", f"{value:g}", *found]) + " |"


def write(heading):
    """Measure the margins and write the page; returns its path."""
    text = PAGE.read_text("utf-8")
    before, after = text.partition(BEGIN)[0], text.partition(END)[2]
    found = "\n\n".join([BEGIN, heading, "\n".join(margins(RUNS)), END])
    PAGE.write_text(before + found + after, "utf-8")
    return str(PAGE.relative_to(toolchain.ROOT))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", choices=["margins", *scenes.names("hand")])
    parser.add_argument("--runs", type=int, default=RUNS)
    parser.add_argument("--first", type=int, default=1, help="the first seed (1)")
    parser.add_argument("--condition", type=int, help="its number, from 0 on (all)")
    parser.add_argument("--engine", choices=list(PARTS), default="fixed")
    parser.add_argument("--set", nargs="*", default=[], metavar="KEY=VALUE", help="in place of the scene's")
    args = parser.parse_args()
    if args.scene == "margins":
        for line in margins(args.runs):
            print(line, flush=True)
        return
    scene = changed(scenes.load(args.scene), args.set)
    which = range(len(scene.conditions)) if args.condition is None else [args.condition]
    found = [list(rows(scene, args.runs, number, args.engine, args.first))[-1] for number in which]
    print("\n".join(table(found)))
    count = sum(row["dropped"] for row in found)
    print("dropped:", interval.words(interval.rate(count, sum(row["runs"] for row in found))))


if __name__ == "__main__":
    main()
