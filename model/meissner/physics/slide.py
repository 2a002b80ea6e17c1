"""The part of physics.hand that runs sample by sample: an object's contacts slide until they stick."""

from dataclasses import dataclass, field
from math import exp

import numpy as np

from meissner.arrays import Floats
from meissner.physics import plate, rubber

G_MM_S2 = 9810.0
MOST_STICKS = 100
ORIGINS = {
    "G_MM_S2": ("computed", "standard gravity", "weights"),
    "MOST_STICKS": ("chosen", "numerical: sticks of one sample that are events of their own", "none"),
}


Event = tuple[int, float, float]  # finger, sample, share


@dataclass
class Contacts:
    """The state of an object's two contacts. ``since_s``: since each began to slide or to stick.

    ``left_mm``: way to the next stick-slip event; ``slid``: whether each slid in the last block.
    """

    rng: np.random.Generator
    fluctuation: float = 1.0
    speed_mm_s: float = 0.0
    sliding: list[bool] = field(default_factory=lambda: [False, False])
    since_s: list[float] = field(default_factory=lambda: [float("inf")] * 2)
    left_mm: list[float] = field(default_factory=lambda: [0.0, 0.0])
    slid: list[bool] = field(default_factory=lambda: [False, False])


@dataclass(frozen=True)
class Slid:
    """``tension_n`` [2, samples], ``slip_mm`` [samples], ``slid_mm`` [2] after the block, ``events``:
    (finger, sample, share).
    """

    tension_n: Floats
    slip_mm: Floats
    slid_mm: Floats
    events: list[Event]


def slide(
    contacts: Contacts,
    force_n: Floats,
    load_n: Floats,
    mass_kg: float,
    mu_s: Floats,
    mu_k: Floats,
    slid_mm: Floats,
    rate_hz: float,
) -> Slid:
    """Advance ``contacts`` by a block: ``force_n``, ``load_n`` [samples], ``slid_mm`` [2] before it."""
    stiffness, dt = rubber.STIFFNESS_N_MM, 1.0 / rate_hz
    mu_s, mu_k, slid = mu_s.tolist(), mu_k.tolist(), slid_mm.tolist()
    tensions, slips = [], []
    events: list[Event] = []
    contacts.slid = list(contacts.sliding)
    for sample, (force, load) in enumerate(zip(force_n.tolist(), load_n.tolist())):
        before = list(slid)
        friction = [
            force * (mu_k[f] + (mu_s[f] - mu_k[f]) * exp(-contacts.since_s[f] / plate.FALL_S))
            if contacts.sliding[f]
            else force * mu_s[f]
            for f in (0, 1)
        ]
        tension = None
        if all(contacts.sliding):
            contacts.speed_mm_s += (load - sum(friction)) / mass_kg * 1e3 * dt
            if contacts.speed_mm_s <= 0:
                _stick(contacts, (0, 1))
            else:
                slid = [way + contacts.speed_mm_s * dt for way in slid]
                tension = friction
        if tension is None:
            tension, slid = _held(contacts, friction, load, slid, stiffness, sample, events)
        for f in (0, 1):
            contacts.since_s[f] += dt
            if contacts.sliding[f]:
                _stick_slip(
                    contacts, f, slid[f] - before[f], (mu_s[f] - mu_k[f]) * force / stiffness, events, sample
                )
        tensions.append(tension)
        slips.append((slid[0] + slid[1]) / 2)
    return Slid(np.array(tensions).T, np.array(slips), np.array(slid), events)


def _stick(contacts: Contacts, fingers: tuple[int, ...]) -> None:
    for f in fingers:
        contacts.sliding[f], contacts.since_s[f] = False, 0.0
    contacts.speed_mm_s = 0.0


def _let_go(contacts: Contacts, f: int, sample: int, events: list[Event]) -> None:
    """The last core lets go; the core of a contact that has stuck only briefly is still small."""
    core = 1.0 - exp(-contacts.since_s[f] / plate.FALL_S)
    share = rubber.GROSS_SHARE * rubber.EVENT_SHARE * contacts.fluctuation * core
    events.append((f, float(sample), share))
    contacts.sliding[f], contacts.slid[f], contacts.since_s[f], contacts.left_mm[f] = True, True, 0.0, -1.0


def _held(
    contacts: Contacts,
    friction: list[float],
    load: float,
    slid: list[float],
    stiffness: float,
    sample: int,
    events: list[Event],
) -> tuple[list[float], list[float]]:
    """Tensions and slides if at least one finger sticks or begins to slide now."""
    for _ in range(3):
        if not any(contacts.sliding):
            apart = stiffness * (slid[1] - slid[0]) / 2
            tension = [load / 2 + apart, load / 2 - apart]
            over = [f for f in (0, 1) if tension[f] > friction[f]]
            if not over:
                return tension, slid
            first = max(over, key=lambda f: tension[f] - friction[f])
            _let_go(contacts, first, sample, events)
        loose = contacts.sliding.index(True)
        other = 1 - loose
        tension = [0.0, 0.0]
        tension[loose], tension[other] = friction[loose], load - friction[loose]
        if tension[other] > friction[other]:
            _let_go(contacts, other, sample, events)
            contacts.speed_mm_s = 0.0
            return list(friction), slid
        way = slid[other] + (tension[other] - tension[loose]) / stiffness
        if way < slid[loose]:
            _stick(contacts, (loose,))
            continue
        slid = list(slid)
        slid[loose] = way
        return tension, slid
    return tension, slid


def _stick_slip(
    contacts: Contacts, f: int, way_mm: float, stick_mm: float, events: list[Event], sample: int
) -> None:
    if contacts.left_mm[f] < 0:
        contacts.left_mm[f] = stick_mm * contacts.rng.gamma(2.0, 0.5)
    contacts.left_mm[f] -= way_mm
    for _ in range(MOST_STICKS):
        if contacts.left_mm[f] >= 0:
            return
        share = rubber.event_shares(1, contacts.fluctuation, contacts.rng)[0]
        events.append((f, float(sample), rubber.SLIDING_SHARE * share))
        contacts.left_mm[f] += max(stick_mm * contacts.rng.gamma(2.0, 0.5), 1e-6)
    contacts.left_mm[f] = max(contacts.left_mm[f], 0.0)  # almost no force: sticks too short to resolve
