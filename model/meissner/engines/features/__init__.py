"""Features of the core that engines run: each is a package here, with the name of the engines' function.

A package has TOP, the module of rtl/ that engines rtl and gate build for it, and BLOCKS, the blocks in TOP.
Its module ``engines``, loaded on use, has ENGINES, {engine of meissner.names.EVERY: its function}.
"""

from importlib import import_module
from pkgutil import iter_modules

FEATURES = {found.name: import_module(f"{__name__}.{found.name}") for found in iter_modules(__path__)}


def of(name):
    """{engine: its function for the feature}."""
    return import_module(f"{__name__}.{name}.engines").ENGINES
