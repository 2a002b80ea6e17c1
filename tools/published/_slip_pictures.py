"""What the pictures of slip share: a figure readable at a phone's width, its curves, and a small file."""

import io

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

INK, BLUE, ORANGE, GREEN, RED, PURPLE = "#222222", "#0072B2", "#E69F00", "#009E73", "#D55E00", "#A0307A"


def figure(rows, height, columns=1, **more):
    """A figure 900 px wide and its axes, [rows, columns]."""
    picture = Figure(figsize=(9, height), layout="constrained")
    FigureCanvasAgg(picture)
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
        axis.set_title(title, loc="left", fontsize=17)


def envelope(time_s, values, columns=1500):
    """Least and greatest of each column of pixels: the same picture from fewer points."""
    step = len(values) // columns
    if step < 2:
        return time_s, values
    starts = np.arange(0, len(values), step)
    both = [np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)]
    return np.repeat(time_s[starts], 2), np.stack(both, axis=1).ravel()


def curve(axis, time_s, values, colour=BLUE, **look):
    axis.plot(*envelope(time_s, values), **({"color": colour, "lw": 1.4} | look))


def save(picture, path, colours=96):
    """As a PNG with a palette, a third of the size of one without."""
    drawn = io.BytesIO()
    picture.savefig(drawn, dpi=100, facecolor="white")
    Image.open(drawn).convert("RGB").quantize(colours).save(path, optimize=True)
