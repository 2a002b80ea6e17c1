"""A rope in a fingertip's grip, pulled out of it: tension, stick-slip, and the forces on 3×3 sensors.

    E(S) = 0.0981 (56 + 7.62336 S) / (0.137505 (254 - 2.54 S)) MPa      of Shore A hardness S (Gent 1958)
    k    = 1 / (1/k_rope + 1/k_grip + 1/k_arm),   k_grip proportional to E
    dT/dt = k v                              while the grip holds: T tension, v speed of the hand
    dS/dt = (S_max - S) / HEAL_S             strength of the contact; S_max = mu N, with the rope's unevenness
    T > S:  T and S fall by share (S - S_kinetic)       stick-slip; the rope slides (fall of T) / k

``share``: a side of the nine-sided grip lets go alone, a round one lets go as a whole. A stiffer grip is
loaded faster, so that the contact has less time to heal: the falls are smaller and closer together, until the
rope slides evenly. Force control is an arm with damping, v = (F - T) / ARM_N_S_MM; the force-free state is
force control to 0.001 N. A load that rises rearranges strands, by small falls of T.

The rope crosses the three columns; a column's force follows the grip and the tension, and spreads to the rows
through the cover (mesh_loads.press). Without a post the hand's torque moves the rope towards the first row.

Not modelled: the other fingers, inertia, waves along the rope, creep and hysteresis of rope and elastomer,
wear, the sensor's delay.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from meissner.arrays import Floats, Ints, finite
from meissner.physics import mesh_loads


@dataclass(frozen=True)
class Rope:
    """``strands``, ``mm``: as published; ``stiff_n_mm``: of the pulled length; ``grip``: its friction as a
    multiple of rope a's; ``rough``: of the surface, as a share of the normal force; ``settles``: size of the
    strands' rearrangement."""

    about: str
    strands: int
    mm: float
    stiff_n_mm: float
    grip: float
    rough: float
    settles: float


ROPES = {
    "a": Rope("12-strand vinylon", 12, 12.0, 5.0, 1.0, 0.010, 1.0),
    "b": Rope("12-strand nylon", 12, 12.0, 2.5, 0.98, 0.008, 2.0),
    "c": Rope("3-strand vinylon", 3, 12.0, 6.0, 1.0, 0.014, 0.8),
    "d": Rope("3-strand hemp", 3, 12.0, 8.0, 1.06, 0.018, 0.8),
    "e": Rope("12-strand nylon, thin", 12, 7.0, 4.0, 0.99, 0.008, 1.0),
    "f": Rope("cable", 1, 7.0, 20.0, 1.25, 0.004, 0.2),
    "g": Rope("PP tape", 1, 12.0, 15.0, 1.3, 0.004, 0.2),
}


class Shape(NamedTuple):
    """``share``: of the contact that lets go at once; ``depth``: of the cover, in pitches of the sensors."""

    share: float
    depth: float


SHAPES = {
    "nine-sided": Shape(0.48, 1.0),
    "nine-sided without protrusions": Shape(0.48, 2.5),
    "R": Shape(1.0, 1.0),
}
SHORES = (27, 60, 95)
# Grasping positions, from the middle row towards the first one, in half sides.
POSITIONS = {"top": 1.0, "top_middle": 0.5, "middle": 0.0, "bottom_middle": -0.5, "bottom": -1.0}
MODES = ("force", "speed")
SENSORS = 9
STEPS_PER_FRAME = 25
GRIP_N, FRICTION, KINETIC, UNEVEN = 5.0, 0.9, 0.43, 0.03
HEAL_S = 0.135
GRIP_N_MM, ARM_N_MM = 1.0, 20.0
ARM_N_S_MM, ARM_MM_S, RAMP_S = 0.1, 9.5, 0.2
FREE_N = 0.001
STRANDS_N, STRANDS_FALL_N = 0.4, 0.02
LOAD_NOISE_N, JITTER, JITTER_S = 0.01, 0.0003, 0.1
LEAD_S = 0.5
ACROSS = (0.3, 0.4, 0.3)
WRAP = (0.1, 0.0, -0.035)
PRELOAD_N, GAP_N_MPA = 0.35, (0.0,) * 8 + (0.05,)
TURN_N, DRIFT_MM, LAY_MM = 0.012, 0.0012, 4.0
EVENTS = 4096


