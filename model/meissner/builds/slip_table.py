"""[slip] of a build and of a scene: one table, with the same keys, units and exact conversion (docs/slip.md).

A threshold is on the peak to peak of the normalised Haar coefficient, as the core compares it: a published
threshold on the coefficient itself, of both signs, is half of that.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import msgspec

from meissner.builds.units import Units
from meissner.tables import NotNegative, Table, exact, naming, whole
from meissner.twins.slip.config import SWITCHES, SlipConfig

if TYPE_CHECKING:
    Switches = Table
else:  # a setting of SlipConfig that is on or off is a key of the table
    Switches = msgspec.defstruct(
        "Switches",
        [(name, bool, default) for name, default in SWITCHES.items() if name != "contact_rises"],
        bases=(Table,),
        kw_only=True,
        frozen=True,
    )


LONGEST_S = 5  # of a window: where it is more, the rate was given in another unit
TIMES = ("hold", "refractory", "blank")


class SlipTable(Switches, frozen=True):
    """The keys of every sensor. ``hop``: the window's where it is not given; times in milliseconds."""

    UNIT: ClassVar[str]
    window: int = 64
    hop: int | None = None
    level: Literal[1, 2, 3] = 1
    contact_rises: bool = False
    hold_ms: NotNegative = 0.0
    refractory_ms: NotNegative = 0.0
    blank_ms: NotNegative = 0.0
    serial: bool = False

    def amount(self, key: str) -> float:
        """The value of ``key`` in the table's unit."""
        return getattr(self, f"{key}_{self.UNIT}")

    @property
    def keeps(self) -> float | None:
        return getattr(self, f"keep_threshold_p2p_{self.UNIT}")

    def __post_init__(self) -> None:
        keep, unit = self.keeps, self.UNIT
        if keep is not None and keep > self.amount("threshold_p2p"):
            raise ValueError(
                f"keep_threshold_p2p_{unit} = {keep:g} must not be above threshold_p2p_{unit} = "
                f"{self.amount('threshold_p2p'):g}"
            )
        self._order("gross_threshold_p2p", "threshold_p2p", True)
        self._order("contact_level", "release_level", self.contact_rises)

    def _order(self, upper: str, lower: str, rises: bool) -> None:
        """ValueError if ``upper`` is on the wrong side of ``lower``; they may be equal."""
        above, below = self.amount(upper), self.amount(lower)
        if above != below and (above > below) != rises:
            side, why = ("least", "") if rises else ("most", ", as the code falls with the force")
            raise ValueError(
                f"{upper}_{self.UNIT} = {above:g} must be at {side} {lower}_{self.UNIT} = {below:g}{why}"
            )

    def codes(self, units: Units) -> SlipConfig:
        """The settings in codes and details.

        Parameters
        ----------
        units : Units
            Of the samples: volts or newtons per code, and samples per second of a channel; at any level.

        Returns
        -------
        SlipConfig
            Thresholds in codes of a detail, levels in codes of a sum, times in details.
        """
        units = replace(units, level=self.level)
        volts = self.UNIT == "v"
        detail = units.detail_code if volts else units.detail_code_of_newtons
        level = units.level_code if volts else units.level_code_of_newtons
        assert units.rate_hz is not None
        if self.window > LONGEST_S * units.rate_hz:
            raise ValueError(
                f"window = {self.window} at rate_hz = {units.rate_hz:g} must not last more than "
                f"{LONGEST_S} s: a rate of at least {self.window / LONGEST_S:g} Hz"
            )

        def of(name: str, convert: Callable[[float], int]) -> int:
            key = f"{name}_{self.UNIT}"
            with naming(key):
                return convert(getattr(self, key))

        codes: dict[str, Any] = {key: of(f"{key}_p2p", detail) for key in ("threshold", "gross_threshold")}
        codes |= {key: of(key, level) for key in ("contact_level", "release_level")}
        if units.codes and codes["release_level"] == units.codes[not self.contact_rises] << self.level:
            raise ValueError(
                f"release_level_{self.UNIT} = {self.amount('release_level'):g} must be within the range: a "
                "sensor at its end is never released"
            )
        details = exact(units.rate_hz) / 1000 / (1 << self.level)
        codes |= {key: whole(f"{key}_ms", getattr(self, f"{key}_ms"), details) for key in TIMES}
        return SlipConfig(
            window=self.window,
            hop=self.window if self.hop is None else self.hop,
            level=self.level,
            keep_threshold=None if self.keeps is None else of("keep_threshold_p2p", detail),
            **codes,
            **{name: getattr(self, name) for name in SWITCHES},
        )


class SlipVolts(SlipTable, frozen=True, kw_only=True):
    """[slip] of a sensor whose samples are volts."""

    UNIT = "v"
    RENAMED: ClassVar = {f"{key}threshold_v": (f"{key}threshold_p2p_v", 1) for key in ("", "gross_", "keep_")}
    threshold_p2p_v: NotNegative
    gross_threshold_p2p_v: NotNegative
    keep_threshold_p2p_v: NotNegative | None = None
    contact_level_v: float
    release_level_v: float


class SlipOfScene(SlipVolts, frozen=True):
    """[slip] of a scene, where the threshold was on the coefficient and times were in seconds."""

    RENAMED: ClassVar = {
        **{key: (name, 2) for key, (name, _) in SlipVolts.RENAMED.items()},
        **{f"{key}_s": (f"{key}_ms", 1000) for key in TIMES},
        **{f"{key}_v": (f"{key}_level_v", 1) for key in ("contact", "release")},
    }

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.serial:
            raise ValueError("serial = true must go with a build; its decisions are the same")


class SlipNewtons(SlipTable, frozen=True, kw_only=True):
    """[slip] of an array, whose samples are the newtons of a taxel."""

    UNIT = "n"
    RENAMED: ClassVar = {f"{key}threshold_n": (f"{key}threshold_p2p_n", 1) for key in ("", "gross_", "keep_")}
    contact_rises: bool = True
    threshold_p2p_n: NotNegative
    gross_threshold_p2p_n: NotNegative
    keep_threshold_p2p_n: NotNegative | None = None
    contact_level_n: float
    release_level_n: float
