"""Scenes of an array of taxels: patches that move over it, or a recording, with the true forces."""

from dataclasses import dataclass

import numpy as np

from meissner.check import between, fields, numbers, one_of, positive, tables
from meissner.physics import mesh_loads, patches, plantar
from meissner.scenes import base
from meissner.twins.cop.cop_accumulate import sum_bits

FEATURES = {"cop": "position and load are compared with the forces"}
WHY = {
    "moving contact": "[[world.patches]]: place and force of each contact",
    "elastic cover": "depth_pitches: spread of a patch",
    "taxel converter": "[converter]: force to codes, with its noise",
    "recorded pressures": "kind recording: dataset",
}
COMPONENTS = tuple(WHY)
_BYTES = 8  # per taxel of a frame: codes, and the pieces that are joined

_TOP = base.TOP | {"rate_hz": int, "array": dict, "world": dict}
_ARRAY = {"rows": int, "columns": int, "min_load": int}
_CONVERTER = {"bits": int, "full_scale_n": float, "noise_lsb": float}
_WORLD = {
    "patches": {"seconds": float, "depth_pitches": float, "patches": list},
    "recording": {"dataset": str, "subject": int, "trial": int},
}
_PATH = {
    "line": {"from": list, "to": list},
    "circle": {"centre": list, "radius": float, "turns": float},
    "hold": {"at": list},
}


@dataclass(frozen=True)
class Converter:
    """Converts a taxel's force to a code: ``full_scale_n`` newtons are the top code of ``bits``."""

    bits: int
    full_scale_n: float
    noise_lsb: float

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


def patch(where, row):
    """One table of [[world.patches]], checked."""
    path = row.get("path")
    one_of(where, "path", path, tuple(_PATH))
    row = fields(where, row, {"path": str, **_PATH[path], "force_n": float, "profile": str})
    one_of(where, "profile", row["profile"], tuple(patches.PROFILES))
    positive(where, row, ["force_n"])
    for key in {"from", "to", "centre", "at"} & set(row):
        row[key] = numbers(where, key, row[key], 2, -1, 1)
    if path == "circle":
        positive(where, row, ["radius", "turns"])
        if max(map(abs, row["centre"])) + row["radius"] > 1:
            raise ValueError(f"{where}: radius = {row['radius']:g} extends beyond the edge at 1")
    return row


def build(name, table):
    """Check a scene's table and return the Scene; ValueError with one sentence if it is invalid."""
    where = f"scene {name}"
    # Only patches need a converter: the kind decides which tables are required.
    expected = _TOP | ({} if "converter" not in table else {"converter": dict})
    top, own = base.top(name, table, expected)
    world = dict(top["world"])
    kind = world.pop("kind", None)
    one_of(f"{where}, [world]", "kind", kind, tuple(_WORLD))
    top = fields(where, table, _TOP | ({"converter": dict} if kind == "patches" else {}))
    array = fields(f"{where}, [array]", top["array"], _ARRAY)
    between(f"{where}, [array]", array, {"rows": (1, 1024), "columns": (1, 1024)})
    limit = (1 << sum_bits(array["rows"], array["columns"])) - 1
    between(f"{where}, [array]", array, {"min_load": (0, limit)})

    inside = f"{where}, [world]"
    world = fields(inside, world, _WORLD[kind])
    converter = None
    if kind == "patches":
        at = f"{where}, [converter]"
        converter = fields(at, top["converter"], _CONVERTER)
        positive(at, converter, ["full_scale_n"])
        between(at, converter, {"bits": (1, 16), "noise_lsb": (0, 1000)})
        converter = Converter(**converter)
        positive(inside, world, ["seconds", "depth_pitches"])
        rows = tables(inside, "world.patches", world["patches"])
        world["patches"] = tuple(patch(f"{where}, [[world.patches]]", row) for row in rows)
        if round(world["seconds"] * top["rate_hz"]) < 1:
            raise ValueError(f"{inside}: seconds = {world['seconds']:g} hold no frame")
    else:
        one_of(inside, "dataset", world["dataset"], (plantar.DATASET,))
        between(inside, world, {"subject": (0, plantar.SUBJECTS - 1), "trial": (0, plantar.TRIALS - 1)})
    return Scene(
        **own,
        **array,
        converter=converter,
        kind=kind,
        world=world,
    )


def modelled(scene):
    """The parts of the physics that the scene has."""
    return COMPONENTS[3:] if scene.kind == "recording" else COMPONENTS[:3]


def memory(scene):
    """(bytes of the largest arrays, what they hold)."""
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
        for start in range(0, len(phase), step):
            part = slice(start, start + step)
            force_n = patches.forces(
                scene.rows, scene.columns, world["patches"], phase[part], world["depth_pitches"]
            )
            load[part], x[part], y[part] = mesh_loads.true_centre(force_n)
            codes[part], over = scene.converter.convert(force_n, rng)
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