@dataclass(frozen=True)
class Pull:
    """A rope pulled several times: force-free, then for each of ``values`` (newtons, or mm/s) pulled for
    ``pull_s`` and free for ``free_s``. ``post``: its end is held, so that it keeps its place."""

    rope: str = "a"
    mode: str = "force"
    values: tuple[float, ...] = (9.0,)
    position: str = "middle"
    shape: str = "nine-sided"
    shore: float = 27.0
    post: bool = False
    pull_s: float = 5.0
    free_s: float = 5.0

    @property
    def seconds(self) -> float:
        return LEAD_S + len(self.values) * (self.pull_s + self.free_s)

    def spans(self, rate_hz: float) -> list[tuple[int, int]]:
        """(first frame, frame after the last) of each section."""
        starts = [LEAD_S + index * (self.pull_s + self.free_s) for index in range(len(self.values))]
        return [(round(at * rate_hz), round((at + self.pull_s) * rate_hz)) for at in starts]


@dataclass(frozen=True)
class Pulled:
    """Tension, the load cell's value and how far the rope has slid in the grip, all [pulls, frames]."""

    tension_n: Floats
    load_n: Floats
    slid_mm: Floats


@finite
def modulus(shore: float) -> float:
    """Young's modulus in MPa of an elastomer of Shore A hardness, by Gent's formula."""
    return 0.0981 * (56 + 7.62336 * shore) / (0.137505 * (254 - 2.54 * shore))


@finite
def stiffness(rope_n_mm: float, shore: float) -> float:
    """N/mm of rope, grip and arm in series."""
    grip = GRIP_N_MM * modulus(shore) / modulus(SHORES[0])
    return 1 / (1 / rope_n_mm + 1 / grip + 1 / ARM_N_MM)


def pull(pulls: Sequence[Pull], rate_hz: float, seeds: Sequence[Sequence[int]]) -> Pulled:
    """All of ``pulls``, which last equally long; ``seeds``: of each, for its own draws."""
    rngs = [np.random.default_rng(seed) for seed in seeds]
    each = np.arange(len(pulls))
    ropes = [ROPES[one.rope] for one in pulls]
    spring = np.array([stiffness(r.stiff_n_mm, one.shore) for r, one in zip(ropes, pulls)])
    share = np.array([SHAPES[one.shape].share for one in pulls])
    limit = FRICTION * GRIP_N * np.array([r.grip for r in ropes])[:, None]
    limit = limit * (1 + UNEVEN * np.stack([rng.standard_normal(EVENTS) for rng in rngs]))
    kinetic = KINETIC * FRICTION * GRIP_N * np.array([r.grip for r in ropes])
    settles = np.stack([STRANDS_N * rng.standard_exponential(EVENTS).cumsum() for rng in rngs])
    fall_n = STRANDS_FALL_N * np.array([r.settles for r in ropes])
    frames = round(pulls[0].seconds * rate_hz)
    dt = 1 / (rate_hz * STEPS_PER_FRAME)
    forced = np.array([one.mode == "force" for one in pulls])
    values = np.array([one.values for one in pulls], float)
    spans = pulls[0].spans(rate_hz)
    tension, risen, slid, strength = np.zeros((4, len(pulls)))
    event, settled = np.zeros((2, len(pulls)), int)
    most = limit[each, 0]
    strength += most
    next_settles = settles[:, 0]
    found = np.empty((3, len(pulls), frames))
    for frame in range(frames):
        section = next((k for k, (start, stop) in enumerate(spans) if start <= frame < stop), None)
        for step in range(STEPS_PER_FRAME):
            free = np.clip((FREE_N - tension) / ARM_N_S_MM, -ARM_MM_S, ARM_MM_S)
            if section is None:
                speed = free
            else:
                since_s = (frame - spans[section][0]) / rate_hz + step * dt
                aim = values[:, section] * min(1.0, since_s / RAMP_S)
                speed = np.where(forced, np.clip((aim - tension) / ARM_N_S_MM, -ARM_MM_S, ARM_MM_S), aim)
            rise = spring * speed * dt
            tension = tension + rise
            strength = strength + (most - strength) * (dt / HEAL_S)
            risen = risen + np.maximum(rise, 0)
            if (risen > next_settles).any():
                who = risen > next_settles
                tension = np.where(who, np.maximum(tension - fall_n, 0), tension)
                settled = np.minimum(settled + who, EVENTS - 1)
                next_settles = settles[each, settled]
            if (tension > strength).any():
                who = tension > strength
                strength = np.where(who, strength - share * np.maximum(strength - kinetic, 0), strength)
                fall = np.where(who, tension - strength, 0)
                tension, slid = tension - fall, slid + fall / spring
                event = np.minimum(event + who, EVENTS - 1)
                most = limit[each, event]
        found[0, :, frame], found[1, :, frame] = tension, slid
    noise = np.stack([rng.standard_normal(frames) for rng in rngs])
    found[2] = found[0] + LOAD_NOISE_N * noise
    return Pulled(found[0], found[2], found[1])


