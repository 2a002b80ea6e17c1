"""Twin of rtl/cop/msn_array.sv: a scanned array, from its converters' samples to its centre of pressure."""

from meissner.twins.cop import cop_array
from meissner.twins.cop.cop_array import CopArray
from meissner.twins.frontend.condition import Condition


class Array:
    """``scan``: ScanAdc or ScanDemod. ``limits``: of msn_health, None without it.

    ``tare``: a dict of the arguments of Tare (contact, step, tare_log2), or None without msn_tare. With it
    ``cop.calibrate`` has gains only, without it offsets too. ``health``, ``tare`` and ``cop`` are the stages.
    """

    def __init__(self, scan, limits=None, tare=None, bits_per_clock=2, **kinds):
        rows, columns = scan.rows, scan.columns
        lanes = getattr(scan, "lanes", 1)  # the demodulator gives one amplitude at a time
        bits = scan.sample_bits
        self.scan = scan
        self.condition = Condition(rows, columns, lanes, bits, limits, tare)
        self.health, self.tare = self.condition.health, self.condition.tare
        zeroed = self.tare is not None
        self.cop = CopArray(rows, columns, lanes, sample_bits=bits + zeroed, offset=not zeroed, **kinds)
        row_column = kinds.get("row_column", False)
        behind = cop_array.latency(lanes, self.cop.fraction_bits, bits_per_clock, row_column)
        self._steps = self.condition.steps | {"cop": behind}

    def next(self, samples, over=None):
        """x, y, load, pressed [frames] of complete frames of signed samples [frames, rows, columns]."""
        return self.cop.of_forces(self.forces(samples, over)[0])

    def forces(self, samples, over=None):
        """The calibrated forces of such frames and which are masked, both [frames, rows, columns]."""
        samples, mask = self.condition.next(samples, over)
        return self.cop.calibrate.next(samples, mask), mask

    def latency(self, settle, **given):
        """Clocks of each step, by name: the scan's, then ``health``, ``tare``, ``cop`` and two sums.

        ``compute``: from the last sample to the result; ``total``: from a frame's first convert start to the
        result. ``given``: further arguments of the scan's latency.
        """
        steps = self.scan.latency(settle, **given) | self._steps
        tail = sum(self._steps.values())
        return steps | {"compute": steps["out"] + tail, "total": steps["last_beat"] + tail}
