"""Pictures of a matrix of force-sensing resistors: a frame with its faults, and the ways to read it."""

import numpy as np
from matplotlib.patches import Rectangle

from meissner.scenes.drawing import BLUE, GREEN, INK, MAP, ORANGE, RED, new_figure, save


def _image(axis, values, top, title):
    shown = axis.imshow(values, cmap=MAP, vmin=0, vmax=top, interpolation="nearest")
    axis.set_facecolor("#BBBBBB")
    axis.set_title(title, fontsize=10)
    axis.set(xticks=[], yticks=[])
    return shown


def draw_matrix(scene, path, recording, force_n, result, truth):
    """The frame with the largest load as applied, converted and calibrated; x, y and load over time."""
    x, y, load_n, valid = result
    figure = new_figure(13, 7.6, f"{scene.name}: {scene.title}")
    upper, lower = figure.subfigures(2, 1, height_ratios=[1.25, 1])
    pressed, raw, calibrated = upper.subplots(1, 3)
    k = recording.shown
    top = recording.force_n[k].max()
    shown = _image(pressed, recording.force_n[k], top, "what presses")
    upper.colorbar(shown, ax=(pressed, calibrated), label="N", shrink=0.8, location="right")
    _image(raw, recording.codes[k], recording.codes[k].max(), "codes")
    _image(calibrated, force_n[k], top, "calibrated, dead cells 0")
    for fault in scene.faults:
        place = (-0.5, fault.row - 0.5, scene.columns, 1)
        if fault.kind == "open column":
            place = (fault.column - 0.5, -0.5, 1, scene.rows)
        elif fault.kind != "dead row":
            place = (fault.column - 1.5, fault.row - 1.5, 3, 3)
        for axis in (raw, calibrated):
            axis.add_patch(Rectangle(place[:2], *place[2:], fill=False, ec=RED, lw=1.2))
    where, load = lower.subplots(1, 2)
    total, true_x, true_y = truth
    for name, got, true, colour in (("x", x, true_x, BLUE), ("y", y, true_y, ORANGE)):
        where.plot(recording.time_s, np.where(valid, got, np.nan), color=colour, lw=1.8, label=name)
        where.plot(recording.time_s, np.where(total > 0, true, np.nan), color=INK, lw=0.8)
    where.set(xlabel="time (s)", ylabel="centre of pressure", ylim=(-1.05, 1.05), title="thin: truth")
    load.plot(recording.time_s, load_n, color=GREEN, lw=1.8, label="reported")
    load.plot(recording.time_s, total, color=INK, lw=0.8, label="truth")
    load.set(xlabel="time (s)", ylabel="load (N)", title="load")
    load.set_ylim(0, 1.1 * max(load_n.max(), total.max()))
    save(figure, path, (where, load))


def draw_ghosts(scene, path, recording):
    """The same frame read in four ways, without faults; each as a share of its largest reading."""
    figure = new_figure(15, 4.2, f"{scene.name}: the same press, read in four ways")
    axes = figure.subplots(1, 1 + len(recording.readings))
    force_n = recording.force_n[recording.shown]
    _image(axes[0], 100 * force_n / force_n.max(), 100, "what presses")
    for axis, (way, volts) in zip(axes[1:], recording.readings.items()):
        shown = _image(axis, 100 * volts / volts.max(), 100, f"{way[0]},\nunselected rows {way[1]}")
    figure.colorbar(shown, ax=axes, label="of the largest (%)", shrink=0.8)
    save(figure, path)
