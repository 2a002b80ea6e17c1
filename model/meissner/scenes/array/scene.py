"""Scenes of an array of taxels: patches that move over it, or a recording, with the true forces."""

from dataclasses import dataclass
from typing import Annotated, Literal

import msgspec
import numpy as np
from msgspec import Meta

from meissner.physics import mesh_loads, patches, plantar
from meissner.scenes import base, scanned
from meissner.scenes.scanned import Scan, ScanKeys
from meissner.tables import Count, Positive, Table, values
from meissner.twins.cop.cop import sum_bits

FEATURES = {"cop": "position and load are compared with the forces"}
WHY = {
    "moving contact": "[[world.patches]]: place and force of each contact",
    "elastic cover": "depth_pitches: spread of a patch",
    "taxel converter": "[converter]: force to codes, with its noise",
    "converter front": "[scan]: what remains of the row before",
    "recorded pressures": "kind recording: dataset",
}
COMPONENTS = tuple(WHY)
_BYTES = 8  # per taxel of a frame: codes, and the pieces that are joined

Side = Annotated[int, Meta(ge=1, le=1024)]
_Unit = Annotated[float, Meta(ge=-1, le=1)]
_Place = tuple[_Unit, _Unit]


class _Patch(Table):
    """[[world.patches]]: the path of a contact, its force and how that changes."""

    force_n: Positive
    profile: Literal["steady", "press", "step"]


class Line(_Patch, kw_only=True, tag_field="path", tag="line"):
    start: _Place = msgspec.field(name="from")
    to: _Place


class Circle(_Patch, tag_field="path", tag="circle"):
    centre: _Place
    radius: Positive
    turns: Positive

    def __post_init__(self):
        if max(map(abs, self.centre)) + self.radius > 1:
            raise ValueError(f"radius = {self.radius:g} extends beyond the edge at 1")


class Hold(_Patch, tag_field="path", tag="hold"):
    at: _Place


Patches = Annotated[list[Line | Circle | Hold], Meta(min_length=1)]


def paths(rows):
    """The rows of [[world.patches]] as meissner.physics.patches takes them."""
    return tuple(msgspec.to_builtins(row) for row in rows)


class Moving(Table, tag_field="kind", tag="patches"):
    seconds: Positive
    depth_pitches: Positive
    patches: Patches


class Recorded(Table, tag_field="kind", tag="recording"):
    dataset: Literal[plantar.DATASET]
    subject: Annotated[int, Meta(ge=0, le=plantar.SUBJECTS - 1)]
    trial: Annotated[int, Meta(ge=0, le=plantar.TRIALS - 1)]


class Converter(Table):
    """[converter]: of a taxel's force to a code; full_scale_n newtons are the top code of ``bits``."""

    bits: Annotated[int, Meta(ge=1, le=16)]
    full_scale_n: Positive
    noise_lsb: Annotated[float, Meta(ge=0, le=1000)]

    @property
    def top(self):
        return (1 << self.bits) - 1

    @property
    def lsb_n(self):
        return self.full_scale_n / self.top

    def convert(self, force_n, rng):
        """(codes, uint16: rounded to nearest with white noise; number of taxels beyond the range)."""
        level = force_n / self.lsb_n
        over = int((level > self.top + 0.5).sum())
        level = level + self.noise_lsb * rng.standard_normal(level.shape)
        return np.clip(np.floor(level + 0.5), 0, self.top).astype(np.uint16), over


class ArrayKeys(Table):
    """[array]; ``min_load`` in codes, as a recording has no newtons."""

    rows: Side
    columns: Side
    min_load: Annotated[int, Meta(ge=0)]

    def __post_init__(self):
        limit = (1 << sum_bits(self.rows, self.columns)) - 1
        if self.min_load > limit:
            raise ValueError(f"min_load = {self.min_load} must lie in 0 .. {limit}")


