"""A scene of the capacitive pad, as a page plays it: demodulated and calibrated. Kind crosstalk has no pad,
and no packet carries its amplitudes."""

from functools import partial

import numpy as np

from meissner import engines
from meissner.builds.units import Units
from meissner.physics.capacitive import PITCH_MM
from meissner.scenes.capacitive.judge import calibrated
from meissner.scenes.capacitive.scene import CALIBRATED_BY, simulate
from meissner.scenes.played import Frames

SHOWN = {"cell": ("cycles",), "select": ("steps",)}  # of kind shapes: every object, one after the other


def frames(scene, seed):
    """Frames of forces, with the calibration that the scene's run uses."""
    recording, (*_, way) = simulate(scene, seed), CALIBRATED_BY[scene.kind]
    parts = recording.parts
    codes = lambda name: engines.demodulate(parts[name].samples, scene.carrier, "fixed")
    lines = calibrated(parts[way], codes(way)).lines
    shown = SHOWN.get(scene.kind) or scene.world["shapes"]
    forces = engines.calibrate(np.concatenate([codes(name) for name in shown]), lines, "fixed")
    units = Units(newtons_per_code=lines.force_lsb_n, pitch_mm=PITCH_MM)
    return Frames(rate_hz=parts[shown[0]].rate_hz, span=len(forces), units=units, forces=forces)


def played(scene):
    return [] if scene.kind == "crosstalk" else [partial(frames, scene)]
