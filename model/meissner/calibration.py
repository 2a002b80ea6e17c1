"""Calibration of an array: a straight line per cell, fitted to a press recording, in the core's integers.

    code = slope·force + intercept                                 least squares, per cell
    F    = clamp(round_half_up((code - offset)·gain / 2^gain_shift), 0, 65535)     0 for a dead cell

with offset = intercept rounded and gain = 2^gain_shift / (slope·force_lsb_n) rounded, so that one code of F
is ``force_lsb_n`` newtons. A cell that bends gets, besides, a table from codes to newtons for the host.
"""

from dataclasses import dataclass
from numbers import Integral
from os import PathLike
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from meissner import files, readers
from meissner.inputs import CODE_LIMIT, MAX_FORCE, MAX_SIDE, SAMPLE_BITS, check_codes
from meissner.terminal import plain, sides
from meissner.twins.frontend.calibrate import forces

GAIN_LIMIT = 1 << 16
GAIN_SHIFT = 12
LEVELS, LEVEL_SHARE = 3, 0.1  # forces needed per cell, and their distance as a share of the largest
HEADROOM = 1.5  # the range of F over the largest force of the recording
LEAST_RISE, LEAST_FIT = 0.1, 0.5  # dead below this share of the median rise, of variance explained
STRAIGHT_FIT = 0.95  # of the variance: a line that explains this much needs no other proof of a response
COARSEST_LSB, GAIN_ERROR = 0.1, 0.02  # of the largest force; of a gain, by rounding it to an integer
# A cell bends where its line misses by more than this share of the largest force, and a curve through half of
# the frames misses the other half by less than this share of what a line misses.
BENT_ERROR, BENT_GAIN = 0.02, 0.8
KNOTS = 64  # of a table
LEAST_END = 128  # of a converter without --adc-bits: 8 bits, signed
NAMED_CELLS = 20
_TABLES = (("offset", "iu", "integers"), ("gain", "iu", "integers"), ("dead", "b", "of bool"))
_KNOTS = ("knot_codes", "knot_n")


