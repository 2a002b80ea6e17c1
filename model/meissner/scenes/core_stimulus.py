"""The stimulus for a core: the codes that its converters give for a scene that fits its configuration."""

import numpy as np

from meissner import scenes
from meissner.builds.units import of_scene
from meissner.scenes.mesh.scene import electrodes
from meissner.twins import core

SCENES = {(3, 3): "fsr_3x3", (64, 64): "fsr_64x64"}
PRESS_FRAMES = 256
BEFORE_S = 0.1  # of a slip scene, before its first slip event


def codes_of(config, seed=1):
    """Codes that the converter of ``config`` gives for a recording of the scene that suits it.

    An array of a size that no scene has gets ``press``.
    """
    top = (1 << config.part.data_bits - config.part.signed) - 1
    if config.kind == "channels":
        scene = scenes.load("acrylic_slip")
        codes = scenes.simulate(scene, 0, seed).codes
        scale = of_scene(scene).volts_per_code / config.volts_per_code
        if scale != 1:
            codes = np.clip(np.rint(codes * scale), 0, top).astype(codes.dtype)
        return np.repeat(codes[:, None], config.channels, axis=1)
    if config.kind == "none":
        return np.zeros((1, 1), np.int32)
    if config.kind == "electrodes":
        scene = scenes.load("cop_slip")
        recording = scenes.simulate(scene, scene.conditions[0], seed)
        return config.cop4.convert(electrodes(recording.solution))
    shape = config.shape
    if shape in SCENES:
        codes = scenes.simulate(scenes.load(SCENES[shape]), seed).codes
        if codes.max() <= top:
            return codes
    return press(*shape, top, seed)


def press(rows, columns, top, seed=1):
    """Codes of a round contact that presses, moves in a circle and shakes now and then; no physics."""
    rng = np.random.default_rng(seed)
    turn = 2 * np.pi * np.arange(PRESS_FRAMES)[:, None, None] / PRESS_FRAMES
    y = (np.arange(rows)[:, None] + 0.5) / rows - 0.5 - 0.25 * np.sin(turn)
    x = (np.arange(columns) + 0.5) / columns - 0.5 - 0.25 * np.cos(turn)
    held = np.minimum(1, np.arange(PRESS_FRAMES) / (PRESS_FRAMES / 4))[:, None, None]
    level = (0.02 + 0.6 * held * np.exp(-12 * (x * x + y * y))) * top
    shaken = np.arange(PRESS_FRAMES)[:, None, None] // 32 % 4 == 3
    level = level * (1 + np.where(shaken, rng.uniform(-0.2, 0.2, level.shape), 0))
    return np.clip(np.rint(level), 0, top).astype(np.int32)


def shown(config):
    """``codes_of`` for a viewer: single channels are rotated to start shortly before the first slip."""
    codes = codes_of(config)
    if config.kind != "channels":
        return codes
    events = core.of_channels(codes, config.slip).slip
    before = round(BEFORE_S * config.rate_hz)
    return np.roll(codes, -max(0, int(events[0][0]) - before), axis=0) if events else codes
