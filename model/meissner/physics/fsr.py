"""A matrix of force-sensing resistors: the cells, their network, its readout and its faults.

    G(F) = 1/R_rest + (F - F_break)^p / R_1N          a cell's conductance; p depends on the material

One row is driven at a time and every column read. Rows and columns are nodes of one network, solved at once:

    rows      sum_j G_ij (u_i - v_j) = t_i (d_i - u_i)     t_i: 1/R of the row's driver, d_i = V or 0
    columns   sum_i G_ij (v_j - u_i) = -s v_j              s: 1/R of the column's termination

``zero potential``: each column ends in an amplifier that holds it at 0 V behind ``hold_ohm``; it reports the
current times its feedback resistor, so ghosting is as small as ``driver_ohm`` and ``hold_ohm``. ``divider``:
each column ends in the series resistor whose voltage is read. Unselected rows are ``grounded`` or
``floating``; a floating row carries current from column to column, which is ghosting.

Not modelled: settling, hysteresis and spread of p from cell to cell, temperature, humidity, conduction in the
sheet from one cell to the next (Velostat between crossed traces has some).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from meissner.arrays import Floats, Ints, Values, finite

CIRCUITS = ("zero potential", "divider")
UNSELECTED = ("grounded", "floating")
FAULTS = ("dead row", "open column", "dead", "stuck", "saturated", "blinking")
SHORT_SIEMENS = 1e-2  # of a saturated cell; chosen
STUCK_SHARE = 0.4  # of the top code; chosen
BLINK_S = 0.05  # mean length of each state of a blinking cell; chosen
DRIFT_FROM_S = 0.1  # from this time under load on G drifts per decade of time; chosen


@dataclass(frozen=True)
class Material:
    """``ohm_1n``: of a cell under 1 N; ``power``: p; ``rest_ohm``: unpressed; ``break_n``: F_break, newtons.

    ``spread``: standard deviation from cell to cell; ``drift``: rise of G per decade of time under load.
    """

    ohm_1n: float
    power: float
    rest_ohm: float
    break_n: float
    spread: float
    drift: float


# Interlink, FSR 400 series data sheet: more than 10 megohms unpressed, from 0.2 N, +-6 % from part to part
# in a batch, drift below 5 % per decade; resistance and power are read off its curve. Velostat is chosen.
FSR400_OHM_1N, FSR400_POWER = 6e3, 0.9
FSR400_REST_OHM, FSR400_BREAK_N, FSR400_SPREAD = 10e6, 0.2, 0.06
FSR400_DRIFT = 0.03
VELOSTAT_OHM_1N, VELOSTAT_REST_OHM, VELOSTAT_SPREAD, VELOSTAT_DRIFT = 20e3, 1e6, 0.08, 0.02
MATERIALS = {
    "FSR400": Material(
        FSR400_OHM_1N, FSR400_POWER, FSR400_REST_OHM, FSR400_BREAK_N, FSR400_SPREAD, FSR400_DRIFT
    ),
    "Velostat": Material(VELOSTAT_OHM_1N, 1.0, VELOSTAT_REST_OHM, 0.0, VELOSTAT_SPREAD, VELOSTAT_DRIFT),
}
HOLD_OHM = 0.5  # of an amplifier that holds its column; chosen
_FSR400 = "Interlink, FSR 400 series data sheet"
ORIGINS = {
    "SHORT_SIEMENS": ("chosen", "well above a cell at full force", "no scene injects a saturated cell"),
    "STUCK_SHARE": ("chosen", "anywhere but an end", "none: the calibration finds a stuck cell at any code"),
    "BLINK_S": ("chosen", "a loose contact's chatter", "no scene injects a blinking cell"),
    "DRIFT_FROM_S": ("chosen", "the data sheet's drift begins at a log of time", "as the drift's share"),
    "FSR400_OHM_1N": (
        "read off",
        f"{_FSR400}, curve",
        "fsr_3x3: 3 kohm is over range; 12 kohm: load 7.7 % off, not 7.2",
    ),
    "FSR400_POWER": ("read off", f"{_FSR400}, curve", "fsr_3x3: 0.8 position 2.6 % off, not 2.3"),
    "FSR400_REST_OHM": ("datasheet", f"{_FSR400}: more than 10 megohms", "1 megohm: nothing in fsr_3x3"),
    "FSR400_BREAK_N": (
        "datasheet",
        f"{_FSR400}: actuation force",
        "fsr_3x3: position and load 1.7 and 3.2 % off at 0 N, 4.0 and 6.0 % at 0.4 N, 2.3 and 7.2 % chosen",
    ),
    "FSR400_SPREAD": (
        "datasheet",
        f"{_FSR400}: +-6 % in a batch, taken as a standard deviation",
        "even press before calibration: 4.5 % at 0.03, 17.8 % at 0.12, 9.0 % chosen; after: 0.05 to 0.07 %",
    ),
    "FSR400_DRIFT": (
        "chosen",
        f"{_FSR400}: below 0.05 a decade",
        "fsr_3x3: load 11 % off without, 4.5 % at 0.06: it hides what the straight line loses",
    ),
    "VELOSTAT_OHM_1N": (
        "chosen",
        "no data sheet",
        "fsr_64x64: 40 kohm, working cells' load 6.8 % off, not 3.2",
    ),
    "VELOSTAT_REST_OHM": (
        "chosen",
        "no data sheet",
        "fsr_64x64: 0.1 megohm, load 31 % off; ghost of the floating divider 47 %, not 12.5",
    ),
    "VELOSTAT_SPREAD": (
        "chosen",
        "no data sheet",
        "even press before calibration: 60 % at 0.16, 30 % chosen; after: 0.15 to 0.17 %",
    ),
    "VELOSTAT_DRIFT": (
        "chosen",
        "no data sheet",
        "fsr_64x64: working cells' load 4.9 % off without, 2.0 % at 0.04, 3.2 % chosen",
    ),
    "MATERIALS": ("computed", "of the constants above; Velostat in proportion to force", "as those"),
    "HOLD_OHM": (
        "chosen",
        "an operational amplifier's input",
        "50 ohm: working cells' load 13 % off, not 3.2",
    ),
}


@dataclass(frozen=True)
class Readout:
    """The circuit; resistances in ohms. ``load_ohm``: feedback or series resistor."""

    circuit: str
    unselected: str
    supply_v: float
    driver_ohm: float
    load_ohm: float
    hold_ohm: float = HOLD_OHM

    @property
    def column_siemens(self) -> float:
        return 1 / (self.hold_ohm if self.circuit == "zero potential" else self.load_ohm)


@dataclass(frozen=True)
class Fault:
    """A fault of FAULTS at ``row``, ``column``; for a complete row or column the other index is -1."""

    kind: str
    row: int
    column: int


@finite
def conductance(force_n: ArrayLike, material: Material, strength: Values = 1.0) -> Floats:
    """Siemens of cells under forces in newtons; ``strength``: each cell's factor on the nominal value."""
    pressed = np.maximum(np.asarray(force_n, float) - material.break_n, 0.0)
    return strength * pressed**material.power / material.ohm_1n + 1 / material.rest_ohm


