"""The resolution of a four-wire sensor: the converter's steps through the four-electrode equations.

    x = Cx (E1-E3) / N     y = Cy (E2-E4) / M     load = Kf N / D        N = M = I R0, D = E1+E3-E2-E4

The mesh is solved with one point pressed at places all over it. The converter spans +-range_v at the
electrodes, by default ROOM V0, through whatever divider that needs: one code is q = 2 range_v / 2^bits there,
and each electrode is wrong by at most q/2. With a differential gain g above 1, two more channels convert
g (E1-E3) and g (E2-E4), so these differences are wrong by at most q/2g; N, M and D still come from the four
electrodes. With ``pairs``, the amplifiers are those of physics.cop4_config: each pair of electrodes keeps its
mean and its difference is multiplied, on the same four channels, so a difference is wrong by at most q/g and
a sum by q, of the same two codes.
Each result is a ratio of linear functions, so its greatest error lies at a corner of those intervals and is
exact, not an estimate.

Noise of ``noise_v`` rms at each electrode enters the rms errors only: a greatest error of noise has no bound.
Not included: the layers' own drop (docs/mesh.md, Correction) and the core's rounding
(meissner.twins.cop.cop4.cop4).
"""

from dataclasses import dataclass

import numpy as np

ROOM = 1.05  # headroom for the rails' tolerance; it also keeps a clipped code apart from a rail's
BITS = (8, 24)
SIDE = 1024
PLACES = 5  # along each axis, both ends included
LOADS = (0.1, 0.2, 0.5, 1, 2, 4)  # of the load asked for
SWEEP = tuple(range(8, 25, 2))  # bits of the table
GAINS = (1, 4, 16, 64, 256, 1024)


@dataclass(frozen=True)
class Circuits:
    """Solved circuits, arrays [places]: ``x``, ``y``; ``n`` = I R0 and ``d`` in volts."""

    x: np.ndarray
    y: np.ndarray
    n: np.ndarray
    d: np.ndarray


def code_v(mesh, bits, range_v=None):
    """Volts at an electrode for one code of a converter with ``bits`` bits."""
    return 2 * (range_v or ROOM * mesh.V0) / 2**bits


def greatest_gain(mesh, range_v=None, pairs=False):
    """The differential gain beyond which E1-E3 or E2-E4 may leave the converter's range; inf for one taxel.

    |E1-E3| <= N / Cx, and N stays below 2 V0. With ``pairs`` E1 and E3 would leave the rails at g > Cx.
    """
    spans = [C for C in (mesh.Cx, mesh.Cy) if C]
    room = 1.0 if pairs else (range_v or ROOM * mesh.V0) / (2 * mesh.V0)
    return room * min(spans, default=float("inf"))


def solve(mesh, load_n):
    """``Circuits`` of ``load_n`` newtons on one taxel, at up to PLACES x PLACES taxels all over the mesh."""
    rows, columns = (
        np.unique(np.rint(np.linspace(0, count - 1, PLACES)).astype(int)) for count in (mesh.m, mesh.n)
    )
    values = []
    for row in rows:
        load = np.zeros((len(columns), mesh.m, mesh.n))
        load[np.arange(len(columns)), row, columns] = load_n
        answer = mesh.solve(load, "fast")
        if not answer.valid.all():
            raise ValueError(f"load = {load_n:g} N cannot be measured: {answer.why[~answer.valid][0]}")
        n = answer.current * mesh.R0
        values.append((answer.x, answer.y, n, mesh.Kf * n / answer.load))
    return Circuits(*np.concatenate(values, axis=1))


def _rms(q, noise_v):
    """Volts rms of an electrode: steps of ``q`` and noise."""
    return np.hypot(q / np.sqrt(12), noise_v)


def position(C, at, n, q, gain, noise_v=0.0, pairs=False):
    """Step of one code, greatest error, rms error [places] of a coordinate ``at`` with its constant ``C``.

    ``n`` volts; ``q`` volts a code. Rms: to first order, for independent errors uniform over their
    intervals, which holds for differences of several codes.
    """
    if not C:
        return np.zeros((3, len(at)))
    difference = at * n / C
    if gain == 1 or pairs:
        corners = [((a - b) / gain, a + b) for a in (-q / 2, q / 2) for b in (-q / 2, q / 2)]
        rms = np.hypot(C / gain + at, C / gain - at)
    else:
        corners = [(a / gain, b) for a in (-q / 2, q / 2) for b in (-q, q)]
        rms = np.hypot(C / gain, np.sqrt(2) * at)
    with np.errstate(divide="ignore", invalid="ignore"):
        wrong = [np.abs(np.clip(C * (difference + a) / (n - b), -1, 1) - at) for a, b in corners]
    # Where the errors can reach N itself, any result in -1 .. 1 is possible.
    greatest = np.where(n > q, np.max(wrong, axis=0), 1 + np.abs(at))
    return np.stack([C * q / gain / n, greatest, rms * _rms(q, noise_v) / n])


