"""[display] of a build: a tactile display, from hertz, newtons, shares and seconds."""

from math import ceil
from typing import TYPE_CHECKING, Annotated

from msgspec import Meta

from meissner.tables import NotNegative, Positive, Table, exact
from meissner.twins.actuate.display import DisplayConfig
from meissner.twins.actuate.pin_display import DisplaySettings, DisplaySize, increment_of
from meissner.twins.actuate.render import RenderSettings

if TYPE_CHECKING:
    from meissner.builds.build import Config

PARAMETERS = {"Display": 1}
TAKES = "computing a frame"
Side = Annotated[int, Meta(ge=1, le=128)]
Share = Annotated[float, Meta(ge=0, le=1)]


class Keys(Table, frozen=True):
    """The table; floor and step are the mean force, or code, of a pin's taxels."""

    rows: Side = 5
    columns: Side = 20
    chains: Annotated[int, Meta(ge=1, le=8)] = 1
    amplitude_bits: Annotated[int, Meta(ge=1, le=6)] = 4
    drive_hz: Annotated[float, Meta(ge=1, le=400)] = 230.0
    burst_s: NotNegative = 0.0
    burst_on_s: NotNegative = 0.0
    top: Annotated[int, Meta(ge=1, le=63)] = 63
    most_pins: Annotated[int, Meta(ge=1, le=4095)] | None = None
    duty: Share = 0.5
    left_on_s: Annotated[float, Meta(ge=1.43, le=21.4)] = 5.0
    stop_s: Annotated[float, Meta(gt=0, le=16)] = 0.5
    source: str = "sensor"
    floor_n: Positive | None = None
    step_n: NotNegative | None = None
    floor_codes: Annotated[int, Meta(ge=0, le=65535)] | None = None
    step_codes: Annotated[int, Meta(ge=0, le=65535)] | None = None
    marker: bool = False
    cue_frames: Annotated[int, Meta(ge=0, le=255)] = 0
    octant: Annotated[int, Meta(ge=0, le=7)] = 0
    health: bool = True

    def __post_init__(self) -> None:
        if self.source not in ("sensor", "host"):
            raise ValueError(f"source = '{self.source}' must be sensor or host")
        if self.rows * self.columns < 2:
            raise ValueError(f"columns = {self.columns} must make 2 pins or more")
        if self.burst_on_s > self.burst_s:
            raise ValueError(f"burst_on_s = {self.burst_on_s:g} must not be above burst_s = {self.burst_s:g}")
        if self.burst_s and not self.burst_on_s:
            raise ValueError(f"burst_on_s must be above 0 with burst_s = {self.burst_s:g}: no pin is ever on")
        for of in ("floor", "step"):
            if getattr(self, f"{of}_n") is not None and getattr(self, f"{of}_codes") is not None:
                raise ValueError(f"{of}_n must go without {of}_codes")


def shape_of(base: "Config") -> tuple[int, int] | None:
    """Rows and columns of the image on the pins; None for four electrodes."""
    return None if base.kind == "electrodes" else base.shape


def clocks(base: "Config") -> int:
    return int(base.features["display"].render_of(shape_of(base)).clocks)


def check(base: "Config") -> None:
    if base.kind == "channels" and base.channels < 2:
        raise ValueError("[display] must go with an array, two channels or more, or four electrodes")
    if base.serial:
        raise ValueError("[display] must go with serial = false")
    display = base.features["display"]
    stop, frame = display.pins.stop * display.size.tick_clocks, base.period_clocks + clocks(base)
    if not display.host and stop <= frame:
        stop_s, least = (count / (1000 * base.clk_khz) for count in (stop, frame))
        raise ValueError(
            f"[display]: stop_s = {stop_s:g} must be above {least:.3g}, the time from frame to frame at "
            f"rate_hz = {base.rate_hz:g}, or all is off between them"
        )
    render, slips = display.render, base.slip or base.cop_slip
    if render.cue and not slips:
        table = "[cop_slip]" if base.kind == "electrodes" else "[slip]"
        raise ValueError(f"[display]: cue_frames = {render.cue} must go with {table}, which finds a slip")
    if render.marker and base.kind == "channels":
        raise ValueError(
            "[display]: marker = true must go with an array or electrodes: it shows their centre"
        )
    if base.kind == "electrodes" and not (display.host or render.marker or render.cue):
        raise ValueError(
            "[display]: electrodes must have marker = true or cue_frames above 0: without an image no pin is "
            "ever on"
        )
    if display.host and not base.link.registers:
        raise ValueError("[display]: source = 'host' must go with registers = true")


