"""[cop] and [cop_slip] of a build and of a scene: pressed, and slip from four wires."""

from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, ClassVar

from msgspec import Meta

from meissner.builds.units import Units
from meissner.tables import NotNegative, Positive, Table, exact, naming, whole
from meissner.twins.shared import LOAD_BITS

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
    min_load_n: NotNegative = 0.0
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
        lag = whole("lag_ms", self.lag_ms, samples, 4096)
        with naming("min_load_n"):
            load = Units(newtons_per_code=load_lsb_n, most_load=(1 << LOAD_BITS) - 1).load_code(
                self.min_load_n
            )
        registers = CopSlipRegisters(
            drop=whole("drop", self.drop, Fraction(256)),
            move=whole("move", self.move, Fraction(16384)),
            min_load=load,
            hold=whole("hold_ms", self.hold_ms, samples),
            refractory=whole("refractory_ms", self.refractory_ms, samples),
        )
        CopSlip(lag, registers)  # whose check it is
        return lag, registers
