"""Calibration of an array: a straight line per cell, fitted to a press recording, in the core's integers.

    code = slope·force + intercept                                 least squares, per cell
    F    = clamp(round_half_up((code - offset)·gain / 2^gain_shift), 0, 65535)     0 for a dead cell

with offset = intercept rounded and gain = 2^gain_shift / (slope·force_lsb_n) rounded, so that one code of F
is ``force_lsb_n`` newtons.
"""

from dataclasses import dataclass
from numbers import Integral
from os import PathLike
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from meissner import files
from meissner.inputs import CODE_LIMIT, MAX_FORCE, MAX_SIDE, check_codes
from meissner.terminal import plain

GAIN_LIMIT = 1 << 16
GAIN_SHIFT = 12
LEVELS, LEVEL_SHARE = 3, 0.1  # forces needed per cell, and their distance as a share of the largest
HEADROOM = 1.5  # the range of F over the largest force of the recording
LEAST_SLOPE, LEAST_FIT = 0.1, 0.8  # dead below this share of the median slope, or of explained variance
NAMED_CELLS = 20
_TABLES = (("offset", "iu", "integers"), ("gain", "iu", "integers"), ("dead", "b", "of bool"))


@dataclass(frozen=True, eq=False)
class Calibration:
    """The tables of msn_calibrate; ``offset``, ``gain`` integers and ``dead`` bool [rows, columns].

    ``force_lsb_n``: newtons per code of F. ValueError with one sentence for tables that no core holds.
    """

    offset: NDArray[np.integer]
    gain: NDArray[np.integer]
    gain_shift: int
    dead: NDArray[np.bool_]
    force_lsb_n: float

    def __post_init__(self) -> None:
        for name, kinds, must in _TABLES:
            table = getattr(self, name)
            if not isinstance(table, np.ndarray):
                raise ValueError(f"{name} must be an array, not {type(table).__name__}")
            if table.dtype.kind not in kinds:
                raise ValueError(f"{name} must be {must}, not {table.dtype}")
        shape = self.offset.shape
        if len(shape) != 2 or 0 in shape or not shape == self.gain.shape == self.dead.shape:
            raise ValueError("offset, gain and dead must have one shape [rows, columns]")
        if not (self.offset.min() >= -CODE_LIMIT and self.offset.max() < CODE_LIMIT):
            raise ValueError(f"the offsets must lie in {-CODE_LIMIT} .. {CODE_LIMIT - 1}")
        if not (self.gain.min() >= 0 and self.gain.max() < GAIN_LIMIT):
            raise ValueError(f"the gains must lie in 0 .. {GAIN_LIMIT - 1}")
        if not isinstance(self.gain_shift, Integral) or not 1 <= self.gain_shift <= 16:
            raise ValueError(f"gain_shift = {self.gain_shift} must lie in 1 .. 16")
        if not 0 < self.force_lsb_n < np.inf:
            raise ValueError(f"force_lsb_n = {self.force_lsb_n:g} must be newtons above 0")

    def save(self, file: IO[bytes]) -> None:
        """Write this calibration as .npz to an open file."""
        np.savez(
            file,
            offset=self.offset,
            gain=self.gain,
            gain_shift=np.int32(self.gain_shift),
            dead=self.dead,
            force_lsb_n=np.float64(self.force_lsb_n),
        )


def _arrays(path, wanted):
    """The ``wanted`` arrays of a .npz file (files.read_arrays); ValueError if it is not such a file."""
    path = files.check_in(path)
    arrays = files.read_arrays(path, wanted)
    if arrays is None:
        raise ValueError(f"{path} is not a .npz file of arrays")
    return arrays


def load(path: str | PathLike[str]) -> Calibration:
    """The Calibration in a file that ``meissner calibrate`` wrote.

    ValueError with one sentence if there is no such file or it is not a calibration.
    """
    names = ("offset", "gain", "gain_shift", "dead", "force_lsb_n")

    def wanted(name, shape, _):
        if name in names and (len(shape) > 2 or max(shape, default=0) > MAX_SIDE):
            size = "×".join(map(str, shape))
            raise files.Unwanted(
                f"{path} is not a calibration: {name} is {size}, beyond {MAX_SIDE}×{MAX_SIDE}"
            )
        return name in names

    arrays = _arrays(path, wanted)
    for name in names:
        if name not in arrays:
            raise ValueError(f"{path} is not a calibration: it has no {name}")
    try:
        for name, kinds, must in (*_TABLES, ("gain_shift", "iu", "integers")):
            if arrays[name].dtype.kind not in kinds:
                raise ValueError(f"{name} must be {must}, not {arrays[name].dtype}")
        if arrays["gain_shift"].ndim or arrays["force_lsb_n"].ndim:
            raise ValueError("gain_shift and force_lsb_n must be single numbers")
        if arrays["force_lsb_n"].dtype.kind not in "iuf":
            raise ValueError(f"force_lsb_n must be newtons, not {arrays['force_lsb_n'].dtype}")
        return Calibration(
            offset=arrays["offset"].astype(np.int64),
            gain=arrays["gain"].astype(np.int64),
            gain_shift=int(arrays["gain_shift"]),
            dead=arrays["dead"],
            force_lsb_n=float(arrays["force_lsb_n"]),
        )
    except ValueError as problem:
        raise ValueError(f"{path} is not a calibration: {problem}") from None


