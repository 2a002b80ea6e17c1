"""Parts of a scene of an object on the four-wire sensor, and what each is for."""

FEATURES = {
    "cop4": "slip is detected in the electrodes' position and load",
    "cop_slip": "its flag and direction are judged; [slip] configures it",
}
WHY = {
    "resistor mesh": "[mesh]: the sensor, loads to voltages",
    "taxel resistance": "k_n_ohm: force to resistance",
    "converter": "[converter]: voltages to codes, with its noise",
    "grip": "grip_n: force that holds the object",
    "pull": "[[world.pulls]]",
    "plate friction": "material of a pull: when the object moves",
    "rubber shear": "fall of the load output under a pull",
    "moment of the pull": "move of the position before the object moves",
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
