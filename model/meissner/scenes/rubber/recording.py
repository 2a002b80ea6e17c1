"""One run of a scene of the rubber: the physics that its condition names, and the ground truth."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from meissner.physics import disturbances, plate, rubber
from meissner.scenes import base

WHY = {
    "rubber divider": "the sensor: force and shear to the voltage Vc",
    "normal force profile": "every kind presses the plate on",
    "shear step": "kinds pull and grip shear the rubber before it slips",
    "partial slip": "what the flag is to find: events from first_event of the friction limit on",
    "plate friction": "material says when the whole contact slips",
    "stick-slip": "what the plate does afterwards: slide_s",
    "adc": "adc: Vc to codes, with its noise",
    "grip follows load": "kind grip: follow",
    "hum": "hum_v of a condition",
    "1/f noise": "flicker of a condition",
    "hysteresis": "hysteresis of a condition",
    "correlated events": "burst of a condition",
}
COMPONENTS = tuple(WHY)[:7]  # those beyond are named only where they are modelled
_MODELLED = {
    "press": ("rubber divider", "normal force profile", "adc"),
    "pull": COMPONENTS,
    "grip": (*COMPONENTS, "grip follows load"),
}
# Keys of a condition that add physics to a run: (the part modelled beyond COMPONENTS, the value for off).
OPTIONS = {
    "hum_v": ("hum", 0.0),
    "flicker": ("1/f noise", 0.0),
    "hysteresis": ("hysteresis", 0.0),
    "burst": ("correlated events", 1.0),
}


def modelled(kind, condition):
    """The parts of the physics in a condition of a scene of that kind."""
    added = (part for key, (part, off) in OPTIONS.items() if getattr(condition, key) != off)
    return (*_MODELLED[kind], *added)


@dataclass(frozen=True)
class Recording(base.Recording):
    """One run of one condition: the core's input, an experimenter's measurements, and the ground truth.

    ``onset_s``: the first event of partial slip; ``gross_s``: the whole contact slips; both None without
    a slip. ``events_s``, ``events_v``: every event of partial slip and its step of Vc, which separate the
    wait for a large enough event from the detector's delay. ``contacts_s``: (from, until) where the normal
    force is not zero, until None if it lasts. ``moving``: the loading stage moves; a hand knows this motion
    as its own. A grip that follows the load is not marked as moving: it moves during the complete pull, and
    masking would leave the detector blind.
    """

    condition: Any
    time_s: np.ndarray
    volts: np.ndarray  # before the converter
    codes: np.ndarray
    over_range: np.ndarray
    normal_n: np.ndarray
    tension_n: np.ndarray
    slip_mm: np.ndarray
    moving: np.ndarray
    contacts_s: tuple
    onset_s: float | None
    gross_s: float | None
    events_s: np.ndarray
    events_v: np.ndarray


@dataclass(frozen=True)
class PartialSlip:
    """A pull's effect on the rubber: its level of shear, its fluctuation, and the events before the slip."""

    level: np.ndarray
    share: np.ndarray
    seen: np.ndarray  # the share, of which the converter's filter leaves this
    events_s: np.ndarray
    shares: np.ndarray


def _contacts(time_s, force_n):
    edges = np.flatnonzero(np.diff(force_n > 0, prepend=False, append=False))
    return tuple(
        (float(time_s[first]), float(time_s[last]) if last < len(time_s) else None)
        for first, last in zip(edges[::2], edges[1::2])
    )


