"""Time from a sensor's frame to the pins of a display: what the core computes, the wait for a wrap, the
load."""

from math import ceil

from meissner.budget.terms import table
from meissner.builds.features.display import shape_of
from meissner.twins.actuate.pin_display import PHASE_BITS

MOST_S = 2e-3  # that computing and load may take, beside one drive period
NAMES = {
    "render": "the image's averages and levels, at their longest",
    "wait": "until the phase wraps: a drive period at most",
    "limits": "each pin's level within its limits",
    "shift": "into the drivers, and until the latch",
}


def of_config(config):
    """The numbers of ``meissner budget --config``; ``config``: meissner.builds.build.Config with
    [display]."""
    display = config.features["display"]
    size, clock_hz = display.size, 1000 * config.clk_khz
    wait = ceil((1 << PHASE_BITS) / display.pins.increment)
    terms = {
        "render": display.render_of(shape_of(config)).clocks,
        "wait": wait,
        "limits": size.pins,
        "shift": size.lead - size.pins,
    }
    total, fixed = sum(terms.values()), sum(terms.values()) - wait
    return {
        "config": config.name,
        "clock_hz": clock_hz,
        "terms_clocks": terms,
        "total_clocks": total,
        "total_s": total / clock_hz,
        "beside_a_period_s": fixed / clock_hz,
        "within_2_ms": fixed / clock_hz <= MOST_S,
        "frame_clocks": config.period_clocks,
        "render_within_a_frame": terms["render"] <= config.period_clocks,
    }


def tell(found):
    """The lines to print, the verdict first."""
    side = "within" if found["within_2_ms"] else "above"
    frame = "within" if found["render_within_a_frame"] else "above"
    return [
        f"from a frame's last taxel to the pins: at most {1e3 * found['total_s']:.3f} ms, of which "
        f"{1e3 * found['beside_a_period_s']:.3f} ms beside a drive period, {side} the limit of 2 ms",
        f"{found['config']}, {found['clock_hz'] / 1e6:g} MHz",
        "",
        *table(found, NAMES),
        "",
        f"computing takes {found['terms_clocks']['render']} clocks, {frame} the frame's "
        f"{found['frame_clocks']}",
    ]