@finite
def strengths(rows: int, columns: int, material: Material, rng: np.random.Generator) -> Floats:
    """Each cell's factor on the nominal conductance [rows, columns]."""
    return np.maximum(1 + material.spread * rng.standard_normal((rows, columns)), 0.1)


@finite
def drift(force_n: ArrayLike, material: Material, rate_hz: float) -> Floats:
    """1 + each cell's relative gain of conductance under load; ``force_n`` [frames, ...]."""
    pressed = np.asarray(force_n) > material.break_n
    frame = np.arange(len(pressed)).reshape(-1, *[1] * (pressed.ndim - 1))
    released = np.maximum.accumulate(np.where(pressed, -1, frame), axis=0)  # the last frame without a load
    loaded_s = np.zeros(pressed.shape)
    loaded_s[1:] = (frame - released)[:-1] / rate_hz
    return 1 + material.drift * np.log10(1 + loaded_s / DRIFT_FROM_S)


def break_cells(
    siemens: ArrayLike, faults: Sequence[Fault], rate_hz: float, rng: np.random.Generator
) -> Floats:
    """The conductances [frames, rows, columns] with dead, saturated and blinking cells."""
    siemens = np.array(siemens)
    for fault in faults:
        cell = siemens[:, fault.row, fault.column]
        if fault.kind == "dead":
            cell[:] = 0.0
        elif fault.kind == "saturated":
            cell[:] = SHORT_SIEMENS
        elif fault.kind == "blinking":
            flips = rng.random(len(siemens)) < 1 / (BLINK_S * rate_hz)
            cell[np.cumsum(flips) % 2 == 1] = 0.0
    return siemens


