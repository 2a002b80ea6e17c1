"""Bit-exact twins of rtl/frontend/msn_health.sv, which finds taxels that cannot be trusted, and
msn_health_report.sv: events of beats to reports of single taxels."""

from dataclasses import dataclass

import numpy as np

from meissner.twins.frontend.calibrate import check_array
from meissner.twins.frontend.health_taxel import BLINKING, DEAD, RAILED, State, judge
from meissner.twins.shared import LANES, Stream, fits, one_of, within

# Slices of an array with a border of one: each taxel, and its left, right, upper and lower neighbours.
HERE = (slice(1, -1), slice(1, -1))
SIDES = tuple((HERE[0], slice(at, at - 2 or None)) for at in (0, 2))
SIDES += tuple((slice(at, at - 2 or None), HERE[1]) for at in (0, 2))


@dataclass
class Limits:
    """The registers of msn_health, in codes unless stated; ``still``, ``rail``, ``blink`` 0: off."""

    band: int = 24  # a larger step is a move
    jump: int = 200  # a larger step is a jump
    low: int = -65536  # at it or below: railed
    high: int = 65535  # at it or above: railed
    over_range_enable: bool = False  # the converter's over-range counts as railed
    edges: bool = True  # judge a taxel at a border by its single neighbour
    still: int = 240
    rail: int = 8  # x 16 frames
    blink: int = 64

    def __post_init__(self):
        fits(self, still=(0, 255), rail=(0, 255), blink=(0, 255))


