"""Scenes of tactile pins under a finger: what a display is sent, drive period by drive period.

Kinds: ``free`` and ``contact`` (a steady drive of each frequency, without and with a finger), ``burst`` (on
and off in turn), ``letter`` (a letter that crosses the pins), ``touch`` (what two sensors feel, on the pins).
"""

from dataclasses import dataclass, replace
from math import ceil
from typing import Annotated

import numpy as np
from msgspec import Meta

from meissner.physics import receptors
from meissner.scenes import base
from meissner.scenes.sensor import sensor
from meissner.tables import Count, Positive, Table, naming, values
from meissner.twins.actuate.pin_display import DisplaySettings, DisplaySize, increment_of

FEATURES = {
    "pin_display": "[display]: which pins are driven in each drive period, and how long it is",
    "render": "kind touch: images, centres and slips become levels of pins",
    "demod": "kind touch: the pad's readings are amplitudes of carriers",
    "calibrate": "kind touch: the pad's cells are compared in newtons",
    "cop4": "kind touch: slip is detected in the four electrodes' position and load",
    "cop_slip": "kind touch: slip and its direction",
}
WHY = {
    "bimorph": "volts, hz: displacement of a pin",
    "finger": "every kind but free: the skin on the pin",
    "laser": "kinds free, contact and burst: 2 kHz, 0.1 um, drift and scatter",
    "spread of the pins": "kind contact: pins",
    "receptors": "every kind but free: thresholds of the four kinds of unit",
    "letter": "kind letter: its image, step by step",
    "capacitive pad": "kind touch: pad, an object pressed on it",
    "four-wire sensor": "kind touch: grip, an object that slips",
}
COMPONENTS = tuple(WHY)
_MODELLED = {
    "free": ("bimorph", "laser"),
    "contact": COMPONENTS[:5],
    "burst": ("bimorph", "finger", "laser", "receptors"),
    "letter": ("bimorph", "finger", "receptors", "letter"),
    "touch": ("bimorph", "finger", "receptors", *COMPONENTS[6:]),
}
_BYTES = 64  # of a pin at an instant: volts, displacement and spectra
# A letter of seven rows; figure 13's pin of row 3 is on where the letter's columns 2 and 4 pass it.
LETTERS = {"A": ("..X..", "..X..", ".X.X.", ".X.X.", "XXXXX", "X...X", "X...X")}
GAP = 1  # columns between letters
LEAST_PERIODS, SURE_HZ = 4, 0.0005  # of kinds free and contact: as many as show the mean frequency so surely
QUIET_S = 0.2  # at the end, for the skin to come to rest

_Hertz = Annotated[tuple[Annotated[float, Meta(ge=1, le=400)], ...], Meta(min_length=1)]
_Volts = Annotated[float, Meta(gt=0, le=200)]
_Hz = Annotated[float, Meta(ge=1, le=400)]
_Area = Annotated[float, Meta(ge=1e-5, le=10)]


class DisplayKeys(Table):
    """[display]; ``rows``: of the display, or of several, one after the other."""

    rows: Annotated[tuple[Annotated[int, Meta(ge=1, le=64)], ...], Meta(min_length=1)]
    columns: Annotated[int, Meta(ge=1, le=64)]
    amplitude_bits: Annotated[int, Meta(ge=1, le=6)]
    clk_khz: Count

    def sizes(self) -> tuple[DisplaySize, ...]:
        given = {"amplitude_bits": self.amplitude_bits, "clk_khz": self.clk_khz}
        return tuple(DisplaySize(pins=rows * self.columns, **given) for rows in self.rows)


class Free(Table, tag_field="kind", tag="free"):
    volts: _Volts
    hz: _Hertz


class Contact(Table, tag_field="kind", tag="contact"):
    volts: Annotated[tuple[_Volts, ...], Meta(min_length=1)]
    hz: _Hertz
    pins: Annotated[int, Meta(ge=1, le=100)]
    tip_cm2: _Area = receptors.TIP_CM2


