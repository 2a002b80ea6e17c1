"""The four electrodes in textbook float64: engine ``float``'s ``cop4``, and the voltages as they are.

    x = Cx (E1-E3) / N     y = Cy (E2-E4) / M     load = Kf N / (D - N p)
    N = 2V0-E1-E3          M = 2V0+E2+E4          D = E1+E3-E2-E4

with p = 0 unless the load is corrected (meissner.world.mesh.correction).
"""

import numpy as np

from meissner.cop.cop4 import LOAD_BITS, Cop4, faults
from meissner.engines import COP_ONE
from meissner.world.mesh.correction import load_terms


def _ratio(above, below, where):
    return np.divide(above, below, out=np.zeros(len(where)), where=where)


def measure(codes, config):
    """x, y (-1 .. 1), load (N, infinite beyond every load) and faults' absence of codes [samples, 4]."""
    mesh = config.mesh
    e1, e2, e3, e4 = (np.asarray(codes) * config.volts_per_code).T
    n, m, d = 2 * mesh.V0 - e1 - e3, 2 * mesh.V0 + e2 + e4, e1 + e3 - e2 - e4
    x = np.clip(_ratio(mesh.Cx * (e1 - e3), n, n > 0), -1, 1)
    y = np.clip(_ratio(mesh.Cy * (e2 - e4), m, m > 0), -1, 1)
    n = np.clip(n, 0, 2 * mesh.V0)  # beyond is no sensor's
    if config.fix is not None:
        d = d - n * (load_terms(x, y) @ config.fix.p)
    load = np.where(n > 0, np.where(d > 0, mesh.Kf * _ratio(n, d, d > 0), np.inf), 0.0)
    # Flags compare codes with levels: logic, not arithmetic, and so the twin's.
    saturated, imbalance, opened = faults(codes, config.registers)
    return x, y, load, ~saturated & ~imbalance & (opened == 0)


def _nearest(value):
    """To integers, ties away from zero."""
    return np.sign(value) * np.floor(np.abs(value) + 0.5)


def cop4(codes, config):
    """``Cop4`` of codes [samples, 4]: the same numbers as the core's, each rounded once."""
    x, y, load, sound = measure(codes, config)
    top = (1 << LOAD_BITS) - 1
    load = _nearest(load / config.load_lsb_n)
    over, load = load > top, np.minimum(load, top).astype(np.int64)
    pressed = sound & (load > 0) & (load >= config.registers.min_load)
    x, y = (np.where(pressed, _nearest(value * COP_ONE), 0).astype(np.int32) for value in (x, y))
    return Cop4(x, y, load, pressed, over, *faults(codes, config.registers))


def cop4_of_volts(solution):
    """x, y, load (N) and valid of each sample, from the electrodes of a mesh's Solution.

    The voltages as they are: no converter. Not valid, and all zero, where nothing is loaded.
    """
    mesh, valid = solution.mesh, solution.valid
    e1, e2, e3, e4 = solution.E1, solution.E2, solution.E3, solution.E4
    drop_a, drop_b = 2 * mesh.V0 - e1 - e3, 2 * mesh.V0 + e2 + e4
    x, y = mesh.Cx * _ratio(e1 - e3, drop_a, valid), mesh.Cy * _ratio(e2 - e4, drop_b, valid)
    return x, y, mesh.Kf * _ratio(drop_a, e1 + e3 - e2 - e4, valid), valid
