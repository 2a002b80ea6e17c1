"""The rubber's physics block by block, with a state that allows reloading, for a hand in closed loop.

    Ring         M = N - T/mu   the stick core's radius varies as M^(1/3), q = T/(mu N) = 1 - M/N
                 a patch lets go when q passes its place and M is below the remembered minimum m
                 m' = min(m, M); while M > m:  dm/dt = (M - m)/heal_s
    Level        u of rubber.shear_level, for a shear speed that is steady within a block
    Fluctuation  e(t) of rubber.fluctuation: one complex pole, its last value kept
    Ripple       plate's ripple as a tape that is read in a loop

For a pull that only grows, these give the same as the forms for a complete run (plate.pull,
rubber.event_ratios, shear_level, fluctuation); they also cover a load that falls or a grip that rises. Then
the contact sticks everywhere, and the slipped part slips again only when N - T/mu falls below its former
value (Mindlin and Deresiewicz), unless it has stuck for long: the memory ``m`` fades with ``heal_s``. A patch
keeps its place and size until the whole contact has slid; then a new, fully slipped contact replaces it.

All arrays are [contacts] or [contacts, samples]; a contact is one finger of one run.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from meissner.arrays import Floats, Ints, Values
from meissner.physics import plate, rubber

HEAL_S = 0.1
ORIGINS = {
    "HEAL_S": (
        "chosen",
        "no paper says how soon a patch that sticks again can let go again; a filled rubber creeps within "
        "tenths of a second",
        "grip_pour at 0.875, seeds 1001 to 1020: ratio 1.17 at 0.02 s, 1.16 at 0.1 s, 1.08 at 0.5 s; none of "
        "60 dropped",
    ),
}


Events = tuple[Ints, Floats, Floats]  # contacts, samples, shares


class Ring:
    """The ring of partial slip of each contact. ``places``: lists of q, ascending, one list per contact.

    ``shares``: of the conductance, in the same lists. ``heal_s``: of the memory; inf: it never fades.
    """

    def __init__(
        self, places: Sequence[Floats], shares: Sequence[Floats], friction: ArrayLike, heal_s: Values = HEAL_S
    ) -> None:
        self.friction, self.heal_s = np.asarray(friction, dtype=float), heal_s
        contacts, most = len(places), max(map(len, places))
        self.places = np.full((contacts, most), np.inf)
        self.shares = np.zeros((contacts, most))
        self.margin = np.full(contacts, np.inf)  # m; inf: nothing has ever slipped
        self.ratio = np.zeros(contacts)  # q of the last sample
        for contact, (place, share) in enumerate(zip(places, shares)):
            self.renew(contact, place, share)

    def renew(self, contact: int, places: Floats, shares: Floats, slid: bool = False) -> None:
        """Start a new contact with new patches; ``slid``: all of it has slipped."""
        more = len(places) - self.places.shape[1]
        if more > 0:
            self.places = np.pad(self.places, ((0, 0), (0, more)), constant_values=np.inf)
            self.shares = np.pad(self.shares, ((0, 0), (0, more)))
        self.places[contact], self.shares[contact] = np.inf, 0.0
        self.places[contact, : len(places)], self.shares[contact, : len(places)] = places, shares
        if slid:
            self.margin[contact] = 0.0

    def start(self, force_n: Floats, tension_n: Floats) -> None:
        """Take this hold as given before the run: the part that slips under it has already slipped."""
        self.margin = force_n - tension_n / self.friction
        self.ratio = tension_n / (self.friction * force_n)

    def reach(self, force_n: Floats) -> Floats:
        """q up to which the contacts have slipped under the present force."""
        known = np.isfinite(self.margin)
        return np.where(known, np.clip(1.0 - np.where(known, self.margin, 0.0) / force_n, 0.0, 1.0), 0.0)

    def next(self, force_n: Floats, tension_n: Floats, block_s: float) -> Events:
        """(contact, sample, shares) of the patches that let go, in order of contact and instant.

        ``sample``: the instant in samples of this block, unrounded; -1 is the last sample before the block.
        """
        margin_n = force_n - tension_n / self.friction[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(force_n > 0, tension_n / (self.friction[:, None] * force_n), 1.0)
        low = margin_n.min(axis=1)
        with np.errstate(invalid="ignore"):
            slipped = np.where(np.isfinite(self.margin), 1.0 - self.margin / force_n.min(axis=1), -1.0)
        near = (self.places > slipped[:, None]) & (self.places <= ratio.max(axis=1)[:, None])
        found = np.flatnonzero((low < self.margin) & near.any(axis=1))
        events = [
            self._of(contact, margin_n[contact], ratio[contact], force_n[contact])
            for contact in found.tolist()
        ]
        self.ratio = ratio[:, -1]
        last = margin_n[:, -1]
        self.margin = np.minimum(self.margin, low)
        self.margin += np.maximum(last - self.margin, 0.0) * -np.expm1(-block_s / self.heal_s)
        if not events:
            return np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros(0)
        samples, shares = zip(*events)
        counts = [len(sample) for sample in samples]
        return np.repeat(found, counts), np.concatenate(samples), np.concatenate(shares)

    def _of(self, contact: int, margin_n: Floats, ratio: Floats, force_n: Floats) -> tuple[Floats, Floats]:
        """(sample, shares) of one contact whose core shrinks below the remembered minimum."""
        below = margin_n <= self.margin[contact]
        first = int(np.argmax(below))
        slipped = 1.0 - self.margin[contact] / force_n[first] if np.isfinite(self.margin[contact]) else -1.0
        reached = np.maximum.accumulate(np.where(below, ratio, -1.0))
        places = self.places[contact]
        low, high = np.searchsorted(places, [slipped, reached[-1]], side="right")
        places = places[low:high]
        at = np.searchsorted(reached, places)
        before = np.where(at > 0, ratio[at - 1], self.ratio[contact])
        with np.errstate(divide="ignore", invalid="ignore"):
            part = (places - before) / (ratio[at] - before)
        part = np.where(np.isfinite(part), np.clip(part, 0.0, 1.0), 1.0)
        return at - 1 + part, self.shares[contact, low:high]


class Level:
    """u of each contact."""

    def __init__(self, contacts: int, recovers: float = rubber.RESTORED) -> None:
        self.recovers = recovers
        self.level, self.left = np.zeros(contacts), np.zeros(contacts)
        self.moved = np.zeros(contacts, dtype=bool)

    def next(self, speed_mm_s: Floats, samples: int, rate_hz: float) -> Floats:
        """u [contacts, samples] of a block in which the rubber shears at ``speed_mm_s`` [contacts]."""
        speed = np.abs(speed_mm_s)
        stops = self.moved & (speed == 0)  # the residual is a share of the present level
        self.left = np.where(stops, (1.0 - self.recovers) * self.level, self.left)
        self.moved = speed > 0
        target = np.where(self.moved, speed**rubber.SHEAR_EXPONENT, self.left)
        rate = 3.0 * (speed / rubber.SHEAR_FULL_MM + 1.0 / rubber.RECOVERY_S)
        since_s = np.arange(1, samples + 1) / rate_hz
        fall = np.exp(-rate[:, None] * since_s)
        level = target[:, None] + (self.level - target)[:, None] * fall
        self.level = level[:, -1]
        return level


class Fluctuation:
    """e(t) of each contact."""

    def __init__(self, contacts: int, rate_hz: float) -> None:
        self.pole = (-1.0 / rubber.RING_S + 2j * np.pi * rubber.RING_HZ) / rate_hz
        self.last = np.zeros(contacts, dtype=complex)

    def next(self, contact: Ints, sample: Floats, shares: Floats, samples: int) -> tuple[Ints, Floats]:
        """(contacts that ring, e [these contacts, samples]); events as from ``Ring.next``."""
        from scipy.signal import lfilter

        ringing = np.abs(self.last) > 1e-18
        ringing[contact] = True
        rows = np.flatnonzero(ringing)
        self.last[~ringing] = 0.0
        if not len(rows):
            return rows, np.zeros((0, samples))
        index = np.ceil(sample).astype(np.int64)
        drive = shares * np.exp(self.pole * (index - sample))
        comb = np.zeros((len(rows), samples), dtype=complex)
        np.add.at(comb, (np.searchsorted(rows, contact), index), drive)
        turn = np.exp(self.pole)
        rung, _ = lfilter([1.0], [1.0, -turn], comb, axis=1, zi=(turn * self.last[rows])[:, None])
        self.last[rows] = rung[:, -1]
        return rows, rung.real


class Ripple:
    """Unit ripple of a moving stage, [runs, samples] per block, from a tape of two seconds that repeats."""

    def __init__(self, rate_hz: float, rngs: Sequence[np.random.Generator]) -> None:
        samples = round(2.0 * rate_hz)
        self.tape = np.stack([plate._ripple(samples, rate_hz, rng) for rng in rngs])
        self.place = 0

    def next(self, samples: int) -> Floats:
        at = (self.place + np.arange(samples)) % self.tape.shape[1]
        self.place = int(at[-1]) + 1
        return self.tape[:, at]
