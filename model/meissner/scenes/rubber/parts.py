"""Parts of a scene of the rubber, and what each is for."""

FEATURES = {"slip": "its flag is judged against the truth"}
WHY = {
    "rubber divider": "the sensor: force and shear to the voltage Vc",
    "normal force profile": "every kind presses the plate on",
    "shear step": "kinds pull and grip shear the rubber before it slips",
    "partial slip": "what the flag is to find: events from first_event of the friction limit on",
    "plate friction": "material says when the whole contact slips",
    "stick-slip": "what the plate does afterwards: slide_s",
    "adc": "adc: Vc to codes, with its noise",
    "grip follows load": "kind grip: follow",
    "hum": "hum_v of a condition",
    "1/f noise": "flicker of a condition",
    "hysteresis": "hysteresis of a condition",
    "correlated events": "burst of a condition",
}
BYTES = 400  # per sample: times, volts, forces, details, decisions, as int64 and double


def uses(scene):
    return FEATURES


def modelled(scene):
    from meissner.scenes.rubber.recording import modelled

    found = {part for condition in scene.conditions for part in modelled(scene.kind, condition)}
    return [part for part in WHY if part in found]


def memory(scene):
    samples = sum(scene.duration_s(condition) for condition in scene.conditions) * scene.rate_hz
    return BYTES * samples, f"{samples:.3g} samples of the shown runs"
