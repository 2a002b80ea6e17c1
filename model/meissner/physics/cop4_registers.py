"""The registers of msn_cop4 and of its load correction from a mesh, amplifiers and a converter."""

from dataclasses import replace
from math import ceil
from typing import TYPE_CHECKING

import numpy as np

from meissner.physics.adc import Adc
from meissner.physics.mesh.constants import cop_constants
from meissner.tables import exact
from meissner.twins.cop.cop4 import SCALE_BITS, Cop4Registers
from meissner.twins.cop.cop4_correct import LOAD_SHIFT, SHIFT_TOP, SUM_TOP, CorrectionRegisters
from meissner.twins.shared import LOAD_BITS

if TYPE_CHECKING:
    from meissner.physics.mesh.correction import Correction
    from meissner.physics.mesh.mesh import Mesh


def scaled(value: float, lowest: int, what: str) -> tuple[int, int]:
    """``value`` as k / 2**(lowest + shift): (k, shift), k of 17 bits, the largest shift in 0 .. 15."""
    for shift in range(SHIFT_TOP, -1, -1):
        k = round(value * 2.0 ** (lowest + shift))
        if k < 1 << SCALE_BITS:
            if value and not k:
                raise ValueError(f"{what} is too small for its register")
            return k, shift
    raise ValueError(f"{what} is too large for its register")


def cop4_registers(
    mesh: "Mesh",
    adc: Adc,
    gain: float = 1.0,
    load_lsb: float = 1e-3,
    min_load: float = 0.05,
    imbalance: float = 1e-3,
    sample_bits: int = 17,
    difference_gain: float = 1.0,
) -> Cop4Registers:
    """``Cop4Registers`` for a mesh (m, n, r, R0, V0, k) read by ``adc`` through amplifiers of ``gain``,
    with ``difference_gain`` of opposite electrodes' differences (physics.cop4_config).

    ``mesh``: a Mesh or an object with those six; ``adc``: meissner.physics.adc.Adc, symmetric about 0 V since
    E2 and E4 are negative. ``load_lsb``, ``min_load``: newtons; ``imbalance``: a fraction of 2V0. An
    electrode counts as open if its current is below 1/500 of V0 / R0 (at least 4 codes) while its partner's
    exceeds what any place of the load could cause. ValueError if a voltage or a constant does not fit.
    """
    lsb = adc.lsb_v / gain
    rail = mesh.V0 / lsb
    if adc.low_v != -adc.high_v:
        raise ValueError("the converter must be symmetric about 0 V: E2 and E4 are negative")
    margin = max(4, round(rail / 500))
    if round(rail) + margin > adc.max_code:
        raise ValueError(f"V0 = {mesh.V0:g} V times the gain {gain:g} leaves no room below {adc.high_v:g} V")
    Cx, Cy, Kf = cop_constants(mesh.m, mesh.n, mesh.r, mesh.R0, mesh.V0, mesh.k)
    least = min([C for C in (Cx, Cy) if C], default=np.inf)
    if difference_gain != 1 and difference_gain >= least:
        raise ValueError(
            f"difference_gain = {difference_gain:g} must be below {least:.4g}, "
            "or a load at the edge leaves the electrodes' range"
        )
    Cx, Cy = Cx / difference_gain, Cy / difference_gain
    kx, shift_x = scaled(Cx, 0, f"Cx = {Cx:g}")
    ky, shift_y = scaled(Cy, 0, f"Cy = {Cy:g}")
    kf, shift_load = scaled(Kf / load_lsb / (1 << LOAD_BITS), LOAD_SHIFT, f"Kf = {Kf:g} N at {load_lsb:g} N")
    # Each electrode carries at least (1 - 1/C) / 2 of its layer's current.
    share = max([(C + 1) / (C - 1) for C in (Cx, Cy) if C] or [1])
    busy = max(round(rail - (margin + 3) * share) - 3, -adc.max_code)
    least, most = ceil(exact(min_load) / exact(load_lsb)), (1 << LOAD_BITS) - 1
    if least > most:
        largest = float(most * exact(load_lsb))
        raise ValueError(f"min_n = {min_load:g} must be at most {largest:g}, the largest load")
    found = Cop4Registers(
        rail=round(2 * rail),
        kx=kx,
        shift_x=shift_x,
        ky=ky,
        shift_y=shift_y,
        kf=kf,
        shift_load=shift_load,
        top=adc.max_code,
        idle=round(rail) - margin,
        busy=busy,
        imbalance=max(4, round(2 * rail * imbalance)),
        min_load=max(1, least),
    )
    found.check(sample_bits)
    return found


def correct_registers(
    fix: "Correction", registers: Cop4Registers
) -> tuple[Cop4Registers, CorrectionRegisters]:
    """(``registers``, a Cop4Registers, and ``fix``, a correction.Correction, as registers) at a common shift.

    The two denominators D and N p share the load's shift, so the shift is lowered, and kf with it, until
    every operand fits. ValueError if kf would lose its resolution of 2**-12.
    """
    shift, kf = registers.shift_load, registers.kf
    while shift >= 0:
        p = tuple(int(v) for v in np.round(np.asarray(fix.p) * 2.0 ** (LOAD_SHIFT + shift)))
        if sum(abs(v) for v in p) < SUM_TOP:
            scaled = round(kf / 2 ** (registers.shift_load - shift))
            if scaled < 1 << 11:
                break
            return replace(registers, kf=scaled, shift_load=shift), CorrectionRegisters(p, LOAD_SHIFT + shift)
        shift -= 1
    raise ValueError("the correction is too large for this load_lsb: choose a larger load_lsb")
