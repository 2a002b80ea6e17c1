"""Measure what the reflex gains from the shear speed: grip_disturb with msn_shear_speed's twin in the loop.

    python tools/published/grip_speed.py --runs 20 --gain 0 70 210

The estimator's twin gets the same codes as the slip path. The reflex gets its speeds, in 1/4096 mm/s, before
the windows of a cycle. ``in_hold_i`` is high while the hand closes and for one cycle after, since a larger
grip lowers Vc like the end of a shear; --no-hold leaves that out. `speed_gain` = 70 would follow a pull: at
0.1 mm/s, 1.2 N/s a finger, it adds 0.011 N a window.
"""

import argparse
import dataclasses
import sys

import numpy as np

from meissner import scenes
from meissner.scenes.hand import loop
from meissner.scenes.hand.run import joined, statistics
from meissner.scenes.results import table
from meissner.twins.actuate.grip import SPEED_BITS, Grip
from meissner.twins.slip.shear_speed import SMALL, UNSETTLED, ShearSettings, ShearSize, ShearSpeed

VI_MIN_V = 1.0  # published: 2, but then no window has a speed here (Vc is near 1.9 V)
SPEED_FRACTION = 12  # of the reflex's 16 bits; the estimator's speeds are truncated to them


def parts_of(scene, gain, holds):
    """(slip class, reflex class) with the estimator between them, and the counts of windows with a speed."""
    settings = ShearSettings.of(1 / scene.adc.lsb_v, scene.rate_hz, vi_min=VI_MIN_V)
    cut, found = ShearSize().speed_fraction - SPEED_FRACTION, {"windows": 0, "speeds": 0, "vi": 0, "rise": 0}
    speeds, moving = [], []

    class Slip(loop.FixedSlip):
        def __init__(self, channels, config):
            super().__init__(channels, config)
            self.estimators = [ShearSpeed(settings) for _ in range(channels)]
            speeds[:], moving[:] = [None] * channels, [0] * (channels // 2)

        def next(self, codes):
            for channel, (estimator, row) in enumerate(zip(self.estimators, codes)):
                hold = np.full(len(row), holds and moving[channel // 2] > 0)
                for speed, flags in zip(*estimator.next(row, hold)):
                    speeds[channel] = None if flags else min(int(speed) >> cut, (1 << SPEED_BITS) - 1)
                    found["windows"] += 1
                    found["speeds"] += not flags
                    found["vi"] += not flags & UNSETTLED
                    found["rise"] += not flags & (UNSETTLED | SMALL)
            return super().next(codes)

    class Reflex(Grip):
        def __init__(self, config, fingers, start):
            super().__init__(dataclasses.replace(config, speed_gain=gain), fingers, start)
            self.number = Reflex.made
            Reflex.made += 1

        def decision(self, finger, over, end=True):
            self.report(finger, speeds[2 * self.number + finger])
            super().decision(finger, over, end)

        def cycle(self, healthy=None, override=None):
            command = super().cycle(healthy, override)
            moving[self.number] = 2 if command.increment > 0 else max(moving[self.number] - 1, 0)
            return command

    Reflex.made = 0
    return (Slip, Reflex), found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--gain", type=int, nargs="+", default=[0, 70, 210])
    parser.add_argument("--condition", type=int, default=0)
    parser.add_argument("--no-hold", action="store_true")
    args = parser.parse_args()
    scene = scenes.load("grip_disturb")
    rows = []
    for gain in args.gain:
        parts, found = parts_of(scene, gain, not args.no_hold)
        held = loop.hold(scene, scene.conditions[args.condition], range(1, 1 + args.runs), parts)
        row = statistics(scene.conditions[args.condition], joined([held]))
        rows.append(row | {"condition": f"gain {gain}"})
        print(
            f"gain {gain}: of {found['windows']} windows {found['vi']} have Vi, {found['rise']} a rise, "
            f"{found['speeds']} a speed"
        )
    print("\n".join(table(rows)))


if __name__ == "__main__":
    sys.exit(main())