def column_volts(siemens: ArrayLike, readout: Readout, faults: Sequence[Fault] = ()) -> Floats:
    """Volts of every column while each row is driven [..., rows, columns], by nodal analysis.

    Parameters
    ----------
    siemens : [..., rows, columns]
        Of the cells.
    faults : sequence of Fault
        The lines of a "dead row" or an "open column" are disconnected at their end; an open column reads 0.
    """
    siemens = np.asarray(siemens, float)
    rows, columns = siemens.shape[-2:]
    tied = np.full(rows, 1 / readout.driver_ohm)
    held = np.full(columns, readout.column_siemens)
    for fault in faults:
        if fault.kind == "dead row":
            tied[fault.row] = 0.0
        elif fault.kind == "open column":
            held[fault.column] = 0.0
    volts = np.zeros(siemens.shape)
    if readout.unselected == "grounded":
        drives = np.diag(readout.supply_v * tied)  # one network for all driven rows
        volts = _solve(siemens, tied, held, drives)
    else:
        for row in range(rows):
            only = np.where(np.arange(rows) == row, tied, 0.0)
            volts[..., row, :] = _solve(siemens, only, held, readout.supply_v * np.diag(only)[row][None])[
                ..., 0, :
            ]
    return np.where(held > 0, volts, 0.0)


def _solve(siemens: Floats, tied: Floats, held: Floats, drives: Floats) -> Floats:
    """Column voltages [..., drives, columns] for currents ``drives`` [drives, rows] into the rows.

    The rows are eliminated: (diag(held + sum_i G) - G' D^-1 G) v = G' D^-1 i with D = diag(tied + sum_j G).
    """
    own = tied + siemens.sum(-1)
    weight = np.divide(1.0, own, out=np.zeros_like(own), where=own > 0)
    onto = siemens * weight[..., None]  # D^-1 G
    matrix = -np.swapaxes(siemens, -1, -2) @ onto
    total = held + siemens.sum(-2)
    # A column with nothing on it stays at 0 V.
    matrix[..., np.arange(len(held)), np.arange(len(held))] += np.where(total > 0, total, 1.0)
    return np.swapaxes(np.linalg.solve(matrix, np.swapaxes(drives @ onto, -1, -2)), -1, -2)


def output_volts(siemens: ArrayLike, readout: Readout, faults: Sequence[Fault] = ()) -> Floats:
    """Voltage at the converter for every cell [..., rows, columns]."""
    volts = column_volts(siemens, readout, faults)
    if readout.circuit == "divider":
        return volts
    return volts * readout.column_siemens * readout.load_ohm


def stick(codes: Ints, faults: Sequence[Fault], top: int) -> Ints:
    """The codes [frames, rows, columns] with the stuck cells."""
    for fault in faults:
        if fault.kind == "stuck":
            codes[:, fault.row, fault.column] = round(STUCK_SHARE * top)
    return codes