def _codes(keys: Keys, of: str, base: "Config", otherwise: int) -> int:
    """``floor`` or ``step`` in codes of a taxel."""
    newtons, codes = getattr(keys, f"{of}_n"), getattr(keys, f"{of}_codes")
    most = base.most_force if base.array else base.input.max_code
    if newtons is None:
        if codes is not None and codes > most and base.kind != "electrodes":
            raise ValueError(f"{of}_codes = {codes} must be at most {most}, the largest code of the image")
        return otherwise if codes is None else codes
    if not base.array:
        raise ValueError(f"{of}_n must go with an array; single channels have {of}_codes")
    found = round(exact(newtons) / exact(base.array.newtons_per_count))
    if found > most or (found < 1 and newtons > 0):
        least = base.array.newtons_per_count
        raise ValueError(
            f"{of}_n = {newtons:g} must lie in {least:g} .. {most * least:g}, the forces of a taxel"
        )
    return found


def config(keys: Keys, base: "Config") -> DisplayConfig:
    """The display of a build in clocks, ticks and codes; ``base``: the rest of the build."""
    pins = keys.rows * keys.columns
    size = DisplaySize(pins, keys.chains, keys.amplitude_bits, base.clk_khz)
    periods = [round(exact(seconds) * exact(keys.drive_hz)) for seconds in (keys.burst_s, keys.burst_on_s)]
    for key, count in zip(("burst_s", "burst_on_s"), periods):
        if count > 4095 or (not count and getattr(keys, key)):
            raise ValueError(
                f"{key} = {getattr(keys, key):g} must lie in {1 / keys.drive_hz:.3g} .. "
                f"{4095 / keys.drive_hz:.4g}, drive periods"
            )
    ticks = exact(1000 * base.clk_khz) / size.tick_clocks  # of a second: 4000 or a little less
    settings = DisplaySettings(
        increment=increment_of(exact(keys.drive_hz), base.clk_khz),
        burst_period=periods[0],
        burst_on=periods[1],
        top=min(keys.top, (1 << keys.amplitude_bits) - 1),
        most=pins if keys.most_pins is None else keys.most_pins,
        duty=65535 if keys.duty == 1 else int(exact(keys.duty) * 10 * ticks),
        watchdog=int(exact(keys.left_on_s) * 7 / 10),
        stop=max(1, round(exact(keys.stop_s) * ticks)),
    )
    if exact(keys.stop_s) * exact(keys.drive_hz) <= 2:
        raise ValueError(
            f"stop_s = {keys.stop_s:g} must be above {2 / keys.drive_hz:.3g}, two drive periods: a frame is "
            "shown in the period after the one that takes it"
        )
    least = ceil(ticks / exact(keys.drive_hz)) + 2  # of a drive period, as msn_pin_limits asks for it
    if settings.duty < least:
        raise ValueError(
            f"duty = {keys.duty:g} must be at least {float(least / (10 * ticks)):g}, a drive period"
        )
    floor = _codes(keys, "floor", base, 1)
    render = RenderSettings(floor, _codes(keys, "step", base, 0), int(keys.marker), keys.cue_frames)
    grid = keys.rows, keys.columns
    return DisplayConfig(grid, size, settings, render, keys.octant, keys.health, keys.source == "host")
