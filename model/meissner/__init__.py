"""Meissner: an open FPGA core for touch, its bit-exact twins and the physics it is judged on.

    Slip, Cop, Cop4, Array     the core's computations on a stream: ``process(x)``, ``next(x)``
    SlipConfig                 the settings of a slip detector
    Cop4Config                 a four-wire sensor: mesh, amplifiers, converter
    Calibration                a straight line per cell of an array
    read                       a recording of any kind, its channels, unit and rate; each class takes it, too
    Forest                     a trained forest as the core decides: ``predict(X)``, in scikit-learn's place

Each is imported on first use, so that the command line starts quickly.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from meissner.calibration import Calibration
    from meissner.forest.forest import Forest
    from meissner.physics.cop4_config import Cop4Config
    from meissner.readers import read
    from meissner.sense import Array, Cop, Cop4, Slip
    from meissner.twins.slip.config import SlipConfig

    __version__: str

__all__ = ["Array", "Calibration", "Cop", "Cop4", "Cop4Config", "Forest", "Slip", "SlipConfig", "read"]
_MODULES = dict.fromkeys(("Array", "Cop", "Cop4", "Slip"), "meissner.sense") | {
    "Calibration": "meissner.calibration",
    "Cop4Config": "meissner.physics.cop4_config",
    "Forest": "meissner.forest.forest",
    "SlipConfig": "meissner.twins.slip.config",
    "read": "meissner.readers",
}


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        return getattr(import_module(_MODULES[name]), name)
    if name != "__version__":
        raise AttributeError(f"module 'meissner' has no attribute {name!r}")
    from importlib.metadata import PackageNotFoundError, version

    from meissner.names import DISTRIBUTION

    try:
        return version(DISTRIBUTION)
    except PackageNotFoundError:  # a source tree that is not installed
        return "0+source"


def __dir__() -> list[str]:
    return [*globals(), *__all__, "__version__"]
