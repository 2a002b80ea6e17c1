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

from meissner.arrays import Bools, Floats, Ints, Values
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
BlockEvents = tuple[Ints, Ints, Floats, Floats]  # contacts, blocks, samples in the block, shares


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

    def next(self, force_n: Floats, tension_n: Floats, block_s: float) -> Events:
        """(contact, sample, shares) of the patches that let go, in order of contact and instant.

        ``sample``: the instant in samples of this block, unrounded; -1 is the last sample before the block.
        """
        contact, _, sample, share = self.ahead(force_n, tension_n, block_s)
        self.keep(1)
        return contact, sample, share

    def ahead(self, force_n: Floats, tension_n: Floats, block_s: float, blocks: int = 1) -> BlockEvents:
        """As ``next`` for several equal blocks, of which ``keep`` then takes some; by block, then contact."""
        contacts = len(force_n)
        margin_n = (force_n - tension_n / self.friction[:, None]).reshape(contacts, blocks, -1)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(force_n > 0, tension_n / (self.friction[:, None] * force_n), 1.0)
        ratio, pressed = ratio.reshape(margin_n.shape), force_n.reshape(margin_n.shape)
        low = margin_n.min(axis=2)
        self.margins = self._margins(low, margin_n[:, :, -1], block_s)
        self.ratios = np.concatenate([self.ratio[:, None], ratio[:, :, -1]], axis=1)
        before = self.margins[:, :-1]
        block, contact = np.nonzero((low < before).T)
        at = contact, block
        with np.errstate(invalid="ignore"):
            slipped = np.where(np.isfinite(before[at]), 1.0 - before[at] / pressed.min(axis=2)[at], -1.0)
        places = self.places[contact]
        near = (places > slipped[:, None]) & (places <= ratio.max(axis=2)[at][:, None])
        found = near.any(axis=1)
        block, contact = block[found], contact[found]
        events = [
            self._of(
                one,
                self.margins[one, k],
                self.ratios[one, k],
                margin_n[one, k],
                ratio[one, k],
                pressed[one, k],
            )
            for one, k in zip(contact.tolist(), block.tolist())
        ]
        if not events:
            nothing = np.zeros(0, dtype=np.int64)
            return nothing, nothing, np.zeros(0), np.zeros(0)
        samples, shares = zip(*events)
        counts = [len(sample) for sample in samples]
        return (
            *(np.repeat(contact, counts), np.repeat(block, counts)),
            *(np.concatenate(samples), np.concatenate(shares)),
        )

    def _margins(self, low: Floats, last: Floats, block_s: float) -> Floats:
        """m [contacts, blocks + 1] before and after each block."""
        fades = np.broadcast_to(-np.expm1(-block_s / self.heal_s), len(low)).tolist()
        rows = [[margin] for margin in self.margin.tolist()]
        for row, lows, lasts, fade in zip(rows, low.tolist(), last.tolist(), fades):
            margin = row[0]
            for least, end in zip(lows, lasts):
                margin = min(margin, least)
                margin += max(end - margin, 0.0) * fade
                row.append(margin)
        return np.array(rows)

    def keep(self, blocks: int) -> None:
        """Go on after so many of the blocks that ``ahead`` looked at."""
        self.margin, self.ratio = self.margins[:, blocks].copy(), self.ratios[:, blocks].copy()

    def reach(self, force_n: Floats) -> Floats:
        """q up to which the contacts have slipped after each of the blocks, under the force at its end."""
        margins = self.margins[:, 1:]
        known = np.isfinite(margins)
        return np.where(known, np.clip(1.0 - np.where(known, margins, 0.0) / force_n, 0.0, 1.0), 0.0)

    def _of(
        self, contact: int, margin: float, last: float, margin_n: Floats, ratio: Floats, force_n: Floats
    ) -> tuple[Floats, Floats]:
        """(sample, shares) of one contact whose core shrinks below the remembered minimum ``margin``.

        ``last``: the ratio before the block.
        """
        below = margin_n <= margin
        first = int(np.argmax(below))
        slipped = 1.0 - margin / force_n[first] if np.isfinite(margin) else -1.0
        reached = np.maximum.accumulate(np.where(below, ratio, -1.0))
        places = self.places[contact]
        low, high = np.searchsorted(places, [slipped, reached[-1]], side="right")
        places = places[low:high]
        at = np.searchsorted(reached, places)
        before = np.where(at > 0, ratio[at - 1], last)
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
        level = self.ahead(speed_mm_s[:, None], samples, rate_hz)
        self.keep(1)
        return level[:, 0]

    def ahead(self, speed_mm_s: Floats, samples: int, rate_hz: float) -> Floats:
        """u [contacts, blocks, samples] for speeds [contacts, blocks], of which ``keep`` then takes some."""
        speed = np.abs(speed_mm_s)
        rate = 3.0 * (speed / rubber.SHEAR_FULL_MM + 1.0 / rubber.RECOVERY_S)
        fall = np.exp(-rate[:, :, None] * (np.arange(1, samples + 1) / rate_hz))
        moving, lasts = speed**rubber.SHEAR_EXPONENT, fall[:, :, -1].tolist()
        self.states = []  # of each contact and block: level before it, target; level, left, moved after it
        for contact, (level, left, moved) in enumerate(
            zip(self.level.tolist(), self.left.tolist(), self.moved.tolist())
        ):
            rows = []
            for v, target, last in zip(speed[contact].tolist(), moving[contact].tolist(), lasts[contact]):
                if moved and v == 0:  # it stops: the residual is a share of the present level
                    left = (1.0 - self.recovers) * level
                moved, before = v > 0, level
                target = target if moved else left
                level = target + (level - target) * last
                rows.append((before, target, level, left, moved))
            self.states.append(rows)
        before, target, *_ = np.array(self.states).transpose(2, 0, 1)
        return target[:, :, None] + (before - target)[:, :, None] * fall

    def keep(self, blocks: int) -> None:
        """Go on after so many of the blocks that ``ahead`` looked at."""
        _, _, *after = zip(*(rows[blocks - 1] for rows in self.states))
        self.level, self.left, self.moved = map(np.array, after)


