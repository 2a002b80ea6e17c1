"""Scenes of the published capacitive pad: forces on its tabs, carriers at the converter, the ground truth.

Kinds: ``crosstalk`` (no pad: eq. 18 over gain and unselected capacitance), ``cell`` (one cell pressed up and
down, held, pressed repeatedly, and left at each force until it has settled), ``select`` (a probe stepped
across cells), ``shapes`` (objects pressed on). The presses for calibration are settled ones, too.
"""

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from msgspec import Meta

from meissner.engines import Carrier
from meissner.physics import capacitive, footprints, mesh_loads
from meissner.physics.adc import Adc
from meissner.physics.capacitive import GRAM_N, PITCH_MM
from meissner.scenes import base
from meissner.tables import Positive, Table, one_of, values
from meissner.twins.frontend.am_demod import IQ, IQ_FAST, RECTIFIER, AmDemod

FEATURES = {
    "demod": "the readings are amplitudes of carriers, which [readout] sets",
    "calibrate": "readings are compared in grams",
    "cop": "position and load of the objects are compared with the forces",
}
_USED = {"crosstalk": 1, "cell": 2, "select": 2, "shapes": 3}
WHY = {
    "cells and amplifier": "gain, drive_v, stray_pf: capacitance to amplitude",
    "carrier": "samples_per_period, periods, skip: the signal that is demodulated",
    "converter": "bits, full_scale_v, noise_v",
    "spread of the parts": "spread that calibration removes",
    "tabs of rubber": "force to capacitance",
    "cover": "how far a press spreads to neighbours",
    "droop and sag": "kind cell: hold_s and rest_s",
    "placement of the probe": "kind cell: placement_mm",
    "leakage": "kind crosstalk: leak_mohm",
}
COMPONENTS = tuple(WHY)
_PAD = COMPONENTS[:6]
_MODELLED = {"crosstalk": (*_PAD[:3], "leakage"), "cell": (*_PAD, "droop and sag", "placement of the probe")}
_BYTES = 20  # per sample of a carrier: codes, volts and noise

FORMS = {"rectifier": RECTIFIER, "synchronous": IQ, "synchronous estimate": IQ_FAST}
_Grams = Annotated[float, Meta(gt=0, le=150)]
_Ohms = Annotated[tuple[Annotated[float, Meta(ge=1e-6, le=1e9)], ...], Meta(min_length=1)]
_Farads = Annotated[tuple[Annotated[float, Meta(ge=0, le=1e6)], ...], Meta(min_length=1)]


class ReadoutKeys(Table):
    gain: Positive
    drive_v: Positive
    stray_pf: Annotated[float, Meta(ge=0, le=1e6)]
    form: Literal[tuple(FORMS)]
    samples_per_period: Literal[4, 8, 16]
    periods: Annotated[int, Meta(ge=1, le=64)]
    skip: Annotated[int, Meta(ge=0, le=255)]
    shift: Annotated[int, Meta(ge=0, le=31)]
    bits: Annotated[int, Meta(ge=1, le=17)]
    full_scale_v: Positive
    noise_v: Annotated[float, Meta(ge=0, le=1e3)]


class Crosstalk(Table, tag_field="kind", tag="crosstalk"):
    gains: Annotated[tuple[Annotated[float, Meta(ge=1, le=1e6)], ...], Meta(min_length=1)]
    unselected_pf: _Farads
    leak_mohm: _Ohms
    gain_bandwidth_hz: Positive


class Cell(Table, tag_field="kind", tag="cell"):
    """[world] of kind cell; grams on the cell."""

    force_g: _Grams
    rate_hz: Annotated[int, Meta(ge=1, le=10000)]
    cycles: Annotated[int, Meta(ge=1, le=1000)]
    hold_g: _Grams
    hold_s: Positive
    rest_s: Positive
    steps_g: Annotated[tuple[Annotated[float, Meta(ge=1, le=150)], ...], Meta(min_length=1)]
    presses: Annotated[int, Meta(ge=2, le=1000)]
    placement_mm: Annotated[float, Meta(ge=0, le=1)]


class Select(Table, tag_field="kind", tag="select"):
    force_g: Positive
    step_mm: Annotated[float, Meta(ge=0.01, le=1)]
    cells: Annotated[int, Meta(ge=2, le=5)]


