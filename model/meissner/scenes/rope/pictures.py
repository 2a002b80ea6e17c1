"""Pictures of a rope in the fingertip: sensors and alarms, the centre's path, differences of frames."""

import numpy as np

from meissner.scenes.drawing import BLUE, INK, LINES, ORANGE, RED, new_figure, save

MARK = 150  # steps between the numbers of figure 6
MOST = 6  # conditions in one picture


def _grid(scene, count, height=2.2):
    figure = new_figure(12, 1 + height * count, f"{scene.name}: {scene.title}")
    return figure, np.atleast_1d(figure.subplots(count, 1, squeeze=False)[:, 0])


def _sensors(axis, recording, title):
    start = recording.sections[0].start
    shown = recording.channels - recording.channels[:, :start].mean(axis=1, keepdims=True)
    for k, codes in enumerate(shown):
        axis.plot(recording.time_s, codes, lw=0.8, color=LINES[k % len(LINES)], label=f"$s_{k}$")
    for section in recording.sections:
        axis.axvline(recording.time_s[section.start], color=RED, lw=1)
        if section.slip is not None:
            axis.axvline(recording.time_s[section.slip], color=ORANGE, lw=1.4)
    axis.set(title=title, xlabel="time (s)", ylabel="codes")


def draw_sensors(scene, path, scene_names, recordings):
    figure, axes = _grid(scene, min(MOST, len(recordings)))
    for axis, name, one in zip(axes, scene_names, recordings):
        _sensors(axis, one, name)
    save(figure, path, axes)


def draw_steps(scene, path, scene_names, recordings, arrays):
    figure, axes = _grid(scene, min(MOST, len(recordings)))
    for k, (axis, name, one) in enumerate(zip(axes, scene_names, recordings)):
        section = one.sections[0]
        part = slice(section.start, section.stop - 1)
        axis.plot(np.arange(part.start + 1, part.stop + 1), arrays[f"c{k}_steps"][1, part], color=BLUE, lw=1)
        axis.axhline(-15, color=RED, lw=0.8)
        axis.set(title=f"{name}: $s_1$", xlabel="time step", ylabel="codes")
    save(figure, path, axes)


def draw_cop(scene, path, names, arrays):
    figure = new_figure(6 * len(names), 6, f"{scene.name}: {scene.title}")
    axes = np.atleast_1d(figure.subplots(1, len(names), sharex=True, sharey=True))
    for k, (axis, name) in enumerate(zip(axes, names)):
        x, y = arrays[f"c{k}_x"], arrays[f"c{k}_y"]
        axis.plot(x, y, color=BLUE, lw=0.6)
        for at in range(0, len(x), MARK):
            axis.annotate(str(at), (x[at], y[at]), (4, 4), textcoords="offset points", color=RED, fontsize=9)
        axis.plot(x[::MARK], y[::MARK], ".-", color=RED, lw=0.8)
        axis.set(title=name, xlabel="centre of gravity, x", ylabel="centre of gravity, y")
    save(figure, path, axes)


def draw_pull(scene, path, recordings, decided):
    figure, axes = _grid(scene, min(MOST, len(recordings)))
    for axis, name, one, (_, slip) in zip(axes, scene.names, recordings, decided):
        _sensors(axis, one, name)
        low = axis.get_ylim()[0]
        axis.plot(one.time_s[slip], np.full(int(slip.sum()), low), "|", color=INK, ms=8)
    save(figure, path, axes)
