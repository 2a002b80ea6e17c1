"""``meissner fit-rubber``: the constants of a batch of rubber from a recording of its shear steps.

    dV = (k0 + k1·Vi)·v^n      Vi: Vc at rest under the normal force; dV: its rise; v: shear speed, mm/s

k0, k1 and n: least squares on log dV (scipy.optimize.curve_fit), because the deviation of repeated steps is
taken as proportional to the step. Their intervals: Student's t with the standard errors of that fit.
"""

import warnings
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from meissner import readers
from meissner.interval import CONFIDENCE
from meissner.readers.table import TIMES, VOLTS
from meissner.terminal import plain

RECORDING = ("time_s", "volts", "speed_mm_s")
STEPS = ("rest_v", "step_v", "speed_mm_s")
NAMES = ("k0", "k1", "n")
UNITS = {"time_s": "s", "volts": "V", "speed_mm_s": "mm/s", "rest_v": "V", "step_v": "V"}
REST_S = 0.1  # the mean over this time before a step is Vi
END_SHARE = 0.05  # the median over this last share of a step is Vi + dV
FULL_MM = 0.01  # published: the step is complete after this shear
LEAST_SAMPLES = 5  # of a rest, of a step
LEAST_STEPS = 5  # two more than the constants
LEAST_REST_RANGE_V, LEAST_SPEED_RATIO = 0.2, 2.0
CODES_PER_V = 819.2  # MCP3208 at 5 V
DRIFT_SHARE = 0.1  # largest drift of Vc in the rest before a step, as a share of the step


class Steps(NamedTuple):
    """One element per shear step, float64."""

    rest_v: np.ndarray
    step_v: np.ndarray
    speed_mm_s: np.ndarray


@dataclass(frozen=True)
class Fit:
    """``value``, ``low``, ``high``: (k0, k1, n) and the ends of their intervals; ``residual``: for each step,
    its dV over the fitted one, minus 1."""

    steps: Steps
    value: np.ndarray
    low: np.ndarray
    high: np.ndarray
    residual: np.ndarray

    def step_v(self, rest_v, speed_mm_s):
        """dV of the fitted line."""
        k0, k1, n = self.value
        return (k0 + k1 * np.asarray(rest_v)) * np.asarray(speed_mm_s) ** n

    def speed_mm_s(self, rest_v, step_v):
        """v of a step: (dV/(k0 + k1·Vi))^(1/n)."""
        k0, k1, n = self.value
        return (np.asarray(step_v) / (k0 + k1 * np.asarray(rest_v))) ** (1.0 / n)


def _columns(path, column=None):
    """({name: values} of a file: its times in seconds, the only column in volts, the speed in mm/s; what was
    taken). ``column``: which are time_s, volts and speed_mm_s, by name or number."""
    table = readers.table(path, column or (*RECORDING, *STEPS))
    if column:
        chosen = readers.chosen(path, table, column)
        if len(chosen) != len(RECORDING):
            raise ValueError(f"{path}: {len(chosen)} columns are named; {', '.join(RECORDING)} are needed")
        found = dict(zip(RECORDING, chosen))
    else:
        found, volts = {}, [one for one in table.columns if one.unit in VOLTS]
        for one in table.columns:
            timed = one.is_time and one.unit in TIMES
            found["time_s" if timed else "speed_mm_s" if one.unit == "mm/s" else one.name] = one
        if len(volts) == 1 and "step_v" not in found:
            found = {"volts": volts[0]} | found
    used = {name: found[name] for name in dict.fromkeys((*RECORDING, *STEPS)) if name in found}
    told = ", ".join(
        f"{name} is {one.name}{f' in {one.unit}' * bool(one.unit)}" for name, one in used.items()
    )
    scale = TIMES | VOLTS
    values = {
        name: one.values / scale[one.unit]
        if one.unit in scale and one.values.dtype.kind in "iuf"
        else one.values
        for name, one in used.items()
    }
    return values, f"{table.how}; {told}"


