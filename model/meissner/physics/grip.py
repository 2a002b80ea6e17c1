"""An object with a rounded end, gripped on the four-wire sensor and pulled along it by a wire until it slips.

    T = K v t                              until T = mu_s N0, when the whole contact slips (physics.plate)
    N = N0 (1 + GRIP_RISE (T/T_slip)^3)    the grip rises before the slip
    felt = N G(N, u)/G(N, 0)               the load that the taxels' conductance shows (physics.rubber)
    centre = place + (LEVER + cover) T/N   along the pull; the tilt of the grip moves it too

While the wire's force rises, the rubber shears at dT/dt over its stiffness and conducts less: the reported
load falls although the grip rises, by about half with the published divider and shear fit alone.
The force acts on top of the rubber and the pressure is sensed beneath: its moment moves the centre in the
direction of the slip to come. The source attributes the move to the change of stuck and slipped areas and
states that a layer of silicone doubled or quadrupled it, as a longer lever would; so here a cover's thickness
adds to the lever.

The contact's edge slips as soon as the force begins to rise (Cattaneo and Mindlin): that is the onset.

A gripper's second sensor feels the same grip and the same pull, seen from its own side: ``mirrored``.

Not modelled: the areas of stick and slip in the taxels (all rubber under the contact shears equally), a pull
that the two sensors share unequally, stick-slip and micro events in the load (about 1 %, see physics.rubber),
ripple of the grip, hysteresis and creep, inertia, bending of the sensor around a cylinder.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from meissner.arrays import Floats, finite
from meissner.physics import mesh_loads, plate, rubber

GRIP_RISE = 0.1  # published: 0.2 N of 2 N just before the slip; the third power is chosen
LEVER_MM = 0.2  # chosen to reach the published 0.05 V of +-4 V at friction 0.7 on a sensor 20 mm wide
TILT = 0.0005  # half ranges per newton; chosen: over 2 N a tenth of the move of a slip
FULL_SCALE_V = 4.0  # published: the position output at the sensor's edge
_PAPER = "Development of High Speed and High Sensitivity Slip Sensor"
ORIGINS = {
    "GRIP_RISE": (
        "published",
        f"{_PAPER}, III-A: 0.2 N of 2 N; chosen: that it goes with the third power of the pull",
        "cop_slip: grip_rise_n, which is GRIP_RISE times the grip; load_drop by less than 0.1 points",
    ),
    "LEVER_MM": (
        "chosen",
        f"reaches the 0.05 V of {_PAPER}, III-A, at friction 0.7 on a sensor 20 mm wide",
        "cop_slip: move_v is proportional to it, the delay falls and the lead grows with it",
    ),
    "TILT": (
        "chosen",
        "a tenth of the move of a slip, over 2 N",
        "cop_slip: false_alarms, of every release at four times as much; direction_error_deg",
    ),
    "FULL_SCALE_V": ("published", f"{_PAPER}, III-A and figure 4 (b)", "the unit of move_v, nothing else"),
}


@dataclass(frozen=True)
class Held:
    """One run, [samples]: newtons and millimetres; ``move_mm``: of the centre, along the pull.

    ``onset_s``: the wire begins to pull; ``gross_s``: the object begins to move; both None without a pull.
    """

    grip_n: Floats
    felt_n: Floats
    tension_n: Floats
    slip_mm: Floats
    move_mm: Floats
    onset_s: float | None
    gross_s: float | None


@finite
def ramps(time_s: Floats, levels: Sequence[tuple[float, float, float]]) -> Floats:
    """Newtons [samples] from 0 through ``levels``, (start_s, length_s, to_n) each, by raised cosines."""
    force_n, last_n = np.zeros(len(time_s)), 0.0
    for start_s, length_s, to_n in levels:
        place = np.clip((time_s - start_s) / length_s, 0, 1)
        force_n = np.where(
            time_s >= start_s, last_n + (to_n - last_n) * (0.5 - 0.5 * np.cos(np.pi * place)), force_n
        )
        last_n = to_n
    return force_n


@finite
def share(force_n: Floats, level: Floats) -> Floats:
    """G(N, u)/G(N, 0): the part of the conductance that remains at shear level u; 1 where nothing presses."""
    rest_v = rubber.rest_volts(force_n)
    volts = rubber.volts(force_n, level)
    pressed = rest_v < rubber.SUPPLY_V
    left = (rubber.SUPPLY_V - volts) / volts * rest_v
    return np.divide(left, rubber.SUPPLY_V - rest_v, out=np.ones(len(rest_v)), where=pressed)


@finite
def mirrored(direction_deg: float) -> float:
    """The direction of a pull for the sensor on the object's other side: left and right swapped."""
    return 180.0 - direction_deg


@finite
def pulled(
    time_s: Floats,
    grip_n: Floats,
    start_s: float,
    speed_mm_s: float,
    material: str,
    wire_n_mm: float,
    rng: Generator,
    cover_mm: float = 0.0,
) -> Held:
    """Pull an object held with the force ``grip_n`` [samples], steady from ``start_s`` on; returns ``Held``.

    ``cover_mm``: thickness of a layer of silicone on the sensor.
    """
    steady_n = float(grip_n[-1])
    pull = plate.pull(time_s, steady_n, speed_mm_s, material, start_s, rng, wire_n_mm)
    limit_n = wire_n_mm * speed_mm_s * (pull.gross_s - start_s)
    grip_n = grip_n * (1 + GRIP_RISE * (pull.tension_n / limit_n) ** 3)
    # The sample at the very start has not been sheared yet.
    shear_mm_s = np.where(time_s > start_s + 1e-9, pull.shear_mm_s, 0.0)
    felt_n = grip_n * share(grip_n, rubber.shear_level(time_s, shear_mm_s))
    lever = np.divide(pull.tension_n, grip_n, out=np.zeros(len(time_s)), where=grip_n > 0)
    move_mm = (LEVER_MM + cover_mm) * lever
    return Held(grip_n, felt_n, pull.tension_n, pull.slip_mm, move_mm, start_s, float(pull.gross_s))


@finite
def gripped(grip_n: Floats) -> Held:
    """``Held`` of a grip without a pull."""
    nothing = np.zeros(len(grip_n))
    return Held(grip_n, grip_n, nothing, nothing, nothing, None, None)


@finite
def loads(
    held: Held, m: int, n: int, pitch_mm: float, cover_pitches: float, direction_deg: float, rng: Generator
) -> tuple[Floats, Floats]:
    """The forces on the taxels and the forces that they show (N), [samples, m, n] each.

    Each run draws one place of the contact in the middle third and one direction of its tilt.
    """
    place, tilt = rng.uniform(-1 / 3, 1 / 3, 2), rng.uniform(0, 2 * np.pi)
    along = np.deg2rad(direction_deg)
    at = []
    for axis, count in enumerate((n, m)):
        turn = (np.cos, np.sin)[axis]
        half_mm = pitch_mm * max(count - 1, 1) / 2
        moved = held.move_mm / half_mm * turn(along) + TILT * held.grip_n * turn(tilt)
        at.append(np.clip(place[axis] + moved, -1, 1))
    x, y = at
    unit = mesh_loads.press(m, n, x, y, 1.0, cover_pitches)
    return unit * held.grip_n[:, None, None], unit * held.felt_n[:, None, None]
