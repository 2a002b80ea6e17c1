"""Bit-exact twins of rtl/cop/msn_cop.sv, centre of pressure and load of frames of forces, and of its parts:
msn_cop_accumulate.sv, load and first moments, and msn_cop_divide.sv, the centre from these."""

import numpy as np

from meissner.twins.common.divide import divide, steps
from meissner.twins.shared import LANES, one_of, within


def check_size(rows, columns):
    """Raise ValueError for a size at which the RTL does not elaborate."""
    within(rows=(rows, 1, 1024), columns=(columns, 1, 1024))


def sum_bits(rows, columns):
    """Width of the load S."""
    return 16 + (rows * columns - 1).bit_length()


def moments(forces):
    """S, Mx and My of each frame, exact; ``forces``: integers 0 .. 65535 [..., rows, columns].

    S = sum F     Mx = sum (2j - (n-1)) F     My = sum ((m-1) - 2i) F

    with rows i from top to bottom, columns j from left to right, both from zero. Returns int64 arrays.
    """
    forces = np.asarray(forces, dtype=np.int64)
    rows, columns = forces.shape[-2:]
    check_size(rows, columns)
    if (forces < 0).any() or (forces > 65535).any():
        raise ValueError("forces must lie in 0 .. 65535")
    by_column, by_row = forces.sum(axis=-2), forces.sum(axis=-1)
    mx = by_column @ (2 * np.arange(columns) - (columns - 1))
    my = by_row @ ((rows - 1) - 2 * np.arange(rows))
    return by_row.sum(axis=-1), mx, my


class CopAccumulate:
    """``moments`` on a stream: beats of ``lanes`` columns as FrameMarker passes them, a row's last padded.

    A frame with a beat that does not fit is dropped entirely and counted in ``damaged``.
    """

    def __init__(self, rows, columns, lanes=1):
        check_size(rows, columns)
        one_of([*LANES, 16], lanes=lanes)
        self.rows, self.columns, self.lanes = rows, columns, lanes
        self.row_beats = -(-columns // lanes)
        self.reset()

    def reset(self):
        """The next beat should be the first of a frame."""
        self.damaged = 0
        self._beats, self._dropping = [], False

    def next(self, data, last, fits=True):
        """One beat of ``lanes`` forces; returns (S, Mx, My) of the frame that it completes, or None."""
        self._beats.append(data)
        self.damaged += not fits and not self._dropping
        whole = fits and not self._dropping
        self._dropping = not last and (self._dropping or not fits)
        if not last:
            return None
        beats, self._beats = self._beats, []
        if not whole:
            return None
        padded = np.array(beats, dtype=np.int64).reshape(self.rows, self.row_beats * self.lanes)
        return tuple(int(value) for value in moments(padded[:, : self.columns]))

    def process(self, data, lasts, fits=None):
        """``reset`` and then ``next`` for each beat; returns the list of (S, Mx, My), one per frame."""
        self.reset()
        fits = [True] * len(lasts) if fits is None else fits
        results = [self.next(*beat) for beat in zip(data, lasts, fits)]
        return [result for result in results if result is not None]


def cop_divide(total, mx, my, rows, columns, fraction_bits=14, min_load=1):
    """x, y and whether they are valid, from each frame's S, Mx, My.

    x = Mx / ((n-1) S)     y = My / ((m-1) S)

    in Q2.fraction_bits, rounded to nearest, ties away from zero. Not valid, with x = y = 0, if S is 0 or
    below ``min_load``; a single column gives x = 0, a single row y = 0. Returns int32 x, int32 y, bool.
    """
    check_size(rows, columns)
    within(fraction_bits=(fraction_bits, 4, 20))
    total, mx, my = (np.asarray(value, dtype=np.int64) for value in (total, mx, my))
    pressed = (total > 0) & (total >= min_load)
    safe = np.where(total > 0, total, 1)
    x = divide(mx, (columns - 1) * safe, fraction_bits) if columns > 1 else np.zeros_like(mx)
    y = divide(my, (rows - 1) * safe, fraction_bits) if rows > 1 else np.zeros_like(my)
    return np.where(pressed, x, 0).astype(np.int32), np.where(pressed, y, 0).astype(np.int32), pressed


def cop(forces, fraction_bits=14, min_load=1):
    """x, y, load and whether x and y are valid, per frame; ``forces``: 0 .. 65535 [..., rows, columns]."""
    total, mx, my = moments(forces)
    rows, columns = np.shape(forces)[-2:]
    x, y, pressed = cop_divide(total, mx, my, rows, columns, fraction_bits, min_load)
    return x, y, total, pressed


def latency(lanes=1, fraction_bits=14, bits_per_clock=2):
    """Clocks of the RTL from a frame's last beat to its centre of pressure, the same for every frame."""
    return 3 + (lanes - 1).bit_length() + steps(fraction_bits, bits_per_clock)
