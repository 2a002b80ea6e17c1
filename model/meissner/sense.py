"""The public interface: the core's computations on a stream, in the core's own integers.

Each class has ``process(x)``, which starts from reset, and ``next(x)``, which continues the last call:
``process(x)`` equals the results of ``next`` over any pieces of ``x``. The numbers are bit-exact with the RTL
(meissner.twins); meissner.engines runs the same on the RTL itself.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meissner.calibration import Calibration, check_codes
from meissner.physics.cop4_config import Cop4Config
from meissner.twins.cop import cop as cop_twin
from meissner.twins.cop import cop4 as cop4_twin
from meissner.twins.frontend.calibrate_taxels import forces
from meissner.twins.slip import slip as slip_twin
from meissner.twins.slip.config import SlipConfig
from meissner.twins.slip.haar import Haar
from meissner.twins.slip.peak_to_peak import PeakToPeak
from meissner.twins.slip.slip import State

MAX_FORCE = 65535


class SlipResult(NamedTuple):
    """Results for every detail (2**level samples); arrays are [channels, details]."""

    p2p: NDArray[np.int64]  # peak-to-peak of the window so far, in codes
    state: NDArray[np.int8]  # twins.slip.slip.State: none, contact, incipient, gross, release
    slips: NDArray[np.bool_]  # the state is incipient or gross
    raised: NDArray[np.bool_]  # ... and was not one detail before


class CopResult(NamedTuple):
    """Results for every frame."""

    x: NDArray[np.int32]  # Q2.14: -16384 at the left edge, 16384 at the right
    y: NDArray[np.int32]  # Q2.14: -16384 at the bottom edge, 16384 at the top
    load: NDArray[np.int64]  # sum of the forces, in codes
    pressed: NDArray[np.bool_]  # x and y are valid


class Slip:
    """Slip of ``channels`` sensors, each with its own state (rtl/slip/msn_slip_path.sv).

    ``config``: thresholds in codes, times in details; ValueError in one sentence for settings of no core.
    """

    def __init__(self, config: SlipConfig | None = None, channels: int = 1) -> None:
        self.config = config = SlipConfig() if config is None else config
        group = 1 << config.level
        self._haar = Haar(channels, config.level)
        self._peak_to_peak = PeakToPeak(channels, config.window // group, config.hop // group)
        self._slip = slip_twin.Slip(channels, config)
        self.channels, self._group = channels, group
        self.reset()

    def reset(self) -> None:
        """Set every channel to no contact and forget all samples."""
        for block in (self._haar, self._peak_to_peak, self._slip):
            block.reset()
        self._slipped = np.zeros((self.channels, 1), dtype=bool)
        self._seen = 0  # samples of the unfinished group

    def next(self, x: ArrayLike, moving: ArrayLike | None = None) -> SlipResult:
        """Decisions about the details that ``x`` completes.

        ``x``: codes, integers of 17 bits [channels, samples], or [samples] of one channel; ``moving``
        [samples]: while the hand itself moves no slip is raised.
        """
        x = np.atleast_2d(np.asarray(x))
        half = 1 << 16
        if x.ndim != 2 or len(x) != self.channels:
            raise ValueError(f"the samples must have the shape [{self.channels}, samples], not {x.shape}")
        if x.dtype.kind not in "iub":
            raise ValueError(f"the samples must be integers, not {x.dtype}")
        if x.size and (x.min() < -half or x.max() >= half):
            raise ValueError(f"the samples lie in {x.min()} .. {x.max()}, outside {-half} .. {half - 1}")
        detail, total = self._haar.next(x)
        if moving is not None:
            moving = np.asarray(moving, dtype=bool)
            if moving.shape != x.shape[1:]:
                raise ValueError(f"moving must have the shape {x.shape[1:]}, not {moving.shape}")
            moving = moving[self._group - 1 - self._seen :: self._group]
        self._seen = (self._seen + x.shape[1]) % self._group
        p2p, _ = self._peak_to_peak.next(detail)
        state = self._slip.next(p2p, total, moving)
        slips = (state == State.INCIPIENT) | (state == State.GROSS)
        before = np.concatenate([self._slipped, slips], axis=1)
        self._slipped = before[:, -1:]
        return SlipResult(p2p, state, slips, slips & ~before[:, :-1])

    def process(self, x: ArrayLike, moving: ArrayLike | None = None) -> SlipResult:
        """``reset``, then ``next``."""
        self.reset()
        return self.next(x, moving)


class Cop:
    """Centre of pressure and load of frames of forces (rtl/cop/msn_cop.sv); no state between frames.

    ``min_load``: the smallest sum with a valid position.
    """

    def __init__(self, min_load: int = 1) -> None:
        self.min_load = min_load

    def next(self, forces: ArrayLike) -> CopResult:
        """Results for ``forces``, integers 0 .. 65535 [frames, rows, columns]."""
        forces = np.asarray(forces)
        if forces.ndim != 3 or 0 in forces.shape:
            raise ValueError(f"the forces must have the shape [frames, rows, columns], not {forces.shape}")
        if forces.dtype.kind not in "iub" or forces.min() < 0 or forces.max() > MAX_FORCE:
            raise ValueError(f"the forces must be integers in 0 .. {MAX_FORCE}")
        return CopResult(*cop_twin.cop(forces, min_load=self.min_load))

    process = next


class Array:
    """A calibrated array: codes to forces to the centre of pressure (rtl/cop/msn_cop_array.sv).

    ``calibration``: from meissner.calibration.load or ``fit``; faulty cells give 0. ``min_load``: as in Cop.
    """

    def __init__(self, calibration: Calibration, min_load: int = 1) -> None:
        self.calibration, self._cop = calibration, Cop(min_load)

    def forces(self, codes: ArrayLike) -> NDArray[np.int64]:
        """Forces 0 .. 65535 of codes, integers of 17 bits [frames, rows, columns]."""
        own = self.calibration
        codes = check_codes(codes, own.offset.shape)
        return forces(codes, own.offset, own.gain, own.gain_shift, mask=own.dead)

    def next(self, codes: ArrayLike) -> CopResult:
        """Results for codes, integers of 17 bits [frames, rows, columns]."""
        return self._cop.next(self.forces(codes))

    process = next


class Cop4:
    """Position and load of the published four-wire sensor (rtl/cop/msn_cop4.sv); no state between samples.

    ``config``: meissner.physics.cop4_config.Cop4Config, with mesh, amplifiers and converter.
    """

    def __init__(self, config: Cop4Config) -> None:
        self.config = config

    def next(self, codes: ArrayLike) -> cop4_twin.Cop4:
        """x, y, load, pressed and faults [samples] of the codes of E1 to E4, integers [samples, 4]."""
        own = self.config
        return cop4_twin.cop4(codes, own.registers, own.sample_bits, own.terms)

    process = next