class Shapes(Table, tag_field="kind", tag="shapes"):
    pressure_g_mm2: Positive
    shapes: list[str]
    even_g: Annotated[float, Meta(ge=1, le=150)]
    frames: Annotated[int, Meta(ge=1, le=1000)]

    def __post_init__(self):
        if not self.shapes:
            raise ValueError("there must be at least one shape")
        for shape in self.shapes:
            one_of("shapes", shape, footprints.SHAPES)


class Keys(base.Keys):
    readout: ReadoutKeys
    world: Crosstalk | Cell | Select | Shapes


SIDE = 8  # published
HOLD_HZ = 2.0  # frames per second while a force is held
SETTLE_SAMPLES = 1.0  # time constant of the amplitude after a switch, in the converter's samples; chosen
PHASE = 0.7  # phase of the carrier at a switch; chosen
CALIBRATION_G = np.linspace(0.0, 150.0, 7)
# Frames at each force: of a probe on each cell, an even press, a probe left on the cell of kind cell.
CALIBRATION_FRAMES, EVEN_FRAMES, SETTLED_FRAMES = 6, 24, 64
CHOSEN_FRAMES = 16  # frames of the crosstalk at the scene's own gain
_CALIBRATED = len(CALIBRATION_G) * (SIDE**2 * CALIBRATION_FRAMES + EVEN_FRAMES)
ORIGINS = {
    "SIDE": ("published", "002, fabrication: 8 x 8", "all images"),
    "HOLD_HZ": ("chosen", "figure 6 prints no rate", "when the first reading after a release is: 0.5 s"),
    "SETTLE_SAMPLES": ("chosen", "no circuit is printed", "3 samples: nothing moves by more than 0.02 g"),
    "PHASE": ("chosen", "free-running carrier", "0: noise 1.0 g, the same; another draw"),
    "CALIBRATION_G": (
        "published",
        "002: the tester's range, 0 to 150 g; seven forces are ours, each settled",
        "the line: -4.3 g at 150 g, +3.3 g half way",
    ),
    "CALIBRATION_FRAMES": (
        "chosen",
        "a short press",
        "the second-order term: 0.8 g off, 0.35 g without noise",
    ),
    "EVEN_FRAMES": ("chosen", "a short press", "even press after: 0.41 %"),
    "SETTLED_FRAMES": ("chosen", "noise 0.12 g", "how sure low_settled_g is"),
    "CHOSEN_FRAMES": ("chosen", "noise 0.1 mV", "how sure output_v is"),
}


@dataclass(frozen=True)
class Scene(base.Scene):
    """A checked scene. ``readout``, ``world``: its tables."""

    readout: dict
    carrier: Carrier
    adc: Adc
    kind: str
    world: dict

    @property
    def volts_per_code(self):
        """Amplitude in volts of one code of the demodulator."""
        return self.adc.lsb_v / self.carrier.code_per_lsb


@dataclass(frozen=True)
class Part:
    """Frames of one experiment: the converter's ``samples`` [frames, ..., samples]; ``force_n`` on each cell.

    ``probe_n`` [frames]: the total force; ``probed`` [frames, 2]: the cell under the probe, -1 for
    none; ``rate_hz``: frames per second.
    """

    samples: np.ndarray
    force_n: np.ndarray
    probe_n: np.ndarray
    probed: np.ndarray | None
    rate_hz: float


@dataclass(frozen=True)
class Recording(base.Recording):
    """One run. ``parts``: by name, including "even" and "probe" for calibration; ``over_range``: samples."""

    parts: dict
    over_range: int


def build(name, table):
    keys, own = base.read(name, table, Keys)
    readout = values(keys.readout)
    full_v = readout["full_scale_v"]
    block = AmDemod(FORMS[readout["form"]], readout["samples_per_period"])
    carrier = Carrier(block, *(readout[key] for key in ("periods", "skip", "shift")))
    return Scene(
        **own,
        readout=readout,
        carrier=carrier,
        adc=Adc(readout["bits"], -full_v, full_v, readout["noise_v"]),
        world=values(keys.world),
    )


def place(x_mm, y_mm):
    """Coordinates -1 to 1 of a place given in millimetres from the pad's centre, right and up."""
    half_mm = (SIDE - 1) / 2 * PITCH_MM
    return np.asarray(x_mm) / half_mm, np.asarray(y_mm) / half_mm


