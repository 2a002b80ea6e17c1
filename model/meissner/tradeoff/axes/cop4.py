"""Four electrodes: the converter's bits, noise and gain and the mesh's resistors, against the errors."""

from functools import lru_cache

import numpy as np

from meissner.budget.cop4 import ROOM, code_v, greatest_gain
from meissner.physics.adc import PARTS
from meissner.physics.mesh import Mesh
from meissner.tradeoff.axis import Axis, Figure

PLACES, DRAWS, V0, K, LOAD_N = 5, 40, 15.0, 4320.0, 5.0
PART_MV, PART_V = 0.117, PARTS["AD7606"].high_v  # its own noise over its own range, physics.adc


def mesh_of(point):
    return Mesh(point["side"], point["side"], point["r_ohm"], point["R0_ohm"], V0, K)


@lru_cache(maxsize=8)
def _solved(side, r_ohm, R0_ohm):
    """(mesh, electrodes [scenes, 4], true x, true y, loads, solution): one point at places all over the mesh.

    The load differs slightly in each scene, so that the voltages fall anywhere between two codes.
    """
    mesh = mesh_of({"side": side, "r_ohm": r_ohm, "R0_ohm": R0_ohm})
    at = np.unique(np.rint(np.linspace(0, side - 1, PLACES)).astype(int))
    row, column = (each.ravel() for each in np.meshgrid(at, at, indexing="ij"))
    totals = LOAD_N * (1 + 0.001 * np.arange(DRAWS))
    row, column = np.repeat(row, DRAWS), np.repeat(column, DRAWS)
    loads = np.tile(totals, len(row) // DRAWS)
    force = np.zeros((len(row), side, side))
    force[np.arange(len(row)), row, column] = loads
    answer = mesh.solve(force, "fast")
    volts = np.stack([answer.E1, answer.E2, answer.E3, answer.E4], axis=1)
    return mesh, volts, 2 * column / (side - 1) - 1, 1 - 2 * row / (side - 1), loads, answer


def error(point):
    """Errors of position (of the range 2) and load.

    ``position``, rms, ``position_most`` and ``load``, largest: errors that the converter adds to the same
    formula on unconverted voltages; ``position_true``, ``load_true``: the largest total errors, with the
    layers' own drop. Each electrode, and each amplified difference, has the converter's own noise:
    ``noise_mv`` over +-5 V.
    """
    mesh, volts, x, y, loads, answer = _solved(*(point[key] for key in ("side", "r_ohm", "R0_ohm")))
    q, gain = code_v(mesh, point["bits"]), point["gain"]
    noise_v = 1e-3 * point["noise_mv"] * ROOM * mesh.V0 / PART_V
    noise = noise_v * np.random.default_rng(1).standard_normal((6, len(volts)))
    e1, e2, e3, e4 = np.rint((volts.T + noise[:4]) / q) * q
    n, m = 2 * mesh.V0 - e1 - e3, 2 * mesh.V0 + e2 + e4
    dx, dy = e1 - e3, e2 - e4
    if gain > 1:  # two more channels convert the amplified differences
        dx, dy = (
            np.rint(((volts[:, a] - volts[:, a + 2]) * gain + noise[4 + a]) / q) * q / gain for a in (0, 1)
        )
    d = e1 + e3 - e2 - e4
    with np.errstate(divide="ignore", invalid="ignore"):
        got_x = np.clip(np.nan_to_num(mesh.Cx * dx / n), -1, 1)
        got_y = np.clip(np.nan_to_num(mesh.Cy * dy / m), -1, 1)
        got = np.where(d > 0, mesh.Kf * n / d, np.inf)
    apart = np.abs([got_x - answer.x, got_y - answer.y])
    load, true = (np.abs(got / of - 1).max() for of in (answer.load, loads))
    return {
        "position": 50 * float(np.sqrt(np.mean(apart**2, axis=1)).max()),
        "position_most": 50 * float(apart.max()),
        "load": 100 * float(load) if np.isfinite(load) else None,
        "load_true": 100 * float(true) if np.isfinite(true) else None,
        "position_true": 50 * float(max(np.abs(got_x - x).max(), np.abs(got_y - y).max())),
    }


def cost(point):
    """Converted bits per sample; power that the mesh takes from the rails at 5 N; number of channels."""
    _, _, _, _, _, answer = _solved(*(point[key] for key in ("side", "r_ohm", "R0_ohm")))
    channels = 4 if point["gain"] == 1 else 6
    return {
        "sample_bits": channels * point["bits"],
        "power_mw": 2e3 * V0 * float(np.max(answer.current)),
        "channels": channels,
    }


def legal(point):
    try:
        return 8 <= point["bits"] <= 24 and 1 <= point["gain"] <= greatest_gain(mesh_of(point))
    except ValueError:
        return False


AXES = (
    Axis(
        name="cop4",
        title="Four electrodes: converter, gain and resistors",
        about="8 to 24 bits; a gain of the differences that keeps them in the converter's range (1: none); "
        "0.117 mV over ±5 V is the AD7606's own noise",
        values={
            "side": (7, 41),
            "r_ohm": (10.0, 47.0, 100.0, 150.0),
            "R0_ohm": (1000.0, 3300.0, 10000.0),
            "bits": (10, 12, 14, 16, 18, 20),
            "noise_mv": (PART_MV, 0.01),
            "gain": (1, 4, 16, 64),
        },
        quick={
            **{"r_ohm": (10.0, 100.0), "R0_ohm": (1000.0, 10000.0)},
            **{"bits": (12, 16), "noise_mv": (PART_MV,), "gain": (1, 16)},
        },
        shipped={"side": 7, "r_ohm": 100.0, "R0_ohm": 1000.0, "bits": 16, "noise_mv": PART_MV, "gain": 1},
        group=("side", "r_ohm", "R0_ohm"),
        apart=("side", "noise_mv"),
        legal=legal,
        cost=cost,
        error=error,
        figures=(
            Figure("sample_bits", "converted bits of a sample", "bits", judged=True),
            Figure("power_mw", "taken from the rails at 5 N", "mW", judged=True),
            Figure("position", "position's error by the converter, rms", "% of the range", judged=True),
            Figure("position_most", "the same, largest", "% of the range"),
            Figure("load_true", "load's error, the layers' drop too", "%", judged=True),
            Figure("load", "load's error by the converter", "%"),
            Figure("position_true", "position's error, the layers' drop too", "% of the range"),
            Figure("channels", "inputs of the converter"),
        ),
        panels=(("sample_bits", "position"), ("power_mw", "position"), ("sample_bits", "load_true")),
    ),
)
