"""A capacitive array on its carrier behind row lines and a column multiplexer, as a converter sees it."""

import numpy as np

import bench
from parts.timing import now


class CarrierMatrix:
    """``amplitude`` [rows, columns] of full scale; the carrier has ``hz`` and a phase; codes of ``bits``
    bits.

    The converter calls ``code``, which fails the test unless exactly one row is driven, and records each code
    with the place it was taken at: ``taken`` [(row, group, time in ns, code)].
    """

    def __init__(self, dut, amplitude, hz, bits, phase=0.3, converter=0, converters=1):
        self.dut, self.amplitude, self.hz, self.bits = dut, np.asarray(amplitude), hz, bits
        self.phase, self.converter, self.converters = phase, converter, converters
        self.taken = []
        self.over = False  # if set, all codes are the highest

    def code(self, channel, time_ns):
        rows = bench.read(self.dut.row_o)
        top = (1 << self.bits) - 1
        if rows == 0:  # the part's first words, before a scan
            return top // 2
        assert rows & rows - 1 == 0, f"rows {rows:b} at once"
        row, group = rows.bit_length() - 1, bench.read(self.dut.group_o)
        column = group * self.converters + self.converter
        level = self.amplitude[row, column] if column < self.amplitude.shape[1] else 0.0
        angle = 2 * np.pi * self.hz * time_ns * 1e-9 + self.phase
        code = top if self.over else int(np.clip(np.rint(top / 2 * (1 + level * np.cos(angle))), 0, top))
        self.taken.append((row, group, now(), code))
        return code
