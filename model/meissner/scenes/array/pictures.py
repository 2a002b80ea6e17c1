"""Pictures of the centre of pressure: its line over the tactile image, its errors, the mesh's curves."""

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from meissner.scenes.rubber.pictures import BLUE, GREEN, INK, ORANGE, PURPLE, RED

LINES = (BLUE, ORANGE, GREEN, RED, PURPLE, INK)
SNAPSHOTS = 6
FAINT = 0.01  # share of the largest force: less is left blank, or noise would fill the picture
PIXELS = 256  # larger sides are shown as maxima of blocks of taxels


def _figure(width, height, title):
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(title, fontsize=13, x=0.01, ha="left", fontweight="bold")
    return figure


def _plain(axis):
    axis.spines[["top", "right"]].set_visible(False)
    axis.grid(color="#E6E6E6", lw=0.6)
    axis.set_axisbelow(True)


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


def _breaks(values, valid):
    """The values with NaN where they are not valid, so that a line breaks there."""
    return np.where(valid, values, np.nan)


def draw_array(path, recording, valid, x, y, load, position, of_load):
    """The path of the centre of pressure over the largest force on each taxel; x, y, load; errors."""
    scene, time_s = recording.scene, recording.time_s
    codes = recording.codes
    scale = scene.load_lsb
    peak = codes.max(axis=0) * scale
    figure = _figure(13, 8, f"{scene.name}: {scene.title}")
    upper, lower = figure.subfigures(2, 1, height_ratios=[3, 1])
    # The image has the shape of the array, limited between a tall strip and a square.
    wide = np.clip(scene.columns / scene.rows, 0.35, 1.0)
    grid = upper.add_gridspec(3, 2, width_ratios=[1.15 * wide, 2.3 - 1.15 * wide])
    image = upper.add_subplot(grid[:, 0])
    shown = _show(image, peak, peak.max())
    upper.colorbar(shown, ax=image, label=f"largest force on a taxel ({scene.unit})", shrink=0.85)
    image.plot(
        *(_breaks(v, recording.load > 0) for v in (recording.x, recording.y)),
        color="white",
        lw=4.5,
        solid_capstyle="round",
    )
    image.plot(*(_breaks(v, recording.load > 0) for v in (recording.x, recording.y)), color=INK, lw=0.8)
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
        axes[0].plot(time_s, _breaks(true, recording.load > 0), color=INK, lw=0.8)
        axes[0].plot(time_s, _breaks(got, valid), color=colour, lw=1.8, label=name, **look)
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
        _plain(axis)
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
    figure.savefig(path, dpi=110, facecolor="white")
    return path


def _draw_points(figure, recordings, runs):
    """Place, load and errors over a sweep."""
    place, load, error = figure.subplots(1, 3)
    first = recordings[0]
    pressed = first.load > 0
    place.plot(first.x[pressed], first.y[pressed], "o", mfc="none", mec=INK, ms=9, label="truth")
    load.plot(first.load, first.load, color=INK, lw=0.8, label="truth")
    for recording, one, colour in zip(recordings, runs, LINES):
        name, valid = f"r = {recording.r_ohm:g} Ω", one["valid"]
        place.plot(one["x"][valid], one["y"][valid], "o-", color=colour, ms=4, label=name)
        load.plot(first.load, one["load"], "o-", color=colour, ms=4, label=name)
        step = np.arange(len(first.load))
        error.plot(step, 100 * one["position"], "o-", color=colour, ms=4, label=f"position, {name}")
        error.plot(step, 100 * one["of_load"], "s--", color=colour, ms=4, label=f"load, {name}")
    place.set(xlabel="x", ylabel="y", xlim=(-1.1, 1.1), ylim=(-1.1, 1.1), aspect="equal", title="where")
    load.set(xlabel="true load (N)", ylabel="reported load (N)", title="how hard")
    if np.ptp(first.load) < 1e-9:  # a constant load: plot over the sweep instead
        load.clear()
        load.plot(first.load, color=INK, lw=0.8, label="truth")
        for recording, one, colour in zip(recordings, runs, LINES):
            load.plot(one["load"], "o-", color=colour, ms=4, label=f"r = {recording.r_ohm:g} Ω")
        load.set(xlabel="step", ylabel="load (N)", title="how hard")
        load.set_ylim(bottom=0)
    error.set(xlabel="step", ylabel="error (%)", title="errors")
    return place, load, error


def _draw_surface(figure, recordings, _):
    """The voltage of layer A: the whole layer for the first r, and the loaded row for each."""
    image, row = figure.subplots(1, 2)
    first = recordings[0]
    millivolts = 1e3 * (first.solution.Va[0] - first.solution.E1[0])
    i = np.unravel_index(np.argmin(millivolts), millivolts.shape)[0]
    shown = image.imshow(millivolts, cmap="YlGnBu_r", extent=(-1, 1, -1, 1))
    lines = {"levels": 8, "colors": "white", "linewidths": 0.6, "linestyles": "solid"}
    image.contour(millivolts, **lines, origin="upper", extent=(-1, 1, -1, 1))
    figure.colorbar(shown, ax=image, label="voltage from the electrodes E1, E3 (mV)")
    image.set(xlabel="x", ylabel="y", title=f"layer A, r = {first.r_ohm:g} Ω")
    for recording, colour in zip(recordings, LINES):
        across = np.linspace(-1, 1, recording.scene.columns)
        volts = recording.solution.Va[0][i]
        row.plot(across, volts, color=colour, lw=1.8, label=f"r = {recording.r_ohm:g} Ω")
    row.set(xlabel="x", ylabel="voltage of layer A (V)", title="along the loaded row")
    return (row,)