def _numbers(path, name, values):
    """A column as float64; ValueError unless every value is a finite number."""
    if values.ndim != 1 or values.dtype.kind not in "iuf":
        raise ValueError(f"{path}: {name} must hold one number a row, not {values.dtype} {[*values.shape]}")
    wrong = np.flatnonzero(~np.isfinite(values))
    if len(wrong):
        raise ValueError(f"{path}: {name} is {values[wrong[0]]} in row {wrong[0] + 1}; it must be finite")
    return values.astype(float)


def read(path, column=None):
    """The Steps of ``recorded``."""
    return recorded(path, column)[0]


def recorded(path, column=None):
    """(Steps in a file with one row per sample (RECORDING) or per step (STEPS), what was taken of it).

    Any file that meissner.readers reads, with columns or arrays of these names, or the ``column``
    that are; others are ignored.
    """
    found, told = _columns(path, column)
    form = STEPS if "step_v" in found or "rest_v" in found else RECORDING
    for name in form:
        if name not in found:
            raise ValueError(
                f"{path} has no column {name}; "
                f"a recording has {', '.join(RECORDING)}, steps {', '.join(STEPS)}"
            )
    columns = [_numbers(path, name, found[name]) for name in form]
    for name, column in zip(form, columns):
        if len(column) != len(columns[0]):
            raise ValueError(
                f"{path}: {form[0]} has {len(columns[0])} rows and {name} has {len(column)}; they must agree"
            )
    return Steps(*columns) if form is STEPS else steps_of(*columns), told


def steps_of(time_s, volts, speed_mm_s):
    """The Steps of a recording: a step is a stretch of one speed other than 0, after a rest at 0.

    Vi is the mean of the last REST_S before it, dV the rise from Vi to the median of its last END_SHARE.
    """
    time_s, volts, speed_mm_s = (np.asarray(column, dtype=float) for column in (time_s, volts, speed_mm_s))
    if (np.diff(time_s) <= 0).any():
        row = int(np.argmax(np.diff(time_s) <= 0)) + 2
        raise ValueError(f"time_s must rise from row to row; row {row} has {time_s[row - 1]:g} s")
    edges = np.concatenate([[0], np.flatnonzero(np.diff(speed_mm_s)) + 1, [len(time_s)]])
    found, previous = [], None
    for first, last in pairwise(edges):
        speed = speed_mm_s[first]
        if speed:
            found.append(_step(len(found) + 1, time_s, volts, abs(speed), previous, first, last))
        previous = None if speed else first
    if not found:
        raise ValueError("speed_mm_s is 0 throughout, so there is no step in the recording")
    return Steps(*np.array(found).T)


def _step(number, time_s, volts, speed, rest_from, first, last):
    """(Vi, dV, speed) of the samples ``first`` up to ``last``, after a rest from ``rest_from`` on."""
    at = f"step {number}, from {time_s[first]:g} s on"
    if rest_from is None:
        raise ValueError(f"{at}: there is no rest before it; speed_mm_s must be 0 for {REST_S:g} s")
    before = max(rest_from, int(np.searchsorted(time_s, time_s[first] - REST_S * (1 + 1e-9))))
    if first - before < LEAST_SAMPLES or time_s[first] - time_s[before] < 0.9 * REST_S:
        raise ValueError(f"{at}: the rest before it is shorter than {REST_S:g} s or {LEAST_SAMPLES} samples")
    period = (time_s[last - 1] - time_s[first]) / max(last - first - 1, 1)
    moved = speed * (last - first) * period
    if last - first < LEAST_SAMPLES or moved < FULL_MM * (1 - 1e-6):
        raise ValueError(
            f"{at}: it is {last - first} samples and {moved:.3g} mm long; "
            f"it needs {LEAST_SAMPLES} samples and {FULL_MM:g} mm"
        )
    rest = volts[before:first]
    end = volts[last - max(1, round(END_SHARE * (last - first))) : last]
    step = float(np.median(end) - rest.mean())
    half = len(rest) // 2
    drift = abs(rest[half:].mean() - rest[:half].mean()) * 2
    if step > 0 and drift > DRIFT_SHARE * step:
        raise ValueError(
            f"{at}: Vc still moves by {drift:.2g} V in the {REST_S:g} s before it; let the rubber recover"
        )
    return float(rest.mean()), step, float(speed)


