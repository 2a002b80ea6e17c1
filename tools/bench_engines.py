"""Samples per second of each engine through ``meissner process slip``, and a scene's time: medians."""

import argparse
import statistics
import time

import numpy as np

from meissner import engines, scenes
from meissner.slip.config import SlipConfig


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=int, default=5_000_000)
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    # Quiet noise that slips in about one window of a thousand, like a held object.
    x = np.random.default_rng(1).integers(-60, 60, options.samples)
    print(f"{options.samples} samples of one channel, median of {options.repeats}; CPU time in brackets")
    for hop in (64, 32, 2):
        config = SlipConfig(threshold=230, hop=hop)
        for name in engines.NAMES:
            samples = x if name != "float" or hop == 64 else x[: len(x) // 10]
            engines.process_slip(samples[:1000], config, name)  # built and warm
            walls, cpus = [], []
            for _ in range(options.repeats):
                wall, cpu = time.perf_counter(), time.process_time()
                engines.process_slip(samples, config, name)
                walls.append(time.perf_counter() - wall)
                cpus.append(time.process_time() - cpu)
            rate, cpu_rate = (len(samples) / statistics.median(t) for t in (walls, cpus))
            print(f"window 64, hop {hop:2}, {name:5}: {rate:9.3g} samples/s ({cpu_rate:.3g})")
    scene, times = scenes.load("acrylic_slip"), []
    for seed in range(10):
        begin = time.perf_counter()
        run = scenes.simulate(scene, seed=seed)
        times.append(time.perf_counter() - begin)
    print(f"scene acrylic_slip, {len(run.volts)} samples: {1e3 * statistics.median(times):.1f} ms")


if __name__ == "__main__":
    main()
