"""One file for a build: RTL parameters, register values and units, from the sensor's own quantities.

    config = load("fingertip")          a name of model/meissner/configs, or the path of a TOML file
    config.parameters                   {name: int} of rtl/msn_core.sv
    config.settings                     {"slip.threshold": code, ...}, every setting it decides
    config.units                        meissner.host.units.Units

docs/config.md describes the tables. Every mistake is a ValueError of one sentence that names file and place.
"""

import tomllib
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path

from meissner.cop.cop4_config import Cop4Config
from meissner.cop.cop_slip import CopSlipRegisters
from meissner.frontend.adc_spi import PARTS as ADC_PARTS
from meissner.frontend.adc_spi import AdcSpi
from meissner.frontend.scan_adc import ScanAdc
from meissner.host.units import Units
from meissner.link.registers import RESET_BITS, reset_word
from meissner.scenes import four_wires
from meissner.scenes.check import between, fields, one_of, positive
from meissner.slip.config import SAMPLE_BITS, TIMER_BITS, SlipConfig

FOLDER = Path(__file__).parent / "configs"
PARTS = {part.name.upper(): part for part in ADC_PARTS.values()}
KINDS = ("channels", "array", "electrodes")
LINK = {"baud": 3_000_000, "registers": True, "statistics": True, "images": False, "slip_only": False}
SLIP = {"window": 64, "hop": 64, "level": 1, "hold_ms": 0.0, "refractory_ms": 0.0, "blank_ms": 0.0}
ARRAY = {"health": False, "tare": True, "gains": "taxel", "newtons_per_count": 1e-3, "pitch_mm": 1.0}
HEALTH = {"band": 2, "jump": 0, "still": 120, "rail": 8, "blink": 120}
TARE = {"contact_codes": 64, "step": 1}
COP_SLIP = {"lag_ms": 16.0, "drop": 0.3, "move": 0.0, "min_n": 0.0, "hold_ms": 0.0, "refractory_ms": 0.0}


