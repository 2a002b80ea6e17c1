"""Bit-exact twin of rtl/cop/msn_cop4_correct.sv: the load's denominator without the layers' voltage drop."""

from dataclasses import replace

import numpy as np

from meissner.cop.cop4 import LOAD_SHIFT, SHIFT_TOP
from meissner.world.mesh.correction import COEFFICIENT_BITS, Registers

SUM_TOP = (1 << COEFFICIENT_BITS - 1) - 2  # |p0| + .. + |p5| below it: no operand beyond 18 bits


def check_correction(registers):
    """Raise ValueError unless the hardware's operands have room for ``registers`` (correction.Registers)."""
    if len(registers.p) != 6 or sum(abs(p) for p in registers.p) >= SUM_TOP:
        raise ValueError(f"p = {registers.p} must be six numbers whose magnitudes add to less than {SUM_TOP}")
    if not LOAD_SHIFT <= registers.shift <= LOAD_SHIFT + SHIFT_TOP:
        raise ValueError(f"shift = {registers.shift} must lie in {LOAD_SHIFT} .. {LOAD_SHIFT + SHIFT_TOP}")


def correct_registers(fix, registers):
    """``fix`` (correction.Correction) as registers beside ``registers`` (Cop4Registers): both, at one shift.

    The two denominators D and N p share the load's shift, so it is lowered, and kf with it, until every
    operand has room. kf keeps 2**-12 or ValueError.
    """
    shift, kf = registers.shift_load, registers.kf
    while shift >= 0:
        p = tuple(int(v) for v in np.round(np.asarray(fix.p) * 2.0 ** (LOAD_SHIFT + shift)))
        if sum(abs(v) for v in p) < SUM_TOP:
            scaled = round(kf / 2 ** (registers.shift_load - shift))
            if scaled < 1 << 11:
                break
            return replace(registers, kf=scaled, shift_load=shift), Registers(p, LOAD_SHIFT + shift)
        shift -= 1
    raise ValueError("the correction is too large beside this load's LSB: choose a larger load_lsb")


def cop4_correct(x, y, n, d, registers):
    """den [k] int64 of x, y [k] (Q2.14, -1 .. +1), N and D [k] (codes), in units of 2**-shift codes.

    den = D 2^s - N p     X = x^2 / 2^12   Y = y^2 / 2^12   (1.0 = 65536)
    p = p0 + (X (p1 + (p3 X + p4 Y) / 2^16) + Y (p2 + p5 Y / 2^16)) / 2^16   divisions rounded down
    """
    check_correction(registers)
    if max(np.abs(x).max(initial=0), np.abs(y).max(initial=0)) > 16384:
        raise ValueError("x and y must lie in -16384 .. 16384")
    return registers.divisor(x, y, n, d)
