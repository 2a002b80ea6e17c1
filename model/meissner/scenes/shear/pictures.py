"""Pictures of sheared rubber in the layout of the published figures; the papers' page uses them, too."""

from functools import partial
from typing import NamedTuple

import numpy as np

from meissner.scenes.drawing import BLUE, GREEN, INK, ORANGE, PURPLE, RED, envelope, literal, new_figure
from meissner.scenes.shear.judge import slope
from meissner.scenes.shear.published import CONVERGED_V, FIT, LINE, STEP_V

COLOURS = (BLUE, ORANGE, GREEN)
COLUMNS = 1500  # of a curve
FIRST_S = 1.0  # shown in the enlarged picture of a slip: figures 6 and 9
BEFORE_S = 0.5  # of rest before the shear


def figure(rows, height, columns=1, **more):
    """A figure 900 px wide and its axes, [rows, columns]."""
    picture = new_figure(9, height)
    axes = picture.subplots(rows, columns, squeeze=False, **more)
    for axis in axes.flat:
        axis.tick_params(labelsize=15)
        axis.spines[["top", "right"]].set_visible(False)
        axis.grid(color="#E6E6E6", lw=0.8)
        axis.set_axisbelow(True)
        axis.margins(x=0)
        axis.locator_params(axis="y", nbins=4)
    return picture, axes


def label(axis, x=None, y=None, title=None):
    for text, put in ((x, axis.set_xlabel), (y, axis.set_ylabel)):
        if text:
            put(text, fontsize=17)
    if title:
        axis.set_title(literal(title), loc="left", fontsize=17)


def curve(axis, time_s, values, colour=BLUE, **look):
    axis.plot(*envelope(time_s, values, COLUMNS), **({"color": colour, "lw": 1.4} | look))


class Slipped(NamedTuple):
    """The data of one pull for a picture; times, ``gross_s`` too, count from the stage's start."""

    title: str
    time_s: np.ndarray
    volts: np.ndarray
    slope_v_s: np.ndarray
    normal_n: np.ndarray
    tension_n: np.ndarray
    gross_s: float
    speed_mm_s: float


