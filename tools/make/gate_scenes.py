"""Run every scene on the twins, the Verilated RTL and its netlist: `python tools/make/gate.py --scenes`.

A scene runs on the engine `gate` as in `meissner run`; each call to the netlist is repeated with the same
arguments on the RTL and the twins. A scene with seeds runs its first seed in every condition, to the end. A
scene of the hand runs HAND_S seconds only, since two cores then advance clock by clock with the physics.
"""

import dataclasses
import math
import tempfile
import time
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from unittest.mock import patch

import numpy as np
from msgspec import structs

from meissner import run as runs
from meissner import scenes
from meissner.engines import features, fixed, gate, rtl_hand
from meissner.engines.features import FEATURE_OF, FEATURES, function
from meissner.scenes.hand import loop

HAND_S = 3.0  # of each condition: the pour, the tugs and the slips of a release all begin within it
SOON = {"pour_start_s": 0.2, "hold_from_s": 0.2}
TUGS = ((0.4, 0.4), (1.1, 0.3), (1.7, 0.05))  # start and length in seconds
RELEASE = {"decay_mm_s": 0.2, "calm_decay_share": 0.5}  # for the scene that else lets go ten times slower


def leaves(answer, name=""):
    """{name: array} of an engine's result: dataclass, dictionary, tuple or array."""
    if dataclasses.is_dataclass(answer):
        parts = {field.name: getattr(answer, field.name) for field in dataclasses.fields(answer)}
    elif isinstance(answer, dict):
        parts = answer
    elif isinstance(answer, tuple):
        parts = answer._asdict() if hasattr(answer, "_asdict") else dict(enumerate(answer))
    else:
        return {name or "result": np.asarray(answer)}
    return {
        path: array for key, part in parts.items() for path, array in leaves(part, f"{name}.{key}").items()
    }


class Compared:
    """Calls to the engines and their results. ``different``: {(stage, engine, result): number of values}."""

    def __init__(self):
        self.inputs, self.results, self.different = 0, 0, {}

    def note(self, stage, count, netlist, others):
        """Compare the netlist's result for ``count`` numbers with {engine: result} for the same numbers."""
        found = leaves(netlist)
        self.inputs += count
        self.results += sum(array.size for array in found.values())
        for engine, answer in others.items():
            wanted = leaves(answer)
            for name in found.keys() | wanted.keys():
                ours, theirs = found.get(name), wanted.get(name)
                if ours is None or theirs is None or ours.shape != theirs.shape:
                    wrong = max(array.size for array in (ours, theirs) if array is not None)
                else:
                    wrong = int((ours != theirs).sum())
                if wrong:
                    key = stage, engine, name.lstrip(".")
                    self.different[key] = self.different.get(key, 0) + wrong

    def stage(self, name):
        """The engine function ``name``, run on all three; it returns the netlist's result."""
        netlist, source, twin = (function(engine, name, None) for engine in ("gate", "rtl", "fixed"))

        def ask(x, *settings, waves=None):
            assert waves is None  # only engine rtl records signals
            found = netlist(x, *settings)
            others = {"rtl": source(x, *settings)}
            if name == "watch_pins":  # the twins have no such function; they get the same samples and motion
                watched = fixed.watch(x.codes[None], *settings, x.moving)
                others["fixed"], x = replace(found, watched=watched), x.codes
            else:
                others["fixed"] = twin(x, *settings)
            self.note(name, np.size(x), found, others)
            return found

        return ask

    def hand(self, *arguments):
        """A hand's core that steps netlist and RTL together; it compares them and returns the netlist's."""
        return _Pair(self, gate_core(*arguments), rtl_hand.Core(*arguments))

    @contextmanager
    def watching(self):
        """A context in which the engine ``gate`` compares."""
        with ExitStack() as stack:
            for name in FEATURE_OF:
                if name in FEATURES:
                    stack.enter_context(patch.dict(features.of(name), gate=self.stage(name)))
                else:
                    stack.enter_context(patch.object(gate, name, self.stage(name)))
            stack.enter_context(patch.object(loop.Netlists, "core", staticmethod(self.hand)))
            yield self


gate_core = loop.Netlists.core


class _Pair:
    def __init__(self, compared, netlist, source):
        self.compared, self.netlist, self.source = compared, netlist, source

    def __setitem__(self, name, value):
        self.netlist[name] = self.source[name] = value

    def next(self, codes):
        found = self.netlist.next(codes)
        self.compared.note("hand", np.size(codes), found, {"rtl": self.source.next(codes)})
        return found


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
    """The ``Compared`` of a scene, and the summary of its run."""
    compared = Compared()
    with compared.watching(), tempfile.TemporaryDirectory() as out:
        summary = runs.run(scene, "gate", out)
    return compared, summary


def table(names):
    """Print a line for each scene; True if any differs, or compares nothing."""
    print(f"{'scene':20} {'numbers in':>11} {'results':>11}  same", flush=True)
    wrong = False
    for name in names:
        began = time.monotonic()
        compared, summary = compare(stretch(scenes.load(name)))
        same = not compared.different and summary["twin_mismatches"] == 0 and compared.results > 0
        wrong |= not same
        took = math.ceil(time.monotonic() - began)
        verdict = "the same" if same else "DIFFERENT"
        print(f"{name:20} {compared.inputs:11} {compared.results:11}  {verdict}; {took} s", flush=True)
        for (stage, engine, result), count in sorted(compared.different.items()):
            print(f"    {stage}: {count} values of {result} are not those of {engine}", flush=True)
        if summary["twin_mismatches"]:
            print(f"    {summary['twin_mismatches']} mismatches of the run itself", flush=True)
    return wrong