def cell_forces(force_n, shape, probed=None):
    """Newtons on every cell [frames, rows, columns], NaN where unknown.

    ``force_n``: [frames, rows, columns], or [frames]: on every cell, or on the ``probed`` cell (row, column)
    of each frame, whose neighbours are then unknown; ``probed`` -1: nothing presses in that frame.
    """
    force_n = np.asarray(force_n)
    if force_n.dtype.kind not in "iuf":
        raise ValueError(f"the forces must be numbers, not {force_n.dtype}")
    force_n = force_n.astype(float)
    frames, rows, columns = shape
    if force_n.shape not in ((frames,), shape):
        raise ValueError(
            f"force_n must have the shape [{frames}] or [{frames}, {rows}, {columns}] as the codes have, "
            f"not {force_n.shape}"
        )
    if np.isinf(force_n).any() or (force_n < 0).any() or (force_n.ndim == 1 and np.isnan(force_n).any()):
        raise ValueError("the forces must be finite newtons of 0 or more")
    if probed is None:
        return np.broadcast_to(force_n if force_n.ndim == 3 else force_n[:, None, None], shape)
    probed = np.asarray(probed)
    if force_n.ndim == 3:
        raise ValueError("probed needs one force per frame, not one per cell")
    if probed.dtype.kind not in "iu" or probed.shape != (frames, 2):
        raise ValueError(f"probed must be integers of the shape [{frames}, 2]: row and column of each frame")
    nothing = (probed == -1).all(axis=1)
    if ((probed < 0) | (probed >= (rows, columns))).any(axis=1)[~nothing].any():
        raise ValueError(f"probed names cells outside {rows}×{columns}")
    if force_n[nothing].any():
        raise ValueError("probed has -1 in a frame with a force")
    known = np.full(shape, np.nan)
    known[nothing] = 0.0
    touched = np.flatnonzero(~nothing)
    known[touched, *probed[touched].T] = force_n[touched]
    return known


def read_recording(path, force_path=None):
    """(codes, newtons on every cell) of a press recording; ValueError with one sentence if it is invalid.

    A .npz file with ``codes``, ``force_n`` and optionally ``probed``, or two .npy files with codes and forces
    (see cell_forces).
    """
    path = Path(path)
    if path.suffix.lower() == ".npz":
        if force_path is not None:
            raise ValueError(f"{path} already contains forces: omit --force")
        names = ("codes", "force_n", "probed")
        arrays = _arrays(path, lambda name, *_: name in names)
        for name in names[:2]:
            if name not in arrays:
                raise ValueError(f"{path} is not a press recording: it has no {name}")
        codes, force_n, probed = arrays["codes"], arrays["force_n"], arrays.get("probed")
    else:
        if force_path is None:
            raise ValueError(f"{path} contains only codes: give the forces with --force, or use a .npz file")
        codes, probed = files.read_array(path), None
        force_n = files.read_array(force_path)
        if Path(force_path).suffix.lower() == ".csv" and len(force_n) == 1:
            force_n = force_n[0]
    codes = check_codes(codes)
    return codes, cell_forces(force_n, codes.shape, probed)


def named(cells):
    """Cells of a mask [rows, columns] as text."""
    places = [f"({row}, {column})" for row, column in np.argwhere(cells)]
    rest = len(places) - NAMED_CELLS
    return ", ".join(places[:NAMED_CELLS]) + (f" and {rest} more" if rest > 0 else "")


def _check_presses(force_n, known):
    """Raise ValueError naming the cells that were pressed with too few different forces."""
    largest = np.max(force_n, where=known, initial=0.0)
    if largest <= 0:
        raise ValueError("nothing presses in the recording: every force is 0")
    level = np.min(force_n, axis=0, where=known, initial=np.inf)
    for _ in range(LEVELS - 1):
        higher = known & (force_n >= level + (LEVEL_SHARE - 1e-9) * largest)
        level = np.min(force_n, axis=0, where=higher, initial=np.inf)
    if np.isinf(level).any():
        few = np.isinf(level)
        count = int(few.sum())
        raise ValueError(
            f"too few presses for {count} cell{'s' * (count > 1)} (row, column): {named(few)}; each needs "
            f"{LEVELS} forces, of which one may be 0, at least {LEVEL_SHARE * largest:.3g} N apart"
        )
    return largest


