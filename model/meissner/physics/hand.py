"""A hand of two parallel fingers with a slip sensor each, and the object between them, block by block.

    N    = GRIP_N_MM · closing              on both fingers; closing: a critically damped position servo
    T_f  = STIFFNESS · (x - s_f)            x: the object's way down, s_f: the slide of finger f's contact
    T_1 + T_2 = m g + tug                   as long as a finger sticks: no inertia (quasi-static)
    m dv/dt = m g + tug - sum mu(t) N       once both contacts slide, until the object stops
    mu(t)  = mu_k + (mu_s - mu_k) exp(-t/FALL_S)    t since the contact began to slide; mu_s when it sticks

A finger whose T_f reaches mu_s N slides until the other finger takes the rest of the load, or slides too. The
object's way has three parts: ``sag`` = load/(2 STIFFNESS), elastic; ``slip``, the mean of s_f; ``ring``, the
way of the slipped rings (rubber.slipped, mu N/STIFFNESS·S(q)), which the equations of force leave out.

Vc of each finger: rubber.volts of N with its ripple, of the shear level at the speed dT/dt/STIFFNESS, and of
the events of its ring, its slide (GROSS_SHARE) and its stick-slip (one per (mu_s - mu_k) N/STIFFNESS).
The hand ripples in proportion to its speed, up to plate's RIPPLE_N at RIPPLE_N_S; the core gets no signal
that the hand moves.

Not modelled: inertia of the object while a finger holds it (tens of hertz), impacts of a poured filling,
rotation of the object, bending of the fingers, a grip force that differs between the fingers, backlash and
friction of the hand's drive, dependence of friction on speed, and everything that physics.rubber and plate
leave out.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from meissner.arrays import Bools, Floats
from meissner.physics import plate, rubber, slide, stepped
from meissner.physics.stepped import BlockEvents, Fluctuation, Level, Ring, Ripple

GRIP_N_MM = 1.0
SERVO_S = 0.002
COUNT_MM = 1e-4
RIPPLE_N_S = 3.0
DROP_MM = 6.0
MASS_S = 0.01
ORIGINS = {
    "GRIP_N_MM": (
        "chosen",
        "rubber and the wall of a PET glass in series; no paper gives it",
        "newtons of a step of the hand: one step of 0.01 mm is 0.01 N",
    ),
    "SERVO_S": (
        "chosen",
        "a fifth of the published control cycle of 10 ms, critically damped",
        "how late a step acts: slip_mm of grip_disturb",
    ),
    "COUNT_MM": ("chosen", "a stroke of 6.5 mm in the 16 bits of a command", "counts of every setting"),
    "RIPPLE_N_S": (
        "chosen",
        "normal_force's fastest loading, 2 N in 1 s, at which plate has its full ripple",
        "false tightenings",
    ),
    "DROP_MM": ("computed", "the sensor's side, published: by then the object has left it", "dropped"),
    "MASS_S": ("chosen", "numerical: the poured mass is drawn in pieces of this length", "none"),
}


@dataclass(frozen=True)
class Grasp:
    """The object of one run and its disturbances.

    Attributes
    ----------
    mass_kg : [times]
        One value every MASS_S.
    mu_s, mu_k : tuple
        Friction of both fingers; ``halves_s``: when it halves, or None.
    closing_mm : float
        Of the fingers at the start.
    tugs : tuple
        (start_s, length_s, newtons) each.
    """

    mass_kg: Floats
    mu_s: tuple[float, float]
    mu_k: tuple[float, float]
    closing_mm: float
    first_event: float = rubber.ONSET_RATIO
    heal_s: float = stepped.HEAL_S
    fluctuation: float = 1.0
    tugs: tuple[tuple[float, float, float], ...] = ()
    halves_s: float | None = None
    rng: np.random.Generator = field(default_factory=np.random.default_rng)


@dataclass(frozen=True)
class Block:
    """The samples of one block or several, [runs, samples] unless stated otherwise.

    Attributes
    ----------
    volts, tension_n : [runs, 2, samples]
    normal_n, load_n, sag_mm, slip_mm : [runs, samples]
    ring_mm : [runs, blocks]
        At each block's end.
    events : tuple
        Contacts (2 run + finger), blocks, samples in the block and shares.
    blocks : int
    """

    volts: Floats
    normal_n: Floats
    tension_n: Floats
    load_n: Floats
    sag_mm: Floats
    slip_mm: Floats
    ring_mm: Floats
    events: BlockEvents
    blocks: int


class Hand:
    """``grasps``: one per run, all advanced together, ``block`` samples at a time."""

    def __init__(self, grasps: Sequence[Grasp], rate_hz: float, block: int) -> None:
        self.grasps, self.rate_hz, self.block = grasps, rate_hz, block
        runs = len(grasps)
        self.mu_s = np.array([grasp.mu_s for grasp in grasps])
        self.mu_k = np.array([grasp.mu_k for grasp in grasps])
        self.mass_kg = np.stack([grasp.mass_kg for grasp in grasps])
        self.place = np.array([grasp.closing_mm for grasp in grasps], dtype=float)
        self.speed = np.zeros(runs)
        self.sample = 0
        patches = [self._patches(grasp) for grasp in grasps for _ in range(2)]
        places, shares = zip(*patches)
        heal_s = np.repeat([grasp.heal_s for grasp in grasps], 2)
        self.ring = Ring(places, shares, self.mu_s.ravel(), heal_s)
        self.level = Level(2 * runs)
        self.noise = Fluctuation(2 * runs, rate_hz)
        self.ripple = Ripple(rate_hz, [grasp.rng for grasp in grasps])
        self.contacts = [slide.Contacts(grasp.rng, grasp.fluctuation) for grasp in grasps]
        self.slid_mm = np.zeros((runs, 2))
        self.sliding = np.zeros(runs, dtype=bool)
        self.dropped = np.zeros(runs, dtype=bool)
        load_n = self.mass_kg[:, 0] * slide.G_MM_S2 / 1e3
        self.tension = np.repeat(load_n / 2, 2)
        self.ring.start(np.repeat(GRIP_N_MM * self.place, 2), self.tension)
        self.since_s = np.arange(1, block + 1) / rate_hz
        self.fall = np.exp(-self.since_s / SERVO_S)

    @staticmethod
    def _patches(grasp: Grasp) -> tuple[Floats, Floats]:
        places = rubber.event_ratios(grasp.rng, grasp.first_event)
        return places, rubber.event_shares(len(places), grasp.fluctuation, grasp.rng)

    def _force(self, goals_mm: Floats) -> Floats:
        """N [runs, samples] while the servo moves to ``goals_mm`` [blocks, runs], with its speed's ripple."""
        blocks, runs = goals_mm.shape
        since_s, fall = self.since_s[-1].item(), self.fall[-1].item()
        self.servo = []  # (place, speed) of each run before each block and after the last
        for place, speed, goals in zip(self.place.tolist(), self.speed.tolist(), goals_mm.T.tolist()):
            rows = [(place, speed)]
            for goal in goals:
                away = place - goal
                drift = speed + away / SERVO_S
                left = away + drift * since_s
                place, speed = goal + left * fall, (drift - left / SERVO_S) * fall
                rows.append((place, speed))
            self.servo.append(rows)
        places, speeds = np.array(self.servo).transpose(2, 0, 1)[:, :, :-1, None]
        goal_mm = goals_mm.T[:, :, None]
        away = places - goal_mm
        drift = speeds + away / SERVO_S
        left = away + drift * self.since_s
        place = (goal_mm + left * self.fall).reshape(runs, -1)
        speed = ((drift - left / SERVO_S) * self.fall).reshape(runs, -1)
        full = np.minimum(np.abs(speed) * GRIP_N_MM / RIPPLE_N_S, 1.0)
        ripple_n = plate.RIPPLE_N * full * self.ripple.ahead(blocks * self.block)
        return np.maximum(GRIP_N_MM * place + ripple_n, 1e-6)

    def _load(self, blocks: int) -> tuple[Floats, Floats, int]:
        """The load on the object, [runs, samples] in newtons, its mass at the first block's end [runs], and
        the number of blocks before another in which friction halves."""
        time_s = (self.sample + np.arange(1, blocks * self.block + 1)) / self.rate_hz
        piece = time_s / MASS_S
        low = np.minimum(piece.astype(np.int64), self.mass_kg.shape[1] - 2)
        part = np.minimum(piece - low, 1.0)
        mass_kg = self.mass_kg.take(low, axis=1) * (1 - part) + self.mass_kg.take(low + 1, axis=1) * part
        load_n = mass_kg * (slide.G_MM_S2 / 1e3)
        for run, grasp in enumerate(self.grasps):
            for start_s, length_s, newtons in grasp.tugs:
                if time_s[0] < start_s + length_s and time_s[-1] > start_s:
                    place = np.clip((time_s - start_s) / length_s, 0, 1)
                    load_n[run] += newtons * (0.5 - 0.5 * np.cos(2 * np.pi * place))
            if grasp.halves_s is not None:
                block = (round(grasp.halves_s * self.rate_hz) - self.sample) // self.block
                if block == 0:
                    self._halve(run)
                elif block > 0:
                    blocks = min(blocks, block)
        return load_n, mass_kg[:, self.block - 1], blocks

    def _halve(self, run: int) -> None:
        self.mu_s[run] /= 2
        self.mu_k[run] /= 2
        self.ring.friction[2 * run : 2 * run + 2] = self.mu_s[run]

    def next(self, goal_mm: ArrayLike) -> Block:
        """The next ``Block``, with the servo's goal ``goal_mm`` [runs]."""
        found = self.ahead(np.asarray(goal_mm, dtype=float)[None])
        self.keep(1)
        return found

    def ahead(self, goals_mm: Floats) -> Block:
        """The next blocks, at least one, with the servo's goals ``goals_mm`` [blocks, runs].

        ``keep`` then takes some of them. A block in which a contact slides is alone.
        """
        load_n, mass_kg, blocks = self._load(len(goals_mm))
        force_n = self._force(goals_mm[:blocks])
        samples = force_n.shape[1]
        load_n = load_n[:, :samples]
        apart = rubber.STIFFNESS_N_MM * (self.slid_mm[:, ::-1] - self.slid_mm) / 2
        tension = load_n[:, None, :] / 2 + apart[:, :, None]
        over = (tension > self.mu_s[:, :, None] * force_n[:, None, :]).any(axis=1) | self.sliding[:, None]
        over &= ~self.dropped[:, None]
        loose: Bools = np.asarray(over[:, : self.block].any(axis=1))
        blocks = max(1, int(over.any(axis=0).argmax()) // self.block) if over.any() else blocks
        samples = blocks * self.block
        force_n, load_n, tension = force_n[:, :samples], load_n[:, :samples], tension[:, :, :samples]
        slid_mm = np.broadcast_to(self.slid_mm.mean(axis=1)[:, None], load_n.shape)
        more = []
        if loose.any():
            slid_mm, tension = slid_mm.copy(), tension.copy()
            for run in np.flatnonzero(loose):
                found = slide.slide(
                    *(self.contacts[run], force_n[run], load_n[run], mass_kg[run]),
                    *(self.mu_s[run], self.mu_k[run], self.slid_mm[run], self.rate_hz),
                )
                tension[run], slid_mm[run] = found.tension_n, found.slip_mm
                self.slid_mm[run], self.sliding[run] = found.slid_mm, any(self.contacts[run].sliding)
                more += [(2 * run + finger, 0, sample, share) for finger, sample, share in found.events]
                self.dropped[run] = found.slip_mm[-1] > DROP_MM
        flat = tension.reshape(-1, samples)
        pressed = np.repeat(force_n, 2, axis=0)
        events = self.ring.ahead(pressed, flat, self.block / self.rate_hz, blocks)
        if loose.any():
            self._renew(loose)
        if more:
            extra = (np.array(column) for column in zip(*more))
            contact, block, sample, share = (np.concatenate(pair) for pair in zip(events, extra))
            events = contact, block, sample, share
        volts, blocks = self._volts(force_n, flat, events, blocks)
        ends_n = force_n.reshape(len(force_n), -1, self.block)[:, :, -1]
        reach = self.ring.reach(np.repeat(ends_n, 2, axis=0)).reshape(-1, 2, ends_n.shape[1])
        shares = (self.mu_s[:, :, None] * rubber.slipped(reach)).mean(axis=1)
        sag_mm = load_n / (2 * rubber.STIFFNESS_N_MM)
        ring_mm = shares * ends_n / rubber.STIFFNESS_N_MM
        return Block(volts, force_n, tension, load_n, sag_mm, slid_mm, ring_mm, events, blocks)

    def keep(self, blocks: int) -> None:
        """Go on after so many of the blocks of ``ahead``."""
        for part in (self.ring, self.level, self.noise):
            part.keep(blocks)
        self.ripple.keep(blocks * self.block)
        self.place, self.speed = np.array([rows[blocks] for rows in self.servo]).T
        self.tension = self.tensions[:, blocks - 1].copy()
        self.sample += blocks * self.block

    def _renew(self, loose: Bools) -> None:
        """New patches for the contacts that have slid in this block."""
        self.ring.keep(1)
        for run in np.flatnonzero(loose).tolist():
            for finger in range(2):
                if self.contacts[run].slid[finger]:
                    self.ring.renew(2 * run + finger, *self._patches(self.grasps[run]), slid=True)
        self.ring.margins[:, 1] = self.ring.margin

    def _volts(
        self, force_n: Floats, tension: Floats, events: BlockEvents, blocks: int
    ) -> tuple[Floats, int]:
        """Vc [runs, 2, samples] of so many blocks, and how many of them are valid."""
        self.tensions = tension.reshape(len(tension), blocks, -1)[:, :, -1]
        before = np.concatenate([self.tension[:, None], self.tensions[:, :-1]], axis=1)
        speed = (self.tensions - before) / rubber.STIFFNESS_N_MM * self.rate_hz / self.block
        slides = np.array([one.sliding for one in self.contacts]).reshape(-1, 1)
        speed = np.where(slides, 0.0, speed)  # a sliding contact shears no further and recovers
        level = self.level.ahead(speed, self.block, self.rate_hz).reshape(len(force_n), 2, -1)
        rest_v = rubber.rest_volts(force_n)
        volts = rest_v[:, None, :] + rubber.shear_gain(rest_v)[:, None, :] * level
        flat = volts.reshape(len(tension), blocks, self.block)
        rows, rings, share, blocks = self.noise.ahead(events, self.block, blocks)
        if len(rows):
            rest_v = flat[rows]
            ratio = (rubber.SUPPLY_V - rest_v) / rest_v * np.maximum(1.0 + share, 0.0)
            flat[rows] = np.where(rings[:, :, None], rubber.SUPPLY_V / (1.0 + ratio), rest_v)
        return volts, blocks
