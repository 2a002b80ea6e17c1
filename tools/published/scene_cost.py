"""What a scene saves compared with the same sensor with all its features on: processor time per simulated
second of its first condition, with world, engine and judge.

    python tools/published/scene_cost.py                            every scene, on engine fixed
    python tools/published/scene_cost.py acrylic_slip --engine rtl  one scene on the core

The features that a scene does not use run on the same samples; their time is added. A rubber's physics can be
switched on together, so its baseline is a scene with all of them; other sensors' kinds exclude each other.
"""

import argparse
import time
from dataclasses import replace

import numpy as np

from meissner import engines, scenes
from meissner.calibration import Calibration
from meissner.engines.features import function
from meissner.pool import Spread
from meissner.scenes.sensor import runner
from meissner.twins.cop.cop_slip import CopSlipRegisters
from meissner.twins.slip.shear_speed import ShearSettings
from meissner.twins.slip.shear_speeds import ShearConfig

REPEATS = 3
WINDOW = 6  # of a rope's differences
# All features of the core that a sensor can have at once.
FEATURES = {
    **dict.fromkeys(("rubber", "shear"), ("slip", "shear_speed")),
    **dict.fromkeys(("mesh", "grip"), ("cop4", "cop_slip")),
    **dict.fromkeys(("array", "fsr"), ("calibrate", "cop")),
    "capacitive": ("demod", "calibrate", "cop"),
    "rope": ("forest_features", "calibrate", "cop"),
}


FITTED = ("shear_speed",)  # scenes whose judge needs several cases
ALL_PHYSICS = {"rubber": ("grip_slip", 6)}  # {sensor: scene, condition}


def one_run(scene, condition=0):
    """The scene with one run of one condition; of all its cases where their judge fits constants to them."""
    for name in ("conditions", "cases", "names", "pulls"):
        if name in scene.__dataclass_fields__ and scene.name not in FITTED:
            scene = replace(scene, **{name: getattr(scene, name)[condition : condition + 1]})
    return replace(scene, seeds=1) if hasattr(scene, "seeds") else scene


def processor_s(call):
    """Seconds of processor time: the best of REPEATS, after a call that builds and warms up."""
    call()
    taken = []
    for _ in range(REPEATS):
        began = time.process_time()
        call()
        taken.append(time.process_time() - began)
    return min(taken)


def straight(shape):
    """A calibration of cells [rows, columns] that leaves every code as it is."""
    shift = 12
    gain = np.full(shape, 1 << shift)
    return Calibration(np.zeros(shape, int), gain, shift, np.zeros(shape, bool), 1.0)


def others(scene, engine):
    """Functions that run the features which the scene does not use, on its samples."""
    missing = set(FEATURES[scene.sensor]) - set(scene.features)
    if not missing:
        return
    found = scenes.simulate(scene, seed=1)
    if "shear_speed" in missing:
        config = ShearConfig(ShearSettings.of(1.0 / scene.adc.lsb_v, scene.rate_hz))
        yield lambda: function(engine, "shear_speed")(found.codes[None], config, found.moving)
    if "cop_slip" in missing:  # which computes the position again: only the difference counts
        one, registers = found[0], CopSlipRegisters()
        yield lambda: function(engine, "cop_slip")(one.codes, one.config, 1, registers)
    if scene.sensor == "capacitive" and missing:
        samples = max((part.samples for part in found.parts.values()), key=len)
        codes = engines.demodulate(samples, scene.carrier, engine)
        codes = codes.reshape(len(codes), -1, codes.shape[-1])
        if "calibrate" in missing:
            yield lambda: engines.calibrate(codes, straight(codes.shape[1:]), engine)
        yield lambda: engines.process_cop(np.clip(codes, 0, engines.MAX_CODE), engine)
    elif "calibrate" in missing:
        yield lambda: engines.calibrate(found.codes, straight(found.codes.shape[1:]), engine)
        if "cop" in missing:
            yield lambda: engines.process_cop(np.clip(found.codes, 0, engines.MAX_CODE), engine)
    if "forest_features" in missing:
        yield lambda: function(engine, "forest_features")(found.channels, WINDOW)


def ms_per_s(scene, engine, calls=None):
    """Milliseconds of a run of the scene, or of ``calls`` on its samples, per simulated second."""
    run = runner(scene.sensor).run
    seconds = run(scene, engine, 1, None, Spread()).summary["seconds_simulated"]
    calls = [lambda: run(scene, engine, 1, None, Spread())] if calls is None else calls
    return 1e3 * sum(map(processor_s, calls)) / seconds


def cost(name, engine="fixed"):
    """{"scene_ms", "all_ms"}: milliseconds per simulated second; "saved": their ratio."""
    scene = whole = one_run(scenes.load(name))
    own = whole_ms = ms_per_s(scene, engine)
    if scene.sensor in ALL_PHYSICS:
        which, condition = ALL_PHYSICS[scene.sensor]
        whole = one_run(scenes.load(which), condition)
        whole_ms = ms_per_s(whole, engine)
    whole_ms += ms_per_s(whole, engine, list(others(whole, engine)))
    return {"scene_ms": own, "all_ms": whole_ms, "saved": whole_ms / own}


def names():
    """The scenes that can be measured: not those in closed loop."""
    return [name for name in scenes.names() if scenes.load(name).sensor in FEATURES]


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scenes", nargs="*", metavar="SCENE", choices=[[], *names()])
    parser.add_argument("--engine", default="fixed", choices=("fixed", "float", "rtl", "gate"))
    wanted = parser.parse_args()
    print(f"{'scene':22}{'ms per second':>15}{'all features':>15}{'times faster':>15}")
    for name in wanted.scenes or names():
        found = cost(name, wanted.engine)
        print(f"{name:22}{found['scene_ms']:15.4g}{found['all_ms']:15.4g}{found['saved']:15.2f}", flush=True)


if __name__ == "__main__":
    main()
