"""Tables of the four-wire sensor in scenes, builds and files of ``meissner process cop4`` (docs/cop4.md)."""

from typing import Annotated

from msgspec import Meta

from meissner.physics.adc import Adc
from meissner.physics.cop4_config import MAX_BITS, MIN_BITS, TOUCHES, Cop4Config
from meissner.physics.mesh import Mesh
from meissner.tables import Positive, Table, naming, one_of

Side = Annotated[int, Meta(ge=1, le=1024)]
DifferenceGain = Annotated[float, Meta(ge=1, le=1e4)]


class Circuit(Table, frozen=True):
    """The keys of [mesh] but r_ohm, of which a scene lists several."""

    rows: Side
    columns: Side
    R0_ohm: Annotated[float, Meta(ge=10, le=1e7)]
    V0_v: Annotated[float, Meta(gt=0, le=100)]
    k_n_ohm: Annotated[float, Meta(ge=1, le=1e7)]

    def mesh(self, r_ohm: float) -> Mesh:
        """The mesh with resistors of ``r_ohm``."""
        return Mesh(self.rows, self.columns, r_ohm, self.R0_ohm, self.V0_v, self.k_n_ohm)


class MeshKeys(Circuit, frozen=True):
    """[mesh]."""

    r_ohm: Annotated[float, Meta(gt=0, le=1e6)]


class Converter(Table, frozen=True):
    """[converter], symmetric about 0 V, after amplifiers of ``gain``; opposite electrodes' differences get
    ``difference_gain`` times as much.
    """

    bits: Annotated[int, Meta(ge=MIN_BITS, le=MAX_BITS)]
    reference_v: Positive
    gain: Positive
    difference_gain: DifferenceGain = 1.0


class NoisyConverter(Converter, frozen=True, kw_only=True):
    """[converter] of a scene."""

    noise_v: Annotated[float, Meta(ge=0, le=1)]


class Load(Table, frozen=True):
    """[load]: newtons of one code, least load with a position, touch that the load is corrected for."""

    lsb_n: Positive
    min_n: Positive
    correction: str

    def __post_init__(self) -> None:
        one_of("correction", self.correction, TOUCHES)


def config(where: str, mesh: Mesh, converter: Converter, load: Load) -> Cop4Config:
    """The sensor of three tables; ``where`` begins the sentence of a ValueError."""
    full = converter.reference_v
    with naming(where):
        return Cop4Config(
            mesh=mesh,
            adc=Adc(converter.bits, -full, full, getattr(converter, "noise_v", 0.0)),
            gain=converter.gain,
            difference_gain=converter.difference_gain,
            load_lsb_n=load.lsb_n,
            min_load_n=load.min_n,
            touch=load.correction,
        )
