"""The table of axes: the ``AXES`` of every module in meissner.tradeoff.axes."""

import pkgutil
from functools import cache
from importlib import import_module

from meissner.tradeoff import axes


@cache
def every():
    """{name: Axis} in the order of modules and of their AXES."""
    found = {}
    for module in sorted(one.name for one in pkgutil.iter_modules(axes.__path__)):
        for axis in getattr(import_module(f"{axes.__name__}.{module}"), "AXES", ()):
            if axis.name in found:
                raise ValueError(f"two axes are called {axis.name}")
            found[axis.name] = axis
    return found


def named(name):
    """The axis of that name; ValueError lists the known ones."""
    if name not in every():
        raise ValueError(f"there is no axis '{name}'; the axes are: {', '.join(every())}")
    return every()[name]
