"""The host of a holding hand: it reads Vc, the command and the packets, and writes four registers.

    threshold = threshold_quiet times the quiet sensor's peak to peak (``quiet_v``), once
    step      = step_share of the grip, in calm calm_share of it; the grip follows from Vc; every LOOK_S
    decay     = decay_mm_s, in calm calm_decay_share of the grip per second
    minimum   = the command + gross_share of the grip at each gross slip, every ANSWER_S; then it falls by
                floor_decay_share of the grip per second: a floor that follows the load

With threshold_p2p_share the threshold is that share of Vc (1 - Vc/5 V) instead, every FOLLOW_S. It
is calm if no look in the last ``guard_s`` found the grip raised by the share RISE since the look before.
docs/grip_scenes.md explains why these are shares, and why calm has its own settings. A scene without these
keys keeps its step and decay, and so does a condition with its own step.
"""

import numpy as np

from meissner.physics import plate, rubber
from meissner.physics.hand import GRIP_N_MM, RIPPLE_N_S
from meissner.physics.stepped import Ripple
from meissner.twins.slip.haar import Haar
from meissner.twins.slip.peak_to_peak import PeakToPeak

FOLLOW_S, LOOK_S, ANSWER_S = 1.0, 0.2, 0.01
CLOSE_N_S, CLOSE_N = 1.0, 3.0  # the hand closes at this speed, to this force, while it measures quiet_v
RISE = 0.025  # share of the grip: that rise in LOOK_S is a tug; answers while letting go are a tenth of it
_NEWTONS = np.geomspace(10.0, 0.02, 2000)
_VOLTS = rubber.rest_volts(_NEWTONS)


def grip_n(vc_v):
    """Newtons for a Vc without shear: the inverse of the sensor's calibration."""
    return np.interp(vc_v, _VOLTS, _NEWTONS)


def quiet_v(scene, condition, seeds):
    """Volts [runs]: the largest peak to peak that either finger's windows have while the hand closes on
    something that does not move. It is the converter's noise and the hand's own ripple: no slip is in it.
    """
    count = round(CLOSE_N / CLOSE_N_S * scene.rate_hz)
    rngs = [np.random.default_rng([seed, scene.conditions.index(condition), 2]) for seed in seeds]
    ripple_n = plate.RIPPLE_N * min(1.0, CLOSE_N_S / RIPPLE_N_S) * Ripple(scene.rate_hz, rngs).next(count)
    volts = rubber.rest_volts(np.maximum(CLOSE_N_S / scene.rate_hz * np.arange(count) + ripple_n, 1e-6))
    noise_v = scene.adc.noise_v * np.stack([rng.standard_normal((2, count)) for rng in rngs])
    codes, _ = scene.adc.convert((scene.front().next(volts)[:, None] + noise_v).reshape(-1, count))
    config = scene.slip_config(condition)
    span = config.window >> config.level
    detail, _ = Haar(len(codes), config.level).next(codes)
    p2p, _ = PeakToPeak(len(codes), span, span).next(detail)
    return scene.adc.lsb_v / 2 ** (config.level / 2) * p2p.reshape(len(rngs), -1).max(axis=1)


class Host:
    """The hosts of all runs of a condition; [runs]: ``vc_v`` before the first cycle, ``quiet_v`` as above."""

    def __init__(self, scene, condition, reflexes, vc_v, quiet_v):
        self.quiet_v = quiet_v
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
        self.answer, self.gross_share = self._cycles(ANSWER_S), scene.steps["gross_share"]
        self.settings = scene.grip_config(condition)
        self.floor = np.full(len(vc_v), float(self.settings.minimum))
        self.floor_decay = scene.steps["floor_decay_share"] * ANSWER_S
        self.gross = np.zeros(len(vc_v), dtype=bool)  # since the last answer

    def _cycles(self, seconds):
        return round(seconds * 1000 / self.condition.cycle_ms)

    def write(self, cycle):
        """Write the registers before the samples of ``cycle``."""
        if cycle % self.follow == 0:
            self.threshold = self.scene.threshold(self.condition, self.vc_v, self.quiet_v)
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
        if self.gross_share and cycle % self.answer == 0:
            closing = grip_n(self.vc_v) / GRIP_N_MM / self.condition.count_mm
            floor = np.maximum(self.floor - self.floor_decay * closing, self.settings.minimum)
            if self.gross.any():
                raised = np.minimum(self.command + self.gross_share * closing, self.settings.maximum)
                floor = np.where(self.gross, np.maximum(floor, raised), floor)
                self.gross[:] = False
            self.floor = floor
            self.reflexes.hold_above(np.rint(floor).astype(np.int64))

    def free(self, cycle):
        """The number of cycles from this one on before ``write`` may change a register again."""
        answers = self.gross_share and (self.gross.any() or (self.floor > self.settings.minimum).any())
        every = (self.follow, self.look, *([self.answer] if answers else []))
        return min(one - cycle % one for one in every)

    def read(self, vc_v, command, gross):
        """Take Vc, the command, and whether a finger slipped gross, after a cycle; all [runs]."""
        self.vc_v, self.command = vc_v, command
        self.gross |= gross
