"""A build as derived from its configuration: RTL parameters, register values and units."""

from dataclasses import asdict, dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from math import ceil, floor, log10
from typing import Any

from meissner.builds import input_range
from meissner.builds.features import FEATURES
from meissner.builds.input_range import Sensed, Wiring
from meissner.builds.keys import (
    PARTS,
    Adc,
    Array,
    ArrayAdc,
    Channels,
    Electrodes,
    Health,
    Link,
    Nothing,
    Tare,
    Taxels,
)
from meissner.builds.settling import Settling
from meissner.builds.units import Units
from meissner.physics.adc import Adc as Converter
from meissner.physics.cop4_config import Cop4Config
from meissner.tables import exact, naming, values
from meissner.twins.cop.cop_slip import CopSlipRegisters
from meissner.twins.frontend.adc_single import AdcSingle
from meissner.twins.frontend.adc_spi import AdcSpi, Part
from meissner.twins.frontend.scan_adc import ScanAdc
from meissner.twins.link import cobs, packet
from meissner.twins.link.registers import RESET_BITS, reset_word
from meissner.twins.shared import LOAD_BITS
from meissner.twins.slip.config import SAMPLE_BITS, TIMER_BITS, SlipConfig
from meissner.twins.slip.slip_path import check_serial


@dataclass(frozen=True)
class Config:
    """A build. ``sensor``, ``adc``, ``link``, ``array``, ``health``, ``tare``: tables of its file.

    ``cop_bits``: bits of a quotient in a clock; ``slip``: its settings in codes; ``serial``: the slip path
    with two bits per clock; ``cop_slip``: (lag, registers); each None (or False) if the build has none;
    ``features``: {name: settings} of meissner.builds.features. ``clk_khz``, ``rate_hz``: the clock, and
    frames per second.
    """

    name: str
    about: str
    clk_khz: int
    sensor: Channels | Taxels | Electrodes | Nothing
    adc: Adc | ArrayAdc
    link: Link
    rate_hz: float
    slip: SlipConfig | None = None
    serial: bool = False
    array: Array | None = None
    health: Health | None = None
    tare: Tare | None = None
    min_load_n: float = 0.0
    cop_bits: int = 2
    cop4: Cop4Config | None = None
    cop_slip: tuple[int, CopSlipRegisters] | None = None
    features: dict[str, Any] = field(default_factory=dict)

    @property
    def kind(self) -> str:
        return self.sensor.kind

    @property
    def part(self) -> Part:
        return PARTS[self.adc.part]

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the array; one row of channels without one."""
        return (
            (self.sensor.rows, self.sensor.columns) if isinstance(self.sensor, Taxels) else (1, self.channels)
        )

    @property
    def channels(self) -> int:
        """Channels of a converter that single sensors take; 1 for an array."""
        if isinstance(self.sensor, Channels):
            return self.sensor.channels
        return 4 if isinstance(self.sensor, Electrodes) else 1

    @property
    def slip_pins(self) -> int:
        """Channels whose slip has a pin of its own."""
        return self.channels if self.link.slip_pins else 0

    @property
    def sample_bits(self) -> int:
        return 13 if self.serial else SAMPLE_BITS

    @property
    def timer_bits(self) -> int:
        """Timer bits of the slip path; without registers, only as many as its longest time needs."""
        if self.link.registers or self.slip is None:
            return TIMER_BITS
        return max(1, *(t.bit_length() for t in (self.slip.hold, self.slip.refractory, self.slip.blank)))

    @property
    def widths(self) -> dict[str, int]:
        """{name in core.widths: bits in this build}."""
        rows, columns = self.shape
        level = self.slip.level if self.slip else 1
        summed = self.array is not None and self.array.gains == "row_column"
        load = min(32, 16 + (rows * columns - 1).bit_length())
        offset = 16 if summed else 17
        return {"detail": self.sample_bits + level, "timer": self.timer_bits, "load": load, "offset": offset}

    @property
    def period_clocks(self) -> int:
        return round(1000 * self.clk_khz / exact(self.rate_hz))

    @property
    def least_period(self) -> int:
        """Clocks from a frame to the next one that converter and scan need."""
        if self.array:
            return self.scan.latency(self.settle_clocks)["frame"]
        if self._single:
            return AdcSingle(
                0, self.clk_khz, self.adc.sclk_khz or 0, 1 << 24, self.sample_bits
            ).minimum_period
        return self.converter.safe_period()

    @property
    def _single(self) -> bool:
        """Whether msn_adc_single reads the converter."""
        return self.serial and self.adc.part == "MCP3208"

    def most_rate_hz(self, least_period: int = 1) -> float:
        """The greatest rate: of converter and scan, of a line that carries the CoP packet of every frame and
        an image a second, and of ``least_period`` clocks at least."""
        clocks = max(self.least_period, least_period)
        if not isinstance(self.sensor, Channels):
            room = Fraction(self.link.baud, 10) - (self._image_bytes if self.link.images else 0)
            if room > 0:
                clocks = max(clocks, floor(1000 * self.clk_khz * COP_BYTES / room) + 1)
        return 1000 * self.clk_khz / clocks

    @cached_property
    def slowest(self) -> tuple[int, str, str]:
        """(clocks from frame to frame that it needs, name, what takes them) of the slowest feature."""
        built = {name: FEATURES[name] for name in self.features}
        needed = [(of.clocks(self), name, of.TAKES) for name, of in built.items() if hasattr(of, "TAKES")]
        return max(needed, default=(1, "", ""))

    @property
    def _image_bytes(self) -> int:
        rows, columns = self.shape
        return sum(map(line_bytes, packet.image_chunks(0, [0] * (rows * columns))))

    @property
    def sampled(self) -> str:
        """What ``rate_hz`` counts, in words."""
        return "frames" if self.array else "samples of each channel"

    @property
    def _array_adc(self) -> ArrayAdc:
        assert isinstance(self.adc, ArrayAdc)
        return self.adc

    @cached_property
    def settling(self) -> Settling:
        """What the scan of an array waits for."""
        return self._array_adc.settling(self.scan)

    @cached_property
    def settle_clocks(self) -> int:
        settling = self.settling
        with naming("[adc]"):
            return settling.clocks(self._array_adc.settle_us)

    @cached_property
    def scan(self) -> ScanAdc:
        """Twin of the scan, for an array."""
        with naming("[adc]"):
            return self._array_adc.scan(*self.shape, self.clk_khz)

    @cached_property
    def converter(self) -> AdcSpi:
        """Twin of a converter with its channels; those of an array work in parallel."""
        if self.array:
            return self.scan.adc
        sizes = (self.part, self.channels, self.adc.lanes, self.clk_khz, self.adc.sclk_khz)
        return AdcSpi(*sizes, self.sample_bits, read_during=self.adc.read == "during")

    @cached_property
    def input(self) -> Converter:
        """The converter's range, codes and noise."""
        return input_range.converter(self.part, self.adc.volts)

    @property
    def volts_per_code(self) -> float:
        return self.input.lsb_v

    @property
    def _sensed(self) -> tuple[Converter, Sensed, Wiring]:
        """A pull-up is usual where the code falls with the force."""
        assert isinstance(self.sensor, Sensed)
        falls = self.slip is not None and not self.array and not self.slip.contact_rises
        return self.input, self.sensor, self.sensor.wiring or ("pulled_up" if falls else "pulled_down")

    @property
    def wiring(self) -> Wiring:
        """How a sensor of channels or an array is wired."""
        return self._sensed[2]

    @property
    def rails(self) -> input_range.Rails:
        """The codes that mean a fault of a taxel or a finger."""
        return input_range.rails(*self._sensed)

    @property
    def rest_code(self) -> int:
        """The code of a sensor at rest."""
        return int(self.input.convert(input_range.rest(*self._sensed))[0])

    @property
    def most_force(self) -> int:
        """The largest force code of a taxel: with the largest gain, and at most that of 16 bits."""
        assert self.array
        gain = Fraction(65535, 4096) ** (2 if self.array.gains == "row_column" else 1)
        return min(65535, floor((self.input.max_code - self.rest_code) * gain + Fraction(1, 2)))

    @property
    def units(self) -> Units:
        """Units of this build's codes."""
        rows, columns = self.shape
        known = Units(
            clk_khz=self.clk_khz,
            rows=rows,
            columns=columns,
            level=self.slip.level if self.slip else 1,
            rate_hz=self.rate_hz,
        )
        if isinstance(self.sensor, Nothing):
            return replace(known, rate_hz=None)
        if self.array:
            known = replace(
                known,
                codes=(0, self.most_force),
                most_load=rows * columns * self.most_force,
                newtons_per_code=self.array.newtons_per_count,
                pitch_mm=self.array.pitch_mm,
                check_settle=self.settling.check,
            )
            with naming("[cop]: min_load_n"):
                return replace(known, min_load=known.load_code(self.min_load_n))
        return replace(
            known,
            codes=(self.input.min_code, self.input.max_code),
            most_load=(1 << LOAD_BITS) - 1,
            volts_per_code=self.volts_per_code,
            newtons_per_code=self.cop4.load_lsb_n if self.cop4 else None,
        )

    @property
    def settings(self) -> dict[str, int]:
        """{"group.register[.field]": value} of the core after reset."""
        found = {"link.images": int(self.link.images)}
        if self.array:
            found |= {"scan.enable": 1, "scan.settle": self.settle_clocks, "scan.period": self.period_clocks}
            found |= {"calibrate.preset": 4096, "cop.min_load": self.units.min_load or 0}
            if self.health:
                given = values(self.health)
                # A sample is marked over-range at either end: low and high say which end is a fault.
                found |= {"health.use.user": 0, "health.use.edges": int(given.pop("edges"))}
                found |= {f"health.{key}": value for key, value in given.items()}
                found |= {f"health.{key}": code for key, code in self.rails._asdict().items()}
            if self.tare:
                found |= {"tare.contact": values(self.tare)["contact_codes"], "tare.step": self.tare.step}
        elif not isinstance(self.sensor, Nothing):
            found |= {"adc.enable": 1, "adc.period": self.period_clocks}
        if self.slip:
            found |= {f"slip.{name}": value for name, value in self.slip.settings.items()}
        if self.cop4:
            found |= {f"cop4.{key}": value for key, value in asdict(self.cop4.registers).items()}
            if self.cop4.terms:
                found |= {f"cop4.p{place}": int(value) for place, value in enumerate(self.cop4.terms.p)}
        if self.cop_slip:
            found |= {f"cop_slip.{key}": value for key, value in asdict(self.cop_slip[1]).items()}
        for name, feature in self.features.items():
            found |= {f"{name}.{key}": value for key, value in feature.settings.items()}
        return found

    @property
    def parameters(self) -> dict[str, int]:
        """Parameters of rtl/msn_core.sv: {name: value}."""
        array, slip, link = self.array, self.slip, self.link
        number = 0 if isinstance(self.sensor, Nothing) else self.part.number
        found = {"Adc": number, "ClkKhz": self.clk_khz, "SclkKhz": self.adc.sclk_khz or 0}
        found |= {"AdcLanes": self.adc.lanes, "BaudHz": link.baud}
        found |= {"ReadDuring": 1} if self.adc.read == "during" else {}
        if array:
            (rows, columns), adc = self.shape, self._array_adc
            found |= {"Array": 1, "Rows": rows, "Columns": columns, "Converters": adc.converters}
            found |= {"AdcChannels": adc.channels, "Health": int(array.health)}
            found |= {"Tare": int(array.tare), "RowColumn": int(array.gains == "row_column")}
            found |= {"GainShift": 24 if array.gains == "row_column" else 12}
            found |= {"Image": int(link.images)} | ({"BitsPerClock": 1} if self.cop_bits == 1 else {})
        else:
            found |= {"Channels": self.channels}
        found |= {"Slip": int(slip is not None)}
        if slip:
            found |= {"Level": slip.level, "Window": slip.window, "Hop": slip.hop}
            found |= {"TimerBits": self.timer_bits, "SampleBits": self.sample_bits}
        if self.serial:
            found |= {"Serial": 1, "AdcPeriod": self.period_clocks if self._single else 0}
        if self.cop4:
            found |= {"Cop4": 1, "Correct": int(self.cop4.terms is not None)}
            found |= {"CopSlip": int(self.cop_slip is not None)}
            found |= {"Lag": self.cop_slip[0]} if self.cop_slip else {}
        for name, feature in self.features.items():
            found |= FEATURES[name].PARAMETERS | getattr(feature, "parameters", {})
        found |= {"Registers": int(link.registers), "Statistics": int(link.statistics)}
        found |= {"SlipOnly": int(link.slip_only)}
        return found | {"Resets": reset_word(self.settings)}

    def check(self) -> "Config":
        """This Config; ValueError if its numbers do not fit together."""
        if not isinstance(self.sensor, Nothing):
            self._sensor_fits()
        elif not self.features:
            raise ValueError("[sensor]: kind = 'none' must go with [forest]")
        if self.array:
            with naming("[adc]"):
                self.settling.check(self.settle_clocks)
            if self.settle_clocks > 65535:
                most, us = 65535 * 1000 / self.clk_khz, self.settle_clocks * 1000 / self.clk_khz
                raise ValueError(f"[adc]: settle_us = {us:.6g} must be at most {most:.1f}, 65535 clocks")
        if self.serial and (self.channels != 1 or self.part.data_bits > 12 or self.link.registers):
            raise ValueError(
                "[slip]: serial must go with one channel of at most 12 bits and registers = false"
            )
        if self.serial:
            try:
                check_serial(self.channels, self.slip)
            except ValueError as problem:
                raise ValueError(f"[slip]: {problem}") from None
        for name in self.features:
            FEATURES[name].check(self)
        clocks, name, what = self.slowest
        self._slow_enough(clocks, f" for [{name}]: {what} takes up to")
        if self.link.slip_only and (self.kind != "channels" or self.link.registers):
            raise ValueError("[link]: slip_only must go with single channels and registers = false")
        if self.link.slip_only and self.adc.read == "during":
            raise ValueError(
                "[link]: slip_only must go with [adc]: read = 'after', as it sends the last convert start"
            )
        if self.link.slip_pins and self.kind != "channels":
            raise ValueError("[link]: slip_pins must go with single channels")
        if self.link.images and not self.array:
            raise ValueError("[link]: images must go with an array")
        if self.link.baud * 4 > self.clk_khz * 1000:
            most = self.clk_khz * 250
            raise ValueError(
                f"[link]: baud = {self.link.baud} must be at most {most}, a quarter of the clock"
            )
        if self.link.images:
            self._images_pass()
        reset_word(self.settings, self.widths)
        return self

    def _slow_enough(self, clocks: int, why: str) -> None:
        """ValueError unless a period lasts so many clocks."""
        if self.period_clocks < clocks:
            most = 1000 * self.clk_khz / clocks
            step = 10.0 ** (floor(log10(most)) - 6)
            raise ValueError(
                f"[adc]: rate_hz = {self.rate_hz:g} is too fast{why} {clocks} clocks, so at most "
                f"{floor(most / step) * step:.7g} Hz"
            )

    def _sensor_fits(self) -> None:
        """ValueError if the converter is too slow or too fast, or a level in codes does not occur."""
        self._codes_occur()
        needed, what = self.least_period, "a scan" if self.array else "a conversion"
        self._slow_enough(needed, f": {what} takes")
        longest = (1 << (32 if self.array else 24)) - 1
        if self.period_clocks > longest:
            least = 1000 * self.clk_khz / longest
            raise ValueError(
                f"[adc]: rate_hz = {self.rate_hz:g} is too slow: the longest period is {longest} clocks, "
                f"so at least {least:.3g} Hz"
            )

    def _codes_occur(self) -> None:
        """ValueError for a level in codes that no sample of this sensor reaches, or that undoes another."""
        span, above = self.input.max_code - self.input.min_code, 0
        if not isinstance(self.sensor, Electrodes):
            with naming("[sensor]"):
                above = self.input.max_code - self.rest_code
        levels = [("[tare]: contact_codes", values(self.tare)["contact_codes"], above)] if self.tare else []
        if self.health:
            band, jump, blink = (values(self.health)[key] for key in ("band", "jump", "blink"))
            levels += [("[health]: band", band, span)] + ([("[health]: jump", jump, span)] if blink else [])
            if blink and jump < band:
                raise ValueError(f"[health]: jump = {jump} must be at least band = {band}: a jump is a move")
        for name, value, most in levels:
            if value >= most:
                raise ValueError(f"{name} = {value} must be below {most}, the largest step of this converter")
        if self.slip:
            rest, release = 0 if self.array else self.rest_code << self.slip.level, self.slip.release_level
            if rest >= release if self.slip.contact_rises else rest <= release:
                if self.array:
                    raise ValueError(
                        "[slip]: contact_rises = false must be true for an array, whose rest is 0 N"
                    )
                volts = input_range.rest(*self._sensed)
                raise ValueError(
                    f"[sensor]: rest_v = {volts:g} must be {'below' if self.slip.contact_rises else 'above'} "
                    "release_level_v of [slip], or a sensor at rest is never released"
                )

    def _images_pass(self) -> None:
        """ValueError if the line has no capacity for one image per second in addition to all CoP frames."""
        room = self.link.baud / 10 - self.rate_hz * COP_BYTES
        image = self._image_bytes
        if room < image:
            needed = ceil(10 * (image + self.link.baud / 10 - room))
            raise ValueError(
                f"[link]: baud = {self.link.baud} is too slow for images: with {self.rate_hz:g} CoP "
                f"frames and one image a second it must be at least {needed}"
            )


def line_bytes(payload: bytes) -> int:
    """Bytes on the line for a packet with this payload."""
    return len(cobs.encode(packet.packet(0, 0, 0, payload)))


COP_BYTES = line_bytes(packet.cop_frame(0, 0, 0, 0))


def verilog(parameters: dict[str, int]) -> dict[str, str]:
    """The parameters as SystemVerilog literals: Resets has more bits than a plain number can."""
    return {k: f"{RESET_BITS}'h{v:x}" if k == "Resets" else str(v) for k, v in parameters.items()}
