"""Bit-exact twin of rtl/cop/msn_cop_accumulate.sv: load and first moments of frames of forces."""

import numpy as np

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
        one_of(LANES, lanes=lanes)
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
