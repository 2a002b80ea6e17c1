"""Features of the core: the functions of the engines that belong to each.

Each package here is a feature, with the name of the engines' function. It has TOP, the module of rtl/ that
engines rtl and gate build for it, and BLOCKS, the blocks in TOP. Its module ``engines``, loaded on use, has
ENGINES, {engine of meissner.names.EVERY: its function}. The other features' functions are in the engines.
"""

from collections.abc import Callable
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

from meissner.engines import load

FEATURES = {found.name: import_module(f"{__name__}.{found.name}") for found in iter_modules(__path__)}
# {function of an engine (meissner.engines.protocol): its feature}
FEATURE_OF = {
    **dict.fromkeys(("watch", "watch_pins", "windows"), "slip"),
    **{"cop": "cop", "cop4": "cop4", "cop_slip": "cop_slip", "demodulate": "demod", "calibrate": "calibrate"},
    **{name: name for name in FEATURES},
}


def of(name: str) -> dict[str, Callable[..., Any]]:
    """{engine: its function for the feature}."""
    return import_module(f"{__name__}.{name}.engines").ENGINES


def function(engine: str, name: str, *otherwise: Callable[..., Any] | None) -> Callable[..., Any]:
    """An engine's function of that name; without one, ``otherwise`` or AttributeError."""
    found = load(engine)  # refuses an engine that cannot run here
    if name in FEATURES:
        return of(name)[engine]
    return getattr(found, name, *otherwise)
