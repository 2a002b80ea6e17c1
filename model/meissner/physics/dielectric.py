"""Why the elastic dielectric has tabs, and how their height sets the range of forces.

Hooke's law of an isotropic solid (Timoshenko and Goodier), x along the force:

    strain_x = (s_x - v·(s_y + s_z)) / E        and the same for y and z, v Poisson's ratio

A flat sheet, glued down and pressed evenly, cannot move along y or z: strain_y = strain_z = 0, so
s_y = s_z = v/(1 - v)·s_x and

    strain_x = s_x/E · (1 + v)(1 - 2v)/(1 - v)       0 for rubber that keeps its volume, v = 1/2

A tab has air around it, so s_y = s_z = 0 and strain_x = s_x/E. This is the published argument (eq. 2 to 7,
printed with v = 1/2); it ignores that a tab is glued at its ends, which stiffens it by 1 + 2·S^2.
Electrically (eq. 16, 17), for an amplifier of large gain:

    |Vout| = Vin·sqrt(Ccell^2 + 1/(w·Rcell)^2) / Cref       the higher the carrier, the less leakage counts
"""

import numpy as np
from numpy.typing import ArrayLike

from meissner.arrays import Floats, Values, finite
from meissner.physics import capacitive

# Published: the lowest and the highest tab that the maker used, "depending on the desired force range".
HEIGHTS_MM = (0.25, 0.75)
REFERENCE_G = 100.0  # chosen: the press of figure 8; heights are compared at its rise of capacitance
ORIGINS = {
    "HEIGHTS_MM": ("published", "002, fabrication", "the ends of the range: 7.0 to 1"),
    "REFERENCE_G": (
        "chosen",
        "the press of 002's figure 8",
        "the range's ratio: 7.0 at 100 g, 5.3 at 10 g, 11 at 200 g",
    ),
}


@finite
def strain_confined(stress: Values, poisson: float, modulus: float) -> Values:
    """Strain along the force of rubber that cannot move sideways (eq. 3 to 6)."""
    return stress / modulus * (1 + poisson) * (1 - 2 * poisson) / (1 - poisson)


def leaking_v(
    drive_v: float,
    hertz: Values,
    cell_ohm: ArrayLike,
    cell_f: float = capacitive.CELL_F,
    ref_f: float = capacitive.REF_F,
) -> Values:
    """Eq. 17; eq. 16, drive·Ccell/Cref, without leakage (``cell_ohm`` infinite)."""
    return drive_v * np.hypot(cell_f, 1 / (2 * np.pi * hertz * np.asarray(cell_ohm, float))) / ref_f


@finite
def rise(force_g: ArrayLike, tab_mm: Values = capacitive.TAB_MM) -> Values:
    """Rise of capacitance under a press, as a share of that at rest, with tabs."""
    return capacitive.capacitance_ratio(np.asarray(force_g) * capacitive.GRAM_N, tab_mm=tab_mm) - 1


@finite
def rise_without_tabs(
    force_g: ArrayLike, poisson: float, thickness_mm: float = capacitive.BACKING_MM + capacitive.TAB_MM
) -> Values:
    """The same for an evenly pressed flat sheet, with each cell's force on the area of a tab.

    Strain does not depend on the thickness, so neither does the rise.
    """
    area_mm2 = np.pi / 4 * capacitive.TAB_DIAMETER_MM**2
    strain = strain_confined(
        np.asarray(force_g) * capacitive.GRAM_N / area_mm2, poisson, capacitive.MODULUS_MPA
    )
    return thickness_mm / (thickness_mm * (1 - strain)) - 1


@finite
def force_for(share: Values, tab_mm: ArrayLike) -> Floats:
    """Grams on one tab that raise the capacitance by ``share``: the tab's law inverted.

    (b + h)/(b + h·u) = 1 + share gives u; F = A·E'/3·(1/u^2 - u). Infinite if the backing alone is too thick.
    """
    h = np.asarray(tab_mm, float)
    u = ((capacitive.BACKING_MM + h) / (1 + share) - capacitive.BACKING_MM) / h
    shape = capacitive.TAB_DIAMETER_MM / (4 * h)
    stiff = np.pi / 4 * capacitive.TAB_DIAMETER_MM**2 * capacitive.MODULUS_MPA * (1 + 2 * shape**2) / 3
    safe = np.where(u > 0, u, 1.0)
    return np.where(u > 0, stiff * (safe**-2.0 - safe), np.inf) / capacitive.GRAM_N
