"""From four electrodes' codes to newtons: sensor, amplifiers, converter, minimum load, correction."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from meissner.arrays import check_finite
from meissner.physics import mesh_loads
from meissner.physics.adc import Adc
from meissner.physics.cop4_registers import cop4_registers, correct_registers
from meissner.physics.mesh import Mesh, correction
from meissner.twins.cop.cop4 import Cop4Registers
from meissner.twins.cop.cop4_correct import CorrectionRegisters

MIN_SAMPLE_BITS = 17  # one build of the core serves every converter up to this width
MIN_BITS, MAX_BITS = 8, 24  # of a converter
TOUCHES = ("none", *mesh_loads.TOUCHES)
ORIGINS = {
    "MIN_SAMPLE_BITS": (
        "chosen",
        "the width of the core's operands",
        "no figure: converters below it use it too",
    ),
    "MIN_BITS": ("chosen", "below, no position is left (docs/cop4.md)", "which converters are accepted"),
    "MAX_BITS": ("chosen", "the widest converters in docs/adc.md", "which converters are accepted"),
}


@dataclass(frozen=True)
class Cop4Config:
    """``adc``: symmetric about 0 V, after amplifiers of ``gain``: code = volts gain / lsb.

    ``difference_gain``: of the pairs of amplifiers for E1, E3 and for E2, E4. Each pair keeps its mean and
    multiplies its difference: (E1 + E3)/2 ± g (E1 - E3)/2.

    ``load_lsb_n``, ``min_load_n``: newtons; ``touch``: the kind of touch that the load's correction is fitted
    to, or "none". ValueError with one sentence if a value exceeds the converter's range or a register,
    TypeError if ``mesh`` is no Mesh or ``adc`` no Adc.
    """

    mesh: Mesh
    adc: Adc
    gain: float
    load_lsb_n: float = 1e-3
    min_load_n: float = 0.05
    touch: str = "none"
    difference_gain: float = 1.0

    def __post_init__(self) -> None:
        for name, wanted in (("mesh", Mesh), ("adc", Adc)):
            given = getattr(self, name)
            if not isinstance(given, wanted):
                where = f"{wanted.__module__}.{wanted.__name__}"
                raise TypeError(f"{name} must be a {where}, not {type(given).__name__}")
        for name in ("gain", "load_lsb_n", "min_load_n", "difference_gain"):
            check_finite(name, given := getattr(self, name))
            if given < 0 or (given == 0 and name != "min_load_n"):
                raise ValueError(f"{name} = {given:g} must be above 0")
        if not MIN_BITS <= self.adc.bits <= MAX_BITS:
            raise ValueError(f"bits = {self.adc.bits} must lie in {MIN_BITS} .. {MAX_BITS}")
        if self.touch not in TOUCHES:
            raise ValueError(f"correction = '{self.touch}' must be one of: {', '.join(TOUCHES)}")
        self.registers.check(self.sample_bits)

    @property
    def sample_bits(self) -> int:
        """SampleBits of the core."""
        return max(MIN_SAMPLE_BITS, self.adc.bits)

    @property
    def volts_per_code(self) -> float:
        return self.adc.lsb_v / self.gain

    @cached_property
    def fix(self) -> correction.Correction | None:
        """The load's correction, fitted to the touch; None without one."""
        if self.touch == "none":
            return None
        return correction.fit(self.mesh, mesh_loads.touches(self.mesh.m, self.mesh.n, self.touch, seed=1))

    @cached_property
    def _both(self) -> tuple[Cop4Registers, CorrectionRegisters | None]:
        registers = cop4_registers(
            *(self.mesh, self.adc, self.gain, self.load_lsb_n, self.min_load_n),
            sample_bits=self.sample_bits,
            difference_gain=self.difference_gain,
        )
        return (registers, None) if self.fix is None else correct_registers(self.fix, registers)

    @property
    def registers(self) -> Cop4Registers:
        return self._both[0]

    @property
    def terms(self) -> CorrectionRegisters | None:
        """The correction's registers; None for a core built without it."""
        return self._both[1]

    def convert(
        self, volts: NDArray[np.floating], rng: np.random.Generator | None = None
    ) -> NDArray[np.int64]:
        """Codes [samples, 4] of electrode voltages [samples, 4]; noise only with ``rng``."""
        return self.converted(volts, rng)[0]

    def converted(
        self, volts: NDArray[np.floating], rng: np.random.Generator | None = None
    ) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """The same, and which are beyond the converter's range."""
        if self.difference_gain != 1:
            mean = (volts + volts[:, [2, 3, 0, 1]]) / 2
            volts = mean + self.difference_gain * (volts - mean)
        return self.adc.convert(volts * self.gain, rng)
