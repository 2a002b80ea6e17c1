"""Checks of what enters the core, the same for engines, commands and the public interface.

Each returns the array in the core's integers, or raises ValueError with one sentence. Files hold whole
numbers as floats, too; with ``floats`` False only arrays of integers (or bool) pass.
"""

from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meissner.terminal import sides
from meissner.twins.slip.config import MAX_CHANNELS, SAMPLE_BITS

MAX_SIDE = 1024  # rows, columns
MAX_FORCE = 65535
CODE_LIMIT = 1 << SAMPLE_BITS - 1  # codes lie in -CODE_LIMIT .. CODE_LIMIT - 1


def check_kind(x: ArrayLike, what: str, floats: bool = True) -> NDArray[Any]:
    """``x`` as an array of numbers."""
    x = np.asarray(x)
    if x.dtype.kind not in ("iufb" if floats else "iub"):
        raise ValueError(f"the {what} must be integers, not {x.dtype}")
    return x


def check_range(x: NDArray[Any], limit: int = CODE_LIMIT) -> None:
    """Raise ValueError unless the samples ``x``, which may be none, lie in -limit .. limit - 1."""
    if x.size and (x.min() < -limit or x.max() >= limit):
        raise ValueError(f"the samples lie in {x.min()} .. {x.max()}, outside -{limit} .. {limit - 1}")


def _whole(x):
    """The non-empty ``x`` if every number in it is an integer; ValueError if not."""
    if x.dtype.kind == "f":
        x = x.astype(np.float64)  # float16 is too narrow for the limits
        if not np.isfinite(x).all():
            raise ValueError("the samples hold NaN or infinity; the core takes integer codes only")
        if (x != np.rint(x)).any():
            raise ValueError(
                "the samples hold numbers that are not integers; the core takes codes, not volts"
            )
    return x


def check_samples(x: ArrayLike) -> NDArray[np.int64]:
    """``x`` as int64 [channels, samples]."""
    x = check_kind(x, "samples")
    if x.ndim == 1:
        x = x[None]
    if x.ndim != 2 or 0 in x.shape:
        raise ValueError(f"the samples must have the shape [samples] or [channels, samples], not {x.shape}")
    if len(x) > MAX_CHANNELS:
        raise ValueError(
            f"{len(x)} channels are more than the core's {MAX_CHANNELS}; is the array transposed?"
        )
    x = _whole(x)
    check_range(x)
    return x.astype(np.int64, copy=False)


def check_forces(x: ArrayLike, floats: bool = True) -> NDArray[np.uint16]:
    """``x`` as uint16 [frames, rows, columns]."""
    x = check_kind(x, "forces", floats)
    if x.ndim != 3 or 0 in x.shape:
        raise ValueError(f"the forces must have the shape [frames, rows, columns], not {x.shape}")
    for count, what in zip(x.shape[1:], ("rows", "columns")):
        if count > MAX_SIDE:
            raise ValueError(f"{count} {what} are more than the core's {MAX_SIDE}")
    x = _whole(x)
    if x.min() < 0 or x.max() > MAX_FORCE:
        raise ValueError(f"the forces lie in {x.min():g} .. {x.max():g}, outside 0 .. {MAX_FORCE}")
    return x.astype(np.uint16, copy=False)


def check_codes(
    codes: ArrayLike, shape: tuple[int, ...] | None = None, floats: bool = True
) -> NDArray[np.int32]:
    """``codes`` as int32 [frames, rows, columns]; ``shape``: rows and columns of a calibration."""
    codes = check_kind(codes, "codes", floats)
    if codes.ndim != 3 or 0 in codes.shape:
        raise ValueError(f"the codes must have the shape [frames, rows, columns], not {codes.shape}")
    if shape is not None and codes.shape[1:] != shape:
        raise ValueError(
            f"the codes have {sides(codes.shape[1:])} cells but the calibration has {sides(shape)}"
        )
    if codes.dtype.kind == "f" and not (np.isfinite(codes).all() and (codes == np.rint(codes)).all()):
        raise ValueError("the codes hold NaN, infinity or numbers that are not integers")
    if codes.min() < -CODE_LIMIT or codes.max() >= CODE_LIMIT:
        raise ValueError(
            f"the codes lie in {codes.min():g} .. {codes.max():g}, outside {-CODE_LIMIT} .. {CODE_LIMIT - 1}"
        )
    return codes.astype(np.int32)


def check_electrodes(x: ArrayLike, bits: int, floats: bool = True) -> NDArray[np.int64]:
    """``x`` as int64 [samples, 4] if these can be codes of a converter of ``bits``."""
    x = check_kind(x, "codes", floats)
    if x.ndim != 2 or x.shape[1] != 4 or not len(x):
        raise ValueError(f"the codes of E1 to E4 must have the shape [samples, 4], not {x.shape}")
    x = _whole(x)
    limit = 1 << bits - 1
    if x.min() < -limit or x.max() >= limit:
        raise ValueError(
            f"the codes lie in {x.min():.0f} .. {x.max():.0f}, outside -{limit} .. {limit - 1} of {bits} bits"
        )
    return x.astype(np.int64, copy=False)


def check_min_load(
    min_load: int, rows: int = MAX_SIDE, columns: int = MAX_SIDE, name: str = "min_load"
) -> int:
    """``min_load`` if the register of an array of that size holds it; by default, of the largest array."""
    from meissner.twins.cop.cop import sum_bits  # here: other cores have no sum

    if not isinstance(min_load, Integral):
        raise ValueError(f"{name} = {min_load} must be an integer")
    limit = 1 << sum_bits(rows, columns)
    if not 0 <= min_load < limit:
        raise ValueError(f"{name} = {min_load} must lie in 0 .. {limit - 1} for this array")
    return int(min_load)