def places(one: Pull, tension_n: Floats, slid_mm: Floats) -> Floats:
    """Where the rope crosses the sensors [frames], 1 at the first row and -1 at the last."""
    moved = (0.0 if one.post else 1.0) * (TURN_N * tension_n + DRIFT_MM * slid_mm)
    return np.clip(POSITIONS[one.position] + moved, -1.0, 1.0)


def forces(one: Pull, tension_n: Floats, slid_mm: Floats, rate_hz: float, rng: np.random.Generator) -> Floats:
    """Newtons on the sensors [frames, rows, columns] of one pull: rows from top to bottom, s_0 to s_2 of the
    first column in rows 0 to 2."""
    rope, shape = ROPES[one.rope], SHAPES[one.shape]
    keep = np.exp(-1 / (JITTER_S * rate_hz))
    hand = np.zeros(len(tension_n))
    for index, drawn in enumerate(rng.standard_normal(len(hand))):
        hand[index] = keep * hand[index - 1] + np.sqrt(1 - keep**2) * drawn
    turns = slid_mm / LAY_MM + rng.random(3)[:, None]
    normal_n = GRIP_N * np.outer(ACROSS, 1 + JITTER * hand) * (1 + rope.rough * np.sin(2 * np.pi * turns))
    columns = np.maximum(normal_n + np.outer(WRAP, tension_n), 0.0)
    y = places(one, tension_n, slid_mm)
    total = sum(
        mesh_loads.press(3, 3, x, y, column, shape.depth) for x, column in zip((-1.0, 0.0, 1.0), columns)
    )
    gap_n = modulus(one.shore) * np.array(GAP_N_MPA).reshape(3, 3).T
    return np.maximum(total + PRELOAD_N - gap_n, 0.0)


def as_published(frames: Floats | Ints) -> Floats | Ints:
    """Frames [..., rows, columns] as channels [..., 9]: s_0 to s_8, down the first column, then the
    others."""
    return np.swapaxes(frames, -1, -2).reshape(*frames.shape[:-2], SENSORS)


