"""The figures of the capacitive array, in the layout of the paper."""

from functools import partial

import numpy as np

from meissner.physics import dielectric
from meissner.scenes.capacitive.pictures import _bars
from meissner.scenes.drawing import BLUE, GREEN, INK, ORANGE, RED, new_figure
from published._parts import figure, label, save

plain = partial(label, legend=False)


def gain(folder, measured):
    arrays = measured("crosstalk").arrays
    drawn, axis = figure(1, 1, 8, 5.0)
    for k, pf in enumerate(arrays["unselected_pf"]):
        shade = (0.0, 0.35 + 0.1 * (5 - k), 0.75 - 0.08 * k)
        axis.plot(arrays["gain"], arrays["eq18_v"][:, k], color=shade, lw=2, label=f"{pf:g} pF")
        axis.plot(arrays["gain"], arrays["measured_v"][:, k], "o", color=shade, ms=5)
    axis.axhline(10, color="#999999", ls="--")
    axis.axvline(200, color=INK, ls=":")
    axis.set(xlim=(0, 520), ylim=(0, 10.6))
    axis.legend(frameon=False, fontsize=14, loc="lower right")
    plain(axis, "amplifier gain", "sensor output (V)", "2: lines eq. 18, dots the demodulated carrier")
    return save(
        drawn, folder, "capacitive_array_gain.png"
    ), "Figure 2: output with unselected cells, over the gain."


def one_cell(folder, measured):
    arrays = measured("cell").arrays
    given = measured("cell").pictures[0].draw.keywords
    drawn, axes = figure(2, 3, 8, 11.5)
    (over, slow), (few, many), (sag, repeat) = axes
    period = len(given["rise"])
    seconds = np.arange(4 * period) / period
    applied, read = arrays["cycles_applied_g"], arrays["cycles_g"]
    kernel = np.hanning(7) / np.hanning(7).sum()
    smooth = np.convolve(np.pad(read, 3, mode="edge"), kernel, "valid")
    for axis, values, title in (
        (over, read, "4 left: as it is"),
        (slow, smooth, "4 right: low-pass filtered"),
    ):
        axis.plot(seconds, applied, color="#999999", lw=2, label="probe")
        axis.plot(seconds, values, color=BLUE, lw=1.5, label="cell")
        plain(axis, "time (s)", "force (g)", title)
    over.legend(frameon=False, fontsize=12, loc="upper right", ncols=2)
    over.set_ylim(-5, 185)
    slow.set_ylim(-5, 185)
    half = period // 2
    cycles = given["cycles"]
    for one in cycles:
        few.plot(given["rise"][: half + 1], one[: half + 1], color=BLUE, lw=1.3)
        few.plot(given["rise"][half:], one[half:], color=ORANGE, lw=1.3)
    few.plot([0, 150], [0, 150], color="#999999", lw=1)
    few.text(5, 140, "loading", color=BLUE, fontsize=12)
    few.text(5, 124, "unloading", color=ORANGE, fontsize=12)
    plain(few, "force of the probe (g)", "cell (g)", "5 left: four trials")
    force, apart = given["rise"][1:half], cycles[:, :half:-1] - cycles[:, 1:half]
    many.axhspan(*(sign * 2**1.5 * given["noise_g"] for sign in (-1, 1)), color="#000000", alpha=0.08, lw=0)
    for one in apart:
        many.plot(force, one, ".", color=BLUE, ms=5)
    many.plot(force, apart.mean(axis=0), color=ORANGE, lw=2)
    plain(many, "force of the probe (g)", "unloading − loading (g)", "5 right: ± 2 of the noise")
    held = (given["hold_s"] > 0) & (given["hold_s"] <= given["held_s"])
    sag.plot(given["hold_s"][held], given["hold"][held], color=BLUE, lw=0.9)
    sag.axhline(given["hold_g"], color="#999999", lw=1)
    sag.set(xlim=(0, 240), ylim=(90, 110))
    plain(sag, "time (s)", "cell (g)", f"6: {given['hold_g']:g} g held")
    for force, values in zip(given["steps"], given["presses"].T):
        repeat.plot(np.full(len(values), force), values, "_", color=BLUE, ms=14, mew=1.2)
    repeat.plot([0, 160], [0, 160], color="#999999", lw=1)
    plain(repeat, "force of the probe (g)", "cell (g)", "7: twelve presses")
    return save(drawn, folder, "capacitive_array_cell.png"), (
        "Figures 4 to 7, one calibrated cell. Grey: the applied force. The curve deviates from it at both "
        "ends; in a cycle of one second the cell lags behind."
    )


