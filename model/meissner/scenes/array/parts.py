"""Parts of a scene of an array of taxels, and what each is for."""

FEATURES = {"cop": "position and load are compared with the forces"}
WHY = {
    "moving contact": "[[world.patches]]: place and force of each contact",
    "elastic cover": "depth_pitches: spread of a patch",
    "taxel converter": "[converter]: force to codes, with its noise",
    "recorded pressures": "kind recording: dataset",
}
BYTES = 8  # per taxel of a frame: codes, and the pieces that are joined


def uses(scene):
    return FEATURES


def modelled(scene):
    return list(WHY)[3:] if scene.kind == "recording" else list(WHY)[:3]


def memory(scene):
    taxels = scene.rows * scene.columns
    frames = 1000 if scene.kind == "recording" else scene.world["seconds"] * scene.rate_hz
    return BYTES * frames * taxels + 16 * 8 * max(1 << 20, taxels), f"{frames:.0f} frames of {taxels} taxels"
