"""Parts of a scene of a resistive matrix, and what each is for."""

FEATURES = {
    "calibrate": "cells are compared in newtons, and calibrate_n presses them for it",
    "cop": "position and load are compared with the forces",
}
WHY = {
    "moving contact": "[[world.patches]]: where and how hard it presses",
    "elastic cover": "depth_pitches: how far a patch spreads",
    "cell resistance": "material: force to resistance",
    "spread of the cells": "what calibration removes",
    "drift under load": "material: what calibration cannot remove",
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