class Health(Stream):
    """Finds dead, railed and blinking taxels in a stream of frames.

        moved = |raw - held| > band, then held = raw      recent = moved in the last 3 frames, up or down
        dead      its count reaches ``still``: +4 per frame without a move of its own while both neighbours in
                  its row or column are recent in the same direction (+1 with ``edges``, for the single
                  neighbour at a border)
        railed    at ``low``, ``high`` or over-range without a break over ``rail`` of the frames 0, 16 ..
        blinking  its count reaches ``blink``: +16 per step > jump while no neighbour is recent, else -1

    The neighbours' state is that at the end of the last complete frame; health_taxel judges each taxel. A
    faulty taxel is masked from the next frame on until ``clear``; a beat that does not fit is masked.
    """

    def __init__(self, rows, columns, lanes=1, sample_bits=17, limits=None):
        check_array(rows, columns, lanes, sample_bits)
        self.rows, self.columns, self.lanes, self.sample_bits = rows, columns, lanes, sample_bits
        self.limits = limits or Limits()
        self.row_beats = -(-columns // lanes)
        shape = (rows, columns)
        self._state = State.none(shape)
        self._history = np.zeros((2, 2, rows + 2, columns + 2), dtype=bool)  # bank; recent, rising
        self._row_ends, self._column_ends = np.zeros((2, *shape), dtype=bool)
        self._row_ends[:, [0, -1]] = columns > 1
        self._column_ends[[0, -1], :] = rows > 1
        self.reset()

    @property
    def faults(self):
        """For each taxel, the sum of its DEAD, RAILED, BLINKING."""
        return self._state.faults

    def reset(self):
        """All taxels are healthy, nothing is known of them, the counts are 0."""
        self.dead = self.railed = self.blinking = 0
        self._fresh, self._again, self._clear, self._report, self._midway = True, False, False, False, False
        self._bank = self._tick = 0
        self._beats = []

    def clear(self):
        """Forget every fault before the next frame."""
        self._clear = True
        self._settle()

    def report(self):
        """Send the events of all faults again with the next frame."""
        self._report = True
        self._settle()

    def next(self, raw, over=None):
        """Masks, bool [frames, rows, columns], of complete frames, and each frame's list of events.

        ``over``: over-range flags. An event: (beat, dead, railed, blinking), the last three a bit per lane.
        """
        raw = np.asarray(raw, dtype=np.int64)
        over = np.zeros(raw.shape, dtype=bool) if over is None else np.asarray(over, bool)
        masks, events = np.empty(raw.shape, dtype=bool), []
        for frame in range(len(raw)):
            masks[frame] = self._mask()
            events.append(self._learn(raw[frame], over[frame], None, True))
        return masks, events

    def beat(self, raw, over, id_, last, fits=True):
        """One beat as FrameMarker passes it: its mask, and the events of the frame that it ends."""
        self._midway = True
        if fits:
            self._beats.append((raw, over))
        padded = np.zeros((self.rows, self.row_beats * self.lanes), dtype=bool)
        padded[:, : self.columns] = self._mask()
        mask = padded.reshape(-1, self.lanes)[id_] | (not fits)
        return mask, self._end(bool(fits)) if last else []

    def _settle(self):
        """Carry out commands, which take effect only between frames."""
        if self._midway:
            return
        if self._clear:
            self._fresh, self.dead, self.railed, self.blinking = True, 0, 0, 0
        self._again |= self._report
        self._clear = self._report = False

    def _mask(self):
        return (self.faults != 0) & (not self._fresh)

    def _end(self, whole):
        """Learn from the beats that arrived in their places."""
        size = self.rows * self.row_beats, self.lanes
        raw, over, seen = (
            np.zeros(size, dtype=np.int64),
            np.zeros(size, dtype=bool),
            np.zeros(size, dtype=bool),
        )
        for beat, (samples, flags) in enumerate(self._beats):
            raw[beat], over[beat], seen[beat] = samples, flags, True
        self._beats = []
        raw, over, seen = (a.reshape(self.rows, -1)[:, : self.columns] for a in (raw, over, seen))
        return self._learn(raw, over, seen, whole)

    def _learn(self, raw, over, seen, whole):
        """Update every taxel that was ``seen`` (None: all); returns the events."""
        c, tick = self.limits, self._tick == 0
        recent, rose = self._history[self._bank]
        recent = recent & (not self._fresh)
        left, right, up, down = (recent[side] for side in SIDES)
        rose_left, rose_right, rose_up, rose_down = (rose[side] for side in SIDES)
        pair = (left & right & (rose_left == rose_right)) | (up & down & (rose_up == rose_down))
        beside, along = left | right, up | down
        border = (beside & self._row_ends) | (along & self._column_ends)
        lonely = ~(beside | along)
        around = (pair, border & c.edges, lonely)
        judged = judge(self._state, raw, over, around, c, tick, self._fresh, self._again)
        news, event = judged.news, judged.event
        if seen is not None:
            news, event = news * seen, event & seen
        if news.any():
            self.dead += int((news & DEAD != 0).sum())
            self.railed += int((news & RAILED != 0).sum())
            self.blinking += int((news & BLINKING != 0).sum())
        events = self._events(judged.state.faults, event, seen)

        after, moves = judged.state, np.stack([judged.moved, judged.rose])
        other = 1 - self._bank
        if seen is not None:
            after = State(*(np.where(seen, new, old) for new, old in zip(after, self._state)))
            moves = np.where(seen, moves, self._history[other][(slice(None), *HERE)])
        self._state = after
        self._history[other][(slice(None), *HERE)] = moves
        if whole:
            self._bank, self._tick = other, (self._tick + 1) % 16
            self._fresh = self._again = False
        self._midway = False
        self._settle()
        return events

    def _events(self, faults, event, seen):
        """(beat, dead, railed, blinking) of each beat in which a taxel has an event."""
        if not event.any():
            return []
        words = []
        for bits in (event, faults & DEAD != 0, faults & RAILED != 0, faults & BLINKING != 0):
            padded = np.zeros((self.rows, self.row_beats * self.lanes), dtype=np.int64)
            padded[:, : self.columns] = bits if seen is None else bits & seen
            words.append(padded.reshape(-1, self.lanes) @ (1 << np.arange(self.lanes)))
        return [(int(beat), *(int(word[beat]) for word in words[1:])) for beat in np.flatnonzero(words[0])]


def reports(events, lanes, columns=None):
    """(taxel, faults) of ``events``: (id of the beat, dead, railed, blinking), a bit for each lane.

    taxel = row columns + beat lanes + lane; ``columns`` None: as many as the lanes, or a multiple of them.
    """
    one_of(LANES, lanes=lanes)
    columns = lanes if columns is None else columns
    within(columns=(columns, 1, 1024))
    row_beats, found = -(-columns // lanes), []
    for beat, dead, railed, blinking in events:
        for lane in range(lanes):
            kinds = ((dead, DEAD), (railed, RAILED), (blinking, BLINKING))
            faults = sum(kind for bits, kind in kinds if bits >> lane & 1)
            row, place = divmod(beat, row_beats)
            found += [(row * columns + place * lanes + lane, faults)] if faults else []
    return found
