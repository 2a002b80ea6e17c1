"""The engines: the same work done by textbook float, by the integer twins, and by the Verilated core.

Each engine module has ``watch``: samples in, what the core says about every detail out. ``process_slip``
makes of it the arrays of ``meissner process slip``.
"""

from dataclasses import dataclass
from importlib import import_module

import numpy as np

from meissner.slip.config import MAX_CHANNELS, SAMPLE_BITS

NAMES = ("float", "fixed", "rtl")


@dataclass(frozen=True)
class Watched:
    """What the slip path says about every detail of every channel; all arrays are [channels, details].

    ``p2p``: peak-to-peak of the window that runs, in codes; ``over``: p2p > threshold; ``state``:
    meissner.slip.slip.State; ``end`` [details]: the detail closes a window; ``blanked``: details that
    were over while blanked or while the actuator moved.
    """

    p2p: np.ndarray
    over: np.ndarray
    state: np.ndarray
    end: np.ndarray
    blanked: int


def load(name):
    """The engine module of that name."""
    if name not in NAMES:
        raise ValueError(f"unknown engine '{name}'; the engines are: {', '.join(NAMES)}")
    return import_module(f"meissner.engines.{name}")


def check_samples(x):
    """``x`` as int64 [channels, samples] if the core can take it; ValueError with one sentence if not."""
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
    if x.dtype.kind == "f":
        x = x.astype(np.float64)  # the limits below do not fit a half
        if not np.isfinite(x).all():
            raise ValueError("the samples hold NaN or infinity; the core takes integer codes only")
        if (x != np.rint(x)).any():
            raise ValueError(
                "the samples hold numbers that are not integers; the core takes codes, not volts"
            )
    limit = 1 << (SAMPLE_BITS - 1)
    if x.min() < -limit or x.max() >= limit:
        raise ValueError(f"the samples lie in {x.min()} .. {x.max()}, outside -{limit} .. {limit - 1}")
    return x.astype(np.int64, copy=False)


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
