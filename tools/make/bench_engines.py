"""Median samples per second of each engine through ``meissner process slip``, and the time of a scene.

The figures depend on the machine: only ratios within one run compare the engines.
"""

import argparse
import statistics
import time

import numpy as np

from meissner import engines, scenes
from meissner.twins.slip.config import SlipConfig


def rates(name, samples, config, repeats):
    """Median samples per second of engine ``name``, by wall-clock time and by CPU time."""
    engines.process_slip(samples[:1000], config, name)  # builds the engine and warms it up
    walls, cpus = [], []
    for _ in range(repeats):
        wall, cpu = time.perf_counter(), time.process_time()
        engines.process_slip(samples, config, name)
        walls.append(time.perf_counter() - wall)
        cpus.append(time.process_time() - cpu)
    return [len(samples) / statistics.median(t) for t in (walls, cpus)]


def measure(count, repeats, hops=(64, 32, 2)):
    """Yield (hop, engine, rate by wall-clock time, rate by CPU time)."""
    # Low noise with a slip in about one window of a thousand, like a held object.
    x = np.random.default_rng(1).integers(-60, 60, count)
    for hop in hops:
        config = SlipConfig(threshold=230, hop=hop)
        for name in engines.NAMES:
            samples = x if name != "float" or hop == 64 else x[: count // 10]
            yield hop, name, *rates(name, samples, config, repeats)


def figures():
    """{engine: samples per second of CPU time}, with window and hop 64."""
    return {name: rate for _, name, _, rate in measure(5_000_000, 5, (64,))}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=5_000_000)
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    print(f"{options.samples} samples of one channel, median of {options.repeats}; CPU time in brackets")
    for hop, name, rate, cpu_rate in measure(options.samples, options.repeats):
        print(f"window 64, hop {hop:2}, {name:5}: {rate:9.3g} samples/s ({cpu_rate:.3g})")
    scene, times = scenes.load("acrylic_slip"), []
    for seed in range(10):
        begin = time.perf_counter()
        run = scenes.simulate(scene, seed=seed)
        times.append(time.perf_counter() - begin)
    print(f"scene acrylic_slip, {len(run.volts)} samples: {1e3 * statistics.median(times):.1f} ms")


if __name__ == "__main__":
    main()
