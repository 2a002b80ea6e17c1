"""What a finger feels of a display: volts of its pins, their displacement, the channels that respond."""

import numpy as np

from meissner.physics import pins, receptors
from meissner.physics.receptors import CHANNELS

OVERSAMPLED = 64  # instants of a drive period


def frequency(shown, size):
    """Mean drive frequency of the periods after the silent one."""
    if len(shown.start) < 3:
        raise ValueError(f"[world]: hz is too low: {len(shown.start)} drive periods in a recording, not 3")
    clocks = (shown.start[-1] - shown.start[1]) / (len(shown.start) - 2)
    return float(1000 * size.clk_khz / clocks)


def voltages(shown, size, volts):
    """Volts [pins, instants] over the periods after the silent one, OVERSAMPLED a period."""
    per_slot = OVERSAMPLED // size.slots or 1
    slots = np.arange(size.slots)
    levels = shown.levels[1:].T[:, :, None]
    high = (levels > 0) & (slots <= levels)
    return volts * np.repeat(high, per_slot, axis=2).reshape(len(levels), -1), per_slot * size.slots


def feel(scene, shown, size):
    """({channel: bool [pins, periods], where it responds}, hertz) of a display under the finger."""
    hz = frequency(shown, size)
    v, points = voltages(shown, size, scene.world["volts"])
    x = pins.moved(v, hz * points, True)
    feels = {}
    for name in CHANNELS:
        y = np.abs(receptors.sensation(name, x, hz * points, scene.world["tip_cm2"]))
        feels[name] = y.reshape(len(x), -1, points).max(axis=2) >= 1.0
    return feels, hz
