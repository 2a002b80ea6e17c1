"""How fast simulation is on this machine: what an engine loses, a core on its pins, and several processes.

    python tools/published/speed.py rtl      engine rtl against a plain C++ loop around the same model
    python tools/published/speed.py live     live core:CONFIG on one processor core, as a share of real time
    python tools/published/speed.py jobs     one process against several (--jobs), for `run slip_materials`

rtl and live count processor time, so that others may work beside them; jobs is by the clock on the wall and
needs an idle machine.
"""

import argparse
import ctypes
import tempfile
import time
from pathlib import Path

import numpy as np

from meissner import pool, scenes
from meissner import run as runs
from meissner.builds import config as builds
from meissner.engines import rtl_slip
from meissner.engines.rtl_core import CoreOnPins
from meissner.scenes.core_stimulus import shown
from meissner.tradeoff.axes.engine import CONFIG
from meissner.twins.slip.config import SAMPLE_BITS

SAMPLES, REPEATS = 1_000_000, 5
CLOCKS = 4_000_000
CONFIGS = ("fingertip", "slip1")


def bare(x):
    """(processor seconds, clocks) of the plain loop for samples of one channel."""
    with rtl_slip.Core(rtl_slip._parameters(1, CONFIG), CONFIG) as core:
        loop, clocks = core._lib.core_bare, ctypes.c_int64()
        loop.restype = ctypes.c_double
        given = ctypes.c_void_p(core._core), x.ctypes.data_as(ctypes.c_void_p), ctypes.c_int64(len(x))
        return loop(*given, ctypes.c_uint32(SAMPLE_BITS), ctypes.byref(clocks)), clocks.value


def rtl(samples=SAMPLES, repeats=REPEATS):
    """{"engine_s", "loop_s": the least of several turns, "clocks"} for noise with a few slips."""
    x = np.random.default_rng(1).integers(-60, 60, samples).astype(np.int32)
    windows = samples // CONFIG.window
    times = []
    for _ in range(repeats):  # in turns, so that a busy spell meets both
        began = time.process_time()
        rtl_slip.windows(x[None], CONFIG, windows)
        taken_s = time.process_time() - began
        loop_s, clocks = bare(x)
        times.append((taken_s, loop_s))
    engine_s, loop_s = map(min, zip(*times))
    return {"engine_s": engine_s, "loop_s": loop_s, "clocks": clocks}


def live(name, clocks=CLOCKS):
    """(clocks per processor second, share of real time) of ``live core:NAME``'s model and converters."""
    config = builds.load(name)
    with CoreOnPins(config, shown(config)) as core:
        core.run(clocks // 10)
        began = time.process_time()
        core.run(clocks)
        rate = clocks / (time.process_time() - began)
    return rate, rate / (1000 * config.clk_khz)


def jobs(name, number):
    """Seconds on the wall of a run of the scene on one process and on ``number`` of them."""
    found = []
    for count in (1, number):
        with tempfile.TemporaryDirectory() as folder:
            began = time.perf_counter()
            runs.run(scenes.load(name), "fixed", Path(folder), jobs=count)
            found.append(time.perf_counter() - began)
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("rtl", "live", "jobs"))
    parser.add_argument("--scene", default="slip_materials", help="of jobs (slip_materials)")
    parser.add_argument("--jobs", type=int, default=2, help="processes (2)")
    given = parser.parse_args()
    if given.what == "rtl":
        found = rtl()
        engine, loop = (found["clocks"] / found[key] / 1e6 for key in ("engine_s", "loop_s"))
        print(f"engine rtl {engine:.2f}, plain loop {loop:.2f} million clocks/s; ratio {loop / engine:.3f}")
    elif given.what == "live":
        for name in CONFIGS:
            rate, share = live(name)
            print(f"core:{name}: {rate / 1e6:.2f} million clocks/s, {share:.3f} of real time")
    else:
        one, several = jobs(given.scene, pool.number(given.jobs))
        print(f"run {given.scene}: {one:.1f} s on one process, {several:.1f} s on {given.jobs}, ", end="")
        print(f"{one / several:.2f} times as fast")


if __name__ == "__main__":
    main()
