"""The published capacitive pad: rubber tabs between crossed traces, an amplifier per column, a carrier.

    Vout = -Vin·G·Ycell / (G·Yref + Ycell + Yref + Yu + Yop)      Y = jw·C + 1/R, G the amplifier's gain

is Kirchhoff's law at the amplifier's input (eq. 11 to 15, all terms kept). Its magnitude without leakage:

    |Vout| = Vin·G·Ccell / (G·Cref + Cu + Cref + Ccell)           eq. 18

Cu is the rest of the column's capacitance: its unselected cells, whose rows are grounded, and stray. So a
press anywhere in a column lowers the reading of all its cells, the less the larger G is.

A tab is a neo-Hookean cylinder bonded at both ends, on an incompressible backing:

    F = A·E'/3·(1/u^2 - u)     u: height over height at rest,  E' = E·(1 + 2·S^2),  S = d/4h   (Gent)
    C = C0·(b + h) / (b + h·u)

A sheet without tabs has an unbounded shape factor S and senses nothing, as published. Droop and sag: a share
of the force acts with delay, through a creep spectrum that is slower when the rubber expands.

Not modelled: fringe fields, the spread of the plate's area, temperature, wear, the traces' resistance, phase
shift of the amplifier (unless its gain is given as a complex number).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from meissner.arrays import Floats, Values, finite

GRAM_N = 9.80665e-3
# Published.
PITCH_MM, TRACE_MM, TAB_MM, BACKING_MM, TAB_DIAMETER_MM = 1.9, 1.27, 0.75, 0.25, 1.4
PERMITTIVITY = 4.0
CELL_F, REF_F = 1e-12, 1e-12
CARRIER_HZ = 200e3
# Chosen: with it 100 g raise the capacitance by 29 %, which fills the axes of figure 8 (1800 to 2500 codes).
MODULUS_MPA = 1.0
COVER_MM = 1.2  # insulation and shield above the tabs; chosen
# Chosen, as standard deviations: of tabs, plates and column amplifiers (the largest published cause).
STIFFNESS_SPREAD, PLATE_SPREAD, COLUMN_SPREAD = 0.04, 0.03, 0.06
# (share, seconds) of the force that acts with delay; chosen. Expansion is slower (published) by the factor.
CREEP = ((0.02, 0.15), (0.02, 5.0), (0.03, 80.0))
EXPANDING = 2.0
ORIGINS = {
    "GRAM_N": ("published", "standard gravity, exact", "the unit of 002: every figure in grams"),
    "PITCH_MM": ("published", "002, fabrication: centre to centre", "figure 8: peaks 1.9 mm apart"),
    "TRACE_MM": (
        "published",
        "002, fabrication: wide and square",
        "plate_f alone: 0.057 pF, not the pad's 1 pF",
    ),
    "TAB_MM": (
        "published",
        "002, fabrication: 0.25 to 0.75, the highest taken",
        "range: 100 g at 0.75 mm are 702 g at 0.25; the rise by 100 g 29 % and 6.1 %",
    ),
    "BACKING_MM": (
        "published",
        "002, fabrication",
        "0.125 mm: the settled cell 3.3 g low at 150 g, 0.5 mm: 5.6 g, not 4.3",
    ),
    "TAB_DIAMETER_MM": ("published", "002, fabrication", "1.27 mm, the trace's: 5.3 g low, not 4.3"),
    "PERMITTIVITY": ("published", "002, design: about 4", "plate_f alone, in proportion"),
    "CELL_F": (
        "published",
        "002, design: on the order of 1 pF; the printed sizes give 0.057",
        "noise against signal: at 0.1 pF noise 9.3 g, not 0.99, load of objects 6.6 % off, not 2.7",
    ),
    "REF_F": (
        "published",
        "002, eq. 18's example",
        "eq. 18: the gain for a loss, in proportion to 1 + (Cu + C)/Cref",
    ),
    "CARRIER_HZ": ("published", "002, design", "leakage: 0.3 % at 10 megohms, 1.3 % at 100 kHz"),
    "MODULUS_MPA": (
        "chosen",
        "100 g then lift the capacitance by 29 %, which fills figure 8's axes (1800 to 2500 codes)",
        "0.5 MPa: settled cell 7.7 g low, load of objects 5.6 % off; 2 MPa: 2.4 g, 1.5 %, noise 1.8 g",
    ),
    "COVER_MM": (
        "chosen",
        "insulation and shield above the tabs; the paper prints 'thin'",
        "0.6 mm: a neighbour reads 0 %, not 2; 2.4 mm: 33 %, and a probe's calibration leaves 30 %, not 7.5",
    ),
    "STIFFNESS_SPREAD": (
        "chosen",
        "the paper names the cause, no number",
        "even press: 0 gives 7.9 % before and 0.28 % after, 0.08 17.6 and 0.68; taken: 10.7 and 0.41",
    ),
    "PLATE_SPREAD": ("chosen", "the paper names no number", "even press before: 0 gives 11.6 %, 0.06 15.1 %"),
    "COLUMN_SPREAD": (
        "chosen",
        "the paper calls the columns' amplifiers the largest cause",
        "even press before: 0 gives 9.3 %, 0.12 14.5 %; after unchanged",
    ),
    "CREEP": (
        "chosen",
        "the paper draws droop and sag (figure 6) without numbers; shares and seconds",
        "none: a cycle's top 4.4 g low, no sag; twice: 17.4 g, 11 %; taken: 10.8 g, 5.5 %",
    ),
    "EXPANDING": (
        "chosen",
        "the paper: expands slower than it contracts; the factor is ours",
        "1 or 4: unloading 1.25 or 1.15 g above loading; what is left after a rest of 60 s",
    ),
}


def output_v(
    cell_f: Values,
    unselected_f: ArrayLike,
    gain: complex,
    drive_v: float = 10.0,
    ref_f: Values = REF_F,
    hertz: float = CARRIER_HZ,
    cell_ohm: ArrayLike = np.inf,
    input_ohm: ArrayLike = np.inf,
) -> Floats:
    """Amplitude |Vout| in volts; eq. 18 if both resistances are infinite.

    Parameters
    ----------
    cell_f, unselected_f, ref_f : float or array
        Farads; arrays broadcast.
    cell_ohm, input_ohm : float or array
        Leakage between the plates, and at the amplifier's input.
    """
    omega = 2j * np.pi * hertz
    cell = omega * cell_f + 1 / np.asarray(cell_ohm, float)
    others = omega * (np.asarray(unselected_f) + ref_f) + 1 / np.asarray(input_ohm, float)
    return np.abs(drive_v * gain * cell / (gain * omega * ref_f + cell + others))


@finite
def plate_f(gap_mm: Values) -> Values:
    """Capacitance of the crossing itself in farads: two plates, no fringe field."""
    return 8.8541878e-15 * PERMITTIVITY * TRACE_MM**2 / gap_mm


@finite
def tab_height(force_n: ArrayLike, stiffness: Values = 1.0, tab_mm: Values = TAB_MM) -> Floats:
    """u, the height of a tab under a force over its height at rest: the root of u^3 + q·u^2 = 1."""
    shape = TAB_DIAMETER_MM / (4 * tab_mm)
    modulus = MODULUS_MPA * (1 + 2 * shape**2)
    area_mm2 = np.pi / 4 * TAB_DIAMETER_MM**2
    q = 3 * np.asarray(force_n, float) / (area_mm2 * modulus * stiffness)
    u = np.ones_like(q)
    for _ in range(20):  # Newton's method from above: the cubic is convex, so u only falls
        u = u - (u**3 + q * u**2 - 1) / (3 * u**2 + 2 * q * u)
    return u


@finite
def capacitance_ratio(force_n: ArrayLike, stiffness: Values = 1.0, tab_mm: Values = TAB_MM) -> Floats:
    """C over C at rest under a force."""
    return (BACKING_MM + tab_mm) / (BACKING_MM + tab_mm * tab_height(force_n, stiffness, tab_mm))


@finite
def creep(force_n: ArrayLike, rate_hz: float) -> Floats:
    """The force that the tabs follow by each frame; ``force_n`` [frames, ...], at rest before the first."""
    force_n = np.asarray(force_n, float)
    late = [np.zeros(force_n.shape[1:]) for _ in CREEP]
    answered = np.empty_like(force_n)
    at_once = 1 - sum(share for share, _ in CREEP)
    for k, force in enumerate(force_n):
        answered[k] = at_once * force + sum(share * z for (share, _), z in zip(CREEP, late))
        for z, (_, tau_s) in zip(late, CREEP):
            slow = np.where(force < z, EXPANDING, 1.0)
            z += (force - z) * -np.expm1(-1 / (rate_hz * tau_s * slow))
    return answered


@dataclass(frozen=True)
class Pad:
    """An array as built.

    Attributes
    ----------
    rest_f, stiffness : [rows, columns]
        Farads unpressed, and the tabs' stiffness as a factor on the nominal one.
    ref_f : [columns]
        Farads of the amplifiers; ``stray_f``: of each column.
    """

    rest_f: Floats
    stiffness: Floats
    ref_f: Floats
    stray_f: float

    @finite
    def capacitance_f(self, force_n: ArrayLike) -> Floats:
        """Farads of every cell under forces [..., rows, columns] in newtons."""
        return self.rest_f * capacitance_ratio(force_n, self.stiffness)

    @finite
    def amplitude_v(self, force_n: ArrayLike, gain: complex, drive_v: float) -> Floats:
        """Output of each column's amplifier, in volts, while each row is driven [..., rows, columns]."""
        cell = self.capacitance_f(force_n)
        others = cell.sum(-2, keepdims=True) - cell + self.stray_f
        return output_v(cell, others, gain, drive_v, self.ref_f)