class Burst(Table, tag_field="kind", tag="burst"):
    volts: _Volts
    hz: _Hz
    burst_s: Annotated[float, Meta(ge=0.02, le=10)]
    bursts: Annotated[int, Meta(ge=1, le=100)]
    tip_cm2: _Area = receptors.TIP_CM2


class Letter(Table, tag_field="kind", tag="letter"):
    volts: _Volts
    hz: _Hz
    words_min: Annotated[float, Meta(ge=1, le=200)]
    tip_cm2: _Area = receptors.TIP_CM2


class Touch(Table, tag_field="kind", tag="touch"):
    """``pad``, ``grip``: scenes of the pad and of the four-wire sensor; ``shape``, ``pull``: of theirs;
    ``frame_ms``: from one frame of a sensor to the next; ``cue_frames``: of a step of the slip's stripes."""

    volts: _Volts
    hz: _Hz
    pad: str
    shape: str
    press_s: Annotated[float, Meta(ge=0.1, le=5)]
    floor_g: Positive
    step_g: Positive
    grip: str
    pull: str
    frame_ms: Annotated[float, Meta(ge=0.5, le=100)]
    cue_frames: Annotated[int, Meta(ge=1, le=255)]
    tip_cm2: _Area = receptors.TIP_CM2


class Keys(base.Keys):
    display: DisplayKeys
    world: Free | Contact | Burst | Letter | Touch


@dataclass(frozen=True)
class Scene(base.Scene):
    """A checked scene. ``grids``: (rows, columns) of each of ``sizes``; ``sensors``: of kind touch."""

    kind: str
    sizes: tuple[DisplaySize, ...]
    grids: tuple[tuple[int, int], ...]
    world: dict
    sensors: tuple = ()

    def settings(self, hz=None, **more):
        """DisplaySettings of a drive frequency, by default the scene's."""
        hz = self.world["hz"] if hz is None else hz
        return DisplaySettings(increment_of(hz, self.sizes[0].clk_khz), **more)

    def level(self, size):
        """The largest level: half of a drive period is high."""
        return (1 << size.amplitude_bits) - 1


@dataclass(frozen=True)
class Recording(base.Recording):
    """``drives``: (size, settings, frames [periods, pins]) of each drive; ``steps``: of kind letter, images
    [steps, rows, columns] of each display; ``felt``: of kind touch, recordings of the pad and of the grip."""

    drives: tuple
    steps: tuple = ()
    felt: tuple = ()


def build(name, table):
    keys, own = base.read(name, table, Keys)
    display, world = keys.display, values(keys.world)
    with naming(f"scene {name}: [display]"):
        sizes = display.sizes()
    grids = tuple((rows, display.columns) for rows in display.rows)
    found = ()
    if own["kind"] == "letter" and (min(display.rows) < 7 or display.columns != 5):
        raise ValueError(f"scene {name}: [display]: a letter needs rows of 7 or more, and columns = 5")
    if own["kind"] == "burst" and world["burst_s"] * world["hz"] < LEAST_PERIODS:
        raise ValueError(f"scene {name}: [world]: burst_s must last {LEAST_PERIODS} drive periods or more")
    if own["kind"] == "letter" and 60 / (world["words_min"] * 5) / (5 + GAP) * world["hz"] < LEAST_PERIODS:
        raise ValueError(
            f"scene {name}: [world]: words_min = {world['words_min']:g} makes steps of a letter shorter than "
            f"{LEAST_PERIODS} drive periods"
        )
    if own["kind"] == "touch":
        found = _sensors(f"scene {name}: [world]", world)
    return Scene(**own, sizes=sizes, grids=grids, world=world, sensors=found)


