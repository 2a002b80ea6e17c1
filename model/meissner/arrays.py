"""Types of arrays in signatures, and the check of the numbers in them."""

from collections.abc import Callable
from functools import wraps
from inspect import signature
from threading import local
from typing import Any, ParamSpec, TypeVar

import numpy as np
from numpy.typing import NDArray

Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Values = float | Floats  # a number, or one for each
V = TypeVar("V", float, Floats)  # a number gives a number, an array an array
Arrays = dict[str, NDArray[Any]]  # by name, as in a .npz file

LARGEST = 1e12  # size of any force, voltage, length, time or frequency
P = ParamSpec("P")
R = TypeVar("R")


def check_finite(name: str, value: object) -> None:
    """ValueError unless every number of ``value`` is at most LARGEST in size; what is no number passes."""
    if isinstance(value, list | tuple):
        for each in value:
            check_finite(name, each)
    elif isinstance(value, int | float | complex | np.number):
        size: Any = abs(value)
        if not size <= LARGEST:
            shown = value if isinstance(value, int) else f"{value:g}"
            raise ValueError(f"{name} = {str(shown)[:40]} must be a number of at most {LARGEST:g} in size")
    elif isinstance(value, np.ndarray) and value.dtype.kind in "iufc":
        check_finite(f"the largest of {name}", np.abs(value).max(initial=0))


class _Depth(local):
    """Whether this thread is in a checked function."""

    within = False


_DEPTH = _Depth()


def finite(function: Callable[P, R]) -> Callable[P, R]:
    """``function`` whose arguments are checked first (``check_finite``), all but a seed. Calls from within
    another checked function are not checked again."""
    names = list(signature(function).parameters)

    @wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> R:
        if _DEPTH.within:
            return function(*args, **kwargs)
        for name, value in (*zip(names, args), *kwargs.items()):
            if name != "seed":
                check_finite(name, value)
        _DEPTH.within = True
        try:
            return function(*args, **kwargs)
        finally:
            _DEPTH.within = False

    return checked
