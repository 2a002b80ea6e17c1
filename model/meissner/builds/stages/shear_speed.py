"""[shear_speed] of a build: the estimator of each channel, from volts, millimetres and a batch of rubber."""

from meissner.builds.units import exact
from meissner.check import between, not_negative, positive
from meissner.twins.slip.shear_speed import ShearSettings
from meissner.twins.slip.shear_speeds import SIZE, ShearConfig

DEFAULTS = {"k0_v": 1.55, "k1": -0.27, "n": 0.11, "vi_min_v": 2.0, "vi_max_v": 4.0, "noise_v": 0.1}
DEFAULTS |= {"still_v": 0.0025, "limit_mm_s": 3.0, "travel_mm": 0.01, "hold_cycles": 0}
PARAMETERS = {"ShearSpeed": 1}
NEEDED_CLOCKS = 70  # from frame to frame, so that no sample waits for the computation of a window


def check(base):
    if base.serial or not base.link["registers"]:
        raise ValueError(
            "[shear_speed] must go with serial = false and registers = true, which hold the speeds"
        )
    if base.period_clocks < NEEDED_CLOCKS:
        most = 1000 * base.clk_khz / NEEDED_CLOCKS
        raise ValueError(
            f"[adc]: rate_hz = {base.rate_hz:g} is too fast for [shear_speed]: computing a window takes "
            f"{NEEDED_CLOCKS} clocks, so at most {most:.0f} Hz"
        )


def config(at, given, base):
    """ShearConfig of the checked table ``given``; ``base``: meissner.builds.build.Config of the rest."""
    positive(at, given, ["k0_v", "n", "limit_mm_s"])
    not_negative(at, given, ["noise_v", "still_v", "travel_mm"])
    between(at, given, {"hold_cycles": (0, 255)})
    lot = {key.split("_")[0] if key[:2] != "vi" else key[:6]: exact(given[key]) for key in DEFAULTS}
    hold_cycles = int(lot.pop("hold"))
    codes_per_v = (1 << base.part.data_bits - base.part.signed) / exact(base.adc["volts"])
    top = (1 << base.part.data_bits - base.part.signed) - 1  # at this code the input is out of range
    try:
        settings = ShearSettings.of(codes_per_v, exact(base.rate_hz), SIZE, **lot, full=top / codes_per_v)
    except ValueError as problem:
        raise ValueError(f"{at}: {problem}") from None
    if given["vi_min_v"] > given["vi_max_v"]:
        raise ValueError(f"{at}: vi_min_v = {given['vi_min_v']:g} must not be above vi_max_v")
    return ShearConfig(settings, hold_cycles)
