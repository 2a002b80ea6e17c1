"""Twin of rtl/sensor/msn_sensor_array.sv: forces, centres of pressure and faults of complete frames."""

from dataclasses import dataclass

import numpy as np

from meissner.twins.cop.array import Array
from meissner.twins.frontend.calibration_preset import preset


@dataclass(frozen=True)
class Sensed:
    """``forces``, ``mask`` [frames, taxels]; ``cop``: (x, y, load, pressed) of each frame."""

    forces: np.ndarray
    mask: np.ndarray
    cop: list


def sensor_array(array, samples, over=None):
    """``Sensed`` of samples [frames, rows, columns]; ``array`` keeps its learned state, as the core does."""
    forces, mask = array.forces(samples, over)
    cop = [tuple(map(int, row)) for row in zip(*array.cop.of_forces(forces))]
    return Sensed(forces.reshape(len(forces), -1), mask.reshape(len(mask), -1), cop)


def from_reset(size, gain, limits=None, tare=None, **kinds):
    """meissner.twins.cop.array.Array as a core has it after reset: preset gains, the first tare requested.

    ``size``: an object with ``rows``, ``columns``, ``lanes``, ``sample_bits``; the rest as in Array.
    """
    twin = Array(size, limits, tare, **kinds)
    table, row_column = twin.cop.calibrate.table, kinds.get("row_column", False)
    for of_row, word, offset, value in preset(size.rows, size.columns, size.lanes, gain, row_column):
        table.write_row(word, offset, value) if of_row else table.write(word, offset, value)
    twin.cop.calibrate.swap()
    if tare:
        twin.tare.tare(force=True)
    return twin
