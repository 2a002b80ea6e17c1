"""Fingertip Tactile Sensor for Detecting Rope Slip, compared with the matrix of 3×3 FSR400; no forest yet."""

from functools import cache
from itertools import pairwise

import numpy as np

from meissner import scenes
from meissner.interval import words
from meissner.scenes.drawing import BLUE, INK, RED
from meissner.scenes.fsr import run
from published import rows_of
from published._parts import figure, label, save

TITLE = "Fingertip Tactile Sensor for Detecting Rope Slip (3×3 FSR400, random forest)"
HEAD = """
This repository models the paper's sensor: nine FSR400, their network, the converter and the centre of
pressure, in `meissner run fsr_3x3`. It models no rope, stick-slip, rubber grips or random forest, so figures
2 to 5 and 7 to 12 and tables I and III have no counterpart. Of tables II and IV only the printed arithmetic
can be checked.
"""
STEPS = 150  # between the numbers of figure 6
NONE = "no counterpart yet"
# Printed in table IV: time steps and milliseconds between the first report and the slip.
TABLE_4 = (
    *((-7.0, -175.0), (-12.7, -317.5), (-0.67, -16.8), (-4.67, -116.8), (-0.33, -8.23), (-0.33, -8.23)),
    *((-0.67, -16.8), (0.0, 0.0), (-4.50, -112.0), (-1.83, -45.8), (-1.33, -33.3), (-0.33, -8.3)),
    *((-0.33, -8.3), (-1.00, -25.0)),
)
TABLE_2 = ((4716, 1773, 6489), (2241, 1773, 4014))


@cache
def measured():
    return run.run(scenes.load("fsr_3x3"), "fixed", 1)


def compute():
    scene = scenes.load("fsr_3x3")
    summary, arrays = measured().summary, measured().arrays
    period_ms = 1e3 / scene.rate_hz
    lsb_mv = 1e3 * scene.adc.lsb_v
    position, load = summary["position_error"], summary["load_error"]
    off_ms = max(abs(steps * period_ms - ms) for steps, ms in TABLE_4)
    mean_ms = np.mean([ms for _, ms in TABLE_4])
    turns = np.sign(np.diff(arrays["y"][arrays["valid"]]))
    ours = (
        "sums " + " and ".join(str(a + b) for a, b, _ in TABLE_2) + "; " + NONE + " of the labels themselves"
    )
    return rows_of(f"""
        1 | sensor | 3×3 FSR400 on a sheet of 45 × 53 mm
        | {scene.rows}×{scene.columns} FSR400 as one network; positions −1 to 1, no millimetres | none

        II-A | converter | 0 to 4095, 0 to 3.3 V, 0.8 mV a bit
        | 0 to {scene.adc.max_code}, 0 to {scene.adc.high_v:g} V, {lsb_mv:.4f} mV a bit; noise of
        {1e3 * scene.adc.noise_v:g} mV | {lsb_mv - 0.8:.4f} mV, rounding of the text

        II-A | rate | 40 Hz, 0.025 s | {scene.rate_hz} Hz, {period_ms / 1e3:g} s | none

        II-A | readout of the matrix | not printed
        | {scene.readout.circuit}, unselected rows {scene.readout.unselected}, {scene.readout.load_ohm:g} Ω
        behind each column; ghost {100 * summary["conditions"][0]["ghost"]:.2g} % | –

        6 | path of the centre of gravity, numbered every 150 steps | two paths of a rope; no numbers but
        the axes'
        | path of a contact of {scene.world["patches"][0]["force_n"]:g} N from top to bottom,
        {len(arrays["x"])} steps: position error {100 * position["mean"]:.2g} % of the range on average,
        {100 * position["maximum"]:.2g} % at most; load error {100 * load["mean"]:.2g} %; y reverses in
        {int((turns > 0).sum())} steps of {len(turns)} | another movement: no rope

        6 | working cells reported as dead | not printed | {words(summary["dead_falsely"], "cells")} | –

        table II | labels of the patterns | {", ".join((f"{a} + {b} = {c}" for a, b, c in TABLE_2))}
        | {ours} | {max(abs(a + b - c) for a, b, c in TABLE_2)}

        table IV | time steps between report and slip, in milliseconds | −{-TABLE_4[1][0]:g} steps are
        −{-TABLE_4[1][1]:g} ms
        | our frame of {period_ms:g} ms gives every row within {off_ms:.2g} ms; mean of its rows
        −{-mean_ms:.1f} ms (printed of all trials: −65.1); {NONE} of the detector | {off_ms:.2g} ms,
        rounding
    """)


def draw(folder):
    arrays = measured().arrays
    drawn, axis = figure(1, 1, 8, 6.4)
    valid, steps = arrays["valid"], np.arange(len(arrays["x"]))
    x, y = arrays["x"][valid], arrays["y"][valid]
    pressed = arrays["true_load_n"] > 0
    axis.plot(arrays["true_x"][pressed], arrays["true_y"][pressed], color=INK, lw=1, label="truth")
    axis.plot(x, y, ".-", color=BLUE, ms=4, lw=0.8, label="reported")
    marks = [k for k in range(0, len(steps) + 1, STEPS) if k < len(steps)]
    nearest = [int(np.abs(steps[valid] - k).argmin()) for k in marks]
    for first, second in pairwise([*nearest, len(x) - 1]):
        arrow = {"arrowstyle": "->", "color": RED, "lw": 2, "shrinkA": 0, "shrinkB": 0}
        axis.annotate("", (x[second], y[second]), (x[first], y[first]), arrowprops=arrow)
    for mark, k in zip(marks, nearest):
        axis.annotate(str(mark), (x[k], y[k]), (10, 4), textcoords="offset points", color=RED, fontsize=15)
    axis.set(xlim=(-1, 1), ylim=(-1, 1))
    label(axis, "centre of gravity, x", "centre of gravity, y")
    name = save(drawn, folder, "rope_slip_path.png")
    return [
        (
            name,
            "Figure 6 with our scene: the reported centre, numbered every 150 steps, of a contact instead of "
            "a rope. At both ends only one row responds, since an FSR400 needs 0.2 N.",
        )
    ]
