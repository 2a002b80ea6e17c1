"""Bit-exact twins of the blocks of rtl/common that follow the beats of frames:

FrameFilter    msn_frame_filter.sv    passes frames, resynchronises on ``last``
FrameMarker    msn_frame_marker.sv    numbers beats, passes no damaged frame as complete
first_frame    msn_frame_gate.sv      which frame is the first to use new settings
FrameOwed      msn_frame_owed.sv      whether results of a frame are still outstanding
FrameTable     msn_frame_table.sv     one word per beat of a frame, in one or two banks
"""

from typing import NamedTuple

import numpy as np

from meissner.twins.shared import one_of, within


class FrameFilter:
    """Channels must count 0 .. channels-1 with ``last`` on the final one.

    From the first sample that breaks this, the rest of the frame is dropped, up to and including its
    ``last``, where the frame is counted as damaged. The next frame is marked ``restart``; so is the first
    frame after reset.
    """

    def __init__(self, channels):
        within(channels=(channels, 1, None))
        self.channels = channels
        self.reset()

    def reset(self):
        """The next sample should be channel 0 of a first frame."""
        self.damaged = 0
        self._expected, self._dropping, self._restart = 0, False, True

    def next(self, channel, last):
        """One sample; returns (kept, restart)."""
        fits = channel == self._expected and last == (channel == self.channels - 1)
        kept, restart = fits and not self._dropping, self._restart
        bad = self._dropping or not fits
        self.damaged += last and bad
        if last:
            self._expected, self._dropping, self._restart = 0, False, bad
        else:
            self._expected, self._dropping = self._expected + 1, bad
        return kept, restart

    def process(self, channels, lasts):
        """``reset`` and then ``next`` for each pair; returns two lists."""
        self.reset()
        pairs = [self.next(int(c), bool(e)) for c, e in zip(channels, lasts)]
        return [kept for kept, _ in pairs], [restart for _, restart in pairs]


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
        within(rows=(rows, 1, None), row_beats=(row_beats, 1, None))
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


def first_frame(beat, frame_beats):
    """Index of the first frame with settings that became pending when ``beat`` beats had been offered.

    ``beat`` includes a beat offered in that clock, even if it is not taken yet.

    A frame that has begun keeps the old settings; between two frames, the next frame has the new ones.
    """
    within(frame_beats=(frame_beats, 1, None))
    return -(-beat // frame_beats)


class FrameOwed:
    """Each frame owes ``results``; a lost one is given up after 2**``quiet_bits`` - 1 quiet clocks."""

    def __init__(self, results=1, quiet_bits=9):
        within(results=(results, 1, None), quiet_bits=(quiet_bits, 2, 16))
        self.results, self.quiet_bits = results, quiet_bits
        self.reset()

    def reset(self):
        self.owed, self.still = set(), 0

    def next(self, taken, first, done, drop, quiet):
        """``busy_o`` in this clock; ``done``: a flag for each result."""
        busy = bool(self.owed)
        lost = self.still == (1 << self.quiet_bits) - 1
        if taken and first:
            self.owed = set(range(self.results))
        elif drop or lost:
            self.owed = set()
        else:
            self.owed = {k for k in self.owed if not done[k]}
        self.still = self.still + 1 if busy and first and quiet and not taken and not lost else 0
        return busy

    def process(self, clocks):
        """``next`` for every clock, in order: a list of bools."""
        return [self.next(*clock) for clock in clocks]


class FrameTable:
    """``words`` words of ``parts`` parts per bank; read in order from ``start``, written at any place.

    Words that were never written are undefined in the RTL and 0 here.
    """

    def __init__(self, words, parts=1, banks=2, start=0):
        within(words=(words, 1, None), parts=(parts, 1, None))
        one_of((1, 2), banks=banks)
        if not 0 <= start < words:
            raise ValueError(f"start = {start} must be below words = {words}")
        self.start = start
        self._memory = np.zeros((banks, words, parts), dtype=np.int64)
        self.restart()

    def restart(self, bank=0):
        """Read from word ``start`` of ``bank`` next."""
        self._bank, self._at = bank, self.start

    def next(self, count):
        """The next ``count`` words [count, parts], wrapping around at the end of the bank."""
        words = self._memory.shape[1]
        at = (self._at + np.arange(count)) % words
        self._at = (self._at + count) % words
        return self._memory[self._bank, at]

    def write(self, bank, word, data, parts=slice(None)):
        """Write the ``parts`` of one word."""
        self._memory[bank, word, parts] = data
