"""Scenes of the pressure-conductive rubber: a plate pressed on it, and pulled until it slips."""

from dataclasses import dataclass

import numpy as np

from meissner.check import fields, one_of, positive, shown
from meissner.physics import plate, rubber
from meissner.physics.adc import PARTS, Adc
from meissner.twins.slip.config import SWITCHES, SlipConfig

COMPONENTS = (
    "rubber divider",
    "normal force profile",
    "shear step",
    "partial slip",
    "plate friction",
    "stick-slip",
    "adc",
)
_MODELLED = {
    "press": ("rubber divider", "normal force profile", "adc"),
    "pull": COMPONENTS,
}

_TOP = {
    "title": str,
    "sensor": str,
    "adc": str,
    "rate_hz": int,
    "features": list,
    "seeds": int,
    "slip": dict,
    "world": dict,
}
_SLIP = dict.fromkeys(("window", "hop", "level"), int) | dict.fromkeys(
    (
        "threshold_v",
        "gross_threshold_v",
        "keep_threshold_v",
        "contact_v",
        "release_v",
        "hold_s",
        "refractory_s",
        "blank_s",
    ),
    float,
)
_WORLD = {
    "press": ("press_start_s", "press_s", "rest_s", "unload_s", "after_s"),
    "pull": ("press_start_s", "press_s", "stage_start_s", "slide_s"),
}
_CONDITION = {
    "press": {"name": str, "normal_n": float},
    "pull": {"name": str, "normal_n": float, "speed_mm_s": float, "material": str},
}


@dataclass(frozen=True)
class Condition:
    """One row of a sweep. ``speed_mm_s`` and ``material`` only where a plate is pulled."""

    name: str
    normal_n: float
    speed_mm_s: float = 0.0
    material: str | None = None


@dataclass(frozen=True)
class Slip:
    """The detector's settings in physical units; ``threshold_v`` is on the Haar coefficient."""

    threshold_v: float
    gross_threshold_v: float
    keep_threshold_v: float
    window: int
    hop: int
    level: int
    contact_v: float
    release_v: float
    hold_s: float
    refractory_s: float
    blank_s: float
    switches: dict  # of SlipConfig, those that are not for the sensor to say


@dataclass(frozen=True)
class Scene:
    """A scene, checked. ``world`` holds the times of its kind, ``press`` or ``pull``."""

    name: str
    title: str
    sensor: str
    adc_part: str
    rate_hz: int
    features: tuple
    seeds: int
    slip: Slip
    kind: str
    world: dict
    conditions: tuple

    @property
    def adc(self) -> Adc:
        return PARTS[self.adc_part]

    def condition(self, which=0):
        """The condition of that name or number."""
        for number, condition in enumerate(self.conditions):
            if which in (number, condition.name, condition):
                return condition
        names = ", ".join(condition.name for condition in self.conditions)
        raise ValueError(f"scene {self.name} has no condition '{which}'; it has: {names}")

    def duration_s(self, condition):
        """How long the condition lasts; the slip comes later under more load or friction."""
        world = self.world
        if self.kind == "press":
            return sum(world.values())
        rise_s = plate.rise_s(condition.normal_n, condition.speed_mm_s, condition.material)
        return world["stage_start_s"] + rise_s + world["slide_s"]

    def peak_to_peak_v(self):
        """The threshold on max cD - min cD."""
        return 2.0 * self.slip.threshold_v

    def slip_config(self) -> SlipConfig:
        """The same settings in codes and details.

        The unnormalised detail is sqrt(2)^level times the coefficient, so p2p in codes, an integer,
        exceeds floor(2·threshold_v·sqrt(2)^level / lsb) exactly when the real comparison holds.
        """
        slip, lsb_v = self.slip, self.adc.lsb_v
        step = 1 << slip.level

        def threshold(volts):
            return int(np.floor(2.0 * volts * 2.0 ** (slip.level / 2) / lsb_v))

        def level(volts):
            return round(step * self.adc.code_of(volts))

        def details(seconds):
            return round(seconds * self.rate_hz / step)

        return SlipConfig(
            window=slip.window,
            hop=slip.hop,
            level=slip.level,
            threshold=threshold(slip.threshold_v),
            gross_threshold=threshold(slip.gross_threshold_v),
            keep_threshold=threshold(slip.keep_threshold_v),
            contact_level=level(slip.contact_v),
            release_level=level(slip.release_v),
            contact_rises=False,
            **slip.switches,
            hold=details(slip.hold_s),
            refractory=details(slip.refractory_s),
            blank=details(slip.blank_s),
        )


@dataclass(frozen=True)
class Recording:
    """One run of one condition: the core's input, an experimenter's measurements, and the truth.

    ``onset_s``: the first event of partial slip; ``gross_s``: the whole contact slips; both None without
    a slip. ``events_s``, ``events_v``: every event of partial slip and the step of Vc it makes, so that
    the wait for an event that is large enough can be separated from the detector's delay. ``contacts_s``:
    (from, until) where the normal force is not zero, until None if it lasts. ``moving``: the loading stage
    moves, the motion that a hand knows to be its own.
    """

    scene: Scene
    condition: Condition
    seed: int
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
    modelled: tuple
    left_out: tuple