def _sensors(where, world):
    """The scenes of pad and grip, with the one shape and the one pull."""
    from meissner import scenes  # here: it reads every sensor's scenes

    pad, grip = scenes.load(world["pad"]), scenes.load(world["grip"])
    if pad.sensor != "capacitive" or pad.kind != "shapes":
        raise ValueError(f"{where}: pad = '{world['pad']}' must be a scene of kind shapes")
    if grip.sensor != "grip":
        raise ValueError(f"{where}: grip = '{world['grip']}' must be a scene of sensor grip")
    pulls = {one.name: one for one in grip.conditions if hasattr(one, "direction_deg")}
    for key, known in (("shape", pad.world["shapes"]), ("pull", pulls)):
        if world[key] not in known:
            raise ValueError(f"{where}: {key} = '{world[key]}' must be one of {', '.join(known)}")
    frames = max(1, round(1000 * world["press_s"] / world["frame_ms"]))
    return (
        replace(pad, world=pad.world | {"shapes": [world["shape"]], "frames": frames}),
        replace(grip, conditions=(pulls[world["pull"]],)),
    )


def uses(scene):
    count = 6 if scene.kind == "touch" else 1
    return {name: FEATURES[name] for name in list(FEATURES)[:count]}


def modelled(scene):
    return _MODELLED[scene.kind]


def memory(scene):
    if scene.kind == "touch":
        return max(sensor(one.sensor).memory(one) for one in scene.sensors)
    world, pins = scene.world, max(size.pins for size in scene.sizes)
    if scene.kind in ("free", "contact"):
        instants = 100_000 * len(world["hz"])
    else:
        seconds = world["burst_s"] * world["bursts"] if scene.kind == "burst" else 120 / world["words_min"]
        instants = pins * seconds * world["hz"] * 64
    return _BYTES * instants, f"{instants:.0f} instants of pins"


def glyph(letter, rows):
    """A letter's image [rows, 5], each of its seven rows as high as the display makes it."""
    image = np.array([[cell == "X" for cell in row] for row in LETTERS[letter]])
    return image[np.arange(rows) * 7 // rows]


def crossing(image):
    """Images [steps, rows, columns] of one that enters at the right, column by column, until it is gone."""
    columns = image.shape[1]
    tape = np.pad(image, ((0, 0), (columns, columns)))
    return np.array([tape[:, step : step + columns] for step in range(1, 2 * columns + 1)])


def _steady(scene):
    size, drives = scene.sizes[0], []
    for hz in scene.world["hz"]:
        periods = 2 + max(LEAST_PERIODS, ceil(hz**2 / (1000 * size.clk_khz * SURE_HZ)))
        drives.append((size, scene.settings(hz), np.full((periods, size.pins), scene.level(size))))
    return drives


def _burst(scene):
    world, size = scene.world, scene.sizes[0]
    periods = round(world["burst_s"] * world["hz"])
    frames = np.full((1 + periods * world["bursts"], size.pins), scene.level(size))
    return [(size, scene.settings(burst_period=periods, burst_on=periods // 2), frames)]


def step_s(scene):
    """Seconds of a step of a letter: five letters a word, five columns and a gap a letter."""
    return 60 / (scene.world["words_min"] * 5) / (5 + GAP)


def _letter(scene):
    drives, steps = [], []
    for size, (rows, _) in zip(scene.sizes, scene.grids):
        images = crossing(glyph("A", rows))
        seconds = len(images) * step_s(scene) + QUIET_S
        at = np.arange(int(seconds * scene.world["hz"])) / scene.world["hz"] / step_s(scene)
        shown = np.concatenate([images, 0 * images[:1]])[np.minimum(at.astype(int), len(images))]
        frames = scene.level(size) * shown.reshape(len(at), -1)
        drives.append((size, scene.settings(), np.concatenate([frames[:1], frames])))
        steps.append(images)
    return drives, steps


def simulate(scene, seed=0):
    """The Recording of one seed, which draws scatter, spread and what the sensors' scenes draw."""
    drives, steps, felt = (), (), ()
    if scene.kind in ("free", "contact"):
        drives = _steady(scene)
    elif scene.kind == "burst":
        drives = _burst(scene)
    elif scene.kind == "letter":
        drives, steps = _letter(scene)
    else:
        pad, grip = scene.sensors
        felt = (
            sensor("capacitive").simulate(pad, seed),
            sensor("grip").simulate(grip, grip.conditions[0], seed),
        )
    return Recording(
        scene=scene,
        seed=seed,
        modelled=modelled(scene),
        drives=tuple(drives),
        steps=tuple(steps),
        felt=felt,
    )
