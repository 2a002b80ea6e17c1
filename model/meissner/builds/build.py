"""A build as derived from its configuration: RTL parameters, register values and units."""

from dataclasses import asdict, dataclass, field
from functools import cached_property
from math import ceil

from meissner.builds.stages import STAGES
from meissner.builds.units import Units, exact
from meissner.physics.cop4_config import Cop4Config
from meissner.twins.frontend.adc_spi import PARTS as ADC_PARTS
from meissner.twins.frontend.adc_spi import AdcSpi
from meissner.twins.frontend.scan_adc import ScanAdc
from meissner.twins.link import cobs, packet
from meissner.twins.link.registers import RESET_BITS, reset_word
from meissner.twins.slip.config import SAMPLE_BITS, TIMER_BITS, SlipConfig
from meissner.twins.slip.slip_path import check_serial

PARTS = {part.name.upper(): part for part in ADC_PARTS.values()}


@dataclass(frozen=True)
class Config:
    """A build. ``sensor``, ``adc``, ``link``, ``array``, ``health``, ``tare``: checked tables.

    ``slip``: SlipConfig; ``serial``: the slip path with two bits per clock; ``cop4``: Cop4Config;
    ``cop_slip``: (lag, CopSlipRegisters); each None (or empty) if the build has none; ``stages``: {name:
    settings} of meissner.builds.stages. ``clk_khz``, ``rate_hz``: the clock, and frames per second.
    """

    name: str
    about: str
    clk_khz: int
    sensor: dict
    adc: dict
    link: dict
    rate_hz: float
    slip: SlipConfig | None = None
    serial: bool = False
    array: dict = field(default_factory=dict)
    health: dict = field(default_factory=dict)
    tare: dict = field(default_factory=dict)
    min_load_n: float = 0.0
    cop4: Cop4Config | None = None
    cop_slip: tuple | None = None
    stages: dict = field(default_factory=dict)

    @property
    def kind(self):
        return self.sensor["kind"]

    @property
    def part(self):
        """frontend.adc_spi.Part."""
        return PARTS[self.adc["part"]]

    @property
    def channels(self):
        return 4 if self.kind == "electrodes" else self.sensor.get("channels", 1)

    @property
    def sample_bits(self):
        return 13 if self.serial else SAMPLE_BITS

    @property
    def timer_bits(self):
        """Timer bits of the slip path; without registers, only as many as its longest time needs."""
        if self.link["registers"] or self.slip is None:
            return TIMER_BITS
        return max(1, *(t.bit_length() for t in (self.slip.hold, self.slip.refractory, self.slip.blank)))

    @property
    def widths(self):
        """{name in core.widths: bits in this build}."""
        taxels = self.sensor["rows"] * self.sensor["columns"] if self.kind == "array" else self.channels
        array, level = self.array, self.slip.level if self.slip else 1
        offset = 16 if array.get("gains") == "row_column" and not array["tare"] else 17
        load = min(32, 16 + (taxels - 1).bit_length())
        return {"detail": self.sample_bits + level, "timer": self.timer_bits, "load": load, "offset": offset}

    @property
    def period_clocks(self):
        return round(1000 * self.clk_khz / exact(self.rate_hz))

    @property
    def settle_clocks(self):
        return max(1, ceil(exact(self.adc["settle_us"]) * self.clk_khz / 1000))

    @cached_property
    def scan(self):
        """Twin of the scan, for an array."""
        return ScanAdc(
            *(self.sensor["rows"], self.sensor["columns"], self.adc["converters"], self.part),
            *(self.adc["channels"], self.adc["lanes"], self.clk_khz, self.adc["sclk_khz"]),
        )

    @cached_property
    def converter(self):
        """Twin of a converter with its channels; those of an array work in parallel."""
        if self.kind == "array":
            return self.scan.adc
        sizes = (self.part, self.channels, self.adc["lanes"], self.clk_khz, self.adc["sclk_khz"])
        return AdcSpi(*sizes, self.sample_bits)

    @property
    def volts_per_code(self):
        return self.adc["volts"] / (1 << self.part.data_bits - self.part.signed)

    @property
    def units(self):
        """host.units.Units of this build's codes."""
        if self.kind == "array":
            return Units(
                clk_khz=self.clk_khz,
                rows=self.sensor["rows"],
                columns=self.sensor["columns"],
                level=self.slip.level if self.slip else 1,
                rate_hz=self.rate_hz,
                volts_of=None,
                newtons_per_code=self.array["newtons_per_count"],
                pitch_mm=self.array["pitch_mm"],
            )
        load = self.cop4.load_lsb_n if self.cop4 else None
        return Units(
            clk_khz=self.clk_khz,
            rows=1,
            columns=self.channels,
            volts_per_code=self.volts_per_code,
            level=self.slip.level if self.slip else 1,
            rate_hz=self.rate_hz,
            newtons_per_code=load,
        )

    @property
    def settings(self):
        """{"group.register[.field]": value} of the core after reset."""
        found = {"link.images": int(self.link["images"])}
        if self.kind == "array":
            found |= {"scan.enable": 1, "scan.settle": self.settle_clocks, "scan.period": self.period_clocks}
            found |= {"calibrate.preset": 4096, "cop.min_load": self.units.load_code(self.min_load_n)}
            if self.array["health"]:
                top = (1 << self.part.data_bits - self.part.signed) - 1
                low = -top - 1 if self.part.signed else 0
                found |= {f"health.{key}": value for key, value in self.health.items()}
                found |= {"health.low": low, "health.high": top}
            if self.array["tare"]:
                found |= {"tare.contact": self.tare["contact_codes"], "tare.step": self.tare["step"]}
        else:
            found |= {"adc.enable": 1, "adc.period": self.period_clocks}
        if self.slip:
            found |= {f"slip.{name}": value for name, value in self.slip.settings.items()}
        if self.cop4:
            found |= {f"cop4.{key}": value for key, value in asdict(self.cop4.registers).items()}
            if self.cop4.terms:
                found |= {f"cop4.p{place}": int(value) for place, value in enumerate(self.cop4.terms.p)}
        if self.cop_slip:
            found |= {f"cop_slip.{key}": value for key, value in asdict(self.cop_slip[1]).items()}
        for name, stage in self.stages.items():
            found |= {f"{name}.{key}": value for key, value in stage.settings.items()}
        return found

    @property
    def parameters(self):
        """Parameters of rtl/msn_core.sv: {name: int}."""
        array, slip, link = self.kind == "array", self.slip, self.link
        found = {"Adc": self.part.number, "ClkKhz": self.clk_khz, "SclkKhz": self.adc["sclk_khz"]}
        found |= {"AdcLanes": self.adc["lanes"], "BaudHz": link["baud"]}
        if array:
            sizes = {"Rows": self.sensor["rows"], "Columns": self.sensor["columns"]}
            found |= {"Array": 1, **sizes, "Converters": self.adc["converters"]}
            found |= {"AdcChannels": self.adc["channels"], "Health": int(self.array["health"])}
            found |= {"Tare": int(self.array["tare"]), "RowColumn": int(self.array["gains"] == "row_column")}
            found |= {"GainShift": 24 if self.array["gains"] == "row_column" else 12}
            found |= {"Image": int(link["images"])}
        else:
            found |= {"Channels": self.channels}
        found |= {"Slip": int(slip is not None)}
        if slip:
            found |= {"Level": slip.level, "Window": slip.window, "Hop": slip.hop}
            found |= {"TimerBits": self.timer_bits, "SampleBits": self.sample_bits}
        if self.serial:
            found |= {"Serial": 1, "AdcPeriod": self.period_clocks if self.adc["part"] == "MCP3208" else 0}
        if self.cop4:
            found |= {"Cop4": 1, "Correct": int(self.cop4.terms is not None)}
            found |= {"CopSlip": int(self.cop_slip is not None)}
            found |= {"Lag": self.cop_slip[0]} if self.cop_slip else {}
        for name in self.stages:
            found |= STAGES[name].PARAMETERS
        flags = {
            "Registers": link["registers"],
            "Statistics": link["statistics"],
            "SlipOnly": link["slip_only"],
        }
        found |= {name: int(value) for name, value in flags.items()}
        return found | {"Resets": reset_word(self.settings)}

    def check(self):
        """This Config; ValueError if its numbers do not fit together."""
        if self.kind == "array":
            needed = self.scan.latency(self.settle_clocks)["frame"]
            what = "a scan"
        else:
            needed = self.converter.safe_period()
            what = "a conversion"
        if self.period_clocks < needed:
            most = 1000 * self.clk_khz / needed
            raise ValueError(
                f"[adc]: rate_hz = {self.rate_hz:g} is too fast: {what} takes {needed} clocks, "
                f"so at most {most:.0f} Hz"
            )
        longest = (1 << (32 if self.kind == "array" else 24)) - 1
        if self.period_clocks > longest:
            least = 1000 * self.clk_khz / longest
            raise ValueError(
                f"[adc]: rate_hz = {self.rate_hz:g} is too slow: the longest period is {longest} clocks, "
                f"so at least {least:.3g} Hz"
            )
        if self.kind == "array" and self.array["health"] and self.sensor["columns"] % self.adc["converters"]:
            raise ValueError(
                f"[sensor]: columns = {self.sensor['columns']} must be a multiple of the "
                f"{self.adc['converters']} converters for health"
            )
        if self.kind == "array" and self.settle_clocks > 65535:
            most = 65535 * 1000 / self.clk_khz
            raise ValueError(
                f"[adc]: settle_us = {self.adc['settle_us']:g} must be at most {most:.1f}, 65535 clocks"
            )
        if self.serial and (self.channels != 1 or self.part.data_bits > 12 or self.link["registers"]):
            raise ValueError(
                "[slip]: serial must go with one channel of at most 12 bits and registers = false"
            )
        if self.serial:
            try:
                check_serial(self.channels, self.slip)
            except ValueError as problem:
                raise ValueError(f"[slip]: {problem}") from None
        for name in self.stages:
            STAGES[name].check(self)
        if self.link["slip_only"] and (self.kind != "channels" or self.link["registers"]):
            raise ValueError("[link]: slip_only must go with single channels and registers = false")
        if self.link["images"] and self.kind != "array":
            raise ValueError("[link]: images must go with an array")
        if self.link["baud"] * 4 > self.clk_khz * 1000:
            most = self.clk_khz * 250
            raise ValueError(
                f"[link]: baud = {self.link['baud']} must be at most {most}, a quarter of the clock"
            )
        if self.link["images"]:
            self._images_pass()
        reset_word(self.settings, self.widths)
        return self

    def _images_pass(self):
        """ValueError if the line has no capacity for one image per second in addition to all CoP frames."""
        room = self.link["baud"] / 10 - self.rate_hz * line_bytes(packet.cop_frame(0, 0, 0, 0))
        taxels = self.sensor["rows"] * self.sensor["columns"]
        image = sum(map(line_bytes, packet.image_chunks(0, [0] * taxels)))
        if room < image:
            needed = ceil(10 * (image + self.link["baud"] / 10 - room))
            raise ValueError(
                f"[link]: baud = {self.link['baud']} is too slow for images: with {self.rate_hz:g} CoP "
                f"frames and one image a second it must be at least {needed}"
            )


def line_bytes(payload):
    """Bytes on the line for a packet with this payload."""
    return len(cobs.encode(packet.packet(0, 0, 0, payload)))


def verilog(parameters):
    """The parameters as SystemVerilog literals: Resets has more bits than a plain number can."""
    return {k: f"{RESET_BITS}'h{v:x}" if k == "Resets" else str(v) for k, v in parameters.items()}
