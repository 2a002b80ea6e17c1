"""How long a scan waits after a switch: what the converter's front needs, and what remains after a wait."""

from dataclasses import dataclass
from functools import cached_property
from math import ceil, isinf

from meissner.builds.units import Units
from meissner.physics import front
from meissner.tables import exact
from meissner.twins.frontend.scan_adc import ScanAdc
from meissner.twins.frontend.scan_demod import ScanDemod


def check_share(share: float | None) -> None:
    """ValueError unless ``share`` of an old row may remain; None: half a code."""
    if share is not None and not 0 < share <= 1:
        raise ValueError(f"settle_share = {share:g} must be above 0 and at most 1")


@dataclass(frozen=True)
class Settling:
    """``scan``: whose converters settle; ``volts``: their full scale, None: any; ``share``: of the old row,
    as much as may remain, None: half a code; ``source_ohm``: of what drives a multiplexed converter."""

    scan: ScanAdc | ScanDemod
    volts: float | None = None
    share: float | None = None
    source_ohm: float = front.SOURCE_OHM

    def __post_init__(self) -> None:
        check_share(self.share)
        if not 0 <= self.source_ohm <= 1e6:
            raise ValueError(f"source_ohm = {self.source_ohm:g} must lie in 0 .. 1e+06")

    @property
    def skip(self) -> int:
        """Samples of a carrier that are ignored before the first one that counts."""
        return self.scan.skip if isinstance(self.scan, ScanDemod) else 0

    @property
    def name(self) -> str:
        return self.scan.part.name.upper()

    @cached_property
    def paths(self) -> list[front.Path]:
        half_s = self.scan.adc.half / (1000 * self.scan.clk_khz)
        return front.paths(self.name, self.volts, half_s, self.source_ohm)

    @property
    def allowed(self) -> float:
        return front.half_code(self.scan.part.data_bits) if self.share is None else self.share

    @property
    def needed_s(self) -> float:
        return max(path.needed_s(self.allowed) for path in self.paths)

    @property
    def needed_clocks(self) -> int:
        """Clocks that are enough; ValueError if none are."""
        if isinf(self.needed_s):
            keep = max(path.keep for path in self.paths)
            raise ValueError(
                f"source_ohm = {self.source_ohm:g} is too large: however long a row settles, the "
                f"{self.name}'s sampling capacitor keeps {100 * keep:.3g} % of the input before, more than "
                f"{self.limit}"
            )
        return max(1, ceil(self.needed_s * 1000 * self.scan.clk_khz))

    @property
    def limit(self) -> str:
        """The share that may remain, in words."""
        share = f"{100 * self.allowed:.3g} %"
        return f"half a code ({share})" if self.share is None else share

    def clocks(self, settle_us: float | None) -> int:
        """Clocks that last at least ``settle_us``; None: as long as is needed, at least LEAST_SETTLE_S."""
        least = 0 if settle_us is not None else self.needed_clocks
        given_us = 1e6 * front.LEAST_SETTLE_S if settle_us is None else settle_us
        return max(least, Units(clk_khz=self.scan.clk_khz).settle_clocks(exact(given_us) / 1_000_000))

    def left(self, clocks: int) -> list[float]:
        """Share of the old row that remains at most in the first sample that counts, so many clocks and
        ``skip`` samples after a switch, for each of ``paths``."""
        every = self.scan.sample_period if isinstance(self.scan, ScanDemod) else 0
        times = [(clocks + k * every) / (1000 * self.scan.clk_khz) for k in range(self.skip + 1)]
        return [path.left(*times) for path in self.paths]

    def short(self, clocks: int) -> bool:
        return max(self.left(clocks)) > self.allowed

    def told(self, clocks: int) -> str:
        """What remains of the old row after so many clocks, and what is needed, in words."""
        us = clocks * 1000 / self.scan.clk_khz
        size = lambda left: f"{100 * left:.3g} %" if left > 1e-8 else "below 1e-06 %"
        shares = " or ".join(
            f"{size(left)} ({path.about})" for path, left in zip(self.paths, self.left(clocks))
        )
        if self.skip:
            text = (
                f"{us:.4g} us and {self.skip} skipped samples after a switch {shares} of the old row remain"
            )
            return (
                f"{text} at the {self.name}, {'more' if self.short(clocks) else 'no more'} than {self.limit}"
            )
        text = f"{us:.4g} us after a switch {shares} of the old row remain at the {self.name}"
        if isinf(self.needed_s):
            return f"{text}, with any settle time more than {self.limit}"
        return f"{text}; {1e6 * self.needed_s:.4g} us are enough for {self.limit}"

    def check(self, clocks: int) -> None:
        """ValueError if so many clocks are too few."""
        if self.short(clocks):
            _ = self.needed_clocks  # no settle time would help
            raise ValueError(
                f"settle_us is too short: {self.told(clocks)}; if that is meant, settle_share says how much "
                "may remain"
            )
