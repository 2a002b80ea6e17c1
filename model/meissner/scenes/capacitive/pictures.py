"""Pictures of the capacitive pad: crosstalk, one cell, a stepped probe, images."""

import numpy as np
from matplotlib import colormaps

from meissner.physics import footprints
from meissner.physics.capacitive import PITCH_MM
from meissner.scenes.capacitive.scene import SIDE
from meissner.scenes.drawing import BLUE, INK, LINES, MAP, ORANGE, RED, lighten, new_figure, save

MUTED = {"color": "#999999", "lw": 0.8}


def draw_crosstalk(
    scene, path, gain, unselected_pf, measured_v, eq18_v, hertz, leaking_v, ideal_v, leak_mohm, chosen
):
    """The published figure 2 with the demodulated output; the carrier's frequency as a compromise."""
    figure = new_figure(13, 5, f"{scene.name}: {scene.title}")
    left, right = figure.subplots(1, 2)
    for k, pf in enumerate(unselected_pf):
        colour = LINES[k % len(LINES)]
        left.plot(gain, eq18_v[:, k], color=colour, lw=1.6, label=f"{pf:g} pF")
        left.plot(gain, measured_v[:, k], "o", color=colour, ms=3.5)
    left.axhline(ideal_v, **MUTED, ls="--")
    left.axvline(chosen, color=INK, lw=1, ls=":")
    left.annotate(
        f"G = {chosen:g}", (chosen, 0.04 * ideal_v), xytext=(4, 0), textcoords="offset points", fontsize=9
    )
    left.set(xlabel="gain G of the amplifier", ylabel="|Vout| (V)", ylim=(0, 1.05 * ideal_v))
    left.set_title("lines: eq. 18; dots: demodulated carrier", fontsize=11)
    for mohm, volts, colour in zip(leak_mohm, leaking_v, LINES):
        right.semilogx(hertz / 1e3, 100 * (volts / ideal_v - 1), color=colour, lw=1.6, label=f"{mohm:g} MΩ")
    right.axvline(200, color=INK, lw=1, ls=":")
    right.axhline(0, **MUTED, ls="--")
    product_mhz = scene.world["gain_bandwidth_hz"] / 1e6
    right.set(xlabel="carrier (kHz)", ylabel="error of the output (%)", ylim=(-60, 60))
    right.set_title(
        f"leakage of the cell, {max(unselected_pf):g} pF unselected, gain-bandwidth {product_mhz:g} MHz",
        fontsize=11,
    )
    save(figure, path, (left, right))


def draw_cell(scene, path, rise, cycles, noise_g, hold_s, hold, hold_g, held_s, steps, presses):
    """The published figures 5, 6 and 7."""
    figure = new_figure(14, 5, f"{scene.name}: {scene.title}")
    loop, sag, repeat = figure.subplots(1, 3)
    half = len(rise) // 2
    for k, one in enumerate(cycles):
        label = k == 0
        loop.plot(rise[: half + 1], one[: half + 1], color=BLUE, lw=0.9, label="loading" if label else None)
        loop.plot(rise[half:], one[half:], color=ORANGE, lw=0.9, label="unloading" if label else None)
    loop.plot([0, rise.max()], [0, rise.max()], **MUTED)
    loop.fill_between(
        [0, rise.max()],
        [-2 * noise_g, rise.max() - 2 * noise_g],
        [2 * noise_g, rise.max() + 2 * noise_g],
        color="#000000",
        alpha=0.07,
        lw=0,
        label="± 2 noise",
    )
    loop.set(xlabel="force of the probe (g)", ylabel="calibrated cell (g)", title="0 to 150 g and back")
    sag.plot(hold_s, hold, color=BLUE, lw=0.8)
    sag.axhline(hold_g, **MUTED)
    sag.set(xlabel="time (s)", ylabel="calibrated cell (g)", title=f"{hold_g:g} g held, released")
    sag.set_ylim(-0.05 * hold_g, 1.25 * hold_g)
    close = sag.inset_axes([0.2, 0.2, 0.5, 0.45])
    close.plot(hold_s, hold, color=BLUE, lw=0.6)
    close.set(xlim=(0, held_s), ylim=(0.94 * hold_g, 1.06 * hold_g))
    close.axhline(hold_g, **MUTED)
    close.tick_params(labelsize=8)
    lighten(close)
    for step, values, colour in zip(steps, presses.T, LINES):
        repeat.plot(
            np.arange(1, len(values) + 1), values, "o-", color=colour, ms=3.5, lw=0.8, label=f"{step:g} g"
        )
        repeat.axhline(step, **MUTED)
    repeat.set(
        xlabel="press", ylabel="calibrated cell (g)", title="the same forces again, probe placed again"
    )
    repeat.set_ylim(0, 1.35 * max(steps))
    for axis in (loop, sag, repeat):
        lighten(axis)
    loop.legend(frameon=False, fontsize=9)
    repeat.legend(frameon=False, fontsize=9, ncols=3, loc="upper center")
    save(figure, path)


