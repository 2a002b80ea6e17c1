"""Tables of the four-wire sensor in scenes, builds and files of ``meissner process cop4`` (docs/cop4.md)."""

from fractions import Fraction
from math import ceil
from typing import Annotated, ClassVar

from msgspec import Meta

from meissner.physics.adc import Adc
from meissner.physics.cop4_config import MAX_BITS, MIN_BITS, TOUCHES, Cop4Config
from meissner.physics.mesh import Mesh
from meissner.tables import NotNegative, Positive, Table, exact, naming, one_of
from meissner.twins.cop.cop_slip import CopSlip, CopSlipRegisters

Side = Annotated[int, Meta(ge=1, le=1024)]


class Circuit(Table):
    """The keys of [mesh] but r_ohm, of which a scene lists several."""

    rows: Side
    columns: Side
    R0_ohm: Positive
    V0_v: Positive
    k_n_ohm: Positive

    def mesh(self, r_ohm: float) -> Mesh:
        """The mesh with resistors of ``r_ohm``."""
        return Mesh(self.rows, self.columns, r_ohm, self.R0_ohm, self.V0_v, self.k_n_ohm)


class MeshKeys(Circuit):
    """[mesh]."""

    r_ohm: Positive


class Converter(Table):
    """[converter], symmetric about 0 V, after amplifiers of ``gain``."""

    bits: Annotated[int, Meta(ge=MIN_BITS, le=MAX_BITS)]
    reference_v: Positive
    gain: Positive


class NoisyConverter(Converter):
    """[converter] of a scene."""

    noise_v: Annotated[float, Meta(ge=0, le=1)]


class Load(Table):
    """[load]: newtons of one code, least load with a position, touch that the load is corrected for."""

    lsb_n: Positive
    min_n: Positive
    correction: str

    def __post_init__(self) -> None:
        one_of("correction", self.correction, TOUCHES)


class CopSlipKeys(Table):
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

    def codes(self, rate_hz: float | Fraction, load_lsb_n: float) -> tuple[int, CopSlipRegisters]:
        """(lag in samples, the registers), the least load rounded up, the rest to the nearest."""
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


def config(where: str, mesh: Mesh, converter: Converter, load: Load) -> Cop4Config:
    """The sensor of three tables; ``where`` begins the sentence of a ValueError."""
    full = converter.reference_v
    with naming(where):
        return Cop4Config(
            mesh=mesh,
            adc=Adc(converter.bits, -full, full, getattr(converter, "noise_v", 0.0)),
            gain=converter.gain,
            load_lsb_n=load.lsb_n,
            min_load_n=load.min_n,
            touch=load.correction,
        )
