"""What the pictures of all scenes share: colours, figures, and the image of an even press."""

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

# Okabe and Ito's palette, which colour-blind readers can distinguish.
INK, BLUE, ORANGE, GREEN, RED = "#222222", "#0072B2", "#E69F00", "#009E73", "#D55E00"
SKY, PURPLE = "#56B4E9", "#A0307A"
LINES = (BLUE, ORANGE, GREEN, RED, PURPLE, INK)
MAP = "YlGnBu"


def new_figure(width, height, title=None):
    """A figure of that size in inches."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    if title is not None:
        put_title(figure, title)
    return figure


def put_title(figure, text):
    figure.suptitle(literal(text), fontsize=13, x=0.01, ha="left", fontweight="bold")


def literal(text):
    """A user's text for a picture, in which a "$" begins no formula."""
    return text.replace("$", r"\$")


def lighten(axis):
    """A faint grid behind the curves, no frame on top and right."""
    axis.spines[["top", "right"]].set_visible(False)
    axis.grid(color="#E6E6E6", lw=0.6)
    axis.set_axisbelow(True)


def save(figure, path, axes=()):
    """Write the picture; ``axes`` are lightened and get a legend of what has a label."""
    for axis in axes:
        lighten(axis)
        if axis.get_legend_handles_labels()[0]:
            axis.legend(frameon=False, fontsize=9)
    figure.savefig(path, dpi=110, facecolor="white")


def breaks(values, valid):
    """The values with NaN where they are not valid, so that a line breaks there."""
    return np.where(valid, values, np.nan)


def envelope(time_s, values, columns):
    """Minimum and maximum per column: the same picture as all samples give, with a fraction of the points."""
    step = len(values) // columns
    if step < 2:
        return time_s, values
    starts = np.arange(0, len(values), step)
    low, high = np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)
    return np.repeat(time_s[starts], 2), np.stack([low, high], axis=1).ravel()


def draw_even(scene, path, images):
    """The image of an even press before and after calibration, each as a share of its own mean."""
    figure = new_figure(4.4 * len(images) + 1, 4.3, f"{scene.name}: an even press")
    axes = figure.subplots(1, len(images))
    limit = 0.0
    shares = {}
    for name, image in images.items():
        values = np.ma.masked_invalid(image)
        shares[name] = 100 * (values / values.mean() - 1)
        limit = max(limit, np.abs(shares[name]).max())
    for axis, (name, share) in zip(axes, shares.items()):
        shown = axis.imshow(share, cmap="PuOr", vmin=-limit, vmax=limit)
        axis.set_facecolor("#BBBBBB")
        axis.set_title(f"{name}\nlargest {np.abs(share).max():.2f} % off the mean", fontsize=10)
        axis.set(xticks=[], yticks=[])
    figure.colorbar(shown, ax=axes, label="off the mean of all cells (%)", shrink=0.85)
    save(figure, path)
