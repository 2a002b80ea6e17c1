"""Published values of sheared rubber, and the physics' values for them without a converter.

"CoP slip": *Development of High Speed and High Sensitivity Slip Sensor*; "journal": the study of the same
rubber with figures 3 to 15; "sensor": *Development of High-Sensitivity Slip Sensor*. They disagree on:

    dV       Table 1 prints about twice what Table 2 of the same papers gives
    range    0.01 to 4 mm/s (CoP slip), 0.01 to 3.0 mm/s (journal, sensor)
    recovery Vc converges to about 3 V from 2 V (CoP slip), returns to the initial state (sensor)
"""

import numpy as np

from meissner.physics import rubber

STEP_V = {0.05: 1.4, 0.1: 1.6, 1.0: 2.1}  # table 1, both: mm/s, volts, from 2 V, 0.3 mm
FIT = {2: (0.99, 0.12), 3: (0.75, 0.11), 4: (0.45, 0.11)}  # table 2, both: initial volts: k, n
LINE = {"k0": 1.55, "k1": -0.27, "n": 0.11}  # CoP slip, eq. 1, 2; journal, eq. 4, 5
SHEARED_MM = 0.3  # of the speed tests
CONVERGED_V = 3.0  # CoP slip, IV: about, from 2 V
SLOWEST_MM_S = 0.01
# The fastest speed that counts as measured. Two of the three papers end there, and it lies in the range of
# all three; a number for 3.5 mm/s would rest on a single paper.
LIMIT_MM_S = 3.0


def joint_speed(rest_v, step_v):
    """v of the joint line, (dV/(1.55 - 0.27·Vi))^(1/0.11). The papers print the exponent as -0.11."""
    k = LINE["k0"] + LINE["k1"] * np.asarray(rest_v)
    return (np.asarray(step_v) / k) ** (1.0 / LINE["n"])


def table_2(rest_v, speed_mm_s):
    """dV of the row of Table 2 for these initial volts (2, 3 or 4)."""
    k, n = FIT[rest_v]
    return k * np.asarray(speed_mm_s) ** n


def step(force_n, speed_mm_s, moved_mm):
    """Rise of Vc at the end of a shear over this distance."""
    time_s = np.linspace(0.0, moved_mm / speed_mm_s, 2001)
    level = rubber.shear_level(time_s, np.full(len(time_s), speed_mm_s))[-1]
    at = np.full(1, force_n)
    return float(rubber.volts(at, level)[0] - rubber.rest_volts(at)[0])


def sheared(speed_mm_s, recovers):
    """Figures 9 to 11: pressed by 1.7 N at 2 s, sheared by 0.3 mm from 4 s on, held: time, Vc, when held."""
    until = 4.0 + SHEARED_MM / speed_mm_s
    time_s = np.arange(round((until + 10.0) * 1000)) / 1000
    force_n = 1.7 * (0.5 - 0.5 * np.cos(np.pi * np.clip(time_s - 1.0, 0.0, 1.0)))
    speed = np.where((time_s >= 4.0) & (time_s < until), speed_mm_s, 0.0)
    return time_s, rubber.volts(force_n, rubber.shear_level(time_s, speed, recovers)), until
