"""Parts of a scene of sheared rubber, and what each is for."""

FEATURES = {
    "slip": "its false alarms are judged; in kind stick_slip also its flag",
    "shear_speed": "kind speed: its estimates are compared with the stage's speed",
}
WHY = {
    "rubber divider": "the sensor: force and shear to the voltage Vc",
    "normal force profile": "normal_n is pressed on before the shear",
    "shear step": "speed_mm_s and moved_mm: the dV that is measured",
    "deviation of repeated steps": "seeds: each repeats the shear",
    "recovery": "held_s: recovery of dV",
    "adc": "adc: Vc to codes, with its noise",
    "partial slip": "kind stick_slip: first_event",
    "plate friction": "kind stick_slip: material",
    "stick-slip": "kind stick_slip: the events to be detected",
}
BYTES = 400  # per sample, as in the scenes of the rubber


def uses(scene):
    return {name: why for name, why in FEATURES.items() if name == "slip" or scene.kind == "speed"}


def modelled(scene):
    return list(WHY)[: None if scene.kind == "stick_slip" else 6]


def memory(scene):
    world = scene.world
    shears_s = sum(case.moved_mm / case.speed_mm_s for case in scene.cases)
    samples = scene.rate_hz * (shears_s + len(scene.cases) * (world["shear_start_s"] + world["held_s"]))
    return BYTES * samples, f"{samples:.3g} samples of the shown runs"
