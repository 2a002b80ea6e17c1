"""Strip charts of a hand's run in the published layout: grip force, wavelet detail, the object's position."""

import numpy as np

from meissner.scenes.drawing import BLUE, GREEN, INK, ORANGE, PURPLE, RED, lighten, new_figure, save

COLUMNS = 3000  # of the picture; with more cycles, each column has their least and greatest


def _thin(trace):
    """(time of groups of cycles, function that reduces an array to these groups)."""
    step = max(1, len(trace.time_s) // COLUMNS)
    starts = np.arange(0, len(trace.time_s), step)
    return trace.time_s[starts], lambda x, of: of.reduceat(x, starts)


def draw(scene, condition, seed, trace, path):
    """Draw the strip charts; ``trace``: scenes.hand.loop.Trace of the run with ``seed``."""
    time_s, thin = _thin(trace)
    figure = new_figure(11, 8, f"{scene.name}: {condition.name}, seed {seed}")
    force, detail, place = figure.subplots(3, 1, sharex=True, height_ratios=(3, 2, 3))
    force.plot(time_s, thin(trace.normal_n, np.maximum), color=BLUE, lw=1.5, label="grip force")
    force.plot(
        time_s, thin(trace.least_n, np.maximum), color=INK, lw=1.2, ls=":", label="least that holds (truth)"
    )
    force.set(ylabel="grip (N)")
    force.set_ylim(0, 1.2 * max(trace.normal_n.max(), trace.least_n.max()))
    volts = scene.adc.lsb_v / 2 ** (scene.slip["level"] / 2)
    for finger, colour in ((0, GREEN), (1, ORANGE)):
        low = thin(trace.detail_low[:, finger], np.minimum) * volts
        high = thin(trace.detail_high[:, finger], np.maximum) * volts
        detail.fill_between(time_s, low, high, color=colour, lw=0.5, alpha=0.8, label=f"finger {finger + 1}")
    for sign, label in ((-1, None), (1, "half the threshold")):
        half_v = thin(sign * trace.threshold_v, np.maximum)
        detail.plot(time_s, half_v, color=PURPLE, lw=1, ls="--", label=label)
    detail.set(ylabel="Haar detail (V)")
    detail.set_ylim(-0.08, 0.08)
    tight = trace.time_s[trace.over > 0]
    if len(tight) <= 400:
        detail.plot(tight, np.full(len(tight), 0.072), "|", color=RED, ms=8, label="tightened")
    total = trace.sag_mm + trace.ring_mm + trace.slip_mm
    rest = total[0]
    place.plot(
        time_s, thin(total - rest, np.maximum), color=INK, lw=1.6, label="downward displacement of the object"
    )
    parts = (
        (trace.sag_mm, BLUE, "elastic sag"),
        (trace.ring_mm, ORANGE, "slipped rings"),
        (trace.slip_mm, RED, "slip"),
    )
    for part, colour, name in parts:
        place.plot(time_s, thin(part - part[0], np.maximum), color=colour, lw=1.2, label=name)
    place.set(ylabel="position (mm)", xlabel="time (s)")
    place.set_ylim(bottom=min(0.0, 1.2 * (total - rest).min()), top=max(0.05, 1.3 * (total - rest).max()))
    for axis in (force, detail, place):
        lighten(axis)
        axis.margins(x=0)
        axis.legend(frameon=False, fontsize=9, loc="lower left" if axis is detail else "upper left", ncols=4)
    save(figure, path)
