"""An axis of the sweep: its values, the cost and error of a point, and the point that the project ships.

``cost`` and ``error`` are functions of one point, a dict, and of nothing else, so that any process can run
them. They measure: they run the twins, the solvers or the engines, or read figures that a tool measured.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import product
from typing import NamedTuple


class Figure(NamedTuple):
    """A figure of a point; ``judged``: less is better. The front is over all judged figures."""

    key: str
    label: str
    unit: str = ""
    judged: bool = False


def always(_point):
    return True


@dataclass(frozen=True)
class Axis:
    """``values``: {parameter: its values}; the points are their product where ``legal``.

    ``apart``: parameters that are given, not chosen; points that differ in them do not compete. ``quick``:
    ``values`` for `--quick`. ``runs``: {parameter: (value, value for quick)} that set how long is measured.
    ``shipped``: the point that the project ships. ``panels``: (key across, key up) of each chart; without
    any, there is only a table. ``near``: with quick, only points that differ from the shipped one in at most
    this many parameters. ``group``: parameters; points that agree in them go to one process, which keeps what
    they share. ``timed``: figures that a clock decides; the axis is then measured alone and does not repeat
    to the digit. ``conclusions``: figures that are true or false, each a sentence. ``placed``: the (entry,
    target) of a point's recorded LUTs and Fmax, or None (meissner.tradeoff.area).
    """

    name: str
    title: str
    about: str
    values: dict
    shipped: dict
    cost: Callable
    error: Callable
    figures: tuple
    panels: tuple = ()
    quick: dict = field(default_factory=dict)
    runs: dict = field(default_factory=dict)
    near: int | None = None
    group: tuple = ()
    apart: tuple = ()
    timed: tuple = ()
    conclusions: tuple = ()
    legal: Callable = always
    placed: Callable | None = None

    def __post_init__(self):
        where = f"axis {self.name}"
        for given in (self.quick, self.shipped):
            if unknown := [key for key in given if key not in self.values]:
                raise ValueError(f"{where} has no parameter {unknown[0]}")
        keys = [figure.key for figure in self.figures]
        if doubled := [key for key in keys if keys.count(key) > 1]:
            raise ValueError(f"{where} has the figure {doubled[0]} twice")
        for key in (*(key for panel in self.panels for key in panel), *self.timed):
            if key not in keys:
                raise ValueError(f"{where} has no figure {key}")

    def kind(self, point):
        """The class of points that a point competes in."""
        return tuple(point[key] for key in self.apart)

    @property
    def judged(self):
        return tuple(figure.key for figure in self.figures if figure.judged)

    def figure(self, key):
        return next(figure for figure in self.figures if figure.key == key)

    def points(self, quick=False):
        """Every point in the order of ``values``, including the shipped one."""
        values = self.values | (self.quick if quick else {})
        runs = {key: both[quick] for key, both in self.runs.items()}
        found = [dict(zip(values, row)) for row in product(*values.values())]
        found = [point for point in found if self.legal(point)]
        if quick and self.near is not None:
            found = [point for point in found if self._away(point) <= self.near]
        if self.shipped and self.shipped not in found:
            found.append(self.shipped)
        return [point | runs for point in found]

    def _away(self, point):
        return sum(point[key] != value for key, value in self.shipped.items())

    def is_shipped(self, point):
        return bool(self.shipped) and all(point.get(key) == value for key, value in self.shipped.items())
