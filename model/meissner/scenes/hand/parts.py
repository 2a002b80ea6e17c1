"""Parts of a scene of a hand, and what each is for."""

FEATURES = {
    "slip": "the reflex reads its windows; [slip] configures it",
    "grip": "it closes the loop; [grip] configures it",
}
WHY = {
    "rubber divider": "the sensor of each finger",
    "shear step": "the object's weight shears the rubber",
    "partial slip that begins again": "first_event and heal_s: events that the reflex answers",
    "friction of two contacts": "material and friction_spread",
    "slide with inertia": "whether and how far the object falls",
    "position servo with ripple": "the hand that carries out the command",
    "grip's compliance": "closing to force",
    "changing mass": "poured_kg",
    "tug": "tugs",
    "adc": "adc: Vc to codes, with its noise",
}
AT_ONCE, CYCLE_BYTES, SAMPLE_BYTES = 50, 1000, 64


def uses(scene):
    return FEATURES


def modelled(scene):
    return list(scene.modelled)


def memory(scene):
    cycles = sum(1000 * scene.duration_s(one) / one.cycle_ms for one in scene.conditions)
    runs = min(AT_ONCE, scene.seeds)
    return CYCLE_BYTES * cycles + SAMPLE_BYTES * runs * scene.rate_hz, f"{cycles:.3g} control cycles"