def _check(steps):
    """Raise ValueError with one sentence if the steps do not determine three constants."""
    rest_v, step_v, speed_mm_s = steps
    for name, values, least in (
        ("speed_mm_s", speed_mm_s, "above 0"),
        ("step_v", step_v, "above 0: Vc rises"),
    ):
        wrong = np.flatnonzero(values <= 0)
        if len(wrong):
            raise ValueError(
                f"step {wrong[0] + 1}: {name} = {values[wrong[0]]:.3g} {UNITS[name]} must be {least}"
            )
    if len(step_v) < LEAST_STEPS:
        count = f"{len(step_v)} step{'s' * (len(step_v) != 1)}"
        raise ValueError(f"{count} of shear: too few for three constants; record {LEAST_STEPS} or more")
    if np.ptp(rest_v) < LEAST_REST_RANGE_V:
        raise ValueError(
            f"every step starts from {rest_v.min():.2f} to {rest_v.max():.2f} V, so k1 cannot be determined; "
            f"press harder for some, by {LEAST_REST_RANGE_V:g} V or more"
        )
    if speed_mm_s.max() < LEAST_SPEED_RATIO * speed_mm_s.min():
        raise ValueError(
            f"the speeds lie in {speed_mm_s.min():g} .. {speed_mm_s.max():g} mm/s, "
            f"so n cannot be determined; the fastest must be {LEAST_SPEED_RATIO:g} times the slowest or more"
        )


def fit(steps, confidence=CONFIDENCE):
    """The Fit of Steps; ValueError with one sentence if they do not determine the constants."""
    from scipy.optimize import OptimizeWarning, curve_fit  # imported here: help does not wait for SciPy
    from scipy.stats import t

    steps = Steps(*(np.asarray(column, dtype=float) for column in steps))
    _check(steps)
    rest_v, step_v, speed_mm_s = steps
    log_speed = np.log(speed_mm_s)

    def log_step(_, k0, k1, n):
        return np.log(np.maximum(k0 + k1 * rest_v, 1e-12)) + n * log_speed

    # Start values: n from a plane through the logs, then k0 and k1 from a straight line through dV/v^n.
    ones = np.ones(len(rest_v))
    n = np.linalg.lstsq(np.stack([ones, rest_v, log_speed], 1), np.log(step_v), rcond=None)[0][2]
    start = np.linalg.lstsq(np.stack([ones, rest_v], 1), step_v / speed_mm_s**n, rcond=None)[0]
    if (start[0] + start[1] * rest_v).min() <= 0:  # the line crosses 0: begin without a slope
        start = np.array([np.exp(np.mean(np.log(step_v) - n * log_speed)), 0.0])
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", OptimizeWarning)
            value, covariance = curve_fit(
                log_step, rest_v, np.log(step_v), [*start, n], xtol=1e-15, ftol=1e-15, gtol=1e-15
            )
    except (RuntimeError, OptimizeWarning):
        raise ValueError("no k0, k1 and n fit these steps") from None
    if (value[0] + value[1] * rest_v).min() <= 0 or value[2] <= 0:
        raise ValueError(
            f"no positive step fits: k0 = {value[0]:.3g}, k1 = {value[1]:.3g}, n = {value[2]:.3g}; "
            "are the speeds those of the steps?"
        )
    half = t.ppf(0.5 + confidence / 2, len(step_v) - 3) * np.sqrt(np.diag(covariance))
    residual = np.exp(np.log(step_v) - log_step(rest_v, *value)) - 1.0
    return Fit(steps, value, value - half, value + half, residual)