def slip_figure(pulls, until_s, derivative):
    """Vc of each pull, with its derivative below it if asked for; at the bottom force and plate of the last.

    Figures 5 and 6 of the journal version, 8 and 9 of the sensor.
    """
    per = 2 if derivative else 1
    picture, axes = figure(len(pulls) * per + 1, 14 if derivative else 9, sharex=True)
    for pull, top in zip(pulls, axes[::per, 0]):
        kept = pull.time_s < until_s
        curve(top, pull.time_s[kept], pull.volts[kept])
        label(top, y="Vc (V)", title=f"{pull.title}; slip: dashed ours, dotted published")
    if derivative:
        for pull, axis in zip(pulls, axes[1::per, 0]):
            kept = pull.time_s < until_s
            curve(axis, pull.time_s[kept], pull.slope_v_s[kept])
            axis.set_ylim(-60, 60)
            label(axis, y="V/s")
    bottom = axes[-1, 0]
    curve(bottom, pull.time_s[kept], pull.normal_n[kept], GREEN, lw=2, label="normal force (N)")
    curve(bottom, pull.time_s[kept], pull.tension_n[kept], INK, lw=2, label="tangential force (N)")
    curve(bottom, pull.time_s[kept], pull.speed_mm_s * pull.time_s[kept], PURPLE, lw=2, label="plate (mm)")
    bottom.set_ylim(0, 3.6)
    for place, axis in enumerate(axes[:, 0]):
        axis.axvline(pulls[min(place // per, len(pulls) - 1)].gross_s, color=RED, lw=1.5, ls="--")
        axis.axvline(0.4, color=INK, lw=1.5, ls=":")
    label(bottom, "time (s)", "N, mm")
    bottom.legend(fontsize=14, loc="upper left", ncols=3)
    return picture


class Sheared(NamedTuple):
    """One panel of ``step_figure``: ``curves`` (name, time, Vc), sheared from ``start_s`` to ``stop_s``."""

    title: str
    curves: list
    start_s: float
    stop_s: float
    published_v: float | None


def step_figure(panels):
    """Figures 9 to 11: pressed (I), sheared (II), held (III), beside the published steps and 3 V."""
    picture, axes = figure(len(panels), 4 * len(panels))
    for axis, panel in zip(axes[:, 0], panels):
        for (name, time_s, volts), colour in zip(panel.curves, (BLUE, ORANGE, PURPLE)):
            curve(axis, time_s, volts, colour, lw=2, label=name)
        if panel.published_v is not None:
            level = [panel.published_v] * 2
            axis.plot([panel.start_s, panel.stop_s], level, color=INK, lw=2.5, ls=":", label="published")
        axis.axhline(CONVERGED_V, color=INK, lw=1.2, ls="--")
        axis.set_ylim(1.5, 5.2)
        for when in (panel.start_s, panel.stop_s):
            axis.axvline(when, color="#999999", lw=1.2)
        label(axis, y="Vc (V)", title=f"{panel.title}; dashed: 3 V (CoP slip)")
    axes[0, 0].legend(fontsize=14, loc="upper right")
    label(axes[-1, 0], "time (s)")
    return picture


def draw_distance(axis, moved_mm, step_v, deviation_v=None):
    """Figure 8: dV over the distance, with the deviation of its measurements if there are several."""
    axis.errorbar(moved_mm, step_v, deviation_v, fmt="o", color=BLUE, ms=8, capsize=5, clip_on=False)
    axis.set_ylim(0, 1)
    label(axis, "shear (mm)", "ΔV (V)", "Fig. 8: 0.05 mm/s, 1 N")


def draw_speed(axis, speed_mm_s, step_v, look="-"):
    """Figure 12: dV over the speed, from 2 V, beside both tables."""
    speeds = np.unique(speed_mm_s)
    axis.plot(speed_mm_s, step_v, look, color=BLUE, lw=2, ms=7, label="ours")
    axis.plot(STEP_V.keys(), STEP_V.values(), "s", color=INK, ms=9, label="table 1")
    axis.plot(speeds, FIT[2][0] * speeds ** FIT[2][1], color=INK, lw=2, ls=":", label="table 2")
    axis.set_ylim(0, 2.4)
    axis.legend(fontsize=14)
    label(axis, "mm/s", "ΔV (V)", "Fig. 12: from 2 V")


def draw_loads(axis, found, look="-"):
    """Figure 14: {rest: (speeds, dV)} in logs, beside Table 2."""
    for (rest, (speed_mm_s, step_v)), colour in zip(found.items(), COLOURS):
        speeds, (k, n) = np.unique(speed_mm_s), FIT[rest]
        axis.loglog(speed_mm_s, step_v, look, color=colour, lw=2, ms=6, label=f"{rest} V")
        axis.loglog(speeds, k * speeds**n, color=colour, lw=2, ls=":")
    axis.legend(fontsize=14)
    axis.set_yticks([0.3, 0.5, 1.0], ["0.3", "0.5", "1"])
    axis.minorticks_off()
    label(axis, "mm/s", "ΔV (V)", "Fig. 14: dotted, table 2")


def draw_k(axis, rest_v, k, look="-", width=None):
    """Figure 15: k over the rest, beside Table 2."""
    axis.errorbar(rest_v, k, width, fmt=look, color=BLUE, lw=2, ms=7, capsize=5)
    axis.plot(FIT.keys(), [k for k, _ in FIT.values()], "s", color=INK, ms=9, clip_on=False)
    axis.margins(0.05)
    label(axis, "initial Vc (V)", "k", "Fig. 15: squares, table 2")


def _converted(recording):
    return recording.scene.adc.volts_of(recording.codes)


def _amount(scene, shown, rows, _):
    """Figure 8, and Vc of each distance."""
    picture, ((traces,), (distance,)) = figure(2, 10)
    for recording in shown.values():
        kept = recording.time_s > recording.start_s - BEFORE_S
        curve(traces, recording.time_s[kept] - recording.start_s, _converted(recording)[kept])
    label(traces, "time from the stage's start (s)", "Vc (V)", scene.title.split(":")[0])
    deviations = [row["deviation_v"] or 0.0 for row in rows]
    draw_distance(distance, [row["moved_mm"] for row in rows], [row["step_v"] for row in rows], deviations)
    yield (
        picture,
        "Vc while the rubber shears and after it, over each distance; dV over the distance (figure 8)",
    )


def _panels(scene, shown, numbers):
    """A panel of ``step_figure`` for each of Table 1's speeds; ``numbers``: of their figures."""
    for number, (speed, step_v) in zip(numbers, STEP_V.items()):
        cases = [case for case in shown if case.speed_mm_s == speed and round(case.rest_v) == 2]
        if cases:
            first = shown[cases[0]]
            curves = [
                (literal(case.name.rsplit(",", 3)[0]), shown[case].time_s, _converted(shown[case]))
                for case in cases
            ]
            title = f"Fig. {number}: {speed:g} mm/s"
            yield Sheared(title, curves, first.start_s, first.stop_s, cases[0].rest_v + step_v)


def _speed(scene, shown, rows, constants):
    """Figures 9 to 11, 12, 14 and 15."""
    panels = list(_panels(scene, shown, (9, 10, 11)))
    if panels:
        yield step_figure(panels), "Vc pressed, sheared and held at the speeds of Table 1 (figures 9 to 11)"
    cases = list(zip(shown, rows))
    found = {
        rest: np.array(
            [(case.speed_mm_s, row["step_v"]) for case, row in cases if round(case.rest_v) == rest]
        ).T
        for rest in FIT
        if any(round(case.rest_v) == rest for case, _ in cases)
    }
    picture, axes = figure(2, 10, 2)
    by_speed, by_load, by_rest, back = axes.flat
    if 2 in found:
        draw_speed(by_speed, *found[2], "o")
    draw_loads(by_load, found, "o")
    of_k = {row["constant"]: row for row in constants if row["constant"].startswith("k from")}
    rests = [float(name.split()[2]) for name in of_k]
    low, value, high = (np.array([row[key] for row in of_k.values()]) for key in ("low", "value", "high"))
    draw_k(by_rest, rests, value, "o", (value - low, high - value))
    for (rest, (speed_mm_s, step_v)), colour in zip(found.items(), COLOURS):
        k = LINE["k0"] + LINE["k1"] * rest
        back.loglog(speed_mm_s, (step_v / k) ** (1 / LINE["n"]), "o", color=colour, ms=6, label=f"{rest} V")
    ends = np.array([min(case.speed_mm_s for case in shown), max(case.speed_mm_s for case in shown)])
    back.loglog(ends, ends, color=INK, lw=1.5)
    back.legend(fontsize=14)
    label(back, "mm/s", "v of ΔV (mm/s)", "the line inverted")
    yield (
        picture,
        "dV over the speed from 2 V and from each rest, and k over the rest (figures 12, 14, 15); the speed "
        "that the published line gives back for the mean step",
    )


def _recover(scene, shown, rows, _):
    panels = list(_panels(scene, shown, (9, 10, 11)))
    yield (
        step_figure(panels),
        "Vc pressed, sheared and held (figures 9 to 11; CoP slip, 6 to 8), by recovery and lot",
    )


def _stick_slip(scene, shown, rows, _):
    """Figures 8 and 9 of the sensor (5 and 6 of the journal without the derivative)."""
    pulls = []
    for case, recording in shown.items():
        since = recording.time_s >= recording.start_s - 1e-9
        volts = _converted(recording)
        pulls.append(
            Slipped(
                case.name.split(",")[0],
                recording.time_s[since] - recording.start_s,
                volts[since],
                slope(volts, scene.rate_hz, scene.slope["slope_s"])[since],
                recording.normal_n[since],
                recording.tension_n[since],
                recording.gross_s - recording.start_s,
                case.speed_mm_s,
            )
        )
    for until_s, what in (
        (np.inf, "the whole run (figures 5 and 8)"),
        (FIRST_S, "its first second (6 and 9)"),
    ):
        yield (
            slip_figure(pulls, until_s, True),
            f"Vc, its derivative over 1 ms, forces and the plate's way: {what}",
        )


_DRAWN = {"amount": _amount, "speed": _speed, "recover": _recover, "stick_slip": _stick_slip}


def drawings(scene, shown, rows, constants):
    """The pictures of a run: (function that writes it to a path, condition, what is shown) of each.

    ``shown``: {case: Recording} of the first seed; ``rows``, ``constants``: of the summary.
    """
    drawn = _DRAWN[scene.kind](scene, shown, rows, constants)
    return [
        (partial(picture.savefig, dpi=100, facecolor="white"), scene.title, what) for picture, what in drawn
    ]
