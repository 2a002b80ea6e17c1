"""Parts of a scene of the four-wire mesh, and what each is for."""

FEATURES = {"cop4": "position and load of the electrodes are compared with the forces"}
WHY = {
    "resistor mesh": "[mesh]: the sensor, loads to voltages",
    "taxel resistance": "k_n_ohm: force to resistance",
    "converter": "[converter]: voltages to codes, with its noise",
    "random points": "kind random: count and draws",
    "rubber response": "kind pulse: response_s",
    "hemispherical cover": "kind stroke: cover_radius",
}
_ADDED = {
    "points": [],
    "random": ["random points"],
    "pulse": ["rubber response"],
    "stroke": ["hemispherical cover"],
}
BYTES = 32  # per taxel of a sample: forces, felt loads, and the places above 0


def uses(scene):
    return FEATURES


def modelled(scene):
    return list(WHY)[:3] + _ADDED[scene.kind]


def memory(scene):
    world, taxels = scene.world, scene.rows * scene.columns
    if scene.kind == "random":
        samples = world["draws"] * len(world["totals_n"])
    else:
        samples = world["seconds"] * scene.rate_hz if scene.kind == "pulse" else world["steps"]
    return BYTES * samples * taxels, f"{samples:.0f} loads of {taxels} taxels"
