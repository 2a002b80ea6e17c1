"""The picture of an array of forces: the line of the centre of pressure over the image, and its errors."""

import numpy as np
from matplotlib.collections import LineCollection

from meissner.scenes.drawing import BLUE, GREEN, INK, ORANGE, PURPLE, RED, breaks, lighten, new_figure, save

SNAPSHOTS = 6
FAINT = 0.01  # share of the largest force: less is left blank, or noise would fill the picture
PIXELS = 256  # larger sides are shown as maxima of blocks of taxels


def _blocks(image):
    step = -(-max(image.shape) // PIXELS)
    if step == 1:
        return image
    rows, columns = (-(-n // step) * step for n in image.shape)
    padded = np.zeros((rows, columns), image.dtype)
    padded[: image.shape[0], : image.shape[1]] = image
    return padded.reshape(rows // step, step, columns // step, step).max(axis=(1, 3))


def _show(axis, image, top):
    """Taxels as squares, row 0 on top, in the core's coordinates; grey where almost nothing presses."""
    rows, columns = image.shape
    half = [1 / max(n - 1, 1) for n in (columns, rows)]
    shown = axis.imshow(
        np.ma.masked_less(_blocks(image), FAINT * top),
        extent=(-1 - half[0], 1 + half[0], -1 - half[1], 1 + half[1]),
        aspect=max(rows - 1, 1) / max(columns - 1, 1),
        cmap="YlGnBu",
        vmin=0,
        vmax=top,
        interpolation="nearest",
    )
    axis.set_facecolor("#F7F7F7")
    return shown


def draw_array(path, recording, valid, x, y, load, position, of_load):
    """The path of the centre of pressure over the largest force on each taxel; x, y, load; errors."""
    scene, time_s = recording.scene, recording.time_s
    codes = recording.codes
    scale = scene.load_lsb
    peak = codes.max(axis=0) * scale
    figure = new_figure(13, 8, f"{scene.name}: {scene.title}")
    upper, lower = figure.subfigures(2, 1, height_ratios=[3, 1])
    # The image has the shape of the array, limited between a tall strip and a square.
    wide = np.clip(scene.columns / scene.rows, 0.35, 1.0)
    grid = upper.add_gridspec(3, 2, width_ratios=[1.15 * wide, 2.3 - 1.15 * wide])
    image = upper.add_subplot(grid[:, 0])
    shown = _show(image, peak, peak.max())
    upper.colorbar(shown, ax=image, label=f"largest force on a taxel ({scene.unit})", shrink=0.85)
    image.plot(
        *(breaks(v, recording.load > 0) for v in (recording.x, recording.y)),
        color="white",
        lw=4.5,
        solid_capstyle="round",
    )
    image.plot(*(breaks(v, recording.load > 0) for v in (recording.x, recording.y)), color=INK, lw=0.8)
    points = np.stack([x, y], axis=1)
    segments = np.stack([points[:-1], points[1:]], axis=1)[valid[:-1] & valid[1:]]
    line = LineCollection(segments, cmap="autumn", linewidths=2.2)
    line.set_array(time_s[:-1][valid[:-1] & valid[1:]])
    image.add_collection(line)
    seen = np.flatnonzero(valid)
    if len(seen):
        image.plot(x[seen[0]], y[seen[0]], "o", mfc="white", mec=RED, ms=8, label="start")
        image.plot(x[seen[-1]], y[seen[-1]], "s", mfc="white", mec=ORANGE, ms=8, label="end")
    image.plot([], [], color=RED, lw=2.2, label="centre of pressure, red to yellow")
    image.plot([], [], color=INK, lw=0.8, label="truth")
    image.legend(loc="upper center", bbox_to_anchor=(0.5, -0.09), ncols=2, frameon=False, fontsize=9)
    image.set(xlabel="x", ylabel="y")

    axes = [upper.add_subplot(grid[k, 1]) for k in range(3)]
    look = {"marker": "o", "ms": 4} if len(time_s) < 20 else {}
    for name, got, true, colour in (("x", x, recording.x, BLUE), ("y", y, recording.y, ORANGE)):
        axes[0].plot(time_s, breaks(true, recording.load > 0), color=INK, lw=0.8)
        axes[0].plot(time_s, breaks(got, valid), color=colour, lw=1.8, label=name, **look)
    axes[0].set(ylabel="centre of pressure", ylim=(-1.05, 1.05))
    axes[0].legend(frameon=False, ncols=2, fontsize=9)
    axes[1].plot(time_s, load, color=GREEN, lw=1.8, label="reported", **look)
    axes[1].plot(time_s, recording.load, color=INK, lw=0.8, label="truth")
    axes[1].set(ylabel=f"load ({scene.unit})")
    axes[1].set_ylim(0, 1.1 * recording.load.max())
    axes[1].legend(frameon=False, fontsize=9)
    shown = np.where(valid, of_load, np.nan)
    for values, colour, name in ((position, BLUE, "position, of the range"), (shown, GREEN, "load")):
        positive = np.where(values > 0, values, np.nan)
        if np.isfinite(positive).any():
            axes[2].semilogy(time_s, positive * 100, color=colour, lw=1.1, label=name, **look)
    half_bit = 100 * 2.0**-16  # half a step of Q2.14, of the range of 2
    axes[2].axhline(half_bit, color=PURPLE, lw=1, ls="--", label="half a step of Q2.14")
    axes[2].set(ylabel="error (%)", xlabel="time (s)")
    axes[2].legend(frameon=False, fontsize=9, ncols=3)
    for axis in axes:
        lighten(axis)
        axis.margins(x=0.01)
    for axis in axes[:2]:
        axis.tick_params(labelbottom=False)

    if len(seen):
        inside = np.linspace(0, len(seen) - 1, SNAPSHOTS + 2)[1:-1] if len(seen) > 2 * SNAPSHOTS else None
        frames = seen[:SNAPSHOTS] if inside is None else seen[np.rint(inside).astype(int)]
        for axis, k in zip(lower.subplots(1, len(frames), squeeze=False)[0], frames):
            axis.set(xticks=[], yticks=[])
            _show(axis, codes[k] * scale, peak.max())
            axis.plot(x[k], y[k], "o", mfc=RED, mec="white", ms=7)
            axis.set_title(f"{time_s[k] * 1e3:.0f} ms", fontsize=10)
    save(figure, path)
