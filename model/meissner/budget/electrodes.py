"""Latency and resolution of a build of four electrodes."""

from meissner.budget import cop4, cop4_report
from meissner.budget.channels import converter_terms
from meissner.budget.terms import table

CLOCKS = {False: 17, True: 37}  # of msn_cop4 at two bits a clock; True: with the load's correction
NAMES = {
    "convert": "the conversion, at its longest",
    "transfer": "until the last electrode's sample is offered",
    "cop4": "position and load",
    "cop_slip": "slip from the load and the position",
}
LOAD_N = 5.0


def of_config(config):
    """``config``: meissner.builds.build.Config of four electrodes. ``resolution``: budget.cop4 over the
    converter's own range, rms with its own noise, behind the pairs of amplifiers of ``difference_gain``."""
    of = config.cop4
    noise_v = config.input.noise_v / of.gain
    terms = converter_terms(config.converter) | {"cop4": CLOCKS[of.terms is not None]}
    if config.cop_slip:
        terms["cop_slip"] = 5
    total, clock_hz = sum(terms.values()), 1000 * config.clk_khz
    return {
        "config": config.name,
        "adc": config.adc.part,
        "clock_hz": clock_hz,
        "terms_clocks": terms,
        "total_clocks": total,
        "total_s": total / clock_hz,
        "resolution": cop4.budget(
            *(of.mesh, of.adc.bits, of.difference_gain, LOAD_N, of.adc.high_v / of.gain, noise_v),
            pairs=True,
        ),
    }


def tell(found):
    """The lines to print, the verdict first."""
    of = "slip" if "cop_slip" in found["terms_clocks"] else "position and load"
    return [
        f"from convert start to {of}: {found['total_clocks']} clocks ({1e6 * found['total_s']:.3f} us)",
        f"{found['config']}, one {found['adc']}, {found['clock_hz'] / 1e6:g} MHz",
        "",
        *table(found, NAMES),
        "",
        *cop4_report.tell(found["resolution"]),
    ]
