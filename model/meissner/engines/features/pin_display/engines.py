"""``pin_display(frames, size, settings)``: a Shown of frames [periods, pins], each complete before the drive
period that it is for.

``size``: DisplaySize; ``settings``: DisplaySettings. The first period is silent: the drive begins.
"""

from typing import NamedTuple

import numpy as np

from meissner.arrays import Bools, Floats, Ints
from meissner.twins.actuate.pin_display import PHASE_BITS, DisplaySettings, DisplaySize, PinDisplay


class Shown(NamedTuple):
    """``levels`` [periods, pins] driven; ``start`` [periods]: clocks from the first period's beginning to
    each; ``limited`` [periods]: a limit keeps a pin off."""

    levels: Ints
    start: Ints | Floats
    limited: Bools


def fixed(frames: Ints, size: DisplaySize, settings: DisplaySettings) -> Shown:
    """By the integer twin."""
    display = PinDisplay(size, settings)
    display.on_again(0)
    found = [display.next(frame) for frame in frames]
    start = np.array([one.start for one in found], dtype=np.int64)
    levels = np.array([one.levels for one in found], dtype=np.int64).reshape(frames.shape)
    return Shown(levels, start - start[:1], np.array([one.limited for one in found], dtype=bool))


def float_(frames: Ints, size: DisplaySize, settings: DisplaySettings) -> Shown:
    """Equal periods of the set frequency; the limits on levels and on pins at once, without those over
    time."""
    periods = np.arange(len(frames))
    hz = settings.increment * 1000 * size.clk_khz / 2**PHASE_BITS
    top = min(settings.top, 2**size.amplitude_bits - 1)
    may = (frames > 0) & (top > 0)
    may &= np.cumsum(may, axis=1) <= settings.most
    on = periods > 0
    if settings.burst_period:
        on &= (periods - 1) % settings.burst_period < settings.burst_on
    levels = np.where(may & on[:, None], np.minimum(frames, top), 0)
    return Shown(levels, periods * (1000 * size.clk_khz / hz), ((frames > 0) & ~may).any(axis=1))


def rtl(frames: Ints, size: DisplaySize, settings: DisplaySettings) -> Shown:
    """By the Verilated module; only here its builder is loaded."""
    from meissner.engines.features.pin_display.driver import display

    return Shown(*display(frames, size, settings))


def gate(frames: Ints, size: DisplaySize, settings: DisplaySettings) -> Shown:
    """By its netlist."""
    from meissner.engines import verilated

    return verilated.of_gates(rtl)(frames, size, settings)


ENGINES = {"float": float_, "fixed": fixed, "rtl": rtl, "gate": gate}
