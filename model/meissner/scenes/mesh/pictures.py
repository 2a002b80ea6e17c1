"""Pictures of the four-wire mesh: the published figure of each kind."""

import numpy as np

from meissner.scenes.drawing import INK, LINES, ORANGE, PURPLE, breaks, lighten, new_figure, save


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
            shown = breaks(one[name], one["valid"])
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
    figure = new_figure(13, 4.8, f"{scene.name}: {scene.title}")
    draw = {"points": _draw_points, "random": _draw_random, "pulse": _draw_pulse, "stroke": _draw_stroke}[
        scene.kind
    ]
    if scene.kind == "points" and len(recordings[0].load) == 1:
        draw = _draw_surface
    for axis in draw(figure, recordings, runs):
        lighten(axis)
        axis.legend(frameon=False, fontsize=9)
    save(figure, path)
