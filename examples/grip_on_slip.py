"""A hand holds a glass while it is filled; the core's grip reflex tightens as soon as the glass slips.

    python examples/grip_on_slip.py [--hold]     --hold: keep the grip constant, and the glass falls

Hand, glass and both rubber sensors are simulated; the core is the twin of the configuration `grip`. A real
core gives the words at its pins, and a host reads core["grip.command"] and core["grip.fault"].
"""

import sys

import numpy as np

from meissner.builds import config
from meissner.physics.adc import PARTS
from meissner.physics.hand import COUNT_MM, MASS_S, Grasp, Hand
from meissner.twins.core import hand_of

BUILD = config.load("grip")
CYCLE_S = 0.01  # cycle_ms of its [grip]
SECONDS = 6.0


def glass():
    """100 g, and from 0.5 s on 20 g more each second; 1.25 N hold the first 150 g."""
    time_s = np.arange(0, SECONDS, MASS_S)
    mass_kg = 0.1 + 0.02 * np.maximum(0, time_s - 0.5)
    rng = np.random.default_rng(1)
    return Grasp(mass_kg, mu_s=(0.6, 0.58), mu_k=(0.5, 0.48), closing_mm=1.25, first_event=0.5, rng=rng)


def main(hold=False):
    core, adc, noise = hand_of(BUILD), PARTS["MCP3208"], np.random.default_rng(1)
    hand = Hand([glass()], round(BUILD.rate_hz), round(BUILD.rate_hz * CYCLE_S))
    closing_mm, tightened = np.array([1.25]), 0
    for cycle in range(round(SECONDS / CYCLE_S)):
        now = hand.next(closing_mm)
        codes, _ = adc.convert(now.volts[0], noise)
        word = core.next(codes.T)
        if word.increment and not tightened:
            print(f"{cycle * CYCLE_S:.2f} s: it begins to slip{'' if hold else ', the hand tightens'}")
        tightened += word.increment > 0
        if not hold:
            closing_mm = closing_mm + word.increment * COUNT_MM
        if hand.dropped[0]:
            break
    what = "fell" if hand.dropped[0] else "was held"
    print(f"{tightened} words that tighten; the glass {what} with {now.normal_n[0, -1]:.1f} N")


if __name__ == "__main__":
    main("--hold" in sys.argv[1:])