def _switches(where, table):
    """({name: value} of the switches in [slip], what else is there); what is not there is as ever."""
    switches = {key: table.pop(key, SWITCHES[key]) for key in SWITCHES if key != "contact_rises"}
    for key, value in switches.items():
        if not isinstance(value, bool):
            raise ValueError(f"{where}: {key} = {shown(value)} must be true or false")
    return switches, table


def build(name, table):
    """Check a scene's table and return the Scene; ValueError with one sentence if it cannot be."""
    where = f"scene {name}"
    top = fields(where, table, _TOP)
    one_of(where, "sensor", top["sensor"], ("rubber",))
    one_of(where, "adc", top["adc"], tuple(PARTS))
    positive(where, top, ("rate_hz", "seeds"))
    for feature in top["features"]:
        one_of(where, "features", feature, ("slip",))

    switches, slip = _switches(f"{where}, [slip]", dict(top["slip"]))
    slip = Slip(**fields(f"{where}, [slip]", slip, _SLIP), switches=switches)
    if not slip.contact_v < slip.release_v:
        raise ValueError(f"{where}, [slip]: contact_v = {slip.contact_v} must be below release_v")
    if slip.keep_threshold_v > slip.threshold_v:
        raise ValueError(
            f"{where}, [slip]: keep_threshold_v = {slip.keep_threshold_v} must not be above threshold_v"
        )

    world = dict(top["world"])
    kind, rows = world.pop("kind", None), world.pop("conditions", None)
    inside = f"{where}, [world]"
    one_of(inside, "kind", kind, tuple(_WORLD))
    world = fields(inside, world, dict.fromkeys(_WORLD[kind], float))
    positive(inside, world, world)
    if kind == "pull" and world["stage_start_s"] < world["press_start_s"] + world["press_s"]:
        raise ValueError(f"{inside}: stage_start_s must not come before the end of pressing")
    if not isinstance(rows, list) or not rows or not all(isinstance(row, dict) for row in rows):
        raise ValueError(f"{inside}: there must be at least one [[world.conditions]]")
    conditions = []
    for row in rows:
        row = fields(f"{where}, [[world.conditions]]", row, _CONDITION[kind])
        positive(f"{where}, [[world.conditions]]", row, [k for k in row if k.endswith(("_n", "_s"))])
        if kind == "pull":
            one_of(f"{where}, [[world.conditions]]", "material", row["material"], tuple(plate.MATERIALS))
        conditions.append(Condition(**row))

    scene = Scene(
        name=name,
        title=top["title"],
        sensor=top["sensor"],
        adc_part=top["adc"],
        rate_hz=top["rate_hz"],
        features=tuple(top["features"]),
        seeds=top["seeds"],
        slip=slip,
        kind=kind,
        world=world,
        conditions=tuple(conditions),
    )
    try:
        scene.slip_config()
    except ValueError as problem:
        raise ValueError(f"{where}, [slip]: {problem}") from None
    return scene


def _contacts(time_s, force_n):
    edges = np.flatnonzero(np.diff(force_n > 0, prepend=False, append=False))
    return tuple(
        (float(time_s[first]), float(time_s[last]) if last < len(time_s) else None)
        for first, last in zip(edges[::2], edges[1::2])
    )


def simulate(scene, condition=0, seed=0):
    """Run one condition (a Condition, its name or its number) with one seed."""
    condition = scene.condition(condition)
    rng = np.random.default_rng([seed, scene.conditions.index(condition)])
    samples = round(scene.duration_s(condition) * scene.rate_hz)
    time_s = np.arange(samples) / scene.rate_hz
    world = scene.world

    ramps = [(world["press_start_s"], world["press_s"])]
    if scene.kind == "press":
        ramps.append((sum(ramps[0]) + world["rest_s"], world["unload_s"]))
    normal_n, moving = plate.press(time_s, condition.normal_n, ramps, rng)

    tension_n = slip_mm = np.zeros(samples)
    events_s = events_v = np.zeros(0)
    onset_s = gross_s = None
    if scene.kind == "pull":
        pull = plate.pull(
            time_s, condition.normal_n, condition.speed_mm_s, condition.material, world["stage_start_s"], rng
        )
        scale = plate.MATERIALS[condition.material].fluctuation
        partial_s = pull.time_of(rubber.event_ratios(rng))
        shares = rubber.event_shares(len(partial_s), scale, rng)
        gross = rubber.GROSS_SHARE * rubber.EVENT_SHARE * scale  # conductance rises: Vc drops
        sliding = rubber.SLIDING_SHARE * rubber.event_shares(len(pull.slips_s), scale, rng)
        share = rubber.fluctuation(
            np.concatenate([partial_s, [pull.gross_s], pull.slips_s]),
            np.concatenate([shares, [gross], sliding]),
            samples,
            scene.rate_hz,
        )
        level = rubber.shear_level(time_s, pull.shear_mm_s)
        volts = rubber.volts(normal_n, level, share)
        before = np.minimum((partial_s * scene.rate_hz).astype(np.int64), samples - 1)
        events_v = rubber.event_steps(rubber.volts(normal_n[before], level[before]), shares)
        events_s = partial_s
        tension_n, slip_mm = pull.tension_n, pull.slip_mm
        onset_s, gross_s = float(partial_s[0]), float(pull.gross_s)
    else:
        volts = rubber.volts(normal_n)

    codes, over_range = scene.adc.convert(volts, rng)
    modelled = _MODELLED[scene.kind]
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
        modelled=modelled,
        left_out=tuple(part for part in COMPONENTS if part not in modelled),
    )
