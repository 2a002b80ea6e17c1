"""Pictures of a slip run."""

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator, MultipleLocator

from meissner.scenes.drawing import (
    BLUE,
    GREEN,
    INK,
    ORANGE,
    PURPLE,
    RED,
    SKY,
    envelope,
    lighten,
    new_figure,
    put_title,
    save,
)

COLUMNS = 4000  # of a curve
STATES = ("none", "contact", "incipient", "gross", "release")
# Grey without contact.
STATE_COLOURS = ("#E4E4E4", SKY, ORANGE, RED, "#999999")


def _within(time_s, values, window):
    first, last = np.searchsorted(time_s, window)
    return envelope(time_s[first:last], values[first:last], COLUMNS)


def _runs(flags):
    """(first index, one past the last) of each run of true values."""
    edges = np.flatnonzero(np.diff(np.asarray(flags, dtype=bool), prepend=False, append=False))
    return list(zip(edges[::2], edges[1::2]))


def _bands(axis, time_s, state, window):
    """The state as a coloured band, with a rectangle per run of equal states."""
    time_s, state = np.asarray(time_s), np.asarray(state).astype(int)
    edges = np.concatenate([[0], np.flatnonzero(np.diff(state)) + 1])
    starts = time_s[edges]
    stops = np.append(starts[1:], time_s[-1])
    for kind, colour in enumerate(STATE_COLOURS):
        runs = [(a, b - a) for a, b, e in zip(starts, stops, edges) if state[e] == kind]
        axis.broken_barh(runs, (0, 1), facecolors=colour, linewidth=0)
    axis.set_ylim(0, 1)
    axis.set_yticks([])
    longest = window[1] - window[0]
    for a, b, e in zip(starts, stops, edges):
        a, b = max(a, window[0]), min(b, window[1])
        if b - a > 0.085 * longest:
            ink = "white" if state[e] == 3 else INK
            axis.text((a + b) / 2, 0.48, STATES[state[e]], ha="center", va="center", color=ink, fontsize=9)


