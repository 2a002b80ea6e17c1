"""Features of the core that engines run, each a module here, found by its name, as the function is called.

A module has TOP, the module of rtl/ that engines rtl and gate build for it; BLOCKS, what is in that; and
ENGINES, {engine of meissner.names.EVERY: its function}.
"""

from importlib import import_module
from pkgutil import iter_modules

FEATURES = {found.name: import_module(f"{__name__}.{found.name}") for found in iter_modules(__path__)}
