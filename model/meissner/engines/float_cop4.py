"""The four electrodes in textbook float64: ``cop4`` and ``cop_slip`` of engine ``float``.

    x = Cx (E1-E3) / N     y = Cy (E2-E4) / M     load = Kf N / (D - N p)
    N = 2V0-E1-E3          M = 2V0+E2+E4          D = E1+E3-E2-E4

with p = 0 unless the load is corrected (meissner.physics.mesh.correction).
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from meissner.arrays import Bools, Floats, Ints
from meissner.engines import COP_ONE
from meissner.engines.protocol import ElectrodesSlip
from meissner.physics.cop4_config import Cop4Config
from meissner.physics.mesh import Solution
from meissner.physics.mesh.correction import load_terms
from meissner.twins.cop.cop4 import Cop4, Cop4Registers
from meissner.twins.shared import LOAD_BITS

if TYPE_CHECKING:
    from meissner.twins.cop.cop_slip import CopSlipRegisters


def _ratio(above: Floats, below: Floats, where: Bools) -> Floats:
    return np.divide(above, below, out=np.zeros(len(where)), where=where)


def measure(codes: ArrayLike, config: Cop4Config) -> tuple[Floats, Floats, Floats, Bools]:
    """x, y (-1 .. 1), load (N, infinite if out of range) and absence of faults, of codes [samples, 4]."""
    mesh = config.mesh
    e1, e2, e3, e4 = (np.asarray(codes) * config.volts_per_code).T
    n, m, d = 2 * mesh.V0 - e1 - e3, 2 * mesh.V0 + e2 + e4, e1 + e3 - e2 - e4
    across, up = (e1 - e3) / config.difference_gain, (e2 - e4) / config.difference_gain
    x = np.clip(_ratio(mesh.Cx * across, n, n > 0), -1, 1)
    y = np.clip(_ratio(mesh.Cy * up, m, m > 0), -1, 1)
    n = np.clip(n, 0, 2 * mesh.V0)  # no sensor gives more
    if config.fix is not None:
        d = d - n * (load_terms(x, y) @ config.fix.p)
    load = np.where(n > 0, np.where(d > 0, mesh.Kf * _ratio(n, d, d > 0), np.inf), 0.0)
    saturated, imbalance, opened = flags(codes, config.registers)
    return x, y, load, ~saturated & ~imbalance & (opened == 0)


def flags(codes: ArrayLike, registers: Cop4Registers) -> tuple[Bools, Bools, Ints]:
    """saturated, imbalance, open (bit 0 for E1) of codes [samples, 4], by docs/cop4.md.

    An electrode is open at ``idle`` or above while its partner across the layer is at ``busy`` or below; the
    lower layer's codes are mirrored. N - M is minus the sum of the four.
    """
    codes = np.asarray(codes, dtype=np.float64)
    top, idle, busy = registers.top, registers.idle, registers.busy
    e1, e2, e3, e4 = codes.T
    saturated = (codes.max(axis=1) >= top) | (codes.min(axis=1) <= -(top + 1))
    imbalance = np.abs(codes.sum(axis=1)) > registers.imbalance
    opened = np.zeros(len(codes), dtype=np.int64)
    for bit, (own, partner) in enumerate(((e1, e3), (-e2 - 1, -e4 - 1), (e3, e1), (-e4 - 1, -e2 - 1))):
        opened += np.where((own >= idle) & (partner <= busy), 1 << bit, 0)
    return saturated, imbalance, opened


def _nearest(value: Floats) -> Floats:
    """Round to integers, ties away from zero."""
    return np.sign(value) * np.floor(np.abs(value) + 0.5)


def cop4(codes: ArrayLike, config: Cop4Config) -> Cop4:
    """``Cop4`` of codes [samples, 4]: the core's numbers, each rounded once."""
    x, y, load, sound = measure(codes, config)
    top = (1 << LOAD_BITS) - 1
    exact = _nearest(load / config.load_lsb_n)
    over, amount = exact > top, np.minimum(exact, top).astype(np.int64)
    pressed = sound & (amount > 0) & (amount >= config.registers.min_load)
    across, up = (np.where(pressed, _nearest(value * COP_ONE), 0).astype(np.int32) for value in (x, y))
    return Cop4(across, up, amount, pressed, over, *flags(codes, config.registers))


def cop4_of_volts(solution: Solution) -> tuple[Floats, Floats, Floats, Bools]:
    """x, y, load (N) and valid of each sample, from the electrodes of a mesh's Solution.

    It uses the voltages directly, without a converter. Without a load, not valid and all zero.
    """
    mesh, valid = solution.mesh, solution.valid
    e1, e2, e3, e4 = solution.E1, solution.E2, solution.E3, solution.E4
    drop_a, drop_b = 2 * mesh.V0 - e1 - e3, 2 * mesh.V0 + e2 + e4
    x, y = mesh.Cx * _ratio(e1 - e3, drop_a, valid), mesh.Cy * _ratio(e2 - e4, drop_b, valid)
    return x, y, mesh.Kf * _ratio(drop_a, e1 + e3 - e2 - e4, valid), valid


def cop_slip(codes: Ints, config: Cop4Config, lag: int, registers: "CopSlipRegisters") -> ElectrodesSlip:
    """``Cop4`` and ``CopSlipResult`` of codes [samples, 4], with decisions on unrounded numbers.

    slip where the load fell by more than a share of its value ``lag`` samples earlier while a coordinate
    moved; dx, dy in units of Q2.14, with fractions; the octant is the nearest by angle.
    """
    from meissner.twins.cop.cop_slip import CopSlipResult

    found = cop4(codes, config)
    x, y, load, _ = measure(codes, config)
    pressed, count = found.pressed, len(load)
    dx, dy, fell = np.zeros((3, count))
    new, old = slice(lag, None), slice(0, max(count - lag, 0))
    pair = np.zeros(count, dtype=bool)
    pair[new] = pressed[new] & pressed[old] & (load[old] >= registers.min_load * config.load_lsb_n)
    dx[new], dy[new] = (np.where(pair[new], a[new] - a[old], 0) * COP_ONE for a in (x, y))
    fell[new] = np.where(pair[new], 1 - load[new] / np.where(pair[new], load[old], 1), 0)
    over = pair & (fell > registers.drop / 256) & (np.maximum(abs(dx), abs(dy)) >= registers.move)
    slip, until, deaf_until = np.zeros(count, dtype=bool), -1, -1
    for k in range(count):
        slipping = k > 0 and slip[k - 1]
        if over[k] and (slipping or k > deaf_until):
            slip[k], until = True, k + registers.hold
        elif slipping:
            slip[k] = k <= until
            deaf_until = k + registers.refractory
    raised = slip & ~np.concatenate([[False], slip[:-1]])
    octant = np.rint(np.arctan2(dy, dx) / (np.pi / 4)).astype(np.int64) % 8
    return found, CopSlipResult(slip, raised, over, dx, dy, octant)
