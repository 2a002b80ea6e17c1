"""Bit-exact twin of rtl/common/msn_frame_marker.sv: numbers beats, passes no damaged frame as complete."""

from typing import NamedTuple


class Place(NamedTuple):
    """The marks that pass with the data of a beat."""

    id: int  # its place in the frame
    fits: bool  # the beat belongs at this place, and the frame is undamaged so far
    row_last: bool
    last: bool


class FrameMarker:
    """Beats must count 0 .. rows*row_beats-1 with ``last`` on the final one (whose id is then not checked).

    A frame that breaks this is counted in ``damaged`` and passes with a wrong length. If it breaks before
    the final beat, the wrong beat is marked ``last`` and the rest is dropped: the frame is too short. If
    ``last`` is missing on the final beat, only the later beat with ``last`` passes: the frame is one beat too
    long. A frame is complete if its last beat fits.
    """

    def __init__(self, rows, row_beats):
        for name, value in (("rows", rows), ("row_beats", row_beats)):
            if value < 1:
                raise ValueError(f"{name} = {value} must be at least 1")
        self.rows, self.row_beats = rows, row_beats
        self.reset()

    def reset(self):
        """The next beat should be the first of a frame."""
        self.damaged = 0
        self._place, self._dropping, self._closed = 0, False, False

    def next(self, id_, last):
        """One beat; returns its Place, or None if it does not pass."""
        place, dropping = self._place, self._dropping
        final = place == self.rows * self.row_beats - 1
        right = bool(last) if final else not last and id_ == place
        row_last = place % self.row_beats == self.row_beats - 1
        passes = not dropping or (bool(last) and not self._closed)
        self.damaged += not right and not dropping
        if not dropping:
            self._closed = not final
        self._dropping = not last and (dropping or not right)
        self._place = 0 if last or final or dropping else place + 1
        if not passes:
            return None
        return Place(place, right and not dropping, row_last, bool(last) or not (right or final))

    def process(self, ids, lasts):
        """``reset`` and then ``next`` for each beat; a list of Places, None for a beat that does not pass."""
        self.reset()
        return [self.next(int(id_), bool(last)) for id_, last in zip(ids, lasts)]
