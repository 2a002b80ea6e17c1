"""A scene of tactile pins, as a page plays it: what the display shows, drive by drive; of kind touch, what
both sensors feel, on the pins."""

from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np

from meissner.engines.features import function
from meissner.engines.features.render.engines import Felt
from meissner.physics.capacitive import GRAM_N
from meissner.scenes.capacitive.play import frames
from meissner.scenes.grip.play import wires
from meissner.scenes.optacon.scene import simulate
from meissner.scenes.played import Pins
from meissner.twins.actuate.render import RenderSettings

LEAST_S = 0.3  # of a steady drive


def _pins(found, seconds, scene):
    """``found``: (second, hz, levels [rows, columns]) of each frame; the Pins of those that are new."""
    new = [True, *(not np.array_equal(one[2], other[2]) for one, other in pairwise(found))]
    shown = [one for one, differs in zip(found, new) if differs]
    return Pins(rate_hz=1.0, frames=shown, span=seconds, bits=scene.sizes[0].amplitude_bits)


def _drives(scene, seed):
    """Each drive, one after the other."""
    found, start_s, drives = [], 0.0, simulate(scene, seed).drives
    hertz = np.broadcast_to(scene.world["hz"], len(drives)).tolist()
    for (size, settings, given), hz in zip(drives, hertz):
        shown = function("fixed", "pin_display")(given, size, settings).levels[1:]  # the first is silent
        grid = scene.grids[scene.sizes.index(size)]
        found += [(start_s + at / hz, hz, levels.reshape(grid)) for at, levels in enumerate(shown)]
        start_s += max(LEAST_S, len(shown) / hz)
    return _pins(found, start_s, scene)


def _pad(scene, seed):
    """The object on the pad; a frame every frame_ms."""
    return replace(frames(scene.sensors[0], seed), rate_hz=1000 / scene.world["frame_ms"])


def _wires(scene, seed):
    return wires(scene.sensors[1], seed, cop=False)


def _touch(scene, seed):
    """The pad's image on the pins, and stripes while the four wires feel a slip."""
    pad, held, world = _pad(scene, seed), _wires(scene, seed), scene.world
    cop, decisions = function("fixed", "cop_slip")(held.codes, held.config, held.lag, held.registers)
    step = round(held.rate_hz / pad.rate_hz)
    at = np.arange(step - 1, len(held.codes), step)
    felt = Felt(
        pad.forces[np.arange(len(at)) % len(pad.forces)].astype(np.int64),
        decisions.slip[at],
        decisions.octant[at].astype(np.int64),
        cop.pressed[at],
        np.stack([cop.x[at], cop.y[at]], axis=1).astype(np.int64),
    )
    codes = (max(1, round(world[key] * GRAM_N / pad.units.newtons_per_code)) for key in ("floor_g", "step_g"))
    settings = RenderSettings(*codes, cue=world["cue_frames"])
    levels = function("fixed", "render")(felt, scene.grids[0], scene.sizes[0].amplitude_bits, settings)
    found = [(k / pad.rate_hz, world["hz"], one) for k, one in enumerate(levels)]
    return _pins(found, len(levels) / pad.rate_hz, scene)


def played(scene):
    return [
        partial(part, scene) for part in ((_pad, _wires, _touch) if scene.kind == "touch" else (_drives,))
    ]