@finite
def build_pad(rows: int, columns: int, rng: np.random.Generator, stray_f: float = 5e-12) -> Pad:
    """A Pad whose parts vary by the chosen standard deviations."""

    def spread(share: float, *shape: int) -> Floats:
        return 1 + share * rng.standard_normal(shape)

    return Pad(
        rest_f=CELL_F * spread(PLATE_SPREAD, rows, columns),
        stiffness=spread(STIFFNESS_SPREAD, rows, columns),
        ref_f=REF_F * spread(COLUMN_SPREAD, columns),
        stray_f=stray_f,
    )


@finite
def carrier(
    amplitude_v: ArrayLike,
    samples: int,
    samples_per_period: float,
    phase: float = 0.0,
    before_v: ArrayLike | None = None,
    settle_samples: float = 0.0,
) -> Floats:
    """The sampled carrier at a converter's input [..., samples] in volts after a switch at sample 0.

    ``amplitude_v`` [...]: settled; ``before_v`` [...]: of the previous connection, from which the amplitude
    moves with the time constant ``settle_samples``; ``phase``: radians at sample 0.
    """
    n = np.arange(samples)
    size = np.asarray(amplitude_v, float)[..., None]
    if before_v is not None and settle_samples > 0:
        size = size + (np.asarray(before_v, float)[..., None] - size) * np.exp(-n / settle_samples)
    return size * np.sin(2 * np.pi * n / samples_per_period + phase)
