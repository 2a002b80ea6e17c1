"""A picture of an axis: its points, the Pareto front, the shipped point."""

from textwrap import wrap

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from meissner.tradeoff import pareto
from meissner.tradeoff.sweep import figure_of

BLUE, ORANGE, GREY, INK = "#0072B2", "#D55E00", "#C4C4C4", "#222222"
FORMS = (("o", "-"), ("s", "--"), ("^", ":"), ("D", "-."), ("v", "-"), ("P", "--")) * 4
WIDE = 50  # an axis is logarithmic above this ratio of its ends


def label(figure):
    return f"{figure.label} ({figure.unit})" if figure.unit else figure.label


def _scale(values):
    least, most = min(values), max(values)
    return "log" if least > 0 and most / least > WIDE else "linear"


def _named(axis, kind):
    """The parameters that a class of competing points has in common, in words."""
    both = zip(axis.apart, kind)
    return ", ".join(str(v) if isinstance(v, str) else f"{key.replace('_', ' ')} {v:g}" for key, v in both)


def _panel(axes, axis, rows, across, up):
    """Points over two figures; the line joins the front of these two figures alone."""
    known = [row for row in rows if None not in (figure_of(row, across), figure_of(row, up))]
    if not known:
        axes.text(0.5, 0.5, "nothing measured", ha="center", transform=axes.transAxes)
        return
    at = {id(row): (figure_of(row, across), figure_of(row, up)) for row in known}
    kinds = list(dict.fromkeys(axis.kind(row["point"]) for row in known))
    for kind, (marker, dashes) in zip(kinds, FORMS):
        same = [row for row in known if axis.kind(row["point"]) == kind]
        what = _named(axis, kind)
        for on, colour, size, order in ((False, GREY, 14, 1), (True, BLUE, 24, 3)):
            chosen = [at[id(row)] for row in same if row["front"] == on]
            name = f"{what}: on the front" if what else "on the front of all judged figures"
            given = {"s": size, "color": colour, "marker": marker, "zorder": order}
            if chosen:
                axes.scatter(*zip(*chosen), **given, label=name if on else "dominated by another")
        corners = pareto.stairs([at[id(row)] for row in same])
        if len(corners) > 1:
            line = {"where": "post", "color": BLUE, "lw": 1, "ls": dashes, "zorder": 2}
            axes.step(*zip(*corners), **line, label="front of these two figures")
    for row in known:
        if row["shipped"]:
            axes.scatter(*at[id(row)], s=110, marker="*", color=ORANGE, zorder=4, label="shipped")
    axes.set_xscale(_scale([x for x, _ in at.values()]))
    axes.set_yscale(_scale([y for _, y in at.values()]))
    for one, values in zip((axes.xaxis, axes.yaxis), zip(*at.values())):
        if one.get_scale() == "linear" and all(value == int(value) for value in values):
            one.get_major_locator().set_params(integer=True)  # no ticks between integers
    axes.set(xlabel=label(axis.figure(across)), ylabel="\n".join(wrap(label(axis.figure(up)), 38)))
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(color="#E6E6E6", lw=0.6)
    axes.set_axisbelow(True)


def _conclusions(axes, axis, rows):
    """A chart of the conclusions that hold: a column for each conclusion, a row for each point."""
    keys = axis.conclusions
    for line, row in enumerate(rows):
        for column, key in enumerate(keys):
            holds = figure_of(row, key)
            axes.scatter(
                column, line, s=90, marker="o" if holds else "X", color=BLUE if holds else ORANGE, zorder=2
            )
    axes.set_xticks(range(len(keys)), [axis.figure(key).label for key in keys], rotation=30, ha="left")
    axes.xaxis.tick_top()
    names = [", ".join(str(row["point"][key]) for key in axis.values) for row in rows]
    axes.set_yticks(range(len(rows)), names)
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlim(-0.5, len(keys) - 0.5)
    axes.tick_params(length=0)
    axes.grid(color="#E6E6E6", lw=0.6)
    axes.spines[:].set_visible(False)
    for marker, colour, name in (("o", BLUE, "holds"), ("X", ORANGE, "does not")):
        axes.scatter([], [], s=90, marker=marker, color=colour, label=name)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0), ncols=2, frameon=False)


def draw(file, axis, rows):
    """PNG into the open ``file``."""
    count = max(1, len(axis.panels))
    size = (9, 1.9 + 0.3 * len(rows)) if axis.conclusions else (max(7.2, 4.6 * count), 4.4)
    figure = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(axis.title, fontsize=12, x=0.01, ha="left", fontweight="bold", color=INK)
    if axis.conclusions:
        _conclusions(figure.subplots(), axis, rows)
    else:
        several = figure.subplots(1, count, squeeze=False)[0]
        for axes, panel in zip(several, axis.panels):
            _panel(axes, axis, rows, *panel)
        handles = {name: one for axes in several for one, name in zip(*axes.get_legend_handles_labels())}
        figure.legend(
            handles.values(),
            handles,
            loc="outside lower left",
            ncols=2 if count == 1 else 4,
            frameon=False,
            fontsize=9,
        )
    figure.savefig(file, format="png", dpi=110, facecolor="white")
