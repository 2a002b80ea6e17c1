"""Types of arrays in signatures."""

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Values = float | Floats  # a number, or one for each
V = TypeVar("V", float, Floats)  # a number gives a number, an array an array
Arrays = dict[str, NDArray[Any]]  # by name, as in a .npz file
