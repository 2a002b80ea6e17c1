"""Parts of a scene of a resistive matrix, and what each is for."""

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
BYTES = 80  # per cell of a frame: forces, conductances, volts, codes, in doubles
PRESSES = 6 * 16 + 64  # frames of calibration and of the even press


def uses(scene):
    return FEATURES


def modelled(scene):
    return list(WHY) if scene.faults else list(WHY)[:-1]


def memory(scene):
    frames = PRESSES + scene.world["seconds"] * scene.rate_hz
    cells = scene.rows * scene.columns
    return BYTES * frames * cells, f"{frames:.0f} frames of {cells} cells"