def draw_select(scene, path, x_mm, grams, codes, peaks, centres):
    """The published figure 8: a curve per cell, raw and calibrated."""
    figure = new_figure(13, 5, f"{scene.name}: {scene.title}")
    raw, axis = figure.subplots(1, 2)
    for k, (values, (place, height), centre) in enumerate(zip(grams.T, peaks, centres)):
        colour = LINES[k % len(LINES)]
        raw.plot(x_mm, codes[:, k], color=colour, lw=1.4, label=f"cell {k + 1}")
        axis.plot(x_mm, values, color=colour, lw=1.4, label=f"cell {k + 1}, peak at {place:.2f} mm")
        axis.plot(place, height, "o", mfc="white", mec=colour, ms=7)
        for one in (raw, axis):
            one.axvline(centre, **MUTED, ls=":")
    raw.set(xlabel="place of the probe (mm)", ylabel="demodulated code", title="before calibration")
    axis.set(xlabel="place of the probe (mm)", ylabel="calibrated cell (g)", title="after")
    axis.set_ylim(0, 1.25 * grams.max())
    save(figure, path, (raw, axis))


def _bars(axis, image, top):
    """A three-dimensional bar per cell, as published: row 0 at the back, columns from left to right."""
    rows, columns = image.shape
    column, row = np.meshgrid(np.arange(columns), np.arange(rows))
    height = np.maximum(image, 0.0).ravel()
    shade = colormaps[MAP](0.15 + 0.85 * height / top)
    axis.bar3d(
        column.ravel(), (rows - 1 - row).ravel(), 0, 0.85, 0.85, np.maximum(height, 0.004 * top), color=shade
    )
    axis.set_zlim(0, top)
    axis.set(xticks=[], yticks=[])
    axis.tick_params(labelsize=7, pad=0)
    axis.view_init(elev=42, azim=-68)
    axis.set_box_aspect((1, 1, 0.45), zoom=1.1)


def draw_shapes(scene, path, images):
    """Each object's outline over the image it makes, and the image as bars."""
    count = len(images)
    figure = new_figure(2.5 * count, 5.6, f"{scene.name}: {scene.title}")
    top = max(image.max() for image in images.values())
    half_mm = SIDE / 2 * PITCH_MM
    for k, (name, image) in enumerate(images.items()):
        axis = figure.add_subplot(2, count, k + 1)
        shown = axis.imshow(image, cmap=MAP, vmin=0, vmax=top, extent=(-half_mm, half_mm, -half_mm, half_mm))
        for line in footprints.outlines(name):
            axis.plot(*line.T, color=RED, lw=1.1)
        axis.set(xlim=(-half_mm, half_mm), ylim=(-half_mm, half_mm), xticks=[], yticks=[], title=name)
        _bars(figure.add_subplot(2, count, count + k + 1, projection="3d"), image, top)
    figure.colorbar(shown, ax=figure.axes, label="calibrated cell (g)", shrink=0.5, pad=0.02)
    save(figure, path)
