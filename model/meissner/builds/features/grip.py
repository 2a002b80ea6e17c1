"""[grip] of a build: the reflex of a hand whose fingers are the channels, from times and counts."""

from math import floor
from typing import TYPE_CHECKING, Annotated, Literal

from msgspec import Meta

from meissner.tables import Positive, Table, exact, values
from meissner.twins.actuate.actuate import ActuateConfig
from meissner.twins.actuate.grip import MIN_PERIOD, PERIOD_BITS, TOP, GripConfig

if TYPE_CHECKING:
    from meissner.builds.build import Config

PARAMETERS = {"Grip": 1}
Counts = Annotated[int, Meta(ge=0, le=TOP)]


class Keys(Table, frozen=True):
    """The table; step, decay, the limits, rate and speed_gain are in counts of the command."""

    mode: Literal["position", "force"] = "position"
    rule: Literal["any", "weakest"] = "any"
    immediate: bool = False
    cycle_ms: Positive = 10.0
    silent_ms: Positive = 50.0
    step: Counts = 256
    decay: Counts = 0
    minimum: Counts = 1024
    maximum: Counts = 60_000
    rate: Counts = 2048
    speed_gain: Counts = 0
    boost: Annotated[int, Meta(ge=0, le=7)] = 0
    rail_samples: Annotated[int, Meta(ge=0, le=255)] = 8
    pulse_divide: Annotated[int, Meta(ge=0, le=255)] = 0

    def __post_init__(self) -> None:
        if self.silent_ms < self.cycle_ms:
            raise ValueError(f"silent_ms = {self.silent_ms:g} must not be below cycle_ms")
        for key in ("step", "decay"):
            if getattr(self, key) > self.rate > 0:
                raise ValueError(
                    f"{key} = {getattr(self, key)} must not be above rate = {self.rate}, the most of a cycle"
                )
        if self.step << self.boost > TOP:
            raise ValueError(
                f"boost = {self.boost} makes a step of {self.step << self.boost}: at most {TOP} counts"
            )


def check(base: "Config") -> None:
    if base.array and "forest" not in base.features:
        raise ValueError("[grip] must go with [forest] for kind = 'array': it answers its decisions")
    if base.serial or not base.link.registers:
        raise ValueError("[grip] must go with serial = false and registers = true, which report a fault")
    if speeds := base.features.get("shear_speed"):
        gain, limit = base.features["grip"].grip.speed_gain, exact(speeds.settings["limit"]) / (1 << 20)
        if gain * 16 * limit > TOP:
            raise ValueError(
                f"[grip]: speed_gain = {gain} must be at most {floor(TOP / 16 / limit)}: with it the highest "
                "speed adds every count of a command"
            )


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
    return ActuateConfig(reflex, *base.rails, keys.rail_samples, keys.pulse_divide)