@dataclass(frozen=True, eq=False)
class Calibration:
    """The tables of msn_calibrate; ``offset``, ``gain`` integers and ``dead`` bool [rows, columns].

    ``force_lsb_n``: newtons per code of F. ``knot_codes``, ``knot_n`` [knots, rows, columns], both or none:
    codes and newtons of each bent cell's table, NaN for the others. ValueError with one sentence for tables
    that no core holds.
    """

    offset: NDArray[np.integer]
    gain: NDArray[np.integer]
    gain_shift: int
    dead: NDArray[np.bool_]
    force_lsb_n: float
    knot_codes: NDArray[np.float64] | None = None
    knot_n: NDArray[np.float64] | None = None

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
        self._check_knots()

    def _check_knots(self) -> None:
        if (self.knot_codes is None) != (self.knot_n is None):
            raise ValueError("knot_codes and knot_n must be there both, or neither")
        for name in _KNOTS:
            knots = getattr(self, name)
            if knots is None:
                return
            if not isinstance(knots, np.ndarray) or knots.dtype.kind != "f":
                raise ValueError(f"{name} must be an array of floats")
            if knots.ndim != 3 or knots.shape[1:] != self.dead.shape or not 2 <= len(knots) <= KNOTS:
                raise ValueError(f"{name} must have the shape [2 to {KNOTS}, rows, columns]")
            own = knots[:, self.bent]
            if np.isinf(own).any() or np.isnan(own).any() or (np.diff(own, axis=0) < 0).any():
                raise ValueError(f"{name} must rise in each bent cell")
        if not np.array_equal(np.isnan(self.knot_codes), np.isnan(self.knot_n)) or (self.knot_n < 0).any():
            raise ValueError("knot_codes and knot_n must be of the same cells, and no newtons below 0")

    @property
    def bent(self) -> NDArray[np.bool_]:
        """Cells with a table [rows, columns]."""
        return np.zeros_like(self.dead) if self.knot_codes is None else ~np.isnan(self.knot_codes[0])

    def load_n(self, codes: NDArray[np.integer], total: NDArray[np.integer]) -> NDArray[np.float64]:
        """Newtons of each frame: ``total``, the core's sum of F, with the bent cells by their tables."""
        found = total * self.force_lsb_n
        for cell in np.argwhere(self.bent):
            own = codes[:, *cell]
            offset, gain = self.offset[*cell], self.gain[*cell]
            found -= forces(own, offset, gain, self.gain_shift) * self.force_lsb_n
            found += np.interp(own, self.knot_codes[:, *cell], self.knot_n[:, *cell])
        return found

    def save(self, file: IO[bytes]) -> None:
        """Write this calibration as .npz to an open file."""
        np.savez(
            file,
            offset=self.offset,
            gain=self.gain,
            gain_shift=np.int32(self.gain_shift),
            dead=self.dead,
            force_lsb_n=np.float64(self.force_lsb_n),
            **{name: getattr(self, name) for name in _KNOTS if self.knot_codes is not None},
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
        dimensions = 3 if name in _KNOTS else 2
        wanted = name in (*names, *_KNOTS)
        if wanted and (len(shape) > dimensions or max(shape, default=0) > MAX_SIDE):
            size = sides(shape)
            raise files.Unwanted(
                f"{path} is not a calibration: {name} is {size}, beyond {MAX_SIDE}×{MAX_SIDE}"
            )
        return wanted

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
            **{name: arrays.get(name) for name in _KNOTS},
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


def read_recording(path, force_path=None, volts_per_code=None, converter=None, **given):
    """(codes, newtons on every cell, what was taken) of a press recording; ValueError with one sentence.

    Arrays ``codes``, ``force_n`` and optionally ``probed``; or codes of any file, with the forces in another
    or in a column in N (see cell_forces). ``given``: column, unit and shape of meissner.readers.read.
    """
    names = ("codes", "force_n", "probed")
    arrays = {one.name: one for one in readers.table(path, (*names, *(given.get("column") or ()))).columns}
    if names[0] in arrays:
        if force_path is not None and names[1] in arrays:
            raise ValueError(f"{path} already contains forces: omit --force")
        if names[1] not in arrays and force_path is None:
            raise ValueError(f"{path} is not a press recording: it has no {names[1]}")
        codes, probed = arrays[names[0]].values, arrays.get(names[2])
        force_n, probed = arrays.get(names[1]), None if probed is None else probed.values
        said = f"{path}: arrays {', '.join(name for name in names if name in arrays)}"
    else:
        if Path(path).suffix.lower() == ".npz":
            raise ValueError(f"{path} is not a press recording: it has no codes")
        force_n, probed = next((one for one in arrays.values() if one.unit == "N"), None), None
        if force_n is not None and not given.get("column"):
            others = [one.name for one in arrays.values() if one.unit != "N" and not one.is_time]
            given["column"] = [name for name in others if not arrays[name].is_index]
        if force_n is None and force_path is None:
            raise ValueError(
                f"{path} contains only codes: give the forces with --force, or in a column in N, or use a "
                "file "
                "with the arrays codes and force_n"
            )
        found = readers.read(path, **given)
        codes, done = found.scaled(volts_per_code, converter)
        said = f"{found.said}; {done}"
    if force_path is not None:
        other = readers.read(force_path)
        force_n = other.values[0] if other.values.ndim == 2 and len(other.values) == 1 else other.values
        said += f"; forces of {other.said}"
    else:
        force_n = force_n.values
    codes = check_codes(codes)
    return codes, cell_forces(force_n, codes.shape, probed), said


def named(cells):
    """Cells of a mask [rows, columns] as text."""
    places = [f"({row}, {column})" for row, column in np.argwhere(cells)]
    rest = len(places) - NAMED_CELLS
    return ", ".join(places[:NAMED_CELLS]) + (f" and {rest} more" if rest > 0 else "")


def _levels(force_n, known, step):
    """Whether each cell [rows, columns] has LEVELS known forces, ``step`` or more apart."""
    level = np.min(force_n, axis=0, where=known, initial=np.inf)
    for _ in range(LEVELS - 1):
        higher = known & (force_n >= level + step)
        level = np.min(force_n, axis=0, where=higher, initial=np.inf)
    return ~np.isinf(level)


def _check_presses(force_n, known, at_end):
    """(Largest force, cells with enough presses), without those ``at_end`` of the converter.

    ValueError naming the cells that were pressed with too few different forces.
    """
    largest = np.max(force_n, where=known & ~at_end, initial=0.0)
    if largest <= 0:
        where = "below the converter's end " if at_end.any() else ""
        raise ValueError(f"nothing presses {where}in the recording: every force is 0")
    step = (LEVEL_SHARE - 1e-9) * largest
    few = ~_levels(force_n, known, step)
    enough = _levels(force_n, known & ~at_end, step)
    if few.any() or not enough.any():
        few = few if few.any() else ~enough
        count = int(few.sum())
        more = " below the converter's end (--adc-bits)" if at_end.any() else ""
        raise ValueError(
            f"too few presses{more} for {count} cell{'s' * (count > 1)} (row, column): {named(few)}; each "
            f"needs {LEVELS} forces, of which one may be 0, at least {LEVEL_SHARE * largest:.3g} N apart"
        )
    return largest, enough


def ends(codes, bits=None):
    """The codes at which a converter of ``bits`` has its ends, (lowest or None, highest or None).

    An unsigned code of 0 is no end: it is where an unpressed cell may rest. Without ``bits``: extremes of the
    recording that are such codes. ValueError for codes that a converter of ``bits`` does not have.
    """
    least, most = int(codes.min()), int(codes.max())
    if bits is None:
        full = lambda value: value >= LEAST_END and not value & value - 1
        return (least if full(-least) else None), (most if full(most + 1) or most + 1 == LEAST_END else None)
    if not 1 <= bits <= SAMPLE_BITS:
        raise ValueError(f"adc-bits = {bits} must lie in 1 .. {SAMPLE_BITS}")
    top = 1 << bits - (least < 0)
    low = -top if least < 0 else 0
    if least < low or most >= top:
        raise ValueError(f"the codes lie in {least} .. {most}, outside {low} .. {top - 1} of {bits} bits")
    return (low or None), top - 1


def at_ends(codes, low=None, high=None):
    """Readings at the converter's ``ends``, which are not true."""
    return (codes <= (-np.inf if low is None else low)) | (codes >= (np.inf if high is None else high))


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


def _best(x, y):
    """(Values of ``x``, place of each in them, the non-falling curve of ``y`` over them that fits best)."""
    from scipy.optimize import isotonic_regression  # here: what reads a calibration needs no SciPy

    values, place, count = np.unique(x, return_inverse=True, return_counts=True)
    return values, place, isotonic_regression(np.bincount(place, y) / count, weights=count)


def _rising(codes, force):
    """(Lowest code, highest code, share of variance explained) of a cell's best non-falling curve.

    The share is corrected for the curve's own freedom; 1 if every reading rises.
    """
    levels, place, curve = _best(force, codes)
    spread = ((codes - codes.mean()) ** 2).sum()
    left = ((codes - curve.x[place]) ** 2).sum()
    blocks = len(curve.blocks) - 1
    if not spread or len(levels) < LEVELS or blocks < 2:
        return 0.0, 0.0, 0.0
    free = len(codes) - blocks
    share = 1 - (left / free) / (spread / (len(codes) - 1)) if free else 1.0
    return curve.x[0], curve.x[-1], share


def _curve(codes, force):
    """Codes and newtons of the non-falling curve of force over code that fits best."""
    own, _, curve = _best(codes, force)
    return own, curve.x


def _table(codes, force):
    """Knots (codes, newtons) of ``_curve``, with the recording's own ends.

    The lowest code reads the smallest force and the highest the largest, also where a range of forces gives
    that code.
    """
    own, newtons = _curve(codes, force)
    # Means of pooled readings, whose last bits may be off.
    newtons = np.clip(newtons, force.min(), force.max())
    newtons[[0, -1]] = force.min(), force.max()
    turns = np.diff(newtons, prepend=-1.0, append=np.inf) > 0  # inside a level stretch no knot is needed
    knots = np.array([own, newtons])[:, turns[:-1] | turns[1:]]
    if len(knots[0]) > KNOTS:
        knots = knots[:, np.linspace(0, len(knots[0]) - 1, KNOTS).round().astype(int)]
    return np.pad(knots, ((0, 0), (0, KNOTS - len(knots[0]))), mode="edge")


def _rms(error, known):
    """Root mean square of each cell's known errors [frames, ...]."""
    return np.sqrt((np.where(known, error, 0.0) ** 2).sum(axis=0) / np.maximum(known.sum(axis=0), 1))


def _bends(codes, force):
    """Whether a curve of force over code describes a cell better than the best straight one.

    The curve through every second reading, in the order of force, is compared with the others, and the other
    way round, so that one that only follows the noise is none.
    """
    order = np.argsort(force, kind="stable")
    codes, force = codes[order], force[order]
    straight = force - np.polyval(np.polyfit(codes, force, 1), codes)
    missed = np.empty(len(force))
    for half in (0, 1):
        known = np.arange(len(force)) % 2 == half
        known[[0, -1]] = True
        other = np.arange(len(force)) % 2 != half
        missed[other] = np.interp(codes[other], *_curve(codes[known], force[known])) - force[other]
    return (missed[1:-1] ** 2).mean() < BENT_GAIN**2 * (straight[1:-1] ** 2).mean()


def _gains(slope, largest, lsb_n, gain_shift):
    """(Newtons per code of F, ``lsb_n`` or the finest that fits; gains of the cells with a ``slope``, not 0).

    ValueError, with a value that fits, if rounding or a register's width would make F wrong.
    """
    one, live = 1 << gain_shift, slope > 0
    least = one / ((GAIN_LIMIT - 1) * slope[live].min())
    finest = _round_up_125(max(least, HEADROOM * largest / MAX_FORCE))
    lsb = finest if lsb_n is None else lsb_n
    fits = "" if lsb_n is None or lsb_n == finest else f"; --lsb {finest:g} fits"
    if not 0 < lsb < np.inf:
        raise ValueError(f"lsb = {lsb:g} N must be newtons above 0{fits}")
    exact = np.divide(one, slope * lsb, out=np.zeros_like(slope), where=live)
    gain = np.floor(exact + 0.5).astype(np.int64)
    coarse = np.abs(gain - exact) > GAIN_ERROR * exact
    if lsb < least:
        raise ValueError(f"lsb = {lsb:g} N must be {least:.3g} N or more: a gain would not fit{fits}")
    if lsb * MAX_FORCE < largest:
        raise ValueError(
            f"lsb = {lsb:g} N reaches {lsb * MAX_FORCE:.4g} N, the recording {largest:g} N{fits}"
        )
    if lsb > COARSEST_LSB * largest:
        raise ValueError(f"lsb = {lsb:g} N is too coarse for forces up to {largest:g} N{fits}")
    if coarse.any():
        raise ValueError(
            f"lsb = {lsb:g} N is too coarse: a gain of {exact[coarse].min():.3g} is rounded by more than "
            f"{100 * GAIN_ERROR:g} % in cells (row, column): {named(coarse)}{fits}"
        )
    return float(lsb), gain


def fit(
    codes: NDArray[np.integer],
    force_n: NDArray[np.floating],
    lsb_n: float | None = None,
    gain_shift: int = GAIN_SHIFT,
    low: int | None = None,
    high: int | None = None,
) -> tuple[Calibration, NDArray[np.float64]]:
    """The Calibration of a press recording, and the deviation of F from its forces: rms newtons of each cell,
    with the rounded offset, gain and F of the core, NaN where dead.

    ``codes``: integers; ``force_n``: newtons on every cell, NaN where unknown; both [frames, rows, columns].
    ``lsb_n``: newtons per code of F; by default the finest of 1, 2, 5 times a power of ten with which
    every gain fits its register and F reaches HEADROOM times the largest force. ``low``, ``high``: codes at
    the converter's ends (``ends``); readings there are left out. A cell is dead that does not respond: its
    code does not rise with the force, or by less than LEAST_RISE of the median cell that does; or whose
    presses are at the converter's end, but for too few. ValueError with one sentence if no cell responds, a
    register cannot hold a value or there are not enough presses; the sentence names the cells.
    """
    known, at_end = ~np.isnan(force_n), at_ends(codes, low, high)
    largest, enough = _check_presses(force_n, known, at_end)
    known &= ~at_end
    force_n = np.where(known, force_n, np.nan)
    slope, intercept, explained = line(codes, force_n)
    with np.errstate(divide="ignore", invalid="ignore"):
        error_n = (codes - intercept) / slope - force_n
    rise = np.where(enough & (slope > 0) & (explained >= STRAIGHT_FIT), slope, 0.0)
    knots = np.full((2, KNOTS, *rise.shape), np.nan)
    missed = np.nan_to_num(_rms(error_n, known)) > BENT_ERROR * largest
    for cell in np.argwhere(enough & (slope > 0) & ((rise == 0) | missed)):
        at = tuple(cell)
        own = codes[known[:, *at], *at], force_n[known[:, *at], *at]
        bends = missed[at] and _bends(*own)
        if bends:
            knots[:, :, *at] = _table(*own)
        if not rise[at]:
            lowest, highest, share = _rising(*own)
            if share >= LEAST_FIT:
                rise[at] = (highest - lowest) / np.ptp(own[1])
                if bends:  # zero and full scale are right, as no line is in between
                    slope[at], intercept[at] = rise[at], lowest - rise[at] * own[1].min()
    answering = rise > 0
    if not answering.any():
        falls = (line(-codes, force_n)[0] > 0)[enough].all()
        raise ValueError(
            "no cell's code rises with the force"
            + (": all fall, and gains are positive; exchange the cell and its resistor" if falls else "")
        )
    dead = rise < LEAST_RISE * np.median(rise[answering])
    lsb_n, gain = _gains(np.where(dead, 0, slope), largest, lsb_n, gain_shift)
    offset = np.where(dead, 0, np.floor(intercept + 0.5)).astype(np.int64)
    outside = (offset < -CODE_LIMIT) | (offset >= CODE_LIMIT)
    if outside.any():
        raise ValueError(
            f"the fitted code at zero force lies outside the codes' range in the cells {named(outside)}"
        )
    knots[:, :, dead] = np.nan
    answer = Calibration(
        offset=offset,
        gain=gain,
        gain_shift=gain_shift,
        dead=dead,
        force_lsb_n=lsb_n,
        **(dict(zip(_KNOTS, knots)) if not np.isnan(knots).all() else {}),
    )
    found_n = forces(codes, offset, gain, gain_shift) * lsb_n
    return answer, np.where(dead, np.nan, _rms(found_n - force_n, known))


def _besides(codes, force_n, lines, low, high):
    """Sentences about cells and readings that are not on a line."""
    known, at_end = ~np.isnan(force_n), at_ends(codes, low, high)
    still = np.ptp(codes, axis=0) == 0
    left_out = known & at_end & ~still
    usable = known & ~at_end
    over = lines.dead & ~still & ~_levels(force_n, usable, LEVEL_SHARE * force_n[usable].max())
    if left_out.any():
        which = " or ".join(str(code) for code in (low, high) if code is not None)
        yield (
            f"left out: {int(left_out.sum())} readings at the converter's end, code {which}, from "
            f"{force_n[left_out].min():g} N on"
        )
    if over.any():
        yield f"masked, with too few presses below the converter's end (row, column): {named(over)}"
    if lines.bent.any():
        places = [tuple(cell) for cell in np.argwhere(lines.bent)]
        read = [np.interp(codes[:, *at], lines.knot_codes[:, *at], lines.knot_n[:, *at]) for at in places]
        wrong = [_rms(found - force_n[:, *at], usable[:, *at]) for found, at in zip(read, places)]
        yield (
            f"{len(places)} cells bend: load_n of `process cop` reads their tables, which deviate by "
            f"{np.median(wrong):.3g} N rms in the median, {max(wrong):.3g} N at most"
        )
    if (lines.dead & ~over).any():
        yield f"dead (row, column): {named(lines.dead & ~over)}"


def command(arguments, converter=None, shape=None):
    """``meissner calibrate`` with the converter and the shape of its configuration."""
    given = {name: getattr(arguments, name) for name in ("column", "unit", "rate")}
    given["shape"] = arguments.shape or shape
    codes, force_n, said = read_recording(
        arguments.recording, arguments.force, arguments.volts_per_code, converter, **given
    )
    if shape is not None and codes.shape[1:] != shape:
        raise ValueError(
            f"{arguments.recording} has {sides(codes.shape[1:])} cells and {arguments.config} {sides(shape)} "
            "taxels"
        )
    if converter is None or arguments.adc_bits is not None:
        low, high = ends(codes, arguments.adc_bits)
    else:
        low, high = converter.min_code or None, converter.max_code
        if codes.min() < converter.min_code or codes.max() > high:
            raise ValueError(
                f"the codes lie in {codes.min()} .. {codes.max()}, outside {converter.min_code} .. {high} of "
                f"the converter of {arguments.config}"
            )
    lines, deviation_n = fit(codes, force_n, arguments.lsb, low=low, high=high)
    if files.check_out(arguments.out).suffix.lower() != ".npz":
        raise ValueError(f"{arguments.out} must be a .npz file")
    with files.written(arguments.out) as file:
        lines.save(file)
    print(plain(said))
    frames, rows, columns = codes.shape
    dead = int(lines.dead.sum())
    print(
        f"{rows}×{columns} cells from {frames} frames, {dead or 'none'} dead; one code of force is "
        f"{lines.force_lsb_n:g} N; deviation from the line: {np.nanmedian(deviation_n):.3g} N rms in the "
        f"median, {np.nanmax(deviation_n):.3g} N at most; {plain(arguments.out)}"
    )
    for sentence in _besides(codes, force_n, lines, low, high):
        print(sentence)
