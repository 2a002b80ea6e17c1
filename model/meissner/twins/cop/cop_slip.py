"""Bit-exact twin of rtl/cop/msn_cop_slip.sv: slip from the total load and the centre of pressure."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meissner.twins.shared import Stream, fits, within

PLACE, LOAD = (-32768, 32767), (0, 65535)  # ranges of the RTL's inputs


@dataclass(frozen=True)
class CopSlipRegisters:
    """``drop``: 256ths of the old load; ``move``: Q2.14; ``min_load``: LSBs of the load; times in samples."""

    drop: int = 77
    move: int = 0
    min_load: int = 1
    hold: int = 0
    refractory: int = 0


class CopSlipResult(NamedTuple):
    """[n] each: ``slip``, ``raised``, ``over`` bool; ``dx``, ``dy`` Q2.14 over the lag; ``octant`` 0 .. 7."""

    slip: NDArray[np.bool_]
    raised: NDArray[np.bool_]
    over: NDArray[np.bool_]
    dx: NDArray[np.int64] | NDArray[np.float64]  # of engine float with fractions
    dy: NDArray[np.int64] | NDArray[np.float64]
    octant: NDArray[np.int64]


def octants(dx, dy):
    """0 .. 7 counter-clockwise from +x, 45 degrees centred on each axis (slope limit 53/128); 0: no move."""
    dx, dy = np.asarray(dx, dtype=np.int64), np.asarray(dy, dtype=np.int64)
    flat, upright = 128 * abs(dy) <= 53 * abs(dx), 128 * abs(dx) <= 53 * abs(dy)
    left, down = dx < 0, dy < 0
    diagonal = np.where(down, np.where(left, 5, 7), np.where(left, 3, 1))
    return np.where(flat, np.where(left, 4, 0), np.where(upright, np.where(down, 6, 2), diagonal))


class CopSlip(Stream):
    """Slip from samples of x, y (Q2.14), load and whether they are valid (pressed).

        over = (old - new) 256 > drop old  and  max(|dx|, |dy|) >= move    dx = x - old x, dy = y - old y

    where old is ``lag`` samples earlier, if both are pressed and the old load is at least ``min_load``;
    else dx = dy = 0 and not over. slip rises with over and lasts through ``hold`` samples in a row that are
    not over; the next ``refractory`` samples cannot raise it again. All in integers, nothing is rounded.
    """

    def __init__(self, lag=16, registers=CopSlipRegisters(), timer_bits=16):
        within(lag=(lag, 1, 4096), timer_bits=(timer_bits, 1, 31))
        widths = {"drop": 8, "move": 16, "min_load": 16, "hold": timer_bits, "refractory": timer_bits}
        fits(registers, **{name: (0, (1 << width) - 1) for name, width in widths.items()})
        self.lag, self.registers = lag, registers
        self.reset()

    def reset(self):
        """Forget the past: no sample counts until ``lag`` others precede it."""
        self._past = np.zeros((4, self.lag), dtype=np.int64)  # not pressed
        self._slipping, self._hold, self._deaf = False, 0, 0

    def next(self, x, y, load, pressed):
        """Feed samples, [n] each; returns a ``CopSlipResult``."""
        r = self.registers
        new = np.stack([np.asarray(a, dtype=np.int64) for a in (x, y, load, pressed)])
        for values, name, (low, high) in zip(new, ("x", "y", "load"), (PLACE, PLACE, LOAD)):
            if values.size and not low <= values.min() <= values.max() <= high:
                raise ValueError(f"{name} must lie in {low} .. {high}")
        line = np.concatenate([self._past, new], axis=1)
        old, self._past = line[:, : new.shape[1]], line[:, new.shape[1] :]
        pair = (new[3] & old[3]).astype(bool) & (old[2] >= r.min_load)
        dx, dy = (np.where(pair, new[i] - old[i], 0) for i in (0, 1))
        over = pair & ((old[2] - new[2]) * 256 > r.drop * old[2]) & (np.maximum(abs(dx), abs(dy)) >= r.move)
        slip = np.zeros(len(over), dtype=bool)
        raised = slip.copy()
        for index, now in enumerate(over.tolist()):
            before = self._slipping
            if before:
                self._slipping = now or self._hold > 0
                self._hold = r.hold if now else self._hold - 1
                self._deaf = r.refractory
            elif now and not self._deaf:
                self._slipping, self._hold = True, r.hold
            else:
                self._deaf = max(0, self._deaf - 1)
            slip[index], raised[index] = self._slipping, self._slipping and not before
        return CopSlipResult(slip, raised, over, dx, dy, octants(dx, dy))
