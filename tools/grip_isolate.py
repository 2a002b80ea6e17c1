"""Why a heavy, slippery glass falls in grip_release with a threshold in volts: change one thing at a time.

    python tools/grip_isolate.py                       all cases, 16 runs of 200 s each
    python tools/grip_isolate.py base felt075 --runs 20 --seconds 300

The glass is that of seed 3 in the first condition: friction 0.52, 0.314 kg, it needs at least 2.96 N. Each
run draws the contacts' patches, the noise and the initial grip. Threshold 0.01 V and step 0.0125 N unless
changed. "felt" multiplies the grip that sets the sensor's Vc and leaves the mechanics unchanged; "mu" and
"mass" multiply the glass's friction and mass.
"""

import argparse
import dataclasses
import sys

import numpy as np

from meissner import interval, scenes
from meissner.physics import rubber
from meissner.physics.hand import COUNT_MM, GRIP_N_MM
from meissner.physics.slide import G_MM_S2
from meissner.scenes.hand import loop
from meissner.scenes.hand import scene as drawn
from meissner.scenes.hand.run import PARTS, joined, statistics

SEED, RATIO = 3, (1.4, 1.8)
CASES = {
    "base": {},
    "felt125": {"felt": 1.25},
    "felt075": {"felt": 0.75},
    "felt050": {"felt": 0.5},
    "mu_and_mass133": {"mu": 4 / 3, "mass": 4 / 3},
    "mass075": {"mass": 0.75},
    "threshold0075": {"threshold_p2p_v": 0.015},
    "heal002": {"heal_s": 0.02},
    "step025": {"step_mm": 0.025},
}


def hold(runs, seconds, felt=1.0, mu=1.0, mass=1.0, **condition):
    """The row of one case."""
    scene = scenes.load("grip_release")
    glass, rest_volts = drawn.grasp(scene, scene.conditions[0], SEED), rubber.rest_volts
    settings = {"threshold_p2p_v": 0.02, "step_mm": 0.0125, "duration_s": seconds} | condition
    only = dataclasses.replace(scene.conditions[0], **settings)
    scene = dataclasses.replace(scene, conditions=(only,))
    mu_s, mu_k = np.array(glass.mu_s) * mu, np.array(glass.mu_k) * mu
    mass_kg = np.full_like(glass.mass_kg, glass.mass_kg[0] * mass)

    def grasp(scene, condition, seed):
        rng = np.random.default_rng([seed, 77])
        least_n = mass_kg[0] * G_MM_S2 / 1e3 / mu_s.sum()
        closing_mm = round(rng.uniform(*RATIO) * least_n / GRIP_N_MM / COUNT_MM) * COUNT_MM
        given = {"mu_s": tuple(mu_s), "mu_k": tuple(mu_k), "mass_kg": mass_kg, "closing_mm": closing_mm}
        return dataclasses.replace(glass, **given, heal_s=condition.heal_s, rng=rng)

    loop.grasp, rubber.rest_volts = grasp, lambda force_n: rest_volts(force_n * felt)
    try:
        held = loop.hold(scene, only, range(1, 1 + runs), PARTS["fixed"])
    finally:
        loop.grasp, rubber.rest_volts = drawn.grasp, rest_volts
    return statistics(only, joined([held]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", help=f"of {', '.join(CASES)}")
    parser.add_argument("--runs", type=int, default=16)
    parser.add_argument("--seconds", type=float, default=200.0)
    args = parser.parse_args()
    for name in args.cases or CASES:
        row = hold(args.runs, args.seconds, **CASES[name])
        dropped = interval.words(interval.rate(row["dropped"], row["runs"]))
        print(f"{name}: dropped {dropped}; ratio of the rest {row['grip_ratio_mean']}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
