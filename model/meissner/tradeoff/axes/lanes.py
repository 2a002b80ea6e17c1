"""Converters in parallel and their inputs, against the read-out speed of an array: the twins' clock counts,
which tb/sensor/test_array_pins.py measures at the pins of the RTL."""

from meissner.budget import array
from meissner.tradeoff.axis import Axis, Figure
from meissner.twins.shared import LANES


def found(point):
    """The budget of an array; it is square unless the point has ``columns``. Rows settle for 1 us, which not
    every converter's front makes of it, or for ``settle_us``; None: as long as the converter needs."""
    return array.budget(
        *(point["side"], point.get("columns", point["side"]), 1e6 * point["clock_mhz"]),
        *(array.part_of(point["adc"]), point["converters"], point.get("settle_us", 1.0)),
        *(point["inputs"], point.get("sclk_khz")),
        health=point.get("health", False),
        settle_share=point.get("settle_share"),
        bits_per_clock=point.get("bits_per_clock", 2),
    )


def error(point):
    """Latency and frame rate in place of an error: a slow frame is not wrong, only older."""
    one = found(point)
    taxels = one["rows"] * one["columns"]
    return {
        "latency_us": 1e6 * one["total_s"],
        "frames_s": one["frames_per_second"],
        "taxels_ms": taxels * one["frames_per_second"] / 1e3,
        "us_taxel": 1e6 / one["frames_per_second"] / taxels,
    }


def cost(point):
    """Inputs, and columns per input; columns that share an input need an analogue switch."""
    pins, columns = point["converters"] * point["inputs"], point.get("columns", point["side"])
    return {"pins": pins, "switched": -(-columns // pins), "converters": point["converters"]}


def legal(point):
    try:
        return bool(found(point))
    except (ValueError, ZeroDivisionError):
        return False


AXES = (
    Axis(
        name="lanes",
        title="Converters side by side: taxels a millisecond",
        about="1 to 8 converters whose inputs the columns fill; settle 1 µs, tare, calibration",
        values={
            "adc": ("mcp3208", "ad7606", "max11125"),
            "clock_mhz": (25, 100),
            "side": (16, 64, 128),
            "converters": tuple(LANES),
            "inputs": (1, 2, 4, 8),
        },
        quick={"side": (64,), "clock_mhz": (100,)},
        shipped={"adc": "ad7606", "clock_mhz": 100, "side": 64, "converters": 8, "inputs": 8},
        apart=("side",),
        legal=legal,
        cost=cost,
        error=error,
        figures=(
            Figure("pins", "inputs of converters", "inputs", judged=True),
            Figure("switched", "columns at an input", judged=True),
            Figure("converters", "converters", judged=True),
            Figure("us_taxel", "time of a taxel", "µs", judged=True),
            Figure("latency_us", "first convert start to centre of pressure", "µs"),
            Figure("frames_s", "frames", "1/s"),
            Figure("taxels_ms", "taxels a millisecond"),
        ),
        panels=(("pins", "us_taxel"), ("switched", "us_taxel")),
    ),
)
