"""[grip] of a build: the reflex of a hand whose fingers are the channels, from times and counts."""

from typing import TYPE_CHECKING, Annotated, Literal

from msgspec import Meta

from meissner.tables import Positive, Table, exact, values
from meissner.twins.actuate.actuate import ActuateConfig
from meissner.twins.actuate.grip import MIN_PERIOD, PERIOD_BITS, GripConfig

if TYPE_CHECKING:
    from meissner.builds.build import Config

PARAMETERS = {"Grip": 1}


class Keys(Table, frozen=True):
    """The table; step, decay, the limits, rate and speed_gain are in counts of the command."""

    mode: Literal["position", "force"] = "position"
    rule: Literal["any", "weakest"] = "any"
    immediate: bool = False
    cycle_ms: Positive = 10.0
    silent_ms: Positive = 50.0
    step: int = 256
    decay: int = 0
    minimum: int = 1024
    maximum: int = 60_000
    rate: int = 2048
    speed_gain: int = 0
    boost: int = 0
    rail_samples: Annotated[int, Meta(ge=0, le=255)] = 8
    pulse_divide: Annotated[int, Meta(ge=0, le=255)] = 0

    def __post_init__(self) -> None:
        if self.silent_ms < self.cycle_ms:
            raise ValueError(f"silent_ms = {self.silent_ms:g} must not be below cycle_ms")


def check(base: "Config") -> None:
    if base.serial or not base.link.registers:
        raise ValueError("[grip] must go with serial = false and registers = true, which report a fault")


def config(keys: Keys, base: "Config") -> ActuateConfig:
    """The settings of the reflex in clocks and codes; ``base``: the rest of the build."""
    period, top = round(exact(keys.cycle_ms) * base.clk_khz), (1 << PERIOD_BITS) - 1
    if not MIN_PERIOD <= period <= top:
        least, most = MIN_PERIOD / base.clk_khz, top / base.clk_khz
        raise ValueError(f"cycle_ms = {keys.cycle_ms:g} must lie in {least:g} .. {most:g}")
    own = ("cycle_ms", "silent_ms", "rail_samples", "pulse_divide")
    reflex = GripConfig(
        **{key: value for key, value in values(keys).items() if key not in own},
        period=period,
        watchdog=max(1, round(exact(keys.silent_ms) / exact(keys.cycle_ms))),
    )
    # The sensors' voltages are positive: a bipolar converter reads below 0 only from noise or if it is dead.
    high = (1 << base.part.data_bits - base.part.signed) - 1
    return ActuateConfig(reflex, 0, high, keys.rail_samples, keys.pulse_divide)
