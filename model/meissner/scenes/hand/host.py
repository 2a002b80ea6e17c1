"""What a host does while the hand holds: it reads Vc and the command, and writes three registers.

    threshold = threshold_share of Vc (1 - Vc/5 V)        scene.threshold; every FOLLOW_S
    step      = step_share of the grip, in calm calm_share of it; the grip is what Vc stands for; every LOOK_S
    decay     = decay_mm_s, in calm calm_decay_share of the grip a second

It is calm when no look in the last ``guard_s`` found the grip raised by RISE of itself since the look before.
Why a share, and why calm has settings of its own: docs/grip_scenes.md. A scene without these keys keeps its
step and its decay, and so does a condition with a step of its own.
"""

import numpy as np

from meissner.physics import rubber
from meissner.physics.hand import GRIP_N_MM

FOLLOW_S, LOOK_S = 1.0, 0.2
RISE = 0.025  # of the grip, in LOOK_S: a tug; letting go is answered with a tenth of it at a time
_NEWTONS = np.geomspace(10.0, 0.02, 2000)
_VOLTS = rubber.rest_volts(_NEWTONS)


def grip_n(vc_v):
    """Newtons that a Vc stands for without shear: the calibration of the sensor, turned round."""
    return np.interp(vc_v, _VOLTS, _NEWTONS)


class Host:
    """Of all runs of a condition; ``vc_v`` [runs]: before the first cycle."""

    def __init__(self, scene, condition, stage, vc_v):
        self.scene, self.condition, self.stage, self.vc_v = scene, condition, stage, vc_v
        self.threshold = None
        self.follow, self.look = (self._cycles(seconds) for seconds in (FOLLOW_S, LOOK_S))
        self.share, self.calm_share = scene.steps["step_share"], scene.steps["calm_share"]
        if condition.step_mm is not None:
            self.share = 0.0
        self.guard = self._cycles(scene.steps["guard_s"])
        self.command = self.seen = None  # the newest, and at the last look
        self.raised_at = np.zeros(len(vc_v), dtype=np.int64)  # the cycle of the last look that found a tug
        self.decay = scene.decay(condition)
        self.calm_decay = scene.steps["calm_decay_share"] * condition.cycle_ms / 1000  # a cycle

    def _cycles(self, seconds):
        return round(seconds * 1000 / self.condition.cycle_ms)

    def write(self, cycle):
        """Before the samples of ``cycle``."""
        if cycle % self.follow == 0:
            self.threshold = self.scene.threshold(self.condition, self.vc_v)
            self.stage.compare_with(self.threshold)
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
            self.stage.answer_by(np.maximum(steps, 1).astype(np.int64), decays.astype(np.int64))

    def read(self, vc_v, command):
        """After a cycle; both [runs]."""
        self.vc_v, self.command = vc_v, command
