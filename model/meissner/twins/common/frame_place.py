"""Bit-exact twin of rtl/common/msn_frame_place.sv: the place of a beat in its frame, may it pass."""

from typing import NamedTuple


class Place(NamedTuple):
    """What is known of one beat."""

    place: int
    keep: bool  # let it pass
    last: bool  # marked so
    fits: bool  # it is the beat of this place, no damage before it
    whole: bool  # and it ends its frame


class FramePlace:
    """Beats must count 0 .. beats-1 with ``last`` on the final one (whose id is then not asked).

    A frame that breaks this is counted in ``damaged``, and what passes of it is too short (broken before
    the final beat: the broken one is marked ``last``, the rest dropped) or one too long (``last`` missing
    on the final beat: of the rest only the beat that brings ``last`` passes).
    """

    def __init__(self, beats):
        if beats < 1:
            raise ValueError(f"beats = {beats} must be at least 1")
        self.beats = beats
        self.reset()

    def reset(self):
        """The next beat should be the first of a frame."""
        self.damaged = 0
        self._place, self._dropping, self._closed = 0, False, False

    def next(self, id_, last):
        """One beat; returns its Place."""
        final = self._place == self.beats - 1
        right = bool(last) if final else not last and id_ == self._place
        fits = right and not self._dropping
        keep = not self._dropping or (bool(last) and not self._closed)
        result = Place(self._place, keep, bool(last) or not (right or final), fits, fits and final)
        self.damaged += not right and not self._dropping
        if not self._dropping:
            self._closed = not final
        self._dropping = not last and (self._dropping or not right)
        self._place = 0 if last or final else self._place + 1
        return result

    def process(self, ids, lasts):
        """``reset`` and then ``next`` for each beat; returns the list of Places."""
        self.reset()
        return [self.next(int(id_), bool(last)) for id_, last in zip(ids, lasts)]