def names():
    """The named configurations."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def _with(where, table, required, defaults):
    """The checked table, absent optional keys filled in."""
    unknown = [key for key in table if key not in required and key not in defaults]
    if unknown:
        known = ", ".join([*required, *defaults])
        raise ValueError(f"{where}: unknown key '{unknown[0]}'; the keys are: {known}")
    kinds = dict(required) | {key: type(value) for key, value in defaults.items() if key in table}
    for key, kind in kinds.items():
        if kind is bool and not isinstance(table.get(key), bool):
            raise ValueError(f"{where}: {key} = {table.get(key)!r} must be true or false")
    plain = {key: value for key, value in table.items() if kinds.get(key) is not bool}
    checked = fields(where, plain, {key: kind for key, kind in kinds.items() if kind is not bool})
    return defaults | checked | {key: table[key] for key, kind in kinds.items() if kind is bool}


@dataclass(frozen=True)
class Config:
    """A build. ``sensor``, ``adc``, ``link``, ``array``, ``health``, ``tare``: checked tables.

    ``slip``: SlipConfig; ``serial``: the slip path a bit a clock; ``cop4``: Cop4Config; ``cop_slip``: (lag,
    CopSlipRegisters); each None (or empty) where the build has none. ``clk_khz``, ``rate_hz``: the clock,
    and frames a second.
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
        """Of the slip path: what its longest time needs, where no register can ask for more."""
        if self.link["registers"] or self.slip is None:
            return TIMER_BITS
        return max(1, *(t.bit_length() for t in (self.slip.hold, self.slip.refractory, self.slip.blank)))

    @property
    def period_clocks(self):
        return round(1000 * self.clk_khz / self.rate_hz)

    @property
    def settle_clocks(self):
        return max(1, -(-round(self.adc["settle_us"] * self.clk_khz) // 1000))

    @cached_property
    def scan(self):
        """Twin of the scan, for an array."""
        return ScanAdc(
            *(self.sensor["rows"], self.sensor["columns"], self.adc["converters"], self.part),
            *(self.adc["channels"], self.adc["lanes"], self.clk_khz, self.adc["sclk_khz"]),
        )

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
        """{"group.register[.field]": value} that the core has from reset on."""
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
            keys = ("threshold", "gross_threshold", "contact_level", "release_level", "contact_rises")
            keys += ("hold", "refractory", "blank")
            found |= {f"slip.{key}": int(getattr(self.slip, key)) for key in keys}
        if self.cop4:
            found |= {f"cop4.{key}": value for key, value in asdict(self.cop4.registers).items()}
            if self.cop4.terms:
                found |= {f"cop4.p{place}": int(value) for place, value in enumerate(self.cop4.terms.p)}
        if self.cop_slip:
            found |= {f"cop_slip.{key}": value for key, value in asdict(self.cop_slip[1]).items()}
        return found

    @property
    def parameters(self):
        """Of rtl/msn_core.sv: {name: int}."""
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
        flags = {
            "Registers": link["registers"],
            "Statistics": link["statistics"],
            "SlipOnly": link["slip_only"],
        }
        found |= {name: int(value) for name, value in flags.items()}
        return found | {"Resets": reset_word(self.settings)}

    def check(self):
        """ValueError where the numbers do not go together."""
        if self.kind == "array":
            needed = self.scan.latency(self.settle_clocks)["frame"]
            what = "a scan"
        else:
            lanes = self.adc["lanes"]
            adc = AdcSpi(
                self.part, self.channels, lanes, self.clk_khz, self.adc["sclk_khz"], self.sample_bits
            )
            needed = adc.safe_period()
            what = "a conversion"
        if self.period_clocks < needed:
            most = 1000 * self.clk_khz / needed
            raise ValueError(
                f"[adc]: rate_hz = {self.rate_hz:g} is too fast: {what} takes {needed} clocks, {most:.0f} Hz"
            )
        if self.serial and (self.channels != 1 or self.part.data_bits > 12 or self.link["registers"]):
            raise ValueError(
                "[slip]: serial must go with one channel of at most 12 bits and registers = false"
            )
        if self.link["slip_only"] and (self.kind != "channels" or self.link["registers"]):
            raise ValueError("[link]: slip_only must go with single channels and registers = false")
        if self.link["images"] and self.kind != "array":
            raise ValueError("[link]: images must go with an array")
        if self.link["baud"] * 4 > self.clk_khz * 1000:
            most = self.clk_khz * 250
            raise ValueError(
                f"[link]: baud = {self.link['baud']} must be at most {most}, a quarter of the clock"
            )
        reset_word(self.settings)
        return self


def verilog(parameters):
    """The parameters as SystemVerilog writes them: Resets has more bits than a plain number may."""
    return {k: f"{RESET_BITS}'h{v:x}" if k == "Resets" else str(v) for k, v in parameters.items()}


def _slip(at, table, config, volts, rises_default):
    """SlipConfig of [slip], thresholds in volts or newtons as the sensor has them."""
    unit = "n" if config.kind == "array" else "v"
    levels = [f"{key}_{unit}" for key in ("threshold", "gross_threshold", "contact_level", "release_level")]
    required = dict.fromkeys(levels, float)
    given = _with(at, table, required, SLIP | {"contact_rises": rises_default, "serial": False})
    lsb, level = volts, given["level"]
    one_of(at, "level", level, (1, 2, 3))
    scale = 2 ** (level / 2)
    details = config.rate_hz / (1 << level) / 1000
    try:
        return given["serial"], SlipConfig(
            *(given["window"], given["hop"], level),
            *(int(given[name] * scale / lsb) for name in levels[:2]),
            *(round((1 << level) * given[name] / lsb) for name in levels[2:]),
            given["contact_rises"],
            *(round(given[name] * details) for name in ("hold_ms", "refractory_ms", "blank_ms")),
        )
    except ValueError as problem:
        raise ValueError(f"{at}: {problem}") from None


def load(name, mhz=None, part=None, registers=None):
    """The Config of a named configuration or a TOML file; ``mhz``, ``part``, ``registers``: a board's."""
    path = Path(name)
    if FOLDER.joinpath(f"{name}.toml").is_file():
        path = FOLDER / f"{name}.toml"
    if not path.is_file():
        raise ValueError(f"'{name}' is neither a file nor one of the configurations {', '.join(names())}")
    try:
        tables = tomllib.loads(path.read_text("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as problem:
        raise ValueError(f"{path} is not a TOML file: {problem}") from None
    for table, key, value in (("clock", "mhz", mhz), ("adc", "part", part), ("link", "registers", registers)):
        if value is not None and table in tables:
            tables[table] = tables[table] | {key: value}
    try:
        return read(path.stem, tables)
    except ValueError as problem:
        raise ValueError(f"{path.name}: {problem}") from None
    except OverflowError as problem:
        raise ValueError(f"{path.name}: a number in it is beyond all computing: {problem}") from None


def read(name, tables):
    """The Config of ``tables``, as a TOML file has them."""
    optional = ("link", "slip", "array", "health", "tare", "cop", "mesh", "load", "cop_slip")
    known = {"about": str, "clock": dict, "sensor": dict, "adc": dict}
    for key in tables:
        if key not in known and key not in optional:
            raise ValueError(f"unknown table [{key}]; the tables are: {', '.join([*known, *optional])}")
        if key in optional and not isinstance(tables[key], dict):
            raise ValueError(f"{key} = {tables[key]!r} must be a table")
    top = fields("the top", {key: tables[key] for key in known if key in tables}, known)
    clock = fields("[clock]", top["clock"], {"mhz": float})
    between("[clock]", clock, {"mhz": (1, 200)})
    sensor = dict(top["sensor"])
    one_of("[sensor]", "kind", sensor.get("kind"), KINDS)
    sizes = {"array": {"rows": int, "columns": int}, "channels": {"channels": int}, "electrodes": {}}
    sensor = fields("[sensor]", sensor, {"kind": str} | sizes[sensor["kind"]])
    adc = _adc("[adc]", top["adc"], sensor, round(1000 * clock["mhz"]))
    link = _with("[link]", tables.get("link", {}), {}, LINK)
    between("[link]", link, {"baud": (1200, 50_000_000)})
    base = Config(name, top["about"], round(1000 * clock["mhz"]), sensor, adc, link, adc["rate_hz"])
    more = {}
    kind = sensor["kind"]
    allowed = {
        "array": ("link", "slip", "array", "health", "tare", "cop"),
        "channels": ("link", "slip"),
        "electrodes": ("link", "mesh", "load", "cop_slip"),
    }[kind]
    for key in tables:
        if key in optional and key not in allowed:
            raise ValueError(f"[{key}] must not be there with kind = '{kind}'")
    if kind == "array":
        limits = {"rows": (1, 256), "columns": (1, 256)}
        between("[sensor]", sensor, limits)
        array = _with("[array]", tables.get("array", {}), {}, ARRAY)
        positive("[array]", array, ["newtons_per_count", "pitch_mm"])
        one_of("[array]", "gains", array["gains"], ("taxel", "row_column"))
        cop = _with("[cop]", tables.get("cop", {}), {}, {"min_load_n": 0.0})
        health, tare = _tables(tables, array)
        more |= {"array": array, "min_load_n": cop["min_load_n"], "health": health, "tare": tare}
        scale = array["newtons_per_count"]
    elif kind == "electrodes":
        more |= _electrodes(tables, adc, base)
        scale = None
    else:
        between("[sensor]", sensor, {"channels": (1, 8)})
        scale = base.volts_per_code
    if "slip" in tables:
        more["serial"], more["slip"] = _slip("[slip]", tables["slip"], base, scale, kind == "array")
    elif kind == "channels":
        raise ValueError("[slip] is missing: single channels have nothing else to do")
    return Config(**{key: value for key, value in vars(base).items() if key not in more} | more).check()


def _tables(tables, array):
    """[health] and [tare], empty where the array has none."""
    for key in ("health", "tare"):
        if key in tables and not array[key]:
            raise ValueError(f"[{key}] must not be there while [array] says {key} = false")
    health = _with("[health]", tables.get("health", {}), {}, HEALTH) if array["health"] else {}
    tare = _with("[tare]", tables.get("tare", {}), {}, TARE) if array["tare"] else {}
    return health, tare


def _adc(at, table, sensor, clk_khz):
    one_of(at, "part", table.get("part"), PARTS)
    part = PARTS[table["part"]]
    optional = {"lanes": 1, "sclk_khz": part.sclk_default_khz}
    if sensor["kind"] == "array":
        optional |= {"converters": 1, "channels": 8, "settle_us": 1.0}
    adc = _with(at, table, {"part": str, "volts": float, "rate_hz": float}, optional)
    positive(at, adc, ["volts", "rate_hz", "sclk_khz"])
    try:
        if sensor["kind"] == "array":
            one_of(at, "converters", adc["converters"], (1, 2, 4, 8))
            between(at, adc, {"channels": (1, 8), "settle_us": (0, 1000)})
        else:
            count = 4 if sensor["kind"] == "electrodes" else sensor["channels"]
            AdcSpi(part, count, adc["lanes"], clk_khz, adc["sclk_khz"])
    except ValueError as problem:
        raise ValueError(f"{at}: {problem}") from None
    return adc


def _electrodes(tables, adc, base):
    for key in ("mesh", "load"):
        if key not in tables:
            raise ValueError(f"[{key}] is missing")
    if not base.part.signed:
        raise ValueError(f"[adc]: part = '{adc['part']}' must be one symmetric about 0 V: the AD7606")
    load = dict(tables["load"])
    gain = load.pop("gain", 1.0)
    mesh = four_wires.mesh_table("[mesh]", tables["mesh"])
    converter = {"bits": base.part.data_bits, "reference_v": adc["volts"], "gain": gain}
    cop4 = four_wires.config("[load]", mesh, converter, load)
    found = {"cop4": cop4}
    if "cop_slip" in tables:
        at = "[cop_slip]"
        slip = _with(at, tables["cop_slip"], {}, COP_SLIP)
        between(at, slip, {"drop": (0, 0.99), "move": (0, 1.99), "min_n": (0, 60)})
        samples = base.rate_hz / 1000
        lag = max(1, round(slip["lag_ms"] * samples))
        between(at, {"lag_ms": lag}, {"lag_ms": (1, 4096)})
        registers = CopSlipRegisters(
            round(256 * slip["drop"]),
            round(16384 * slip["move"]),
            round(slip["min_n"] / cop4.load_lsb_n),
            *(round(slip[key] * samples) for key in ("hold_ms", "refractory_ms")),
        )
        found["cop_slip"] = (lag, registers)
    return found


def add_command(commands):
    """``meissner config list | check FILE | show FILE``."""
    config = commands.add_parser("config", help="check a configuration, or show what it comes to")
    actions = config.add_subparsers(dest="action", required=True, metavar="ACTION")
    listing = actions.add_parser("list", help="the named configurations, one line each")
    listing.set_defaults(call=_list)
    check = actions.add_parser("check", help="say what is wrong with a file, or that nothing is")
    check.add_argument("file", metavar="FILE", help="a TOML file (docs/config.md), or a name")
    check.set_defaults(call=_check)
    show = actions.add_parser("show", help="its RTL parameters and register values")
    show.add_argument("file", metavar="FILE", help="a TOML file, or a name")
    show.set_defaults(call=_show)


def _list(_):
    width = max(map(len, names()))
    for name in names():
        print(f"{name:<{width}}  {load(name).about}")


def _check(arguments):
    config = load(arguments.file)
    print(
        f"{config.name}: {config.about}; {len(config.parameters)} parameters, {len(config.settings)} settings"
    )


def _show(arguments):
    config = load(arguments.file)
    print(f"{config.name}: {config.about}\n\nparameters of msn_core")
    for name, value in verilog(config.parameters).items():
        print(f"  {name:<16} {value}")
    print("\nregisters after reset")
    for name, value in config.settings.items():
        print(f"  {name:<24} {value}")
