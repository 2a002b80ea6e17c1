"""Bit-exact twin of rtl/frontend/msn_tare.sv: each taxel's own zero, found by averaging, then tracked."""

import numpy as np

from meissner.twins.common.arithmetic import round_sat
from meissner.twins.frontend.calibrate import check_array
from meissner.twins.shared import Stream, within


class Tare(Stream):
    """Subtracts each taxel's own zero b from its samples; finds b, and tracks it while nothing presses.

        r = raw - o   o = floor(b + 1/2)   contact = r > contact    b in steps of 2^-fraction_bits codes,
                                                                    o saturates to a sample's bits
        each frame, not in contact: b += sign(r) step               frozen in contact
        after ``tare``: b += (sum of r over the next 2^tare_log2 frames) / 2^tare_log2, exact, for all taxels
        with the same frame; refused, with no change, if an unmasked taxel was in contact in these frames

    ``contact``: codes; ``step``: steps of b per frame, 0 .. 255. The state is all integers.
    """

    def __init__(
        self, rows, columns, lanes=1, sample_bits=17, fraction_bits=12, tare_log2=4, contact=64, step=1
    ):
        check_array(rows, columns, lanes, sample_bits)
        within(fraction_bits=(fraction_bits, 1, 16), tare_log2=(tare_log2, 0, min(fraction_bits, 8)))
        within(step=(step, 0, 255))
        if sample_bits + fraction_bits < 9:  # b overshoots by at most a step of 255
            raise ValueError(
                f"sample_bits = {sample_bits} and fraction_bits = {fraction_bits} must add to 9 or more"
            )
        self.rows, self.columns, self.lanes, self.sample_bits = rows, columns, lanes, sample_bits
        self.fraction_bits, self.tare_log2, self.contact, self.step = fraction_bits, tare_log2, contact, step
        self.row_beats = -(-columns // lanes)
        beats = rows * self.row_beats
        column = np.arange(beats * lanes).reshape(beats, lanes) % (self.row_beats * lanes)
        self._surplus = column >= columns
        self._zero = np.zeros((beats, lanes), dtype=np.int64)
        self._sum = np.zeros((beats, lanes), dtype=np.int64)
        self.reset()

    def reset(self):
        """All zeros are 0, no request is pending, the counters are 0."""
        self.tared = self.refused = self.swallowed = 0
        self.pressed = self.loading = False
        self._fresh, self._asked, self._midway = True, None, False
        self._averaging = self._forced = self._commit = self._any_contact = False
        self._frames = 0
        self._load = False

    @property
    def taring(self):
        """Whether an averaging is requested or not finished."""
        return self._asked is not None or self._averaging or self._commit

    def tare(self, force=False):
        """Average the next frames into the zeros; ``force``: also while pressed."""
        self._asked = force
        self._settle()

    def load(self, on):
        """While ``on`` (from the next frame, after any averaging), frames are dropped and zeros written."""
        self._load = on
        self._settle()

    def write(self, word, offset, lanes=slice(None)):
        """Write the zero, in codes, of ``lanes`` of one beat; ignored unless ``loading``."""
        if self.loading:
            self._zero[word, lanes] = offset << self.fraction_bits
            self._sum[word, lanes] = 0

    def zeros(self):
        """Zeros in codes [rows, columns], exact in float64."""
        words = (self._effective(slice(None)) / 2.0**self.fraction_bits).reshape(self.rows, -1)
        return words[:, : self.columns]

    def next(self, raw, mask=None):
        """r of complete frames [frames, rows, columns]; ``mask``: taxels whose contact is ignored."""
        raw = np.asarray(raw, dtype=np.int64)
        count = len(raw)
        wide = (count, self.rows, self.row_beats * self.lanes)
        padded, masked = np.zeros(wide, dtype=np.int64), np.zeros(wide, dtype=bool)
        padded[:, :, : self.columns] = raw
        if mask is not None:
            masked[:, :, : self.columns] = mask
        flat = (count, *self._zero.shape)
        padded, masked = padded.reshape(flat), masked.reshape(flat)
        out = np.empty_like(padded)
        for frame in range(count):
            out[frame] = self._take(slice(None), padded[frame], masked[frame], True)
            self._end(True)
        return out.reshape(wide)[:, :, : self.columns]

    def beat(self, raw, id_, last, mask, fits=True):
        """One beat as FrameMarker passes it: r of its ``lanes``, 0 if it does not fit; None while loading."""
        self._midway = True
        swallowed = self.loading
        r = self._take(id_, np.asarray(raw), np.asarray(mask, bool), fits and not swallowed)
        if last:
            self._end(bool(fits))
        return None if swallowed else r if fits else np.zeros_like(r)

    def _effective(self, at):
        if self._fresh:
            return np.zeros_like(self._zero[at])
        if not self._commit:
            return self._zero[at]
        return self._zero[at] + (self._sum[at] << (self.fraction_bits - self.tare_log2))

    def _settle(self):
        """Begin or end loading, then averaging, which happens only between frames."""
        if self._midway:
            return
        wanted = self._load and not self._averaging and not self._commit
        if wanted != self.loading:
            self.loading, self._fresh = wanted, False
        if self._asked is not None and not (self._averaging or self._commit or self.loading):
            self._averaging, self._forced, self._frames, self._asked = True, self._asked, 0, None

    def _take(self, at, raw, mask, learn):
        zero = self._effective(at)
        zero_bits = self.sample_bits + 1 + self.fraction_bits
        r = raw - round_sat(zero, zero_bits, self.sample_bits, self.fraction_bits)
        if learn:
            contact = r > self.contact
            if contact.any():
                self._any_contact |= bool((contact & ~mask & ~self._surplus[at]).any())
            if self._averaging:
                self._sum[at] = r + (self._sum[at] if self._frames else 0)
            else:
                self._sum[at] = 0
                zero = zero if self._commit else zero + np.sign(r) * ~contact * self.step
            self._zero[at] = zero
        return r

    def _end(self, whole):
        any_contact, self._any_contact, self._midway = self._any_contact, False, False
        self.swallowed += self.loading
        if self.loading or not whole:
            self._frames = 0
        else:
            self.pressed, self._fresh = any_contact, False
            self.tared += self._commit
            self._commit = False
            self._frames += 1
            if self._averaging and any_contact and not self._forced:
                self._averaging = False
                self.refused += 1
            elif self._averaging and self._frames == 1 << self.tare_log2:
                self._averaging, self._commit = False, True
        self._settle()
