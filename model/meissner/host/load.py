"""A calibration (meissner.calibration) in a core: written cell by cell over its registers, and read back.

Every register is read again before the write that puts it into the core's table; the table's new half is used
from the next frame on, all cells at once. In a core with tare the offsets become its zeros.
"""

import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from meissner.calibration import GAIN_SHIFT, Calibration
from meissner.host.core import Core
from meissner.terminal import sides

SWAP_S = 5.0  # the longest wait for a frame's end, or for the end of an averaging
WHAT = "the calibration"
TRIES = 3  # if the core is reset meanwhile, or a swap had to be sent again
ROW_COLUMN_BITS = 16  # of an offset where the tables are of rows and columns (core.widths)


def load(core: Core, lines: Calibration) -> None:
    """Write ``lines`` into ``core``, and again after each reset; forces then have the unit ``force_lsb_n``.

    Raises
    ------
    ValueError
        If the core cannot take this calibration, or a register reads back another value than was written.
    OSError
        If the core is reset again and again meanwhile, or does not answer.
    """
    check(core, lines)
    core.forget(WHAT)
    for _ in range(TRIES):
        restarts = core.counts.restarts
        if _write(core, lines) and core.counts.restarts == restarts:
            break
    else:
        raise OSError(
            "the core was reset, or did not answer in time, in each attempt to write its calibration"
        )
    core.units = replace(core.units, newtons_per_code=lines.force_lsb_n)
    core.keep(WHAT, lambda: load(core, lines))


def check(core: Core, lines: Calibration) -> None:
    """Raise ValueError with one sentence if ``core`` cannot hold ``lines``."""
    if not core.registers:
        raise ValueError("this core is only listened to: a calibration is loaded over its registers")
    if "calibrate" not in core.features:
        raise ValueError("this core has no array, and so no calibration")
    if core.build["offset"] == ROW_COLUMN_BITS:
        raise ValueError(
            "this core has gains of rows and columns, not of cells: gains = 'row_column' in its configuration"
        )
    own, size = lines.offset.shape, (core.units.rows, core.units.columns)
    if own != size:
        raise ValueError(f"the calibration has {sides(own)} cells but the core has {sides(size)}")
    if lines.gain_shift != GAIN_SHIFT:
        raise ValueError(f"the calibration has gain_shift = {lines.gain_shift} but the core has {GAIN_SHIFT}")


def _places(core: Core) -> Iterator[tuple[int, int, int, int]]:
    """(row, column, beat, lanes) of every cell; the last column's lanes include those beyond it."""
    assert core.units.rows and core.units.columns
    row_beats, lanes = core.build["beats"] // core.units.rows, core.build["lanes"]
    for row, column in np.ndindex(core.units.rows, core.units.columns):
        lane = column % lanes
        last = column == core.units.columns - 1
        mask = (1 << lanes) - (1 << lane) if last else 1 << lane
        yield row, column, row * row_beats + column // lanes, mask


def _put(core: Core, name: str, value: int) -> None:
    core[name] = value
    found = core[name]
    if found != value:
        raise ValueError(f"{name} reads back {found} where {value} was written: the core is not calibrated")


def wait(core: Core, name: str, value: int, what: str, other: bool = False) -> None:
    """Until the register is ``value``, or ``other`` than that; ValueError says ``what`` did not happen."""
    end = time.monotonic() + SWAP_S
    while (core[name] == value) == other:
        if time.monotonic() > end:
            raise ValueError(f"{what} within {SWAP_S:g} s: {name} is {'still' if other else 'not'} {value}")


def _write(core: Core, lines: Calibration) -> bool:
    """Whether the swap was sent once: one sent again may have exchanged the halves back."""
    zeroed = "tare" in core.features
    for row, column, word, mask in _places(core):
        _put(core, "calibrate.word", word)
        if not zeroed:
            _put(core, "calibrate.offset", int(lines.offset[row, column]))
        _put(core, "calibrate.gain", 0 if lines.dead[row, column] else int(lines.gain[row, column]))
        core["calibrate.write"] = mask
    if zeroed:
        _write_zeros(core, lines)
    retries = core.counts.retries
    core["calibrate.swap"] = 1
    once = core.counts.retries == retries
    wait(core, "calibrate.swapping", 0, "the core did not take the calibration")
    return once


def _write_zeros(core: Core, lines: Calibration) -> None:
    _put(core, "tare.load", 1)
    try:
        wait(core, "tare.state.loading", 1, "the core did not end its averaging of zeros")
        for row, column, word, mask in _places(core):
            _put(core, "tare.word", word)
            _put(core, "tare.zero", int(lines.offset[row, column]))
            core["tare.write"] = mask
    finally:
        _put(core, "tare.load", 0)
    wait(core, "tare.state.loading", 0, "the core did not go on from its new zeros")
