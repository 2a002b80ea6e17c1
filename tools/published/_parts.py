"""Shared by the papers' pages: numbers as text, pictures."""

import io

from PIL import Image

from meissner.scenes.drawing import new_figure

NONE = "none stated"


def signed(value, digits=4):
    """A signed number with so many digits; 0 without a sign if it rounds to zero."""
    return f"{value:+.{digits}f}" if abs(value) >= 0.5 * 10**-digits else "0"


def percent(values, digits=2):
    return f"{100 * values.mean():.{digits}f} ± {100 * values.std():.{digits}f}"


def beside(ours, theirs):
    """The deviation of ours from the paper's, in percent of the paper's."""
    return f"{100 * (ours / theirs - 1):+.0f} %"


def figure(columns=1, rows=1, width=9.0, height=4.4, **axes):
    """A figure 900 to 1000 pixels wide with text readable on a phone, and its axes."""
    drawn = new_figure(width, height)
    axes = drawn.subplots(rows, columns, **axes)
    for axis in getattr(axes, "flat", [axes]):
        axis.tick_params(labelsize=13)
        axis.grid(color="#E6E6E6", lw=0.7)
        axis.set_axisbelow(True)
        axis.spines[["top", "right"]].set_visible(False)
    return drawn, axes


def label(axis, x, y, title=None, legend=True):
    axis.set_xlabel(x, fontsize=14)
    axis.set_ylabel(y, fontsize=14)
    if title:
        axis.set_title(title, fontsize=14, loc="left")
    if legend:
        axis.legend(frameon=False, fontsize=12)


def save(drawn, folder, name, colours=96):
    """Save a figure with a palette, which takes a third of the bytes; returns its name."""
    whole = io.BytesIO()
    drawn.savefig(whole, dpi=100, facecolor="white")
    Image.open(whole).convert("RGB").quantize(colours).save(folder / name, optimize=True)
    return name