def _round_up_125(value):
    """The smallest of 1, 2, 5 times a power of ten that is not below ``value``."""
    power = 10.0 ** np.floor(np.log10(value))
    return next(step * power for step in (1, 2, 5, 10) if step * power >= value * (1 - 1e-12))


def line(codes, force_n):
    """Slope (codes per newton), intercept (codes) and share of explained variance of each cell.

    ``codes``, ``force_n`` [frames, rows, columns], NaN where unknown; slope 0 where the forces do not vary.
    """
    known = ~np.isnan(force_n)
    count = np.maximum(known.sum(axis=0), 1)
    force = np.where(known, force_n, 0.0)
    code = np.where(known, codes, 0.0)
    mean_force, mean_code = force.sum(axis=0) / count, code.sum(axis=0) / count
    force, code = (np.where(known, a - mean, 0.0) for a, mean in ((force, mean_force), (code, mean_code)))
    ff, fc, cc = (np.einsum("fij,fij->ij", a, b) for a, b in ((force, force), (force, code), (code, code)))
    slope = np.divide(fc, ff, out=np.zeros_like(ff), where=ff > 0)
    explained = np.divide(fc**2, ff * cc, out=np.zeros_like(ff), where=ff * cc > 0)
    return slope, mean_code - slope * mean_force, explained


def fit(
    codes: NDArray[np.integer],
    force_n: NDArray[np.floating],
    lsb_n: float | None = None,
    gain_shift: int = GAIN_SHIFT,
) -> tuple[Calibration, NDArray[np.float64]]:
    """The Calibration of a press recording, and its residual: rms newtons of each cell, NaN where dead.

    ``codes``: integers; ``force_n``: newtons on every cell, NaN where unknown; both [frames, rows, columns].
    ``lsb_n``: newtons per code of F; by default the finest of 1, 2, 5 times a power of ten with which
    every gain fits its register and F reaches HEADROOM times the largest force. ValueError with one sentence
    if the codes of no cell rise with the force, a register cannot hold a value or there are not enough
    presses; the sentence names the cells.
    """
    known = ~np.isnan(force_n)
    largest = _check_presses(force_n, known)
    slope, intercept, explained = line(codes, force_n)
    answering = (slope > 0) & (explained >= LEAST_FIT)
    dead = ~answering
    if answering.any():
        dead |= slope < LEAST_SLOPE * np.median(slope[answering])
    if dead.all():
        raise ValueError("no cell's code rises with the force in a straight line")
    least = (1 << gain_shift) / ((GAIN_LIMIT - 1) * slope[~dead].min())
    if lsb_n is None:
        lsb_n = _round_up_125(max(least, HEADROOM * largest / MAX_FORCE))
    elif not least <= lsb_n < np.inf:
        raise ValueError(
            f"lsb = {lsb_n:g} N must be {least:.3g} N or more: a gain would not fit its register"
        )
    offset = np.where(dead, 0, np.floor(intercept + 0.5)).astype(np.int64)
    gain = np.floor((1 << gain_shift) / (np.where(dead, 1.0, slope) * lsb_n) + 0.5).astype(np.int64)
    outside = (offset < -CODE_LIMIT) | (offset >= CODE_LIMIT)
    if outside.any():
        raise ValueError(
            f"the fitted code at zero force lies outside the codes' range in the cells {named(outside)}"
        )
    answer = Calibration(
        offset=offset,
        gain=np.where(dead, 0, gain),
        gain_shift=gain_shift,
        dead=dead,
        force_lsb_n=float(lsb_n),
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        error = np.where(known, (codes - intercept) / slope - force_n, 0.0)
        residual = np.sqrt((error**2).sum(axis=0) / known.sum(axis=0))
    return answer, np.where(dead, np.nan, residual)


def command(arguments):
    """``meissner calibrate``."""
    codes, force_n = read_recording(arguments.recording, arguments.force)
    lines, residual_n = fit(codes, force_n, arguments.lsb)
    if files.check_out(arguments.out).suffix.lower() != ".npz":
        raise ValueError(f"{arguments.out} must be a .npz file")
    with files.written(arguments.out) as file:
        lines.save(file)
    frames, rows, columns = codes.shape
    dead = int(lines.dead.sum())
    print(
        f"{rows}×{columns} cells from {frames} frames, {dead or 'none'} dead; one code of force is "
        f"{lines.force_lsb_n:g} N; deviation from the line: {np.nanmedian(residual_n):.3g} N rms in the "
        f"median, {np.nanmax(residual_n):.3g} N at most; {plain(arguments.out)}"
    )
    if dead:
        print(f"dead (row, column): {named(lines.dead)}")