def draw_slip(
    path,
    recording,
    *,
    detail_time_s,
    detail_v,
    p2p_v,
    state,
    threshold_v,
    flag_s=None,
    title=None,
    zoom_s=None,
):
    """Draw a slip run the way the published figure lays it out, the whole run beside its onset.

    ``detail_v``, ``p2p_v``, ``state`` [n] belong to ``detail_time_s`` [n]: the Haar coefficient, its
    peak to peak over the window so far, and the state's number. ``threshold_v`` is on peak to peak.
    ``flag_s``: first rise of the flag, or None. ``zoom_s``: (from, until) of the right column; by default
    around the onset, or around the largest coefficient where nothing slips.
    """
    time_s = recording.time_s
    whole = (float(time_s[0]), float(time_s[-1]))
    onset_s, gross_s = recording.onset_s, recording.gross_s
    if zoom_s is None:
        centre_s = onset_s if onset_s is not None else float(detail_time_s[np.argmax(np.abs(detail_v))])
        until_s = centre_s + 0.045
        if flag_s is not None and centre_s < flag_s < centre_s + 0.5:
            until_s = max(until_s, flag_s + 0.02)
        zoom_s = (centre_s - 0.015, until_s)

    figure = new_figure(13, 9.2)
    figure.get_layout_engine().set(h_pad=0.02, w_pad=0.08, hspace=0.02)
    rows = figure.subplots(
        5, 2, sharex="col", gridspec_kw={"width_ratios": [2.2, 1], "height_ratios": [2.2, 1.5, 1.5, 0.5, 1.6]}
    )
    marks = [
        ("first partial slip (truth)", onset_s, {"color": ORANGE, "lw": 1.8}),
        ("flag", flag_s, {"color": RED, "lw": 1.8, "ls": (0, (4, 2))}),
        ("whole contact slips (truth)", gross_s, {"color": INK, "lw": 1.4, "ls": ":"}),
    ]
    marks = [mark for mark in marks if mark[1] is not None]
    for column, window in enumerate((whole, zoom_s)):
        width = 1.1 if column else 0.6
        vc, detail, p2p, band, force = rows[:, column]
        vc.plot(*_within(time_s, recording.volts, window), color=BLUE, lw=width)
        detail.plot(*_within(detail_time_s, detail_v, window), color=BLUE, lw=width)
        p2p.plot(*_within(detail_time_s, p2p_v, window), color=BLUE, lw=width)
        p2p.axhline(threshold_v, color=PURPLE, lw=1.3)
        # Scaled to the time before the whole contact slips; that slip may leave the frame.
        before = (
            (detail_time_s >= window[0])
            & (detail_time_s < (gross_s or window[1]))
            & (detail_time_s <= window[1])
        )
        p2p.set_ylim(0, max(2.5 * threshold_v, 1.4 * np.max(p2p_v[before], initial=0.0)))
        reach = max(threshold_v, 1.4 * np.max(np.abs(detail_v[before]), initial=0.0))
        detail.set_ylim(-reach, reach)
        _bands(band, detail_time_s, state, window)
        force.plot(*_within(time_s, recording.normal_n, window), color=GREEN, lw=1.6)
        if gross_s is not None:
            force.plot(*_within(time_s, recording.tension_n, window), color=INK, lw=1.6)
        for first, last in _runs(recording.moving):
            force.axvspan(time_s[first], time_s[last - 1], color=SKY, alpha=0.25, lw=0)
        force.set_ylim(0, 1.15 * recording.normal_n.max())
        band.spines[["top", "right"]].set_visible(False)
        band.margins(x=0)
        for axis in (vc, detail, p2p, force):
            axis.margins(x=0)
            for _, when_s, look in marks:
                if window[0] <= when_s <= window[1]:
                    axis.axvline(when_s, **look)
            lighten(axis)
            axis.yaxis.set_major_locator(MaxNLocator(5))
        force.set_xlim(window)
    for axis in rows[:, 0]:
        axis.axvspan(*zoom_s, color="#000000", alpha=0.06, lw=0)

    for axis, label in zip(rows[:, 0], ("Vc (V)", "Haar detail (V)", "peak to peak (V)", "", "force (N)")):
        axis.set_ylabel(label)
    figure.align_ylabels(rows[:, 0])
    rows[3, 0].set_ylabel("state", rotation=0, ha="right", va="center")
    rows[0, 0].set_title("the whole run", loc="left", fontsize=11, color="#555555")
    rows[0, 1].set_title("the shaded part", loc="left", fontsize=11, color="#555555")
    rows[4, 0].set_xlabel("time (s)")
    origin_s = zoom_s[0] if onset_s is None else onset_s
    rows[4, 1].set_xlabel(
        f"time from {'the left edge' if onset_s is None else 'the first partial slip'} (ms)"
    )
    span_ms = (zoom_s[1] - zoom_s[0]) * 1e3
    tick_ms = next((t for t in (1, 2, 5, 10, 20, 50, 100, 200, 500) if span_ms / t <= 7), 1000)
    rows[4, 1].xaxis.set_major_locator(MultipleLocator(tick_ms * 1e-3, offset=origin_s))
    rows[4, 1].xaxis.set_major_formatter(lambda x, _: f"{(x - origin_s) * 1e3:.0f}")

    handles = [Line2D([], [], label=name, **look) for name, _, look in marks]
    handles.append(Line2D([], [], color=PURPLE, lw=1.3, label=f"threshold, {threshold_v:g} V"))
    handles.append(Line2D([], [], color=GREEN, lw=1.6, label="normal force"))
    if gross_s is not None:
        handles.append(Line2D([], [], color=INK, lw=1.6, label="tensile force"))
    handles.append(Patch(color=SKY, alpha=0.25, label="loading stage moves"))
    present = np.unique(np.asarray(state).astype(int))
    handles += [Patch(color=STATE_COLOURS[kind], label=f"state: {STATES[kind]}") for kind in present]
    figure.legend(handles=handles, loc="outside lower left", ncols=6, frameon=False, fontsize=9.5)
    name = title or f"{recording.scene.name}: {recording.condition.name}, seed {recording.seed}"
    outcome = "no flag" if flag_s is None else "flag"
    if flag_s is not None and onset_s is not None:
        outcome += f" {(flag_s - onset_s) * 1e3:.1f} ms after the first partial slip"
        outcome += f", {(gross_s - flag_s) * 1e3:.0f} ms before the whole contact slips"
    put_title(figure, f"{name}: {outcome}")
    save(figure, path)