def _ranges(found):
    """Where the constants hold: Vi from and to, the highest speed, at most the largest of its register."""
    from meissner.twins.slip.shear_speeds import SIZE  # here: a fit needs no estimator

    rest_v, _, speed_mm_s = found.steps
    most = 16 - 1e-4  # a speed has 24 bits
    assert 1 << 24 - SIZE.speed_fraction == 16
    return {
        "vi_min": float(rest_v.min()),
        "vi_max": float(rest_v.max()),
        "limit": min(float(speed_mm_s.max()), most),
    }


def registers(found, codes_per_v=CODES_PER_V):
    """The registers of msn_shear_speed that follow from a Fit, by name."""
    from meissner.twins.slip.shear_speed import ShearSettings

    ranges = _ranges(found)
    # None of these registers depends on the rate of the windows.
    settings = ShearSettings.of(codes_per_v, 10_000, **dict(zip(NAMES, map(float, found.value))), **ranges)
    return {f"cfg_{name}": getattr(settings, name) for name in ("k0", "k1", "exponent", *ranges)}


def _table_lines(found, codes_per_v):
    """[shear_speed] of a build (docs/config.md) and its registers; as comments if no core holds them."""
    k0, k1, n = found.value
    vi_min, vi_max, limit = _ranges(found).values()
    keys = {"k0_v": k0, "k1": k1, "n": n, "vi_min_v": vi_min, "vi_max_v": vi_max, "limit_mm_s": limit}
    table = ["[shear_speed]", *(f"{name} = {value:.6g}" for name, value in keys.items())]
    try:
        words = ", ".join(f"{name} = {value}" for name, value in registers(found, codes_per_v).items())
    except ValueError as problem:
        return [f"# no registers of msn_shear_speed: {problem}", *(f"# {line}" for line in table)]
    return [
        *table,
        f"# registers of msn_shear_speed, {codes_per_v:g} codes a volt (docs/shear_speed.md):",
        f"# {words}",
    ]


def tell(found, codes_per_v=CODES_PER_V):
    """The lines to print for a Fit: constants and intervals, the data fitted, residuals, TOML, registers."""
    rest_v, _, speed_mm_s = found.steps
    lines = [
        f"{name:<2} = {value:8.4f}   {100 * CONFIDENCE:g} % interval {low:.4f} to {high:.4f}"
        for name, value, low, high in zip(NAMES, found.value, found.low, found.high)
    ]
    k0, k1, n = found.value
    worst = int(np.argmax(np.abs(found.residual)))
    dof = len(rest_v) - 3
    rms = np.sqrt((found.residual**2).sum() / dof)
    lines += [
        f"{len(rest_v)} steps from {rest_v.min():.2f} to {rest_v.max():.2f} V at {speed_mm_s.min():g} to "
        f"{speed_mm_s.max():g} mm/s; outside these ranges the constants are extrapolated",
        f"residuals of dV: {100 * rms:.2g} % rms ({dof} degrees of freedom), "
        f"{100 * found.residual[worst]:+.2g} % at most, step {worst + 1} "
        f"({rest_v[worst]:.2f} V, {speed_mm_s[worst]:g} mm/s)",
        f"1 % of dV is {100 * (1.01 ** (1 / n) - 1):.2g} % of v",
    ]
    if k1 < 0:
        lines.append(f"k0 + k1·Vi is 0 at Vi = {-k0 / k1:.2f} V")
    return [
        *lines,
        "",
        "# dV = (k0 + k1·Vi)·v^n, v = (dV/(k0 + k1·Vi))^(1/n); volts and mm/s",
        *_table_lines(found, codes_per_v),
    ]


def command(arguments):
    """``meissner fit-rubber``."""
    if not 0 < arguments.codes_per_v < float("inf"):
        raise ValueError(f"codes-per-v = {arguments.codes_per_v:g} must be a number above 0")
    steps, told = recorded(arguments.recording, arguments.column)
    lines = tell(fit(steps), arguments.codes_per_v)
    print(plain(f"{arguments.recording}: {told}"), "dV = (k0 + k1·Vi)·v^n", *lines, sep="\n")
