"""Features of the core that engines run, each a package here, found by its name, as the function is called.

A package has TOP, the module of rtl/ that engines rtl and gate build for it, and BLOCKS, what is in that. Its
module ``engines`` has ENGINES, {engine of meissner.names.EVERY: its function}: loaded where it runs.
"""

from importlib import import_module
from pkgutil import iter_modules

FEATURES = {found.name: import_module(f"{__name__}.{found.name}") for found in iter_modules(__path__)}


def of(name):
    """{engine: what it runs for the feature}."""
    return import_module(f"{__name__}.{name}.engines").ENGINES