def cell_mm(row, column):
    """Centre of a cell in millimetres from the pad's centre, right and up."""
    half = (SIDE - 1) / 2
    return (np.asarray(column) - half) * PITCH_MM, (half - np.asarray(row)) * PITCH_MM


def on_tabs(x_mm, y_mm, force_n):
    """Newtons on every tab [frames, 8, 8] under a probe at a place in millimetres."""
    depth = capacitive.COVER_MM / PITCH_MM
    return mesh_loads.press(SIDE, SIDE, *place(x_mm, y_mm), force_n, depth)


class _World:
    """The pad of one seed and the converter after it."""

    def __init__(self, scene, seed):
        self.scene, self.rng = scene, np.random.default_rng(seed)
        self.pad = capacitive.build_pad(SIDE, SIDE, self.rng, scene.readout["stray_pf"] * 1e-12)
        self.over_range = 0

    def sampled(self, amplitude_v):
        """The converter's codes [..., samples]; the rows of the pad follow each other along axis -2."""
        carrier = self.scene.carrier
        samples = np.empty((*amplitude_v.shape, carrier.samples), dtype=np.int32)
        for k, frame in enumerate(amplitude_v):
            volts = capacitive.carrier(
                frame,
                carrier.samples,
                carrier.block.samples_per_period,
                PHASE,
                before_v=np.roll(frame, 1, axis=0),
                settle_samples=SETTLE_SAMPLES,
            )
            samples[k], over = self.scene.adc.convert(volts, self.rng)
            self.over_range += int(over.sum())
        return samples

    def part(self, force_n, probe_n, probed=None, rate_hz=100.0, felt_n=None):
        """A Part of forces on the tabs; ``felt_n``: the force that the tabs respond to, if they lag."""
        readout = self.scene.readout
        amplitude_v = self.pad.amplitude_v(
            force_n if felt_n is None else felt_n, readout["gain"], readout["drive_v"]
        )
        return Part(self.sampled(amplitude_v), force_n, np.asarray(probe_n), probed, rate_hz)

    def even(self, forces_g, frames):
        """The same force on every cell."""
        each = np.repeat(np.asarray(forces_g) * GRAM_N, frames)
        return self.part(np.broadcast_to(each[:, None, None], (len(each), SIDE, SIDE)), each * SIDE**2)

    def probed(self, cells, forces_g, frames):
        """A probe at the centre of each cell (row, column) in turn with each force."""
        probed = np.repeat(cells, len(forces_g) * frames, axis=0)
        probe_n = np.tile(np.repeat(np.asarray(forces_g) * GRAM_N, frames), len(cells))
        return self.part(on_tabs(*cell_mm(*probed.T), probe_n), probe_n, probed)


EVERY_CELL = np.argwhere(np.ones((SIDE, SIDE)))
PROBED_CELL = np.array([[3, 4]])  # of kind cell


def _cell(world, scene):
    """Cycles from 0 to the force and back, a held force, and many presses at several forces."""
    setting = scene.world
    row, column = PROBED_CELL[0]
    x_mm, y_mm = cell_mm(row, column)
    period = setting["rate_hz"]
    cycle = 1 - np.abs(1 - 2 * (np.arange(setting["cycles"] * period) % period) / period)
    held, rest = (round(setting[key] * HOLD_HZ) for key in ("hold_s", "rest_s"))
    hold = setting["hold_g"] * np.repeat([0.0, 1.0, 0.0], [1, held, rest])
    parts = {}
    for name, grams, rate_hz in (
        ("cycles", setting["force_g"] * cycle, float(period)),
        ("hold", hold, HOLD_HZ),
    ):
        probe_n = grams * GRAM_N
        force_n = on_tabs(x_mm, y_mm, probe_n)
        parts[name] = world.part(force_n, probe_n, None, rate_hz, capacitive.creep(force_n, rate_hz))
    steps, presses = setting["steps_g"], setting["presses"]
    placed_mm = setting["placement_mm"] * world.rng.standard_normal((2, presses))
    probe_n = np.tile(steps, presses) * GRAM_N
    force_n = on_tabs(*(at + np.repeat(off, len(steps)) for at, off in zip((x_mm, y_mm), placed_mm)), probe_n)
    parts["presses"] = world.part(force_n, probe_n)
    settled_g = CALIBRATION_G * setting["force_g"] / CALIBRATION_G[-1]
    parts["settled"] = world.probed(PROBED_CELL, settled_g, SETTLED_FRAMES)
    return parts


