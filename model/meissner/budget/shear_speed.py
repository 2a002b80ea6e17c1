"""Latency from a window's last sample to its speed, and the waits before it: docs/shear_speed.md."""

from meissner.budget.terms import table
from meissner.twins.slip.shear_speeds import SIZE

NAMES = {
    "frame_filter": "pass complete frames only",
    "look": "compare the level with Vi and the reference",
    "k1 Vi": "multiply, one bit per clock; add k0",
    "log2": "of k and of the rise",
    "times 1/n": "multiply, one bit per clock; round",
    "exp2": "the speed",
    "judge": "flags, Vi",
    "report": "registers, reflex",
}


def of_config(config):
    """``config``: meissner.builds.build.Config with [shear_speed]."""
    settings = config.features["shear_speed"].shear
    terms = {
        "frame_filter": 1,
        "look": 2,
        "k1 Vi": 18,
        "log2": 9,
        "times 1/n": 19,
        "exp2": 7,
        "judge": 3,
        "report": 1,
    }
    window_s = (1 << SIZE.window_log2) / config.rate_hz
    travel = settings.travel / (1 << SIZE.speed_fraction) * window_s
    limit = settings.limit / (1 << SIZE.speed_fraction)
    total = sum(terms.values())
    return {
        "config": config.name,
        "clock_hz": 1000 * config.clk_khz,
        "terms_clocks": terms,
        "total_clocks": total,
        "total_s": total / (1000 * config.clk_khz),
        "window_s": window_s,
        "settle_s": window_s * (1 << SIZE.settle_log2),
        "travel_mm": travel,
        "travel_s": [travel / limit, travel / (limit / 100)],
    }


def tell(found):
    """The lines to print."""
    fast, slow = found["travel_s"]
    return [
        f"from a window's last sample to its speed of shear: at most {found['total_clocks']} clocks: "
        f"{found['total_s'] * 1e6:.3f} us",
        f"{found['config']}, {found['clock_hz'] / 1e6:g} MHz",
        "",
        *table(found, NAMES),
        "",
        f"before it: a window of {1e3 * found['window_s']:.3g} ms; {1e3 * found['settle_s']:.3g} ms at rest;",
        f"{found['travel_mm']:.3g} mm of shear, {fast:.3g} s at the limit, {slow:.3g} s at 1/100 of it",
    ]
