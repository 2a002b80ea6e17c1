"""Run every scene on the twins, the Verilated RTL and its netlist: `python tools/make/gate.py --scenes`.

A run on the engine `rtl` or `gate` compares every result of the core with the integer twins'; here both must
equal them, and so each other, in as many clocks at the converter's pins. A scene with seeds runs its first
seed in every condition, to the end. A scene of the hand runs HAND_S seconds only, since its core advances
clock by clock with the physics.
"""

import math
import tempfile
import time
from dataclasses import replace

from msgspec import structs

from meissner import run as runs
from meissner import scenes

HAND_S = 3.0  # of each condition: the pour, the tugs and the slips of a release all begin within it
SOON = {"pour_start_s": 0.2, "hold_from_s": 0.2}
TUGS = ((0.4, 0.4), (1.1, 0.3), (1.7, 0.05))  # start and length in seconds
RELEASE = {"decay_mm_s": 0.2, "calm_decay_share": 0.5}  # for the scene that else lets go ten times slower


def stretch(scene):
    """The part of a scene that is run; see the module's docstring."""
    if scene.sensor == "hand":
        world = scene.world | SOON
        world["tugs"] = [(*when, newtons) for when, (_, _, newtons) in zip(TUGS, scene.world["tugs"])]
        grip = scene.grip | (RELEASE if scene.name == "grip_release" else {})
        conditions = tuple(structs.replace(condition, duration_s=HAND_S) for condition in scene.conditions)
        scene = replace(scene, conditions=conditions, world=world, grip=grip)
    return replace(scene, seeds=1) if hasattr(scene, "seeds") else scene


def compare(scene):
    """(a sentence for each difference, the summary on engine gate)."""
    found, said = {}, []
    for engine in ("rtl", "gate"):
        with tempfile.TemporaryDirectory() as out:
            found[engine] = runs.run(scene, engine, out)
        if (count := found[engine]["twin_mismatches"]) != 0:  # None: nothing was compared
            said.append(f"{count} results on {engine} are not the twins'")
    if found["rtl"].get("pins") != found["gate"].get("pins"):
        said.append(f"at the pins {found['rtl']['pins']} on rtl, {found['gate']['pins']} on gate")
    return said, found["gate"]


def table(names):
    """Print a line for each scene; True if any differs, or compares nothing."""
    wrong = False
    for name in names:
        began = time.monotonic()
        said, _ = compare(stretch(scenes.load(name)))
        wrong |= bool(said)
        took = math.ceil(time.monotonic() - began)
        print(f"{name:20} {'DIFFERENT' if said else 'the same'}; {took} s", flush=True)
        print(*(f"    {line}\n" for line in said), sep="", end="", flush=True)
    return wrong
