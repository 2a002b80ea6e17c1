"""Scenes of a matrix of force-sensing resistors: forces, network, faults, and the ground truth."""

from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
from msgspec import Meta

from meissner.builds.cop_tables import Cop
from meissner.physics import fsr, mesh_loads, patches
from meissner.physics.adc import Adc
from meissner.scenes import base, scanned
from meissner.scenes.array import scene as cop
from meissner.scenes.array.scene import Patches, Side
from meissner.scenes.scanned import Scan, ScanKeys
from meissner.tables import Count, Positive, Table, naming, one_of, read, values

FEATURES = {
    "calibrate": "cells are compared in newtons after a calibration with calibrate_n",
    "cop": "position and load are compared with the forces",
}
WHY = {
    "moving contact": "[[world.patches]]: place and force of each contact",
    "elastic cover": "depth_pitches: spread of a patch",
    "cell resistance": "material: force to resistance",
    "spread of the cells": "spread that calibration removes",
    "drift under load": "material: drift that calibration cannot remove",
    "resistor network": "[readout]: the cells share their lines",
    "converter": "[converter]: volts to codes, with its noise",
    "converter front": "[scan]: what remains of the row before",
    "faults": "[[faults]]",
}
COMPONENTS = tuple(WHY)
_BYTES = 80  # per cell of a frame: forces, conductances, volts, codes, in doubles


class ArrayKeys(Table):
    RENAMED: ClassVar = {"min_load_n": ("[cop] min_load_n", 1)}
    rows: Side
    columns: Side
    material: str

    def __post_init__(self):
        one_of("material", self.material, fsr.MATERIALS)


class ReadoutKeys(Table):
    circuit: str
    unselected: str
    supply_v: Positive
    driver_ohm: Positive
    load_ohm: Positive

    def __post_init__(self):
        one_of("circuit", self.circuit, fsr.CIRCUITS)
        one_of("unselected", self.unselected, fsr.UNSELECTED)


class ConverterKeys(Table):
    """[converter], from 0 V to the supply."""

    bits: Annotated[int, Meta(ge=1, le=16)]
    noise_v: Annotated[float, Meta(ge=0, le=100)]


class World(Table):
    """[world]; ``even_n``, ``calibrate_n``: newtons on each cell."""

    seconds: Positive
    depth_pitches: Positive
    even_n: Positive
    calibrate_n: Positive
    patches: Patches


class _Fault(Table):
    kind: str


class CellFault(_Fault):
    """[[faults]] of a cell."""

    row: int
    column: int


class RowFault(_Fault):
    row: int


class ColumnFault(_Fault):
    column: int


_OF_LINES = {"dead row": RowFault, "open column": ColumnFault}


class Keys(base.Keys):
    rate_hz: Count
    array: ArrayKeys
    cop: Cop
    readout: ReadoutKeys
    converter: ConverterKeys
    world: World
    scan: ScanKeys | None = None
    faults: Annotated[list[dict], Meta(min_length=1)] | None = None

    def __post_init__(self):
        if round(self.world.seconds * self.rate_hz) < 1:
            raise ValueError(f"[world]: seconds = {self.world.seconds:g} hold no frame")


CALIBRATION_STEPS, CALIBRATION_FRAMES = 6, 16  # forces from 0 up, frames at each
EVEN_FRAMES = 64
ORIGINS = {
    "CALIBRATION_STEPS": ("chosen", "a bladder's steps", "even press after: 0.05 and 0.15 %"),
    "CALIBRATION_FRAMES": ("chosen", "a short press", "as the steps"),
    "EVEN_FRAMES": ("chosen", "a short press", "how sure the unevenness is"),
}


@dataclass(frozen=True)
class Scene(base.Scene):
    """A checked scene. ``faults``: of meissner.physics.fsr.Fault."""

    rate_hz: int
    rows: int
    columns: int
    material: fsr.Material
    min_load_n: float
    readout: fsr.Readout
    adc: Adc
    world: dict
    faults: tuple
    scan: Scan | None


@dataclass(frozen=True)
class Recording(base.Recording):
    """One run; ``codes`` int32 and ``force_n``, newtons on each cell, both [frames, rows, columns].

    ``parts``: codes and forces of the presses for calibration ("calibration") and of an even press ("even").
    ``readings``: {(circuit, unselected): volts of frame number ``shown`` [rows, columns], without faults};
    ``alone``: the conductances of that frame.
    """

    time_s: np.ndarray
    codes: np.ndarray
    force_n: np.ndarray
    parts: dict
    readings: dict
    alone: np.ndarray
    shown: int
    over_range: int


def _fault(where, row, rows, columns):
    with naming(where):
        one_of("kind", row.get("kind"), fsr.FAULTS)
    row = values(read(_OF_LINES.get(row.get("kind"), CellFault), row, where))
    for key, count in (("row", rows), ("column", columns)):
        if not 0 <= row.get(key, 0) < count:
            raise ValueError(f"{where}: {key} = {row[key]} must lie in 0 .. {count - 1}")
    return fsr.Fault(**{"row": -1, "column": -1, **row})


