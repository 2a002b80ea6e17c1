"""The public interface: the core's computations on a stream, in the core's own integers.

Each class has ``process(x)``, which starts from reset, and ``next(x)``, which continues the last call:
``process(x)`` equals the results of ``next`` over any pieces of ``x``. The numbers are bit-exact with the RTL
(meissner.twins); meissner.engines runs the same on the RTL itself. Results have the names of the arrays that
``meissner process`` writes (OUT.npz); docs/decisions/host.md lists what each class adds.

In place of an array each takes the path of a recording, or a Recording of meissner.read, whose codes it uses.

Input that the core cannot take raises ValueError, an argument of the wrong class TypeError, each with one
sentence. Floats are refused even if they are whole, since volts are a common mistake.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meissner.calibration import Calibration
from meissner.inputs import (
    check_codes,
    check_electrodes,
    check_forces,
    check_kind,
    check_min_load,
    check_range,
)
from meissner.physics.cop4_config import Cop4Config
from meissner.readers import taken
from meissner.twins.cop import cop4 as cop4_twin
from meissner.twins.cop.cop import cop_divide, moments
from meissner.twins.frontend.calibrate import forces
from meissner.twins.slip import slip as slip_twin
from meissner.twins.slip.config import SlipConfig
from meissner.twins.slip.haar import Haar
from meissner.twins.slip.peak_to_peak import PeakToPeak
from meissner.twins.slip.slip import State


class SlipResult(NamedTuple):
    """Slip of the windows that close, named as in OUT.npz, and of every detail (2**level samples).

    Attributes
    ----------
    p2p : int64 [channels, windows]
        Peak-to-peak of the window, in codes.
    window_end : int64 [windows]
        Index of the window's last sample, counted from the last reset.
    slip : bool [channels, windows]
        ``p2p`` exceeds the threshold. The core's own decision, which also depends on contact, hold, blanking
        and movement, is ``state``.
    fired_at : int64 [channels, windows]
        Index of the sample at which ``slip`` rose in the window, or -1.
    running_p2p : int64 [channels, details]
        Peak-to-peak of the window so far, in codes.
    state : int8 [channels, details]
        meissner.twins.slip.slip.State: none, contact, incipient, gross, release.
    slipping : bool [channels, details]
        The state is incipient or gross.
    raised : bool [channels, details]
        ``slipping``, and not one detail before.
    """

    p2p: NDArray[np.int64]
    window_end: NDArray[np.int64]
    slip: NDArray[np.bool_]
    fired_at: NDArray[np.int64]
    running_p2p: NDArray[np.int64]
    state: NDArray[np.int8]
    slipping: NDArray[np.bool_]
    raised: NDArray[np.bool_]


class CopResult(NamedTuple):
    """The centre of pressure of every frame, named as in OUT.npz.

    Attributes
    ----------
    x, y : int32 [frames]
        Q2.14: -16384 at the left and the bottom edge, 16384 at the right and the top.
    sum : int64 [frames]
        Of the forces, in codes.
    valid : bool [frames]
        ``sum`` reaches ``min_load``: ``x`` and ``y`` are valid.
    mx, my : int64 [frames]
        First moments: x = mx / ((columns - 1) sum), in half pitches times codes.
    """

    x: NDArray[np.int32]
    y: NDArray[np.int32]
    sum: NDArray[np.int64]
    valid: NDArray[np.bool_]
    mx: NDArray[np.int64]
    my: NDArray[np.int64]


class Cop4Result(NamedTuple):
    """Position and load of every sample, named as in OUT.npz, and what is wrong with it.

    Attributes
    ----------
    x, y : int32 [samples]
        Q2.14, as in CopResult.
    load : int64 [samples]
        In units of ``Cop4Config.load_lsb_n`` newtons.
    valid : bool [samples]
        Loaded and without faults: ``x`` and ``y`` are valid.
    over : bool [samples]
        The load exceeds its 16 bits.
    saturated : bool [samples]
        An electrode is at the end of the converter's range.
    imbalance : bool [samples]
        The electrodes' currents disagree.
    open : int64 [samples]
        Electrodes without contact; bit 0 is E1.
    """

    x: NDArray[np.int32]
    y: NDArray[np.int32]
    load: NDArray[np.int64]
    valid: NDArray[np.bool_]
    over: NDArray[np.bool_]
    saturated: NDArray[np.bool_]
    imbalance: NDArray[np.bool_]
    open: NDArray[np.int64]


def _check_class(name: str, value: object, wanted: type) -> None:
    if not isinstance(value, wanted):
        raise TypeError(f"{name} must be a meissner.{wanted.__name__}, not {type(value).__name__}")


class Slip:
    """Slip of several sensors, each with its own state (rtl/slip/msn_slip_path.sv).

    Parameters
    ----------
    config : SlipConfig, optional
        Thresholds in codes, times in details; the defaults of SlipConfig.
    channels : int
        Number of sensors.

    Raises
    ------
    TypeError
        If ``config`` is no SlipConfig.
    ValueError
        For a number of channels that no core has.
    """

    def __init__(self, config: SlipConfig | None = None, channels: int = 1) -> None:
        self.config = config = SlipConfig() if config is None else config
        _check_class("config", config, SlipConfig)
        if not isinstance(channels, int | np.integer):
            raise ValueError(f"channels = {channels} must be an integer")
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
        self._over = np.zeros((self.channels, 0), dtype=bool)  # of the details of the unfinished window
        self._seen = 0  # samples

    def next(self, x: ArrayLike, moving: ArrayLike | None = None) -> SlipResult:
        """Decisions about the details and windows that ``x`` completes.

        Parameters
        ----------
        x : integers [channels, samples], or [samples] of one channel
            Codes of 17 bits; it may be empty.
        moving : bool [samples], optional
            The hand itself moves: no slip is raised.

        Raises
        ------
        ValueError
            For another shape, floats and codes of more than 17 bits; the state then stays.
        """
        x = np.atleast_2d(np.asarray(taken(x)))
        if x.ndim != 2 or len(x) != self.channels:
            raise ValueError(f"the samples must have the shape [{self.channels}, samples], not {x.shape}")
        if x.size:  # NumPy takes an empty list for floats
            check_range(check_kind(x, "samples", floats=False))
        if moving is not None:
            moving = check_kind(moving, "values of moving", floats=x.size == 0).astype(bool)
            if moving.shape != x.shape[1:]:
                raise ValueError(f"moving must have the shape {x.shape[1:]}, not {moving.shape}")
            moving = moving[self._group - 1 - self._seen % self._group :: self._group]
        first = self._seen // self._group
        self._seen += x.shape[1]
        detail, total = self._haar.next(x)
        running, end = self._peak_to_peak.next(detail)
        state = self._slip.next(running, total, moving)
        slipping = (state == State.INCIPIENT) | (state == State.GROSS)
        before = np.concatenate([self._slipped, slipping], axis=1)
        self._slipped = before[:, -1:]
        window_end = (first + np.flatnonzero(end) + 1) * self._group - 1
        over = running > self.config.threshold
        windows = (running[:, end], window_end, over[:, end], self._fired(over, window_end, over[:, end]))
        return SlipResult(*windows, running, state, slipping, slipping & ~before[:, :-1])

    def _fired(
        self, over: NDArray[np.bool_], window_end: NDArray[np.int64], slip: NDArray[np.bool_]
    ) -> NDArray[np.int64]:
        """The sample at which the flag of each window rose: in tumbling windows, its first detail over."""
        rose = np.broadcast_to(window_end, slip.shape)
        if self.config.hop == self.config.window:
            over = np.concatenate([self._over, over], axis=1)
            span = self.config.window // self._group
            whole = len(window_end) * span
            self._over = over[:, whole:]
            inside = over[:, :whole].reshape(self.channels, len(window_end), span)
            rose = window_end - self.config.window + (inside.argmax(axis=2) + 1) * self._group
        return np.where(slip, rose, -1)

    def process(self, x: ArrayLike, moving: ArrayLike | None = None) -> SlipResult:
        """``reset``, then ``next``, with the errors of ``next``."""
        self.reset()
        return self.next(x, moving)


class Cop:
    """Centre of pressure and sum of frames of forces (rtl/cop/msn_cop.sv); no state between frames.

    Parameters
    ----------
    min_load : int
        The smallest sum with a valid position, in codes.

    Raises
    ------
    ValueError
        If no core's register holds ``min_load``.
    """

    def __init__(self, min_load: int = 1) -> None:
        self.min_load = check_min_load(min_load)

    def next(self, forces: ArrayLike) -> CopResult:
        """Results for frames of forces.

        Parameters
        ----------
        forces : integers [frames, rows, columns]
            0 .. 65535, of 1024 × 1024 taxels at most.

        Raises
        ------
        ValueError
            For another shape, no frames, floats, forces out of range and a ``min_load`` beyond the register
            of an array of this size.
        """
        forces = check_forces(taken(forces), floats=False)
        rows, columns = forces.shape[1:]
        check_min_load(self.min_load, rows, columns)
        total, mx, my = moments(forces)
        x, y, valid = cop_divide(total, mx, my, rows, columns, min_load=self.min_load)
        return CopResult(x, y, total, valid, mx, my)

    def process(self, forces: ArrayLike) -> CopResult:
        """The same as ``next``."""
        return self.next(forces)


class Array:
    """A calibrated array: codes to forces to the centre of pressure (rtl/sensor/msn_array_forces.sv).

    Parameters
    ----------
    calibration : Calibration
        From meissner.calibration.load or ``fit``; faulty cells give 0.
    min_load : int
        As in Cop.

    Raises
    ------
    TypeError
        If ``calibration`` is no Calibration.
    ValueError
        If the array's register does not hold ``min_load``.
    """

    def __init__(self, calibration: Calibration, min_load: int = 1) -> None:
        _check_class("calibration", calibration, Calibration)
        check_min_load(min_load, *calibration.offset.shape)
        self.calibration, self._cop = calibration, Cop(min_load)

    def forces(self, codes: ArrayLike) -> NDArray[np.int64]:
        """Forces of codes, 0 .. 65535 [frames, rows, columns], in steps of ``calibration.force_lsb_n``.

        Parameters
        ----------
        codes : integers [frames, rows, columns]
            Of 17 bits.

        Raises
        ------
        ValueError
            For another shape than the calibration's, no frames, floats and codes of more than 17 bits.
        """
        own = self.calibration
        codes = check_codes(taken(codes), own.offset.shape, floats=False)
        return forces(codes, own.offset, own.gain, own.gain_shift, mask=own.dead)

    def next(self, codes: ArrayLike) -> CopResult:
        """Results for codes as in ``forces``, with the same errors."""
        return self._cop.next(self.forces(codes))

    def process(self, codes: ArrayLike) -> CopResult:
        """The same as ``next``."""
        return self.next(codes)


class Cop4:
    """Position and load of the published four-wire sensor (rtl/cop/msn_cop4.sv); no state between samples.

    Parameters
    ----------
    config : Cop4Config
        Mesh, amplifiers and converter.

    Raises
    ------
    TypeError
        If ``config`` is no Cop4Config.
    """

    def __init__(self, config: Cop4Config) -> None:
        _check_class("config", config, Cop4Config)
        self.config = config

    def next(self, codes: ArrayLike) -> Cop4Result:
        """Results for the codes of the electrodes.

        Parameters
        ----------
        codes : integers [samples, 4]
            Of E1 to E4, in the converter's bits.

        Raises
        ------
        ValueError
            For another shape, no samples, floats and codes that the converter does not give.
        """
        own = self.config
        codes = check_electrodes(taken(codes, samples_first=True), own.adc.bits, floats=False)
        return Cop4Result(*cop4_twin.cop4(codes, own.registers, own.sample_bits, own.terms))

    def process(self, codes: ArrayLike) -> Cop4Result:
        """The same as ``next``."""
        return self.next(codes)
