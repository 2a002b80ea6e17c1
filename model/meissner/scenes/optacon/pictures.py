"""Pictures of pins under a finger, in the published layout: figures 1, 6, 8 to 11, 13 and 14, and the
letter."""

import numpy as np
from matplotlib.patches import Circle, Rectangle

from meissner.physics import receptors
from meissner.physics.receptors import CHANNELS, PLOTTED_CM2, SMALLEST_CM2
from meissner.scenes.drawing import BLUE, GREEN, INK, ORANGE, PURPLE, RED, lighten, new_figure, save

COLOURS = dict(zip(CHANNELS, (BLUE, PURPLE, ORANGE, RED)))
MARKS = ("^", "x", "+", "o", "s")
FIGURES = {"SA-I": 8, "SA-II": 9, "FA-I": 10, "FA-II": 11}
HZ = np.geomspace(0.4, 500, 200)
FRAME_MS = 400  # of the animation; slower than the letter, so that it can be followed


def _axes(axis, title, low=-30, high=50):
    axis.set(xscale="log", xlim=(0.4, 500), ylim=(low, high), title=title)
    axis.set(xlabel="frequency (Hz)", ylabel="peak (dB re 1 µm)")
    axis.set_xticks([0.4, 1, 10, 100, 500], ["0.4", "1", "10", "100", "500"])


def _curve(axis, name, cm2, style="-", label=None):
    axis.plot(HZ, receptors.threshold_db(name, HZ, cm2), style, color=COLOURS[name], lw=1.4, label=label)


def thresholds(axis):
    """Figure 1."""
    for name, channel in CHANNELS.items():
        _curve(axis, name, PLOTTED_CM2, label=f"{name} ({channel.channel})")
    _curve(axis, "FA-II", SMALLEST_CM2, "--", f"FA-II, {SMALLEST_CM2} cm²")
    _axes(axis, "Thresholds of the four channels")
    axis.legend(frameon=False, fontsize=8, ncols=2)


def draw_thresholds(scene, path):
    figure = new_figure(7, 5, f"{scene.name}: figure 1")
    axis = figure.subplots()
    thresholds(axis)
    lighten(axis)
    save(figure, path)


def free(axes, hz, above_db, below_db):
    """Figure 6."""
    for axis, db, way in zip(axes, (above_db, below_db), ("above: the pin", "below: the bimorph")):
        axis.plot(hz, db, "x", color=BLUE, ms=6)
        axis.axvline(230, color=INK, lw=0.6, ls=":")
        _axes(axis, f"measured from {way}", -10, 50)


def draw_free(scene, path, hz, above_db, below_db):
    figure = new_figure(9, 7, f"{scene.name}: {scene.title}")
    axes = figure.subplots(2, 1, sharex=True)
    free(axes, hz, above_db, below_db)
    save(figure, path, axes)


def channels(axes, hz, volts, db, tip_cm2):
    """Figures 8 to 11."""
    for axis, name in zip(axes, CHANNELS):
        for v, one, mark in zip(volts, db, MARKS):
            axis.plot(hz, one, mark, color=INK, ms=5, mew=1, mfc="none", label=f"{v:g} V")
        if name == "FA-II":
            for cm2, style in ((PLOTTED_CM2, "-"), (SMALLEST_CM2, "--"), (tip_cm2, ":")):
                _curve(axis, name, cm2, style, f"{cm2:g} cm²")
        else:
            _curve(axis, name, PLOTTED_CM2)
        _axes(axis, f"Figure {FIGURES[name]}: {name}")


def draw_channels(scene, path, hz, volts, db, tip_cm2):
    figure = new_figure(12, 9, f"{scene.name}: {scene.title}")
    axes = [*figure.subplots(2, 2).flat]
    channels(axes, hz, volts, db, tip_cm2)
    save(figure, path, axes)


def burst(axes, time_s, um):
    """Figure 14, and the drive's ripple in 30 ms of it."""
    on = (time_s > 0.15) & (time_s < 0.18)
    axes[0].plot(time_s, um, color=BLUE, lw=0.7)
    axes[1].plot(time_s[on], um[on], ".-", color=BLUE, lw=0.8, ms=4)
    for axis in axes:
        axis.set(xlabel="time (s)", ylabel="displacement (µm)")


