"""Shared by the pictures of slip: a figure readable on a phone, its curves, and a small file."""

import io

from PIL import Image

from meissner.scenes.drawing import BLUE, GREEN, INK, ORANGE, PURPLE, RED
from meissner.scenes.shear.pictures import curve, envelope, figure, label

__all__ = ["BLUE", "GREEN", "INK", "ORANGE", "PURPLE", "RED", "curve", "envelope", "figure", "label", "save"]


def save(picture, path, colours=96):
    """Save as a PNG with a palette, a third of the size without one."""
    drawn = io.BytesIO()
    picture.savefig(drawn, dpi=100, facecolor="white")
    Image.open(drawn).convert("RGB").quantize(colours).save(path, optimize=True)
