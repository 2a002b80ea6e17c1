"""[grip] of a build: the reflex of a hand whose fingers are the channels, from times and counts."""

from meissner.builds.units import exact
from meissner.check import between, one_of, positive
from meissner.twins.actuate.actuate import ActuateConfig
from meissner.twins.actuate.grip import MIN_PERIOD, MODES, PERIOD_BITS, RULES, GripConfig

DEFAULTS = {"mode": "position", "rule": "any", "immediate": False, "cycle_ms": 10.0, "step": 256, "decay": 0}
DEFAULTS |= {"minimum": 1024, "maximum": 60_000, "rate": 2048, "silent_ms": 50.0, "rail_samples": 8}
DEFAULTS |= {"pulse_divide": 0, "speed_gain": 0, "boost": 0}
PARAMETERS = {"Grip": 1}


def check(base):
    if base.serial or not base.link["registers"]:
        raise ValueError("[grip] must go with serial = false and registers = true, which report a fault")


def config(at, given, base):
    """ActuateConfig of the checked table ``given``; ``base``: meissner.builds.build.Config of the rest."""
    one_of(at, "rule", given["rule"], RULES)
    one_of(at, "mode", given["mode"], MODES)
    positive(at, given, ["cycle_ms", "silent_ms"])
    between(at, given, {"rail_samples": (0, 255), "pulse_divide": (0, 255)})
    cycle = exact(given["cycle_ms"])
    period, top = round(cycle * base.clk_khz), (1 << PERIOD_BITS) - 1
    if not MIN_PERIOD <= period <= top:
        least, most = MIN_PERIOD / base.clk_khz, top / base.clk_khz
        raise ValueError(f"{at}: cycle_ms = {given['cycle_ms']:g} must lie in {least:g} .. {most:g}")
    if given["silent_ms"] < given["cycle_ms"]:
        raise ValueError(f"{at}: silent_ms = {given['silent_ms']:g} must not be below cycle_ms")
    counts = ("step", "speed_gain", "boost", "decay", "minimum", "maximum", "rate")
    counts += ("rule", "mode", "immediate")
    try:
        reflex = GripConfig(
            **{key: given[key] for key in counts},
            period=period,
            watchdog=max(1, round(exact(given["silent_ms"]) / cycle)),
        )
    except ValueError as problem:
        raise ValueError(f"{at}: {problem}") from None
    # The sensors' voltages are positive: a bipolar converter reads below 0 only from noise or if it is dead.
    high = (1 << base.part.data_bits - base.part.signed) - 1
    return ActuateConfig(reflex, 0, high, given["rail_samples"], given["pulse_divide"])
