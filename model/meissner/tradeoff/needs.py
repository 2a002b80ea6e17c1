"""The needs of a user, and those that the named configurations were made for.

None: no such need. ``error``: at most, in per cent: for a slip sensor the runs with a missed slip or a false
alarm, for four wires the converter's part of the position error; for the centre of an array it is negligible.
``latency_ms``: at most, the median from the first partial slip to the flag, or the time from a frame's first
convert start to the centre of pressure. ``window``: samples of a window; the papers use 64. ``settle_share``:
of the old row of an array, as much as may remain when the next one is sampled; None: half a code.
"""

from dataclasses import dataclass, fields

from meissner.builds.settling import check_share

LIMITS = (("channels", 8), ("rows", 256), ("columns", 256), ("window", 4096), ("lut", 10**7))
SENSORS = ("channels", "electrodes", "array")


@dataclass(frozen=True)
class Needs:
    """``lut``: LUTs at most on the board's chip, for a configuration that was placed there."""

    sensor: str
    error: float | None = None
    latency_ms: float | None = None
    board: str | None = None
    adc: str | None = None
    channels: int | None = None
    rows: int | None = None
    columns: int | None = None
    r_ohm: float | None = None
    window: int | None = None
    lut: int | None = None
    settle_share: float | None = None

    def __post_init__(self):
        if self.sensor not in SENSORS:
            raise ValueError(f"sensor = '{self.sensor}' must be one of: {', '.join(SENSORS)}")
        for key, most in LIMITS:
            value = getattr(self, key)
            if value is not None and not 1 <= value <= most:
                raise ValueError(f"{key} = {value} must lie in 1 .. {most}")
        for key in ("error", "latency_ms", "r_ohm"):
            value = getattr(self, key)
            if value is not None and not 0 <= value < 1e9:
                raise ValueError(f"{key} = {value:g} must be a number from 0 on")
        check_share(self.settle_share)
        own = {
            "channels": ("channels", "window"),
            "electrodes": ("rows", "columns", "r_ohm"),
            "array": ("rows", "columns", "settle_share"),
        }
        for key in ("channels", "window", "rows", "columns", "r_ohm", "settle_share"):
            if getattr(self, key) is not None and key not in own[self.sensor]:
                raise ValueError(f"{key} must not be given with the sensor {self.sensor}")

    def said(self):
        """{name: value} of the given needs."""
        return {
            field.name: getattr(self, field.name)
            for field in fields(self)
            if getattr(self, field.name) is not None and field.name != "sensor"
        }


NEEDS = {
    "slip1": Needs(
        sensor="channels",
        error=0,
        latency_ms=10,
        board="icebreaker",
        adc="MCP3208",
        channels=1,
        window=64,
        lut=500,
    ),
    "cop4": Needs("electrodes", error=0.05, board="ulx3s", adc="AD7606", rows=7, columns=7, r_ohm=100.0),
    "array64": Needs(
        "array", latency_ms=1, board="ulx3s", adc="AD7606", rows=64, columns=64, settle_share=1.0
    ),
    "fingertip": Needs("array", latency_ms=1, board="icebreaker", adc="MCP3208", rows=3, columns=3),
}
