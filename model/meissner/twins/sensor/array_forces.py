"""Bit-exact twin of rtl/sensor/msn_array_forces.sv: an array's samples to forces, centres of pressure and
faults."""

import numpy as np

from meissner.twins.cop import cop
from meissner.twins.cop.cop import CopAccumulate, cop_divide
from meissner.twins.frontend.calibrate import Calibrate
from meissner.twins.frontend.calibrate import latency as calibrate_latency
from meissner.twins.frontend.health import Health
from meissner.twins.frontend.tare import Tare


class ArrayForces:
    """``limits``: of msn_health, None without it. ``tare``: a dict of Tare's arguments (contact, step,
    tare_log2), None without msn_tare. With it ``calibrate`` has gains only, without it offsets too.

    ``health``, ``tare`` and ``calibrate`` are the stages; ``steps``: clocks of each.
    """

    def __init__(
        self,
        rows,
        columns,
        lanes=1,
        limits=None,
        tare=None,
        row_column=False,
        gain_shift=None,
        min_load=1,
        fraction_bits=14,
        bits_per_clock=2,
    ):
        size, zeroed = (rows, columns, lanes, 17), tare is not None
        self.rows, self.columns, self.lanes = rows, columns, lanes
        self.health = None if limits is None else Health(*size, limits)
        self.tare = Tare(*size, **tare) if zeroed else None
        self.calibrate = Calibrate(rows, columns, lanes, 17 + zeroed, row_column, not zeroed, gain_shift)
        self._accumulate = CopAccumulate(rows, columns, lanes)
        self.fraction_bits, self.min_load = fraction_bits, min_load
        self.steps = {"health": int(limits is not None), "tare": int(zeroed)}
        found = cop.latency(lanes, fraction_bits, bits_per_clock)
        self.steps["cop"] = calibrate_latency(row_column) + found

    @property
    def damaged(self):
        """Frames without a result."""
        return self._accumulate.damaged

    def next(self, samples, over=None):
        """x, y, load, pressed [frames] of complete frames of signed samples [frames, rows, columns]."""
        return self.cops(self.forces(samples, over)[0])

    def forces(self, samples, over=None):
        """The calibrated forces of such frames and which are masked, both [frames, rows, columns]."""
        samples = np.asarray(samples, dtype=np.int64)
        mask = np.zeros(samples.shape, dtype=bool)
        if self.health is not None:
            mask, _ = self.health.next(samples, over)
        if self.tare is not None:
            samples = self.tare.next(samples, mask)
        return self.calibrate.next(samples, mask), mask

    def cops(self, forces):
        """x, y, load, pressed of frames of forces."""
        return cop.cop(forces, self.fraction_bits, self.min_load)

    def beat(self, raw, over, id_, last, fits=True):
        """One beat as FrameMarker passes it: (forces, mask, faults, cop). The forces are None while zeros are
        loaded; cop is (x, y, load, pressed) of the frame that the beat ends, else None."""
        mask, faults = np.zeros(len(raw), dtype=bool), []
        if self.health is not None:
            mask, faults = self.health.beat(raw, over, id_, last, fits)
        if self.tare is not None:
            raw = self.tare.beat(raw, id_, last, mask, fits)
        if raw is None:
            return None, mask, faults, None
        forces = self.calibrate.beat(raw, id_, last, mask)
        sums = self._accumulate.next(forces.tolist(), last, fits)
        if not sums:
            return forces, mask, faults, None
        x, y, pressed = cop_divide(*sums, self.rows, self.columns, self.fraction_bits, self.min_load)
        return forces, mask, faults, (int(x), int(y), sums[0], bool(pressed))