def build(name, table):
    keys, own = base.read(name, table, Keys)
    array, converter, supply_v = keys.array, keys.converter, keys.readout.supply_v
    size, at = (array.rows, array.columns), f"scene {name}, [[faults]]"
    scan = keys.scan and scanned.build(f"scene {name}", keys.scan, *size, keys.rate_hz)
    return Scene(
        **own,
        rows=array.rows,
        columns=array.columns,
        material=fsr.MATERIALS[array.material],
        min_load_n=keys.cop.min_load_n,
        readout=fsr.Readout(**values(keys.readout)),
        adc=Adc(converter.bits, 0.0, supply_v, converter.noise_v),
        world=values(keys.world) | {"patches": cop.paths(keys.world.patches)},
        faults=tuple(_fault(at, row, *size) for row in keys.faults or ()),
        scan=scan,
    )


class Sheet:
    """The sheet of one seed, its network and converter; ``scene``: a Scene, or one with its fields."""

    def __init__(self, scene, seed):
        self.scene, self.rng = scene, np.random.default_rng(seed)
        self.strength = fsr.strengths(scene.rows, scene.columns, scene.material, self.rng)
        self.over_range = 0

    def conductance(self, force_n):
        return fsr.conductance(force_n, self.scene.material, self.strength)

    def codes(self, siemens):
        """The converter's codes of the whole matrix, with the scene's faults."""
        scene = self.scene
        siemens = fsr.break_cells(siemens, scene.faults, scene.rate_hz, self.rng)
        codes = np.empty(siemens.shape, dtype=np.int32)
        piece = max(1, (1 << 18) // siemens[0].size)
        front = scene.scan.through() if scene.scan else None
        for start in range(0, len(siemens), piece):
            part = slice(start, start + piece)
            volts = fsr.output_volts(siemens[part], scene.readout, scene.faults)
            volts = front.next(volts) if front else volts
            codes[part], over = scene.adc.convert(volts, self.rng)
            self.over_range += int(over.sum())
        return fsr.stick(codes, scene.faults, scene.adc.max_code)

    def even(self, forces_n, frames):
        """Codes and forces while the same force presses on every cell, without drift."""
        scene = self.scene
        force_n = np.repeat(forces_n, frames)[:, None, None] * np.ones((scene.rows, scene.columns))
        return self.codes(self.conductance(force_n)), force_n


def modelled(scene):
    out = {"faults": not scene.faults, "converter front": not scene.scan}
    return tuple(part for part in COMPONENTS if not out.get(part))


def memory(scene):
    presses = CALIBRATION_STEPS * CALIBRATION_FRAMES + EVEN_FRAMES
    frames = presses + scene.world["seconds"] * scene.rate_hz
    cells = scene.rows * scene.columns
    return _BYTES * frames * cells, f"{frames:.0f} frames of {cells} cells"


def simulate(scene, seed=0):
    """Run the scene with one seed, which draws the spread of the cells and the noise."""
    world, table = Sheet(scene, seed), scene.world
    count = round(table["seconds"] * scene.rate_hz)
    force_n = patches.forces(
        scene.rows, scene.columns, table["patches"], np.arange(count) / count, table["depth_pitches"]
    )
    # Even presses, as a bladder over the whole sheet gives: the usual calibration of many cells.
    parts = {
        "calibration": world.even(
            np.linspace(0, table["calibrate_n"], CALIBRATION_STEPS), CALIBRATION_FRAMES
        ),
        "even": world.even([table["even_n"]], EVEN_FRAMES),
    }
    siemens = world.conductance(force_n) * fsr.drift(force_n, scene.material, scene.rate_hz)
    codes = world.codes(siemens)
    shown = int(np.argmax(mesh_loads.true_centre(force_n)[0]))
    readings = {}
    for circuit in fsr.CIRCUITS:
        for unselected in fsr.UNSELECTED:
            readout = replace(scene.readout, circuit=circuit, unselected=unselected)
            readings[circuit, unselected] = fsr.output_volts(siemens[shown], readout)
    return Recording(
        scene=scene,
        seed=seed,
        time_s=np.arange(count) / scene.rate_hz,
        codes=codes,
        force_n=force_n,
        parts=parts,
        readings=readings,
        alone=siemens[shown],
        shown=shown,
        over_range=world.over_range,
        modelled=modelled(scene),
    )


def broken_cells(scene):
    """Cells [rows, columns] that the scene's faults make useless."""
    broken = np.zeros((scene.rows, scene.columns), dtype=bool)
    for fault in scene.faults:
        if fault.kind == "dead row":
            broken[fault.row] = True
        elif fault.kind == "open column":
            broken[:, fault.column] = True
        else:
            broken[fault.row, fault.column] = True
    return broken