def _select(world, scene):
    """A probe with one force, stepped along a row across the scene's ``cells`` in the middle."""
    setting = scene.world
    first = (SIDE - setting["cells"]) // 2
    left, right = (cell_mm(3, column)[0] for column in (first, first + setting["cells"] - 1))
    x_mm = np.arange(left - PITCH_MM, right + PITCH_MM + 1e-9, setting["step_mm"])
    probe_n = np.full(len(x_mm), setting["force_g"] * GRAM_N)
    return {"steps": world.part(on_tabs(x_mm, cell_mm(3, 0)[1], probe_n), probe_n)}


def shape_forces(shape, pressure_g_mm2):
    """Newtons on the tabs [8, 8] under an object that presses evenly where it touches."""
    x_mm, y_mm, area_mm2 = footprints.points(shape)
    inside = np.maximum(np.abs(x_mm), np.abs(y_mm)) <= (SIDE - 1) / 2 * PITCH_MM
    force_n = pressure_g_mm2 * GRAM_N * area_mm2[inside]
    return on_tabs(x_mm[inside], y_mm[inside], force_n).sum(0)


def _shapes(world, scene):
    setting = scene.world
    parts = {"even press": world.even([setting["even_g"]], setting["frames"])}
    for shape in setting["shapes"]:
        force_n = shape_forces(shape, setting["pressure_g_mm2"])
        frames = np.broadcast_to(force_n, (setting["frames"], SIDE, SIDE))
        parts[shape] = world.part(frames, frames.sum((1, 2)))
    return parts


def _crosstalk(world, scene):
    setting, readout = scene.world, scene.readout

    def part(gains, frames):
        others_f, gains = np.array(setting["unselected_pf"]) * 1e-12, np.array(gains)[:, None]
        amplitude_v = capacitive.output_v(capacitive.CELL_F, others_f, gains, readout["drive_v"])
        amplitude_v = np.broadcast_to(amplitude_v, (frames, *amplitude_v.shape))
        return Part(world.sampled(amplitude_v), amplitude_v, None, None, 1.0)

    return {"sweep": part(setting["gains"], 1), "chosen": part([readout["gain"]], CHOSEN_FRAMES)}


_KINDS = {"cell": _cell, "select": _select, "shapes": _shapes, "crosstalk": _crosstalk}
CALIBRATED_BY = {"cell": ("probe",), "select": ("probe",), "shapes": ("probe", "even")}


def uses(scene):
    return {name: FEATURES[name] for name in list(FEATURES)[: _USED[scene.kind]]}


def modelled(scene):
    return _MODELLED.get(scene.kind, _PAD)


def memory(scene):
    world, frames = scene.world, _CALIBRATED
    if scene.kind == "crosstalk":
        points = len(world["gains"]) * len(world["unselected_pf"])
        return _BYTES * 200 * points * scene.carrier.samples, f"{points} readings"
    if scene.kind == "cell":
        frames += world["cycles"] * world["rate_hz"] + 2 * (world["hold_s"] + world["rest_s"])
        frames += len(world["steps_g"]) * world["presses"]
    elif scene.kind == "select":
        frames += 10 * (world["cells"] + 1) / world["step_mm"]
    else:
        frames += world["frames"] * (1 + len(world["shapes"]))
    return _BYTES * frames * SIDE**2 * scene.carrier.samples, f"{frames:.0f} frames of {SIDE**2} carriers"


def simulate(scene, seed=0):
    """Run the scene with one seed, which draws the parts' spread, the noise and the probe's places."""
    world = _World(scene, seed)
    parts = {}
    for way in CALIBRATED_BY.get(scene.kind, ()):
        if way == "even":
            parts[way] = world.even(CALIBRATION_G, EVEN_FRAMES)
        else:
            parts[way] = world.probed(EVERY_CELL, CALIBRATION_G, CALIBRATION_FRAMES)
    parts |= _KINDS[scene.kind](world, scene)
    return Recording(
        scene=scene, seed=seed, parts=parts, over_range=world.over_range, modelled=modelled(scene)
    )
