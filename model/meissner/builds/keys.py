"""The tables of a build's file (docs/config.md), each with its keys, limits and defaults."""

from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from meissner.builds.cop_tables import Cop, CopSlipKeys
from meissner.builds.features import FEATURES
from meissner.builds.four_wires import DifferenceGain, Load, MeshKeys
from meissner.builds.input_range import Sensed
from meissner.builds.read_by import Eight, ReadBy, Scanning
from meissner.builds.slip_table import SlipNewtons, SlipVolts
from meissner.tables import Positive, Table, shown
from meissner.twins.frontend.adc_spi import BY_NAME, Part

PARTS: dict[str, Part] = BY_NAME
Side = Annotated[int, Meta(ge=1, le=256)]
Byte = Annotated[int, Meta(ge=0, le=255)]
Code = Annotated[int, Meta(ge=0, le=65535)]


class Clock(Table, frozen=True):
    """[clock] of the core."""

    mhz: Annotated[float, Meta(ge=1, le=200)]


class Channels(Sensed, frozen=True, kw_only=True):
    """[sensor] of single sensors, each on a channel of one converter."""

    kind: Literal["channels"]
    channels: Eight


class Taxels(Sensed, frozen=True, kw_only=True):
    """[sensor] of an array."""

    kind: Literal["array"]
    rows: Side
    columns: Side

    def __post_init__(self) -> None:
        if self.wiring == "pulled_up":
            raise ValueError(
                "wiring = 'pulled_up' must be pulled_down or differential for an array: its forces rise with "
                "the code"
            )


class Electrodes(Table, frozen=True):
    """[sensor] of four electrodes."""

    kind: Literal["electrodes"]


class Nothing(Table, frozen=True):
    """[sensor] of a build without one: a forest for rows from a host."""

    kind: Literal["none"]


class Adc(ReadBy, frozen=True, kw_only=True):
    """[adc]."""

    rate_hz: Positive


UNUSED = Adc(part="MCP3208", volts=5.0, rate_hz=1.0)  # of a build without a sensor


class ArrayAdc(Scanning, frozen=True, kw_only=True):
    """[adc] of an array."""

    rate_hz: Positive


class Link(Table, frozen=True):
    """[link]."""

    baud: Annotated[int, Meta(ge=1200, le=50_000_000)] = 3_000_000
    registers: bool = True
    statistics: bool = True
    images: bool = False
    slip_only: bool = False
    slip_pins: bool = False


class Array(Table, frozen=True):
    """[array]."""

    health: bool = False
    tare: bool = True
    gains: Literal["taxel", "row_column"] = "taxel"
    newtons_per_count: Annotated[float, Meta(ge=1e-6, le=0.1)] = 1e-3
    pitch_mm: Annotated[float, Meta(ge=0.05, le=100)] = 1.0


class Health(Table, frozen=True):
    """[health] of taxels, in codes and frames; None: by the converter and the rate."""

    band: Code | None = None
    jump: Code | None = None
    still: Byte = 120
    rail: Byte = 8
    blink: Byte | None = None
    edges: bool = False


class Tare(Table, frozen=True):
    """[tare] of taxels; ``contact_codes`` None: by the converter."""

    contact_codes: Code | None = None
    step: Byte = 1


class AmplifiedLoad(Load, frozen=True):
    """[load] of a build, whose converter has its own table."""

    gain: Annotated[float, Meta(ge=1e-3, le=1e3)] = 1.0
    difference_gain: DifferenceGain = 1.0


class File(Table, frozen=True):
    """The tables of every build."""

    about: str
    clock: Clock
    link: Link = Link()

    def __post_init__(self) -> None:
        if not self.about.isprintable():
            raise ValueError(f"about = {shown(self.about)} must be one line of text")

    @classmethod
    def unknown(cls, key: str, value: Any) -> str | None:
        if key == "converter":
            return (
                "[converter] belongs in a file for `meissner process cop4` (docs/cop4.md); a build has "
                "[clock], [sensor] and [adc] instead"
            )
        kinds = [kind for kind, file in FILES.items() if key in file.__struct_fields__]
        if kinds:
            own = next(kind for kind, file in FILES.items() if file is cls)
            return f"[{key}] is not allowed with kind = '{own}'"
        known = dict.fromkeys(key for file in FILES.values() for key in file.__struct_fields__)
        return f"unknown table [{shown(key)[1:-1]}]; the tables are: {', '.join(known)}"


class ArrayCop(Cop, frozen=True):
    """[cop] of a build; ``bits_per_clock``: how many bits of a quotient the dividers find in a clock."""

    bits_per_clock: Annotated[int, Meta(ge=1, le=2)] = 2


class ArrayFile(File, frozen=True, kw_only=True):
    """A build of an array."""

    sensor: Taxels
    adc: ArrayAdc
    array: Array = Array()
    health: Health | None = None
    tare: Tare | None = None
    cop: ArrayCop = ArrayCop()
    slip: SlipNewtons | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        for key in ("health", "tare"):
            if getattr(self, key) and not getattr(self.array, key):
                raise ValueError(f"[{key}] is not allowed with {key} = false in [array]")


class ElectrodesFile(File, frozen=True, kw_only=True):
    """A build of the four-wire sensor."""

    sensor: Electrodes
    adc: Adc
    mesh: MeshKeys
    load: AmplifiedLoad
    cop_slip: CopSlipKeys | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if not PARTS[self.adc.part].signed:
            raise ValueError(f"[adc]: part = '{self.adc.part}' must be symmetric about 0 V: use the AD7606")


class ChannelsFile(File, frozen=True, kw_only=True):
    """A build of single sensors."""

    sensor: Channels
    adc: Adc
    slip: SlipVolts


class NothingFile(File, frozen=True, kw_only=True):
    """A build without a sensor."""

    sensor: Nothing


def _with(file: Any, *names: str) -> Any:
    """``file`` with the tables of these features."""
    tables: list[Any] = [(name, FEATURES[name].Keys | None, None) for name in names]
    return msgspec.defstruct(f"Own{file.__name__}", tables, bases=(file,), kw_only=True, frozen=True)


FILES: dict[str, Any] = {
    "channels": _with(ChannelsFile, *FEATURES),
    "array": _with(ArrayFile, "display", "forest", "grip"),
    "electrodes": _with(ElectrodesFile, "display", "forest"),
    "none": _with(NothingFile, "forest"),
}