def load(Kf, n, d, q, noise_v=0.0):
    """Step of one code of D, greatest error (inf: not resolved) and rms error, as fractions of the load."""
    corners = [(a, b) for a in (-q, q) for b in (-q, q)]
    with np.errstate(divide="ignore", invalid="ignore"):
        wrong = [np.abs((n - a) / n * d / (d + a - b) - 1) for a, b in corners]
    greatest = np.where(d > 2 * q, np.max(wrong, axis=0), np.inf)
    return np.stack([q / d, greatest, np.hypot(1 / n + 1 / d, 1 / d) * np.sqrt(2) * _rms(q, noise_v)])


def _worst(mesh, circuits, bits, gain, range_v=None, noise_v=0.0, pairs=False):
    """Step, greatest and rms error of x, y (fractions of the range) and load, at the worst places."""
    q = code_v(mesh, bits, range_v)
    x = position(mesh.Cx, circuits.x, circuits.n, q, gain, noise_v, pairs).max(axis=1) / 2
    y = position(mesh.Cy, circuits.y, circuits.n, q, gain, noise_v, pairs).max(axis=1) / 2
    return x, y, load(mesh.Kf, circuits.n, circuits.d, q, noise_v).max(axis=1)


def _finite(value):
    return float(value) if np.isfinite(value) else None


def _row(mesh, circuits, bits, gain, **converter):
    names = ("step", "greatest", "rms")
    parts = zip(("x", "y", "load"), _worst(mesh, circuits, bits, gain, **converter))
    return {what: {name: _finite(v) for name, v in zip(names, values)} for what, values in parts}


def pitch(mesh):
    """Half a taxel's pitch as a fraction of the range, the smaller of both axes; None for one taxel."""
    side = max(mesh.m, mesh.n)
    return 0.5 / (side - 1) if side > 1 else None


def budget(mesh, bits=16, gain=1.0, load_n=5.0, range_v=None, noise_v=0.0, pairs=False):
    """The budget as a dict of numbers (None: no such number); ValueError if it cannot be computed.

    ``loads``: rows over the load at ``bits`` and ``gain``; ``sweep``: rows over bits and gain at ``load_n``;
    ``load_sweep``: the load's greatest error over bits and load; ``needed``: for each gain the fewest bits
    whose greatest position error is below half a taxel's pitch. Position errors are fractions of the range
    from -1 to 1, load errors are fractions of the load.
    """
    if not BITS[0] <= bits <= BITS[1]:
        raise ValueError(f"adc-bits = {bits} must lie in {BITS[0]} .. {BITS[1]}")
    if not 1 <= gain < float("inf"):
        raise ValueError(f"gain = {gain:g} must be 1 (no difference amplifiers) or more")
    if not 0 < load_n < float("inf"):
        raise ValueError(f"load = {load_n:g} must be a number of newtons above 0")
    top = greatest_gain(mesh, range_v, pairs)
    converter = {"range_v": range_v, "noise_v": noise_v, "pairs": pairs}
    if gain > top:
        raise ValueError(
            f"gain = {gain:g} is beyond {top:.4g}: a difference could leave the converter's range"
        )
    gains = [g for g in GAINS if g == 1 or g <= top]
    circuits = {load_n * part: solve(mesh, load_n * part) for part in LOADS}
    loads = [
        {"load_n": force, "n_v": float(c.n.min()), "d_v": float(c.d.min())}
        | _row(mesh, c, bits, gain, **converter)
        for force, c in circuits.items()
    ]
    here = circuits[load_n]
    sweep = [{"bits": b, "gain": g} | _row(mesh, here, b, g, **converter) for g in gains for b in SWEEP]
    load_sweep = [
        {"bits": b, "load_n": force, "greatest": _row(mesh, c, b, 1, **converter)["load"]["greatest"]}
        for force, c in circuits.items()
        for b in SWEEP
    ]
    half = pitch(mesh)
    needed = []
    for g in gains if half else ():
        worst = lambda b, g=g: max(axis[1] for axis in _worst(mesh, here, b, g, **converter)[:2])
        enough = (b for b in range(BITS[0], BITS[1] + 1) if worst(b) < half)
        needed.append({"gain": g, "bits": next(enough, None)})
    return {
        "rows": mesh.m,
        "columns": mesh.n,
        "r_ohm": mesh.r,
        "R0_ohm": mesh.R0,
        "V0_v": mesh.V0,
        "k_n_ohm": mesh.k,
        "Cx": mesh.Cx,
        "Cy": mesh.Cy,
        "Kf_n": mesh.Kf,
        "bits": bits,
        "gain": gain,
        "load_n": load_n,
        "range_v": range_v or ROOM * mesh.V0,
        "code_v": code_v(mesh, bits, range_v),
        "noise_v": noise_v,
        "greatest_gain": _finite(top),
        "places": len(here.x),
        "half_pitch": half,
        "loads": loads,
        "sweep": sweep,
        "load_sweep": load_sweep,
        "needed": needed,
    }
