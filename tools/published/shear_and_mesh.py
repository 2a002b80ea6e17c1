"""One page for the rubber papers and the mesh paper: published._shear and, if it exists, published._mesh."""

from importlib import import_module
from importlib.util import find_spec

TITLE = "Sheared rubber, the slip sensor and the mesh: the papers' figures, and ours"
HEAD = """
Three papers: one on the change of the resistance of pressure-conductive rubber with shear (the journal
version of the study in *Development of High Speed and High Sensitivity Slip Sensor*, "CoP slip"); *A
High-Speed Mesh of Tactile Sensors Fitting Arbitrary Surfaces*; and *Development of High-Sensitivity Slip
Sensor Using Special Characteristics of Pressure Conductive Rubber*. Ours is computed with `meissner.physics`.
"""


def parts():
    names = [name for name in ("_shear", "_mesh") if find_spec(f"published.{name}")]
    return [import_module(f"published.{name}") for name in names]


def compute():
    return [row for part in parts() for row in part.compute()]


def draw(folder):
    return [picture for part in parts() for picture in part.draw(folder)]
