"""Everything on: every sensor with every component, through every feature of the core.

This is the baseline of ``saved``. For each sensor, the scenes that together have all its components run as
fast as they can: world, converter and engine, without verdict, pictures and waves. The complete core of
configuration ``full`` is added, with scan, health, tare, images, packets and registers: on rtl from its
converters' pins to its line, on fixed its twin. Costs are in milliseconds per second of simulated time.
"""

import time
from dataclasses import replace

import numpy as np

from meissner import engines, scenes

REPEATS = 3
LONG_S = 1.0  # a run that takes longer is timed once
HAND = {
    "duration_s": 2.0,
    "hold_from_s": 0.0,
    "poured_kg": 0.1,
    "pour_start_s": 0.0,
}  # other keys as in the TOML
CORE_FRAMES = {"fixed": 8, "rtl": 2}
# (scene, condition): together they have every component of each sensor.
EVERYTHING = (
    *(("grip_slip", 6), ("stick_slip", 0), ("shear_speed", 6), ("grip_disturb", 0), ("cop_slip", 0)),
    *(("cop_six_random", None), ("cop_impulse", None), ("cop_circle", None)),
    *(("dense_64", None), ("plantar_step", None), ("fsr_64x64", None)),
    *(("capacitive_shapes", None), ("capacitive_cell", None), ("capacitive_crosstalk", None)),
)


def _slip(scene, engine, condition, seed):
    recording = scenes.simulate(scene, condition, seed)
    engines.load(engine).watch(recording.codes[None], scene.slip_config())
    return len(recording.codes) / scene.rate_hz


def _shear(scene, engine, condition, seed):
    from meissner.scenes.shear.estimate import Estimator

    if "shear_speed" in scene.features:
        Estimator(scene, engine, engine).of(scenes.simulate(scene, condition, seed))
    return _slip(scene, engine, condition, seed)


def _hand(scene, engine, condition, seed):
    from meissner.scenes.hand import loop, run

    one = replace(scene.conditions[condition], duration_s=None)
    scene = replace(scene, world=scene.world | HAND, conditions=(one,))
    loop.hold(scene, one, [seed], run.PARTS[engine])
    return HAND["duration_s"]


def _grip(scene, engine, condition, seed):
    recording = scenes.simulate(scene, scene.conditions[condition], seed)
    engines.load(engine).cop_slip(recording.codes, scene.config, scene.lag, scene.registers)
    return len(recording.codes) / scene.rate_hz


def _mesh(scene, engine, condition, seed):
    from meissner.scenes.mesh.run import reported

    recordings = scenes.simulate(scene, seed)
    for recording in recordings:
        reported(recording, engine)
    return len(recordings) * len(recordings[0].time_s) / scene.rate_hz


def _array(scene, engine, condition, seed):
    codes = scenes.simulate(scene, seed).codes
    engines.process_cop(codes, engine, scene.min_load)
    return len(codes) / scene.rate_hz


def _fsr(scene, engine, condition, seed):
    from meissner import calibration

    recording = scenes.simulate(scene, seed)
    lines, _ = calibration.fit(*recording.parts["calibration"])
    min_load = round(scene.min_load_n / lines.force_lsb_n)
    engines.process_cop(recording.codes, engine, min_load, lines)
    return len(recording.codes) / scene.rate_hz


def _capacitive(scene, engine, condition, seed):
    from meissner.scenes.capacitive.judge import calibrations

    recording, codes = scenes.simulate(scene, seed), {}
    for name, part in recording.parts.items():
        codes[name] = engines.demodulate(part.samples, scene.carrier, engine)
    if "calibrate" in scene.features:
        lines = next(iter(calibrations(recording, codes).values())).lines
        for each in codes.values():
            forces = engines.calibrate(each, lines, engine)
            if "cop" in scene.features:
                engines.process_cop(forces, engine)
    return sum(len(part.samples) / part.rate_hz for part in recording.parts.values())


_OF = {"rubber": _slip, "shear": _shear, "hand": _hand, "grip": _grip, "mesh": _mesh, "array": _array}
_OF |= {"fsr": _fsr, "capacitive": _capacitive}


def _core(engine, seed):
    """Run the complete core of configuration full; the simulated seconds."""
    from meissner.builds import config
    from meissner.scenes.shown import press
    from meissner.twins import core

    built = config.load("full")
    frames = CORE_FRAMES["rtl" if engine in engines.VERILATED else "fixed"]
    shape = built.shape
    codes = press(*shape, (1 << built.part.data_bits - built.part.signed) - 1, seed)[64 : 64 + frames]
    if engine in engines.VERILATED:
        from meissner.engines.rtl_core import CoreOnPins

        with CoreOnPins(built, codes) as whole:
            whole.run(frames * built.period_clocks)
            return whole.simulated_s
    samples, over = core.samples_of(built, codes)
    core.of_array(core.array_of(built), samples, built.slip, over)
    return frames / built.rate_hz


def _ms_per_s(run):
    """Milliseconds per simulated second: the best of REPEATS runs, after one that builds and warms up.

    The processor's clock measures, so that other load on the machine counts little.
    """
    run()
    best = np.inf
    for _ in range(REPEATS):
        began = time.process_time()
        seconds = run()
        took = time.process_time() - began
        best = min(best, 1e3 * took / seconds)
        if took > LONG_S:
            break
    return round(best, 4)


def cost(scene, engine, condition=0, seed=1):
    """Milliseconds of world and engine per simulated second of a scene's condition."""
    return _ms_per_s(lambda: _OF[scene.sensor](scene, engine, condition, seed))


def everything(engine, progress=list, seed=1):
    """{part: milliseconds per simulated second}: every sensor, then the complete core."""
    costs = {}
    for name, condition in progress(EVERYTHING):
        costs[name] = cost(scenes.load(name), engine, condition, seed)
    costs["core: full"] = core_cost(engine, seed)
    return costs


def core_cost(engine, seed=1):
    """Milliseconds per simulated second of the complete core of configuration full."""
    return _ms_per_s(lambda: _core(engine, seed))
