"""Bit-exact twin of rtl/cop/msn_cop_array.sv: centre of pressure and load from an array's samples."""

from meissner.twins.cop import cop
from meissner.twins.cop.cop_accumulate import CopAccumulate
from meissner.twins.cop.cop_divide import cop_divide
from meissner.twins.frontend import calibrate_grid, calibrate_taxels


def latency(lanes=1, fraction_bits=14, bits_per_clock=2, row_column=False):
    """Clocks of the RTL from a frame's last beat to its centre of pressure, the same in every frame."""
    calibration = calibrate_grid if row_column else calibrate_taxels
    return calibration.LATENCY + cop.latency(lanes, fraction_bits, bits_per_clock)


class CopArray:
    """Calibration, then the centre of pressure; ``calibrate``: the twin with the tables."""

    def __init__(self, rows, columns, lanes=1, fraction_bits=14, min_load=1, row_column=False, **kinds):
        calibrate = calibrate_grid.CalibrateGrid if row_column else calibrate_taxels.CalibrateTaxels
        self.calibrate = calibrate(rows, columns, lanes, **kinds)
        self._accumulate = CopAccumulate(rows, columns, lanes)
        self.rows, self.columns = rows, columns
        self.fraction_bits, self.min_load = fraction_bits, min_load

    def reset(self):
        """The next beat should be the first of a frame; no table is in use."""
        self.calibrate.reset()
        self._accumulate.reset()

    @property
    def damaged(self):
        """Frames without a result."""
        return self._accumulate.damaged

    def next(self, raw, mask=None):
        """x, y, load, pressed of complete frames [..., rows, columns]."""
        return self.of_forces(self.calibrate.next(raw, mask))

    def of_forces(self, forces):
        """The same from the forces of ``calibrate``."""
        return cop.cop(forces, self.fraction_bits, self.min_load)

    def process(self, raw, mask=None):
        """``reset``, put the written tables in use, then ``next``."""
        self.reset()
        self.calibrate.swap()
        return self.next(raw, mask)

    def beat(self, raw, id_, last, mask=None, fits=True):
        """One beat as FrameMarker passes it: (x, y, load, pressed) of the frame that it ends, else None."""
        forces = self.calibrate.beat(raw, id_, last, mask)
        sums = self._accumulate.next(forces.tolist(), last, fits)
        if not sums:
            return None
        x, y, pressed = cop_divide(*sums, self.rows, self.columns, self.fraction_bits, self.min_load)
        return int(x), int(y), sums[0], bool(pressed)
