"""Parts of a scene of the capacitive pad, and what each is for."""

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
_PAD = list(WHY)[:6]
_MODELLED = {"crosstalk": [*_PAD[:3], "leakage"], "cell": [*_PAD, "droop and sag", "placement of the probe"]}
CELLS, BYTES = 64, 20  # cells of the pad; per sample of a carrier: codes, volts and noise
CALIBRATED = 64 * 7 * 6 + 7 * 24  # frames of a probe on each cell and of even presses


def uses(scene):
    return {name: FEATURES[name] for name in list(FEATURES)[: _USED[scene.kind]]}


def modelled(scene):
    return _MODELLED.get(scene.kind, _PAD)


def memory(scene):
    world, frames = scene.world, CALIBRATED
    if scene.kind == "crosstalk":
        points = len(world["gains"]) * len(world["unselected_pf"])
        return BYTES * 200 * points * scene.carrier.samples, f"{points} readings"
    if scene.kind == "cell":
        frames += world["cycles"] * world["rate_hz"] + 2 * (world["hold_s"] + world["rest_s"])
        frames += len(world["steps_g"]) * world["presses"]
    elif scene.kind == "select":
        frames += 10 * (world["cells"] + 1) / world["step_mm"]
    else:
        frames += world["frames"] * (1 + len(world["shapes"]))
    return BYTES * frames * CELLS * scene.carrier.samples, f"{frames:.0f} frames of {CELLS} carriers"
