"""[cop] and [cop_slip] of a build and of a scene: pressed, and slip from four wires."""

from fractions import Fraction
from math import ceil
from typing import TYPE_CHECKING, Annotated, ClassVar

from msgspec import Meta

from meissner.tables import NotNegative, Positive, Table, exact

if TYPE_CHECKING:
    from meissner.twins.cop.cop_slip import CopSlipRegisters


class Cop(Table, frozen=True):
    """[cop]: pressed from this load on."""

    min_load_n: NotNegative = 0.0


class CopSlipKeys(Table, frozen=True):
    """[cop_slip] of a build and of a scene: shares of the load and of the half range, times in ms."""

    RENAMED: ClassVar = {
        "min_n": ("min_load_n", 1),
        **{f"{key}_s": (f"{key}_ms", 1000) for key in ("lag", "hold", "refractory")},
    }
    lag_ms: Positive = 16.0
    drop: Annotated[float, Meta(ge=0, le=0.99)] = 0.3
    move: Annotated[float, Meta(ge=0, le=1.99)] = 0.0
    min_load_n: Annotated[float, Meta(ge=0, le=60)] = 0.0
    hold_ms: NotNegative = 0.0
    refractory_ms: NotNegative = 0.0

    def codes(self, rate_hz: float | Fraction, load_lsb_n: float) -> "tuple[int, CopSlipRegisters]":
        """The settings in samples and codes.

        Parameters
        ----------
        rate_hz : float
            Samples a second.
        load_lsb_n : float
            Newtons of one code of the load.

        Returns
        -------
        tuple of int and CopSlipRegisters
            The lag in samples; the registers, the least load rounded up, the rest to the nearest.
        """
        from meissner.twins.cop.cop_slip import CopSlip, CopSlipRegisters

        samples = exact(rate_hz) / 1000
        lag = max(1, round(exact(self.lag_ms) * samples))
        registers = CopSlipRegisters(
            drop=round(256 * exact(self.drop)),
            move=round(16384 * exact(self.move)),
            min_load=ceil(exact(self.min_load_n) / exact(load_lsb_n)),
            hold=round(exact(self.hold_ms) * samples),
            refractory=round(exact(self.refractory_ms) * samples),
        )
        CopSlip(lag, registers)  # whose check it is
        return lag, registers