def probe(folder, measured):
    given = measured("select").pictures[0].draw.keywords
    drawn, axes = figure(1, 3, 8, 7.5)
    for k, axis in enumerate(axes):
        axis.plot(given["x_mm"], given["codes"][:, k], color=BLUE, lw=2)
        axis.axvline(given["peaks"][k][0], color=RED, ls=":", lw=1.5)
        plain(axis, "", "code", f"8: cell {k + 1}, peak at {given['peaks'][k][0]:.2f} mm")
    axes[-1].set_xlabel("place of the probe (mm)", fontsize=13)
    return save(drawn, folder, "capacitive_array_probe.png"), (
        "Figure 8: three neighbouring cells while a probe of 100 g passes; codes of our demodulator."
    )


def bars(folder, measured):
    given = measured("shapes").pictures[0].draw.keywords["images"]
    drawn = new_figure(8, 12)
    drawn.set_layout_engine("none")
    figures = {
        "edge": "9: edge",
        "upright edge": "9: upright edge",
        "IC socket": "10: socket",
        "opposite socket": "10: opposite diagonal",
        "two edges": "11: two edges",
        "bolt": "12: bolt",
        "washer": "12: washer",
        "connector": "13: connector",
    }
    top = max(image.max() for image in given.values())
    for k, (name, title) in enumerate(figures.items()):
        place = (0.5 * (k % 2), 0.745 - 0.248 * (k // 2), 0.46, 0.225)
        axis = drawn.add_axes(place, projection="3d")
        _bars(axis, given[name], top)
        axis.set_title(title, fontsize=16, y=1.01)
        axis.tick_params(labelsize=12)
    return save(drawn, folder, "capacitive_array_objects.png"), (
        "Figures 9 to 13: 8×8 bars in grams, as published; row 0 at the back."
    )


def tabs(folder, _):
    drawn, (left, right) = figure(2, 1, 8, 4.6)
    height = np.linspace(0.25, 0.75, 101)
    share = float(dielectric.rise(100.0))
    for grams, colour in ((50, GREEN), (100, BLUE), (150, ORANGE)):
        rise = [100 * float(dielectric.rise(grams, one)) for one in height]
        left.plot(height, rise, color=colour, lw=2.2)
        left.annotate(f"{grams} g", (height[-1], rise[-1]), (-32, 6), textcoords="offset points", fontsize=12)
    flat = [100 * float(dielectric.rise_without_tabs(150.0, 0.499, 0.25 + one)) for one in height]
    left.plot(height, flat, color=INK, lw=1.5, ls="--")
    left.text(0.26, flat[0] + 1.2, "150 g, no tabs, ν = 0.499", fontsize=11)
    left.set_ylim(-1, 47)
    plain(left, "tab, or as much sheet (mm)", "capacitance rises by (%)", "what a press does")
    for one, colour in ((share / 2, GREEN), (share, BLUE)):
        right.semilogy(height, dielectric.force_for(one, height), color=colour, lw=2.2)
        right.text(0.5, 1.12 * float(dielectric.force_for(one, 0.5)), f"{100 * one:.0f} %", fontsize=13)
    right.set_yticks([50, 100, 200, 500], ["50", "100", "200", "500"])
    right.minorticks_off()
    plain(right, "tab (mm)", "force for a rise (g)", "range of forces")
    return save(drawn, folder, "capacitive_array_tabs.png"), (
        "Equations 2 to 7 as figures: with tabs the rise of capacitance and the range of forces depend on "
        "the tab's height; a flat sheet of nearly incompressible rubber shows almost no change."
    )


def draw(folder, measured):
    return [part(folder, measured) for part in (tabs, gain, one_cell, probe, bars)]