def partial_slip(pull, condition, time_s, rate_hz, rng, low_pass=None):
    """The PartialSlip of a pull under a Condition; ``low_pass``: the converter's."""
    scale = plate.MATERIALS[condition.material].fluctuation
    ratios = rubber.event_ratios(rng, condition.first_event, 1.0 / condition.burst)
    partial_s = pull.time_of(ratios)
    if condition.burst > 1:
        partial_s = disturbances.bursts(partial_s, condition.burst, pull.gross_s, rng)
    shares = rubber.event_shares(len(partial_s), scale, rng)
    gross = rubber.GROSS_SHARE * rubber.EVENT_SHARE * scale  # conductance rises: Vc drops
    sliding = rubber.SLIDING_SHARE * rubber.event_shares(len(pull.slips_s), scale, rng)
    events = (
        np.concatenate([partial_s, [pull.gross_s], pull.slips_s]),
        np.concatenate([shares, [gross], sliding]),
    )
    share = rubber.fluctuation(*events, len(time_s), rate_hz)
    seen = rubber.fluctuation(*events, len(time_s), rate_hz, low_pass) if low_pass else share
    level = rubber.shear_level(time_s, pull.shear_mm_s, condition.recovers)
    return PartialSlip(level, share, seen, partial_s, shares)


def simulate(scene, condition=0, seed=0):
    """Run one condition (itself, its name or its number) with one seed."""
    condition = scene.condition(condition)
    number = scene.conditions.index(condition)
    rng = np.random.default_rng([seed, number])
    disturbed = np.random.default_rng([seed, number, 1])  # separate: disturbances leave the slip unchanged
    samples = round(scene.duration_s(condition) * scene.rate_hz)
    time_s = np.arange(samples) / scene.rate_hz
    world, front = scene.world, scene.front()

    ramps = [(world["press_start_s"], world["press_s"])]
    if scene.kind == "press":
        ramps.append((sum(ramps[0]) + world["rest_s"], world["unload_s"]))
    normal_n, moving = plate.press(time_s, condition.normal_n, ramps, rng)

    slip, tension_n, slip_mm = None, *np.zeros((2, samples))
    onset_s = gross_s = None
    if scene.kind != "press":
        pull = plate.pull(
            time_s,
            condition.normal_n,
            condition.speed_mm_s,
            condition.material,
            world["stage_start_s"],
            rng,
            follow=condition.follow,
        )
        slip = partial_slip(pull, condition, time_s, scene.rate_hz, rng, front.low_pass)
        tension_n, slip_mm = pull.tension_n, pull.slip_mm
        onset_s, gross_s = float(slip.events_s[0]), float(pull.gross_s)
    if scene.kind == "grip":
        normal_n = plate.followed(time_s, normal_n, pull, condition.follow, disturbed)

    shown_n = disturbances.hysteresis(normal_n, condition.hysteresis) if condition.hysteresis else normal_n
    level = None if slip is None else slip.level
    noise, hum_v = None, 0.0
    if condition.flicker:
        noise = disturbances.flicker(samples, scene.rate_hz, condition.flicker, disturbed)
    if condition.hum_v:
        hum_v = disturbances.hum(time_s, condition.hum_v, disturbed)

    def at_pin(share=None):
        both = noise if share is None else share if noise is None else share + noise
        return rubber.volts(shown_n, level, both) + hum_v

    volts = sampled = at_pin(None if slip is None else slip.share)
    if front.low_pass:
        sampled = front.next(quiet := at_pin())
        sampled = sampled + (0.0 if slip is None else at_pin(slip.seen) - quiet)

    events_s = events_v = np.zeros(0)
    if slip is not None:
        events_s = slip.events_s
        before = np.minimum((events_s * scene.rate_hz).astype(np.int64), samples - 1)
        events_v = rubber.event_steps(rubber.volts(shown_n[before], slip.level[before]), slip.shares)

    codes, over_range = scene.adc.convert(sampled, rng)
    return Recording(
        scene=scene,
        condition=condition,
        seed=seed,
        time_s=time_s,
        volts=volts,
        codes=codes,
        over_range=over_range,
        normal_n=normal_n,
        tension_n=tension_n,
        slip_mm=slip_mm,
        moving=moving,
        contacts_s=_contacts(time_s, normal_n),
        onset_s=onset_s,
        gross_s=gross_s,
        events_s=events_s,
        events_v=events_v,
        modelled=modelled(scene.kind, condition),
    )
