"""Parts of a scene of an object on the four-wire sensor, and what each is for."""

FEATURES = {
    "cop4": "position and load of the electrodes are what the slip is found in",
    "cop_slip": "its flag and direction are judged, and [slip] sets it",
}
WHY = {
    "resistor mesh": "[mesh]: the sensor, loads to voltages",
    "taxel resistance": "k_n_ohm: force to resistance",
    "converter": "[converter]: voltages to codes, with its noise",
    "grip": "grip_n: what holds the object",
    "pull": "[[world.pulls]]",
    "plate friction": "material of a pull: when the object moves",
    "rubber shear": "what a pull takes from the load output",
    "moment of the pull": "what moves the position before the object does",
}
BYTES = 32  # per taxel of a sample: loads applied and felt


def uses(scene):
    return FEATURES


def modelled(scene):
    pulled = any(hasattr(condition, "direction_deg") for condition in scene.conditions)
    return list(WHY)[: None if pulled else 4]


def memory(scene):
    mesh = scene.config.mesh
    longest_s = max(scene.duration_s(condition) for condition in scene.conditions)
    samples, taxels = longest_s * scene.rate_hz, mesh.m * mesh.n
    return BYTES * samples * taxels, f"{samples:.0f} samples of {taxels} taxels"
