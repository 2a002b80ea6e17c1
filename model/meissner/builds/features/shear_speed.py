"""[shear_speed] of a build: the estimator of each channel, from volts, millimetres and a batch of rubber."""

from typing import TYPE_CHECKING, Annotated

from msgspec import Meta

from meissner.tables import NotNegative, Positive, Table, exact
from meissner.twins.slip.shear_speed import ShearSettings
from meissner.twins.slip.shear_speeds import SIZE, ShearConfig

if TYPE_CHECKING:
    from meissner.builds.build import Config

PARAMETERS = {"ShearSpeed": 1}
TAKES = "computing a window"


class Keys(Table, frozen=True):
    """The table: dV = (k0 + k1 Vi) v^n of this lot of rubber, and what counts as a rise or as rest."""

    k0_v: Positive = 1.55
    k1: float = -0.27
    n: Annotated[float, Meta(gt=0, le=1)] = 0.11
    vi_min_v: float = 2.0
    vi_max_v: float = 4.0
    noise_v: NotNegative = 0.1
    still_v: NotNegative = 0.0025
    limit_mm_s: Annotated[float, Meta(gt=0, lt=16)] = 3.0
    travel_mm: Annotated[float, Meta(ge=0, le=1)] = 0.01
    hold_cycles: Annotated[int, Meta(ge=0, le=255)] = 0

    def __post_init__(self) -> None:
        if self.vi_min_v > self.vi_max_v:
            raise ValueError(f"vi_min_v = {self.vi_min_v:g} must not be above vi_max_v")


def clocks(base: "Config") -> int:
    """So that no sample waits for the computation of a window."""
    return 70


def check(base: "Config") -> None:
    if base.serial or not base.link.registers:
        raise ValueError(
            "[shear_speed] must go with serial = false and registers = true, which hold the speeds"
        )


def config(keys: Keys, base: "Config") -> ShearConfig:
    """The settings of the estimator in codes and clocks; ``base``: the rest of the build."""
    adc, codes_per_v = base.input, 1 / exact(base.input.lsb_v)
    for key, least, most in (
        ("vi_min_v", adc.low_v, adc.high_v),
        ("vi_max_v", adc.low_v, adc.high_v),
        ("noise_v", 0, adc.high_v - adc.low_v),
        ("still_v", 0, adc.high_v - adc.low_v),
    ):
        value = getattr(keys, key)
        if not least <= value <= most:
            raise ValueError(
                f"{key} = {value:g} must lie in {least:g} .. {most:g}, the range of the converter"
            )
    rise = [exact(keys.k0_v) + exact(keys.k1) * exact(v) for v in (keys.vi_min_v, keys.vi_max_v)]
    if max(rise) <= 0 or min(rise) >= exact(adc.high_v - adc.low_v):
        raise ValueError(
            f"k0_v = {keys.k0_v:g}, k1 = {keys.k1:g}: 1 mm/s makes {float(min(rise)):g} to "
            f"{float(max(rise)):g} V, which must be above 0 and below {adc.high_v - adc.low_v:g}"
        )
    settings = ShearSettings.of(
        *(codes_per_v, exact(base.rate_hz), SIZE),
        k0=exact(keys.k0_v),
        k1=exact(keys.k1),
        n=exact(keys.n),
        vi_min=exact(keys.vi_min_v),
        vi_max=exact(keys.vi_max_v),
        noise=exact(keys.noise_v),
        still=exact(keys.still_v),
        limit=exact(keys.limit_mm_s),
        travel=exact(keys.travel_mm),
        full=adc.max_code / codes_per_v,  # at this code the input is out of range
    )
    for key, value in (
        ("noise_v", settings.noise),
        ("still_v", settings.still),
        ("travel_mm", settings.travel),
    ):
        if getattr(keys, key) and not value:
            raise ValueError(f"{key} = {getattr(keys, key):g} must be 0 or more: it is less than half a step")
    return ShearConfig(settings, keys.hold_cycles)
