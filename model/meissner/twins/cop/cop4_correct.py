"""Bit-exact twin of rtl/cop/msn_cop4_correct.sv: the load's denominator without the layers' voltage drop."""

from dataclasses import dataclass

import numpy as np

from meissner.twins.shared import fits

COORDINATE_BITS = 14  # x, y are Q2.14
SQUARE_BITS = 16  # X, Y unsigned, 1.0 = 65536
COEFFICIENT_BITS = 18  # signed registers
SHIFT_TOP = 15
LOAD_SHIFT = 8  # added to the load's shift
SUM_TOP = (1 << COEFFICIENT_BITS - 1) - 2  # with |p0| + .. + |p5| below it every operand fits 18 bits


@dataclass(frozen=True)
class CorrectionRegisters:
    """The load's correction in integers: p in 18-bit signed registers that share one shift.

    ``divisor`` is the arithmetic of the RTL: X, Y of 16 bits (floor), Horner's scheme in 18×18 products, each
    floored to a register's scale, N p in full width, one subtraction upstream of the divider.
    """

    p: tuple
    shift: int  # p = register / 2**shift

    def divisor(self, x, y, N, D):
        """D - N p as an integer in units of 2**-shift codes; x, y Q2.14, N and D codes, int64 arrays."""
        x, y, N, D = (np.asarray(a, np.int64) for a in (x, y, N, D))
        down = 2 * COORDINATE_BITS - SQUARE_BITS
        X, Y = x * x >> down, y * y >> down
        p0, p1, p2, p3, p4, p5 = self.p
        along = p1 + (p3 * X + p4 * Y >> SQUARE_BITS)
        across = p2 + (p5 * Y >> SQUARE_BITS)
        p = p0 + (X * along + Y * across >> SQUARE_BITS)
        return (D << self.shift) - N * p


def check_correction(registers):
    """Raise ValueError unless ``registers`` (CorrectionRegisters) fit the hardware's operands."""
    if len(registers.p) != 6 or sum(abs(p) for p in registers.p) >= SUM_TOP:
        raise ValueError(f"p = {registers.p} must be six numbers whose magnitudes add to less than {SUM_TOP}")
    fits(registers, shift=(LOAD_SHIFT, LOAD_SHIFT + SHIFT_TOP))


def cop4_correct(x, y, n, d, registers):
    """den [k] int64 of x, y [k] (Q2.14, -1 .. +1), N and D [k] (codes), in units of 2**-shift codes.

    den = D 2^s - N p     X = x^2 / 2^12   Y = y^2 / 2^12   (1.0 = 65536)
    p = p0 + (X (p1 + (p3 X + p4 Y) / 2^16) + Y (p2 + p5 Y / 2^16)) / 2^16   divisions rounded down
    """
    check_correction(registers)
    if max(np.abs(x).max(initial=0), np.abs(y).max(initial=0)) > 16384:
        raise ValueError("x and y must lie in -16384 .. 16384")
    return registers.divisor(x, y, n, d)
