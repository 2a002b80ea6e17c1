"""Pictures of slip seen by four wires: a run in the layout of the published figure, and the directions."""

import numpy as np

from meissner.engines import COP_ONE
from meissner.physics.grip import FULL_SCALE_V
from meissner.scenes.drawing import BLUE, GREEN, INK, ORANGE, PURPLE, RED, lighten, new_figure, save


def draw(recording, found, decisions, verdict, path):
    """Load output, position output, forces and the object's displacement over time."""
    scene, held, time_s = recording.scene, recording.held, recording.time_s
    figure = new_figure(11, 7.5, f"{scene.name}: {recording.condition.name}, seed {recording.seed}")
    load, place, force = figure.subplots(3, 1, sharex=True)
    reported = np.where(found.pressed, found.load * scene.config.load_lsb_n, np.nan)
    load.plot(time_s, reported, color=BLUE, lw=1.8, label="load output")
    load.plot(time_s, held.grip_n, color=GREEN, lw=1.4, label="grip force (truth)")
    load.set(ylabel="load (N)")
    load.set_ylim(bottom=0)
    for name, values, colour in (("x", found.x, BLUE), ("y", found.y, ORANGE)):
        volts = np.where(found.pressed, values / COP_ONE * FULL_SCALE_V, np.nan)
        middle = np.median(volts[found.pressed]) if found.pressed.any() else 0.0
        place.plot(time_s, volts - middle, color=colour, lw=1.6, label=f"position output {name}")
    place.set(ylabel=f"from its median (V of ±{FULL_SCALE_V:g})", ylim=(-0.1, 0.1))
    force.plot(time_s, held.tension_n, color=INK, lw=1.6, label="pulling force (truth)")
    force.set(ylabel="force (N)", xlabel="time (s)")
    force.set_ylim(0, 1.1 * max(held.tension_n.max(), 0.1))
    moved = force.twinx()
    moved.plot(time_s, held.slip_mm, color=PURPLE, lw=1.4, label="displacement of the object (truth, right)")
    moved.set(ylabel="mm")
    moved.set_ylim(0, max(1.1 * held.slip_mm.max(), 1.0))
    marks = (
        ("the pull begins", verdict["onset_s"], {"color": ORANGE, "lw": 1.4}),
        ("flag", verdict["flag_s"], {"color": RED, "lw": 1.8, "ls": (0, (4, 2))}),
        ("the object moves", verdict["gross_s"], {"color": INK, "lw": 1.2, "ls": ":"}),
    )
    for axis in (load, place, force):
        for name, when_s, look in marks:
            if when_s is not None:
                axis.axvline(when_s, label=name if axis is load else None, **look)
        lighten(axis)
        axis.margins(x=0)
    for axis, where in ((load, "upper right"), (place, "upper right"), (force, "upper left")):
        axis.legend(frameon=False, fontsize=9, loc=where)
    moved.legend(frameon=False, fontsize=9, loc="center left")
    save(figure, path)


def draw_ways(scene, ways, path):
    """Every slip's reported direction beside the true one; ``ways``: (true, reported or None) in degrees."""
    figure = new_figure(5.5, 5.5, f"{scene.name}: direction of slip")
    axis = figure.add_subplot(projection="polar")
    for index, true_deg in enumerate(dict.fromkeys(true for true, _ in ways)):
        label = "truth" if index == 0 else None
        axis.plot([np.deg2rad(true_deg)] * 2, [0, 1], color=INK, lw=1.2, label=label)
    told = np.deg2rad([way for _, way in ways if way is not None])
    axis.plot(told, np.full(len(told), 0.85), "o", color=BLUE, ms=5, alpha=0.6, label="reported, each run")
    axis.set_yticks([])
    axis.set_ylim(0, 1)
    axis.legend(frameon=False, fontsize=9, loc="lower left", bbox_to_anchor=(-0.12, -0.12))
    save(figure, path)