ORIGINS = {
    "ROPES": (
        "chosen",
        "rope paper, figure 10: material, strands, mm; stiffness, friction, surface and strands are ours, "
        "in the order that V-B gives: b the softest, f and g stiff and with the most friction",
        "rope_pull: one row each; only a and c are trained on",
    ),
    "SHAPES": (
        "read off",
        "rope paper, table I: the nine-sided grip falls twice as often and half as far as the R shape",
        "table I: share 0.48; with 1.0 both shapes are the R shape. Depths are chosen: figure 6",
    ),
    "SHORES": ("published", "rope paper, II-C", "fingertip_hardness: one condition each"),
    "POSITIONS": ("published", "rope paper, II-A, as fractions of the sheet", "the training set"),
    "SENSORS": ("published", "rope paper, II-A", "channels of the forest"),
    "STEPS_PER_FRAME": ("chosen", "numerical: 1 ms at 40 Hz", "smallest time between two falls"),
    "GRIP_N": ("chosen", "with FRICTION: the rope holds at 4 N and slips at 5 N", "when a section slips"),
    "FRICTION": (
        "read off",
        "rope paper: the printed counts need that 1 and 3 N hold and 5 N slips; V-A: 4 N holds, 14 N slips",
        "60 of the 480 sections do not slip",
    ),
    "KINETIC": ("chosen", "fitted to table I", "size of the falls"),
    "UNEVEN": ("chosen", "keeps every rope above 4 N", "spread of the falls"),
    "HEAL_S": (
        "chosen",
        "fitted so that A95 slides evenly, as figures 4 and 5 state",
        "fingertip_hardness: oscillation over hardness; without it, none",
    ),
    "GRIP_N_MM": ("chosen", "with ARM_MM_S: fitted to table I", "period of the falls"),
    "ARM_N_MM": ("chosen", "a robot's arm", "little: the grip is softer"),
    "ARM_N_S_MM": ("chosen", "no controller is printed", "how fast a force is reached"),
    "ARM_MM_S": ("chosen", "fitted to table I's number of falls", "period of the falls under force control"),
    "RAMP_S": ("chosen", "no controller is printed", "the first frames of a section"),
    "FREE_N": ("published", "rope paper, III-A: the force-free state", "tension between pulls"),
    "STRANDS_N": ("chosen", "no figure", "how often strands rearrange while the load rises"),
    "STRANDS_FALL_N": (
        "chosen",
        "V-B: weak vibrations as a soft rope stretches; set as JITTER",
        "first alarm: -20 ms, not +34, at 0.05",
    ),
    "LOAD_NOISE_N": ("chosen", "a tenth of the fall that a label needs", "how far t_s lies before the fall"),
    "JITTER": (
        "chosen",
        "of the grip's force; set so that holds at 4 N raise no alarm at seed 1",
        "alarms without slip: in 6 of 21 sections at 0.001",
    ),
    "JITTER_S": ("chosen", "a servo's", "as JITTER"),
    "LEAD_S": ("chosen", "until the first pull", "none"),
    "ACROSS": ("chosen", "the rope presses on three sides, most on the middle one", "levels of s_0 to s_8"),
    "WRAP": (
        "read off",
        "rope paper, figure 6: tension raises the side of s_1; size fitted to table I's mean of -25.8",
        "every amplitude in codes; the ratio of table I's two means does not depend on it",
    ),
    "PRELOAD_N": ("chosen", "the cover's fit; an FSR400 needs 0.2 N", "sensors beside the rope read too"),
    "GAP_N_MPA": (
        "read off",
        "rope paper, figure 5: s_8 is straight with A95, from a gap; not with A27",
        "s_8 with A95",
    ),
    "TURN_N": ("read off", "rope paper, figure 6: y grows with tension; size chosen", "y_moves"),
    "DRIFT_MM": ("read off", "rope paper, III-B: the rope moves towards s_3; size chosen", "y_left"),
    "LAY_MM": ("chosen", "a strand's width on a rope of 12 mm", "vibration of a rough rope that slides"),
    "EVENTS": ("chosen", "numerical: falls of a pull that have their own draws", "none"),
}
