"""Tighten a gripper as soon as the object begins to slip, before it moves.

    python examples/grip_on_slip.py [--hold]     --hold: leave the grip as it is, and see it slip

The gripper, the object that is pulled out of it and the rubber sensor are simulated; between them and this
program is a simulated core on a pty, as it would be on a serial port.
"""

import sys

import numpy as np

from meissner import host, scenes
from meissner.host.pty import Pty
from meissner.host.simulated import BLOCK, SimulatedCore, settings_of, slip_source
from meissner.physics import plate, rubber
from meissner.twins.link.packet import STATISTIC, statistic

SCENE = scenes.load("acrylic_slip")
MU = plate.MATERIALS["acrylic"].mu_s
STEP_S = 2 * BLOCK / SCENE.rate_hz


class Gripper:
    """Holds an object that is pulled harder and harder; ``blocks`` is what its sensor's converter says."""

    def __init__(self, force_n=2.0, speed_n_s=20.0):
        self.force_n = self.wanted_n = force_n
        self.speed_n_s, self.slipped = speed_n_s, False

    def tighten(self, factor=1.5):
        self.wanted_n = factor * self.wanted_n

    def blocks(self, seconds=1.5):
        rng = np.random.default_rng(1)
        lets_go, last = rubber.event_ratios(rng), 0.0  # shares of the friction limit at which patches let go
        for pull_n in np.linspace(0.8, 1.2, round(seconds / STEP_S)) * MU * self.force_n:
            was_n = self.force_n
            self.force_n = min(self.wanted_n, was_n + self.speed_n_s * STEP_S)
            ratio = pull_n / (MU * self.force_n)
            self.slipped |= ratio > 1
            count = np.count_nonzero((lets_go > last) & (lets_go <= ratio))
            last = max(last, ratio)
            shares = rubber.event_shares(count, 1.0, rng)
            share = rubber.fluctuation(rng.uniform(0, STEP_S, count), shares, 2 * BLOCK, SCENE.rate_hz)
            volts = rubber.volts(np.linspace(was_n, self.force_n, 2 * BLOCK), share=share)
            yield SCENE.adc.convert(volts, rng)[0][None]


def main(hold=False):
    gripper = Gripper()
    # The end of the pull is a packet of its own, so that this program knows when to stop.
    slips = slip_source(gripper.blocks(), SCENE.rate_hz)

    def source(core):
        yield from slips(core)
        yield core.now, STATISTIC, statistic(0, 0)

    core = SimulatedCore(source, settings=settings_of(SCENE.slip_config()), speed=1.0)
    with Pty(core) as pty, host.connect(pty.url) as core:
        for packet in core.packets(20):
            if isinstance(packet, host.Statistics):
                break
            if isinstance(packet, host.SlipEvent):
                print(f"{packet.time_s:.3f} s: it begins to slip", end="\n" if hold else ": grip harder\n")
                if not hold:
                    gripper.tighten()
    print(f"the object {'slipped away' if gripper.slipped else 'was held'} with {gripper.force_n:.1f} N")
    return gripper.slipped


if __name__ == "__main__":
    main("--hold" in sys.argv[1:])