class Keys(base.Keys, kw_only=True):
    rate_hz: Count
    array: ArrayKeys
    converter: Converter | None = None
    scan: ScanKeys | None = None
    world: Moving | Recorded

    def __post_init__(self):
        moving = isinstance(self.world, Moving)
        if moving and self.converter is None:
            raise ValueError("the key 'converter' is missing")
        if self.converter and not moving:
            raise ValueError("unknown key 'converter': a recording has codes")
        if self.scan and not moving:
            raise ValueError("unknown key 'scan': a recording has codes")
        if moving and round(self.world.seconds * self.rate_hz) < 1:
            raise ValueError(f"[world]: seconds = {self.world.seconds:g} hold no frame")


@dataclass(frozen=True)
class Scene(base.Scene):
    """A checked scene. ``world``: its table, ``patches`` a tuple of tables; ``converter`` may be None."""

    rate_hz: int
    rows: int
    columns: int
    min_load: int
    converter: Converter | None
    kind: str
    world: dict
    scan: Scan | None

    @property
    def unit(self):
        return "counts" if self.converter is None else "N"

    @property
    def load_lsb(self):
        """The value of one of the core's load codes, in ``unit``."""
        return 1.0 if self.converter is None else self.converter.lsb_n


@dataclass(frozen=True)
class Recording(base.Recording):
    """One run: the core's input, and the ground truth.

    ``codes`` uint16 [frames, rows, columns]; ``load`` (in the scene's unit), ``x``, ``y`` [frames]: of the
    forces on the taxels before conversion. ``over_range``: number of taxel samples beyond full scale.
    """

    time_s: np.ndarray
    codes: np.ndarray
    load: np.ndarray
    x: np.ndarray
    y: np.ndarray
    over_range: int


def build(name, table):
    keys, own = base.read(name, table, Keys)
    world = values(keys.world)
    if "patches" in world:
        world["patches"] = paths(world["patches"])
    size = keys.array.rows, keys.array.columns
    return Scene(
        **own,
        scan=keys.scan and scanned.build(f"scene {name}", keys.scan, *size, keys.rate_hz),
        **values(keys.array),
        converter=keys.converter,
        world=world,
    )


def modelled(scene):
    return COMPONENTS[4:] if scene.kind == "recording" else COMPONENTS[: 4 if scene.scan else 3]


def memory(scene):
    taxels = scene.rows * scene.columns
    frames = 1000 if scene.kind == "recording" else scene.world["seconds"] * scene.rate_hz
    return _BYTES * frames * taxels + 16 * 8 * max(1 << 20, taxels), f"{frames:.0f} frames of {taxels} taxels"


def simulate(scene, seed=0):
    """Run the scene with one seed, which draws the converter's noise."""
    world, over_range = scene.world, 0
    if scene.kind == "recording":
        codes = plantar.step(world["subject"], world["trial"])
        if codes.shape[1:] != (scene.rows, scene.columns):
            raise ValueError(
                f"scene {scene.name}: the recording has {codes.shape[1]}×{codes.shape[2]} taxels, "
                f"not {scene.rows}×{scene.columns}"
            )
        load, x, y = mesh_loads.true_centre(codes)
    else:
        rng = np.random.default_rng(seed)
        phase = np.arange(round(world["seconds"] * scene.rate_hz)) / (world["seconds"] * scene.rate_hz)
        codes = np.empty((len(phase), scene.rows, scene.columns), dtype=np.uint16)
        load, x, y = np.empty((3, len(phase)))
        step = max(1, (1 << 20) // (scene.rows * scene.columns))
        front = scene.scan.through() if scene.scan else None
        for start in range(0, len(phase), step):
            part = slice(start, start + step)
            force_n = patches.forces(
                scene.rows, scene.columns, world["patches"], phase[part], world["depth_pitches"]
            )
            load[part], x[part], y[part] = mesh_loads.true_centre(force_n)
            sampled_n = front.next(force_n) if front else force_n
            codes[part], over = scene.converter.convert(sampled_n, rng)
            over_range += over
    return Recording(
        scene=scene,
        seed=seed,
        time_s=np.arange(len(codes)) / scene.rate_hz,
        codes=codes,
        load=load,
        x=x,
        y=y,
        over_range=over_range,
        modelled=modelled(scene),
    )
