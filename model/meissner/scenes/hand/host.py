"""The host of a holding hand: it reads Vc and the command, and writes three registers.

    threshold = threshold_share of Vc (1 - Vc/5 V)        scene.threshold; every FOLLOW_S
    step      = step_share of the grip, in calm calm_share of it; the grip follows from Vc; every LOOK_S
    decay     = decay_mm_s, in calm calm_decay_share of the grip per second

It is calm if no look in the last ``guard_s`` found the grip raised by the share RISE since the look before.
docs/grip_scenes.md explains why these are shares, and why calm has its own settings. A scene without these
keys keeps its step and decay, and so does a condition with its own step.
"""

import numpy as np

from meissner.physics import rubber
from meissner.physics.hand import GRIP_N_MM

FOLLOW_S, LOOK_S = 1.0, 0.2
RISE = 0.025  # share of the grip: that rise in LOOK_S is a tug; answers while letting go are a tenth of it
_NEWTONS = np.geomspace(10.0, 0.02, 2000)
_VOLTS = rubber.rest_volts(_NEWTONS)


def grip_n(vc_v):
    """Newtons for a Vc without shear: the inverse of the sensor's calibration."""
    return np.interp(vc_v, _VOLTS, _NEWTONS)


class Host:
    """The hosts of all runs of a condition; ``vc_v`` [runs]: before the first cycle."""

    def __init__(self, scene, condition, reflexes, vc_v):
        self.scene, self.condition, self.reflexes, self.vc_v = scene, condition, reflexes, vc_v
        self.threshold = None
        self.follow, self.look = (self._cycles(seconds) for seconds in (FOLLOW_S, LOOK_S))
        self.share, self.calm_share = scene.steps["step_share"], scene.steps["calm_share"]
        if condition.step_mm is not None:
            self.share = 0.0
        self.guard = self._cycles(scene.steps["guard_s"])
        self.command = self.seen = None  # the newest command, and the one at the last look
        self.raised_at = np.zeros(len(vc_v), dtype=np.int64)  # cycle of the last look that found a tug
        self.decay = scene.decay(condition)
        self.calm_decay = scene.steps["calm_decay_share"] * condition.cycle_ms / 1000  # per cycle

    def _cycles(self, seconds):
        return round(seconds * 1000 / self.condition.cycle_ms)

    def write(self, cycle):
        """Write the registers before the samples of ``cycle``."""
        if cycle % self.follow == 0:
            self.threshold = self.scene.threshold(self.condition, self.vc_v)
            self.reflexes.compare_with(self.threshold)
        if self.share and cycle % self.look == 0:
            closing_mm = grip_n(self.vc_v) / GRIP_N_MM
            if self.seen is not None:
                raised_mm = (self.command - self.seen) * self.condition.count_mm
                self.raised_at[raised_mm >= RISE * closing_mm] = cycle
            self.seen = self.command
            calm = (cycle - self.raised_at > self.guard) & (self.calm_share > 0)
            closing = closing_mm / self.condition.count_mm
            steps = np.rint(np.where(calm, self.calm_share, self.share) * closing)
            decays = np.where(calm, np.rint(self.calm_decay * closing), self.decay)
            self.reflexes.answer_by(np.maximum(steps, 1).astype(np.int64), decays.astype(np.int64))

    def read(self, vc_v, command):
        """Take Vc and the command after a cycle; both [runs]."""
        self.vc_v, self.command = vc_v, command
