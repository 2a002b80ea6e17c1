"""Twin of rtl/sensor/msn_sensor_array.sv: forces, centres of pressure and faults of complete frames."""

from dataclasses import dataclass

import numpy as np

from meissner.twins.frontend.calibration_preset import preset
from meissner.twins.sensor.array_forces import ArrayForces


class Array(ArrayForces):
    """A scanned array; ``scan``: ScanAdc, ScanDemod or, of a stream, any object with ``rows`` and
    ``columns``, and ``lanes`` if there are several. The rest as in ArrayForces."""

    def __init__(self, scan, limits=None, tare=None, **kinds):
        lanes = getattr(scan, "lanes", 1)  # the demodulator gives one amplitude at a time
        super().__init__(scan.rows, scan.columns, lanes, limits, tare, **kinds)
        self.scan = scan

    def latency(self, settle, **given):
        """Clocks of each step, by name: the scan's, then ``health``, ``tare``, ``cop`` and two sums.

        ``compute``: from the last sample to the result; ``total``: from a frame's first convert start to the
        result. ``given``: further arguments of the scan's latency.
        """
        steps = self.scan.latency(settle, **given) | self.steps
        tail = sum(self.steps.values())
        return steps | {"compute": steps["out"] + tail, "total": steps["last_beat"] + tail}


@dataclass(frozen=True)
class Sensed:
    """``forces``, ``mask`` [frames, taxels]; ``cop``: (x, y, load, pressed) of each frame."""

    forces: np.ndarray
    mask: np.ndarray
    cop: list


def sensor_array(array, samples, over=None):
    """``Sensed`` of samples [frames, rows, columns]; ``array`` keeps its learned state, as the core does."""
    forces, mask = array.forces(samples, over)
    cop = [tuple(map(int, row)) for row in zip(*array.cops(forces))]
    return Sensed(forces.reshape(len(forces), -1), mask.reshape(len(mask), -1), cop)


def from_reset(scan, gain, limits=None, tare=None, **kinds):
    """Array as a core has it after reset: preset gains, the first tare requested. The rest as in Array."""
    twin = Array(scan, limits, tare, **kinds)
    table = twin.calibrate.table
    for of_row, word, offset, value in preset(twin.rows, twin.columns, twin.lanes, gain, table.row_column):
        table.put(of_row, word, slice(None), offset, value)
    twin.calibrate.swap()
    if tare:
        twin.tare.tare(force=True)
    return twin