def _draw_random(figure, recordings, runs):
    """Mean and spread of the errors over the total load."""
    axes = figure.subplots(1, 2)
    totals = recordings[0].scene.world["totals_n"]
    for axis, name, label in zip(axes, ("position", "of_load"), ("position, of the range", "load")):
        for k, (recording, one, colour) in enumerate(zip(recordings, runs, LINES)):
            parts = [100 * one[name][recording.load.round(6) == total] for total in totals]
            at = np.array(totals) + 0.15 * (k - (len(runs) - 1) / 2)
            axis.errorbar(
                *(at, [p.mean() for p in parts], [p.std() for p in parts]),
                fmt="o-",
                color=colour,
                ms=5,
                capsize=3,
                label=f"r = {recording.r_ohm:g} Ω",
            )
        axis.set(xlabel="total load (N)", ylabel="error (%)", title=f"{label}: mean and deviation")
        axis.set_ylim(bottom=0)
    return axes


def _draw_pulse(figure, recordings, runs):
    """Applied load, load felt by the taxels and reported load over time, and the errors."""
    load, place = figure.subplots(1, 2)
    first = recordings[0]
    milliseconds = first.time_s * 1e3
    load.step(milliseconds, first.load, where="post", color=INK, lw=1, label="what presses")
    load.plot(milliseconds, first.felt_n, color=ORANGE, lw=1.8, label="what the taxels feel")
    for recording, one, colour in zip(recordings, runs, LINES):
        load.plot(
            milliseconds, one["load"], color=colour, lw=1.8, label=f"reported, r = {recording.r_ohm:g} Ω"
        )
        for name, dashes in (("x", "-"), ("y", "--")):
            shown = _breaks(one[name], one["valid"])
            place.plot(milliseconds, shown, dashes, color=colour, lw=1.8, label=name)
    start, response = (first.scene.world[key] * 1e3 for key in ("start_s", "response_s"))
    load.axvspan(
        start, start + response, color=PURPLE, alpha=0.15, lw=0, label=f"{response:g} ms: the rubber"
    )
    load.set(xlabel="time (ms)", ylabel="load (N)", title="load")
    place.set(xlabel="time (ms)", ylabel="x, y", title="position", ylim=(-1.05, 1.05))
    return load, place


def _draw_stroke(figure, recordings, runs):
    """The locus over the taxels, and its radius around the circle."""
    place, radius = figure.subplots(1, 2, gridspec_kw={"width_ratios": [1, 1.4]})
    first = recordings[0]
    scene = first.scene
    columns, rows = np.meshgrid(np.linspace(-1, 1, scene.columns), np.linspace(1, -1, scene.rows))
    place.plot(columns.ravel(), rows.ravel(), "s", color="#CCCCCC", ms=9, label="taxels")
    closed = np.append(np.arange(len(first.x)), 0)
    angle = np.linspace(0, 360, len(first.x), endpoint=False)
    turn = np.linspace(0, 2 * np.pi, 361)
    path = scene.world["radius"]
    place.plot(path * np.cos(turn), path * np.sin(turn), ":", color=PURPLE, lw=1.4, label="the finger")
    place.plot(first.x[closed], first.y[closed], color=INK, lw=0.8, label="centre of the load")
    radius.plot(angle, np.hypot(first.x, first.y), color=INK, lw=0.8, label="centre of the load")
    for recording, one, colour in zip(recordings, runs, LINES):
        name = f"reported, r = {recording.r_ohm:g} Ω"
        place.plot(one["x"][closed], one["y"][closed], color=colour, lw=1.8, label=name)
        radius.plot(angle, np.hypot(one["x"], one["y"]), color=colour, lw=1.2, label=name)
    place.set(xlabel="x", ylabel="y", xlim=(-1.2, 1.2), ylim=(-1.2, 1.9), aspect="equal", title="locus")
    radius.axhline(path, color=PURPLE, ls=":", lw=1.4)
    radius.set(xlabel="place on the circle (degrees)", ylabel="distance from the middle", title="radius")
    radius.set_ylim(0, 1.15 * path)
    return place, radius


def draw_mesh(path, recordings, runs):
    """The published figure for the scene's kind; ``runs``: one dict per recording."""
    scene = recordings[0].scene
    figure = _figure(13, 4.8, f"{scene.name}: {scene.title}")
    draw = {"points": _draw_points, "random": _draw_random, "pulse": _draw_pulse, "stroke": _draw_stroke}[
        scene.kind
    ]
    if scene.kind == "points" and len(recordings[0].load) == 1:
        draw = _draw_surface
    for axis in draw(figure, recordings, runs):
        _plain(axis)
        axis.legend(frameon=False, fontsize=9)
    figure.savefig(path, dpi=110, facecolor="white")
    return path