def draw_burst(scene, path, time_s, um):
    figure = new_figure(12, 4, f"{scene.name}: {scene.title}")
    axes = figure.subplots(1, 2, width_ratios=(2, 1))
    burst(axes, time_s, um)
    save(figure, path, axes)


def _pins(axis, image, colour, title=None, marked=None):
    rows, columns = image.shape
    for row in range(rows):
        for column in range(columns):
            on = image[row, column]
            axis.add_patch(
                Circle(
                    (column, row), 0.36, fc=colour if on else "white", ec=colour if on else "#BBBBBB", lw=0.7
                )
            )
    if marked:
        row, column = marked
        axis.add_patch(Rectangle((column - 1.5, row - 1.5), 1, 1, fc="none", ec=RED, lw=1.4))
    axis.set(xlim=(-0.6, columns - 0.4), ylim=(rows - 0.4, -0.6), xticks=[], yticks=[], aspect="equal")
    axis.spines[:].set_visible(False)
    if title:
        axis.set_title(title, fontsize=10)


def numbered_steps(axes, images, pin):
    """Figure 13."""
    for number, (axis, image) in enumerate(zip(axes, images), 1):
        _pins(axis, image, INK, f"({number})", pin)


def draw_steps(scene, path, steps, pin):
    figure = new_figure(
        1.3 * len(steps), 2.6, f"{scene.name}: figure 13, pin of row {pin[0]}, column {pin[1]}"
    )
    numbered_steps(figure.subplots(1, len(steps)), steps, pin)
    save(figure, path)


def _dots(page, left, image, colour, pitch=16):
    """Draw pins as dots on a page of PIL, from that left edge on; returns the right edge."""
    for row, cells in enumerate(image):
        for column, on in enumerate(cells):
            x, y = left + pitch * column, 44 + pitch * row
            page.ellipse(
                (x, y, x + 11, y + 11), fill=colour if on else "white", outline=colour if on else "#BBBBBB"
            )
    return left + pitch * len(image[0])


def animate(scene, path, seen, step_s):
    """Each step of the letter, slowed down: the pins driven on each display, and where each channel
    responds."""
    from PIL import Image, ImageDraw

    wide = 20 + sum((1 + len(CHANNELS)) * (16 * grid[1] + 26) + 30 for grid, *_ in seen)
    high = 64 + 16 * max(grid[0] for grid, *_ in seen)
    pages = []
    for step in range(max(len(images) for _, images, _ in seen)):
        page = Image.new("RGB", (wide, high), "white")
        pen, left = ImageDraw.Draw(page), 20
        pen.text((20, 6), f"step {step + 1}, {FRAME_MS / 1000 / step_s:.1f} times slower than read", fill=INK)
        for _, images, by in seen:
            for name, image in {
                "driven": images[step],
                **{name: by[name][step] for name in CHANNELS},
            }.items():
                colour = COLOURS.get(name, INK)
                pen.text((left, 26), name, fill=colour)
                left = _dots(pen, left, image, colour) + 26
            left += 30
        pages.append(page.quantize(64))
    pages[0].save(path, "GIF", save_all=True, append_images=pages[1:], duration=FRAME_MS, loop=0)


def draw_touch(scene, path, force_g, levels, felt, patterns, true_deg):
    figure = new_figure(13, 5.4, f"{scene.name}: {scene.title}")
    axes = figure.subplots(1, 7, width_ratios=(2.2, 1, 1, 1, 1, 1, 1))
    shown = axes[0].imshow(force_g, cmap="YlGnBu")
    axes[0].set(title="pad: load (g)", xticks=[], yticks=[])
    figure.colorbar(shown, ax=axes[0], shrink=0.5)
    _pins(axes[1], levels > 0, INK, "pins")
    _pins(axes[2], felt, COLOURS["SA-I"], "SA-I responds")
    changed = [0, *(np.flatnonzero((np.diff(patterns.astype(int), axis=0) != 0).any(axis=(1, 2))) + 1)]
    changed = changed if len(patterns) else []
    for axis, at in zip(axes[3:], changed):
        _pins(axis, patterns[at], GREEN, f"slip to {true_deg:g}°")
    for axis in axes[3 + len(changed) :]:
        axis.set_visible(False)
    save(figure, path)
