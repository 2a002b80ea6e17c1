"""The keys of a converter in builds and scenes (docs/config.md)."""

from typing import TYPE_CHECKING, Annotated, Literal

from msgspec import Meta

from meissner.physics.front import SOURCE_OHM
from meissner.tables import Positive, Table, one_of

if TYPE_CHECKING:
    from meissner.builds.settling import Settling
    from meissner.twins.frontend.scan_adc import ScanAdc

Eight = Annotated[int, Meta(ge=1, le=8)]


class ReadBy(Table, frozen=True, kw_only=True):
    """``volts``: full scale; ``sclk_khz``: the part's own where it is not given; ``read``: whether a
    conversion is read before the next one starts, or during it."""

    part: str
    volts: Positive
    lanes: int = 1
    sclk_khz: Annotated[int, Meta(gt=0)] | None = None
    read: Literal["after", "during"] = "after"

    def __post_init__(self) -> None:
        from meissner.twins.frontend.adc_spi import BY_NAME  # a scene that is not scanned needs no twin of it

        one_of("part", self.part, list(BY_NAME))
        if self.read == "during" and not BY_NAME[self.part].has_busy:
            raise ValueError(f"read = 'during' must be 'after' for part = '{self.part}', which has no BUSY")


class Scanning(ReadBy, frozen=True, kw_only=True):
    """Converters side by side, inputs used of each, wait after a switch (None: what the converters' front
    needs), share of the old row that may remain (None: half a code), source of their inputs."""

    converters: Eight = 1
    channels: Eight = 8
    settle_us: Annotated[float, Meta(ge=0, le=1000)] | None = None
    settle_share: Annotated[float, Meta(gt=0, le=1)] | None = None
    source_ohm: Annotated[float, Meta(ge=0, le=1e6)] = SOURCE_OHM

    def scan(self, rows: int, columns: int, clk_khz: int) -> "ScanAdc":
        """The twin of the scan of an array with these converters."""
        from meissner.twins.frontend.adc_spi import BY_NAME
        from meissner.twins.frontend.scan_adc import ScanAdc

        return ScanAdc(
            *(rows, columns, self.converters, BY_NAME[self.part]),
            *(self.channels, self.lanes, clk_khz, self.sclk_khz),
            read_during=self.read == "during",
        )

    def settling(self, scan: "ScanAdc") -> "Settling":
        """What ``scan`` waits for."""
        from meissner.builds.settling import Settling

        return Settling(scan, self.volts, self.settle_share, self.source_ohm)
