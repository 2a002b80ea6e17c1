"""Latency of slip from a converter's channels: from convert start to the decision about the last channel."""

from meissner.budget.terms import table
from meissner.twins.frontend.adc_single import AdcSingle
from meissner.twins.slip.peak_to_peak import latency
from meissner.twins.slip.slip_serial import SlipSerial

NAMES = {
    "convert": "the conversion, at its longest",
    "transfer": "until the last channel's sample is offered",
    "frame_filter": "pass complete frames only",
    "haar": "detail of the sample's group",
    "peak_to_peak": "peak-to-peak of the window so far",
    "slip": "compare, update the state",
    "serial": "all of these, two bits a clock",
}


def slip_terms(slip):
    """{term: clocks} from a sample to its decision; ``slip``: SlipConfig."""
    span, hop = slip.window >> slip.level, slip.hop >> slip.level
    return {"frame_filter": 1, "haar": slip.level, "peak_to_peak": latency(span, hop), "slip": 2}


def converter_terms(converter):
    """{term: clocks} from convert start to the last channel's sample; ``converter``: AdcSpi."""
    convert = int(converter.part.conversion_max_ns * converter.clk_khz // 1_000_000)
    return {"convert": convert, "transfer": converter.latencies()[-1]}


def of_config(config):
    """``config``: meissner.builds.build.Config of single channels."""
    if config.parameters.get("AdcPeriod"):
        period, sclk_khz = config.period_clocks, config.adc.sclk_khz
        reader = AdcSingle(0, config.clk_khz, sclk_khz, period, config.sample_bits)
        terms = {"convert": 0, "transfer": reader.latency}
    else:
        terms = converter_terms(config.converter)
    if config.serial:
        path = SlipSerial(config.slip, config.sample_bits, config.timer_bits)
        terms |= {"serial": path.clocks + 1}
    else:
        terms |= slip_terms(config.slip)
    total, clock_hz = sum(terms.values()), 1000 * config.clk_khz
    return {
        "config": config.name,
        "channels": config.channels,
        "adc": config.adc.part,
        "clock_hz": clock_hz,
        "terms_clocks": terms,
        "total_clocks": total,
        "total_s": total / clock_hz,
        "group_s": ((1 << config.slip.level) - 1) / config.rate_hz,
    }


def tell(found):
    """The lines to print, the verdict first."""
    several = "s" * (found["channels"] > 1)
    return [
        f"from convert start to the slip decision: {found['total_clocks']} clocks "
        f"({1e6 * found['total_s']:.3f} us)",
        f"{found['config']}, {found['channels']} channel{several} of one {found['adc']}, "
        f"{found['clock_hz'] / 1e6:g} MHz",
        "",
        *table(found, NAMES),
        "",
        f"before it, up to {1e3 * found['group_s']:.3g} ms until a group of samples is complete",
    ]