class Fluctuation:
    """e(t) of each contact."""

    def __init__(self, contacts: int, rate_hz: float) -> None:
        self.pole = (-1.0 / rubber.RING_S + 2j * np.pi * rubber.RING_HZ) / rate_hz
        self.last = np.zeros(contacts, dtype=complex)

    def next(self, contact: Ints, sample: Floats, shares: Floats, samples: int) -> tuple[Ints, Floats]:
        """(contacts that ring, e [these contacts, samples]); events as from ``Ring.next``."""
        rows, _, rung, _ = self.ahead((contact, np.zeros_like(contact), sample, shares), samples, 1)
        self.keep(1)
        return rows, rung[:, 0]

    def ahead(self, events: BlockEvents, samples: int, blocks: int) -> tuple[Ints, Bools, Floats, int]:
        """(contacts, whether each rings [contacts, blocks], e [contacts, blocks, samples], valid blocks).

        ``keep`` then takes some of the valid blocks: a ring that has faded is 0 before another event.
        """
        from scipy.signal import lfilter

        contact, block, sample, shares = events
        ringing = np.abs(self.last) > 1e-18
        self.last[~ringing] = 0.0
        ringing[contact] = True
        rows = np.flatnonzero(ringing)
        rings = np.zeros((len(rows), blocks), dtype=bool)
        if not len(rows):
            self.kept = rows, rings, rings.astype(complex)
            return rows, rings, np.zeros((0, blocks, samples)), blocks
        index = np.ceil(sample).astype(np.int64)
        drive = shares * np.exp(self.pole * (index - sample))
        comb = np.zeros((len(rows), blocks, samples), dtype=complex)
        row = np.searchsorted(rows, contact)
        np.add.at(comb, (row, block, index), drive)
        turn, last = np.exp(self.pole), self.last[rows]
        rung, _ = lfilter([1.0], [1.0, -turn], comb.reshape(len(rows), -1), axis=1, zi=(turn * last)[:, None])
        rung = rung.reshape(comb.shape)
        ends = np.concatenate([last[:, None], rung[:, :, -1]], axis=1)
        rings = np.abs(ends[:, :-1]) > 1e-18
        faded = ~rings & (ends[:, :-1] != 0)
        begins = np.zeros_like(rings)
        begins[row, block] = True
        again = np.flatnonzero((begins & faded).any(axis=0))
        rings |= begins
        self.kept = rows, rings, ends[:, 1:]
        return rows, rings, rung.real, int(again[0]) if len(again) else blocks

    def keep(self, blocks: int) -> None:
        """Go on after so many of the blocks that ``ahead`` looked at."""
        rows, rings, ends = self.kept
        self.last[rows] = np.where(rings[:, blocks - 1], ends[:, blocks - 1], 0.0)


class Ripple:
    """Unit ripple of a moving stage, [runs, samples] per block, from a tape of two seconds that repeats."""

    def __init__(self, rate_hz: float, rngs: Sequence[np.random.Generator]) -> None:
        samples = round(2.0 * rate_hz)
        self.tape = np.stack([plate._ripple(samples, rate_hz, rng) for rng in rngs])
        self.place = 0

    def next(self, samples: int) -> Floats:
        ripple = self.ahead(samples)
        self.keep(samples)
        return ripple

    def ahead(self, samples: int) -> Floats:
        """The next samples, of which ``keep`` then takes some."""
        return self.tape.take(self.place + np.arange(samples), axis=1, mode="wrap")

    def keep(self, samples: int) -> None:
        self.place = (self.place + samples) % self.tape.shape[1]
