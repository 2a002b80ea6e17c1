"""Scenes of a matrix of force-sensing resistors: forces, network, faults, and the ground truth."""

from dataclasses import dataclass

import numpy as np

from meissner.check import between, fields, one_of, positive, tables
from meissner.physics import fsr, mesh_loads, patches
from meissner.physics.adc import Adc
from meissner.scenes import base
from meissner.scenes.array import scene as cop

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
    "faults": "[[faults]]",
}
COMPONENTS = tuple(WHY)
_BYTES = 80  # per cell of a frame: forces, conductances, volts, codes, in doubles
_TOP = base.TOP | dict.fromkeys(("array", "readout", "converter", "world"), dict) | {"rate_hz": int}
_ARRAY = {"rows": int, "columns": int, "material": str, "min_load_n": float}
_READOUT = {"circuit": str, "unselected": str, "supply_v": float, "driver_ohm": float, "load_ohm": float}
_CONVERTER = {"bits": int, "noise_v": float}
_WORLD = {"seconds": float, "depth_pitches": float, "even_n": float, "calibrate_n": float, "patches": list}
_FAULT = {"kind": str, "row": int, "column": int}
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
    one_of(where, "kind", row.get("kind"), fsr.FAULTS)
    unused = {"dead row": "column", "open column": "row"}.get(row["kind"])
    row = fields(where, row, {key: kind for key, kind in _FAULT.items() if key != unused})
    between(where, row, {key: (0, n - 1) for key, n in (("row", rows), ("column", columns)) if key in row})
    return fsr.Fault(**{"row": -1, "column": -1, **row})


def build(name, table):
    """Check a scene's table and return the Scene; ValueError with one sentence if it is invalid."""
    where = f"scene {name}"
    expected = _TOP | ({"faults": list} if "faults" in table else {})
    top, own = base.top(name, table, expected)
    at = f"{where}, [array]"
    array = fields(at, top["array"], _ARRAY)
    between(at, array, {"rows": (1, 1024), "columns": (1, 1024), "min_load_n": (0, 1e6)})
    one_of(at, "material", array["material"], tuple(fsr.MATERIALS))
    at = f"{where}, [readout]"
    readout = fields(at, top["readout"], _READOUT)
    one_of(at, "circuit", readout["circuit"], fsr.CIRCUITS)
    one_of(at, "unselected", readout["unselected"], fsr.UNSELECTED)
    positive(at, readout, ["supply_v", "driver_ohm", "load_ohm"])
    at = f"{where}, [converter]"
    converter = fields(at, top["converter"], _CONVERTER)
    between(at, converter, {"bits": (1, 16), "noise_v": (0, 100)})
    at = f"{where}, [world]"
    world = fields(at, top["world"], _WORLD)
    positive(at, world, ["seconds", "depth_pitches", "even_n", "calibrate_n"])
    rows = tables(at, "world.patches", world["patches"])
    world["patches"] = tuple(cop.patch(f"{where}, [[world.patches]]", row) for row in rows)
    if round(world["seconds"] * top["rate_hz"]) < 1:
        raise ValueError(f"{at}: seconds = {world['seconds']:g} hold no frame")
    faults = tables(where, "faults", top["faults"]) if "faults" in top else ()
    size = array["rows"], array["columns"]
    return Scene(
        **own,
        rows=array["rows"],
        columns=array["columns"],
        material=fsr.MATERIALS[array["material"]],
        min_load_n=array["min_load_n"],
        readout=fsr.Readout(**readout),
        adc=Adc(converter["bits"], 0.0, readout["supply_v"], converter["noise_v"]),
        world=world,
        faults=tuple(_fault(f"{where}, [[faults]]", row, *size) for row in faults),
    )


class _World:
    """The sheet of one seed, its network and converter."""

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
        for start in range(0, len(siemens), piece):
            part = slice(start, start + piece)
            volts = fsr.output_volts(siemens[part], scene.readout, scene.faults)
            codes[part], over = scene.adc.convert(volts, self.rng)
            self.over_range += int(over.sum())
        return fsr.stick(codes, scene.faults, scene.adc.max_code)

    def even(self, forces_n, frames):
        """Codes and forces while the same force presses on every cell, without drift."""
        scene = self.scene
        force_n = np.repeat(forces_n, frames)[:, None, None] * np.ones((scene.rows, scene.columns))
        return self.codes(self.conductance(force_n)), force_n


def modelled(scene):
    """The parts of the physics that the scene has."""
    return COMPONENTS if scene.faults else COMPONENTS[:-1]


def memory(scene):
    """(bytes of the largest arrays, what they hold)."""
    presses = CALIBRATION_STEPS * CALIBRATION_FRAMES + EVEN_FRAMES
    frames = presses + scene.world["seconds"] * scene.rate_hz
    cells = scene.rows * scene.columns
    return _BYTES * frames * cells, f"{frames:.0f} frames of {cells} cells"


def simulate(scene, seed=0):
    """Run the scene with one seed, which draws the spread of the cells and the noise."""
    world, table = _World(scene, seed), scene.world
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
            readout = fsr.Readout(
                circuit,
                unselected,
                scene.readout.supply_v,
                scene.readout.driver_ohm,
                scene.readout.load_ohm,
            )
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
