"""A scene of a resistive matrix, as a page plays it: calibrated as its run does."""

from functools import partial

from meissner import calibration, engines
from meissner.builds.units import Units
from meissner.scenes.fsr.scene import simulate
from meissner.scenes.played import Frames


def calibrated(codes, pressed, rate_hz, min_load_n):
    """Frames of ``codes``; ``pressed``: (codes, forces) of even presses."""
    lines, _ = calibration.fit(*pressed)
    units = Units(newtons_per_code=lines.force_lsb_n)
    forces = engines.calibrate(codes, lines, "fixed")
    given = {"rate_hz": rate_hz, "span": len(codes), "units": units}
    return Frames(**given, forces=forces, min_load=units.load_code(min_load_n))


def _frames(scene, seed):
    recording = simulate(scene, seed)
    return calibrated(recording.codes, recording.parts["calibration"], scene.rate_hz, scene.min_load_n)


def played(scene):
    return [partial(_frames, scene)]
