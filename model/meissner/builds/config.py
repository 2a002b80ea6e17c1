"""One file for a build: RTL parameters, register values and units from the sensor's own quantities.

    config = load("fingertip")          a name in model/meissner/builds/configs, or the path of a TOML file
    config.parameters                   {name: int} of rtl/msn_core.sv
    config.settings                     {"slip.threshold": code, ...}, every setting that the file determines
    config.units                        meissner.builds.units.Units

docs/config.md describes the tables. Every mistake raises ValueError in one sentence with file and place.
"""

import tomllib
from dataclasses import replace
from pathlib import Path

from meissner.builds import four_wires
from meissner.builds.build import PARTS, Config, verilog
from meissner.builds.stages import STAGES
from meissner.check import between, fields, not_negative, one_of, positive, shown
from meissner.terminal import plain
from meissner.twins.cop.cop_slip import CopSlipRegisters
from meissner.twins.frontend.adc_spi import AdcSpi
from meissner.twins.slip.config import SWITCHES, SlipConfig

FOLDER = Path(__file__).parent / "configs"
SMALLEST, LARGEST = 1e-12, 1e12
KINDS = ("channels", "array", "electrodes")
LINK = {"baud": 3_000_000, "registers": True, "statistics": True, "images": False, "slip_only": False}
SLIP_CODES = ("threshold", "gross_threshold", "contact_level", "release_level")
SLIP = {"window": 64, "hop": 64, "level": 1, "hold_ms": 0.0, "refractory_ms": 0.0, "blank_ms": 0.0}
ARRAY = {"health": False, "tare": True, "gains": "taxel", "newtons_per_count": 1e-3, "pitch_mm": 1.0}
HEALTH = {"band": 2, "jump": 0, "still": 120, "rail": 8, "blink": 120}
TARE = {"contact_codes": 64, "step": 1}
COP_SLIP = {"lag_ms": 16.0, "drop": 0.3, "move": 0.0, "min_n": 0.0, "hold_ms": 0.0, "refractory_ms": 0.0}


def names():
    """The named configurations."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def _with(where, table, required, defaults):
    """The checked table, with defaults for absent optional keys."""
    unknown = [key for key in table if key not in required and key not in defaults]
    if unknown:
        known = ", ".join([*required, *defaults])
        raise ValueError(f"{where}: unknown key '{unknown[0]}'; the keys are: {known}")
    kinds = dict(required) | {key: type(value) for key, value in defaults.items() if key in table}
    for key, kind in kinds.items():
        if kind is bool and not isinstance(table.get(key), bool):
            raise ValueError(f"{where}: {key} = {shown(table.get(key))} must be true or false")
    plain = {key: value for key, value in table.items() if kinds.get(key) is not bool}
    checked = fields(where, plain, {key: kind for key, kind in kinds.items() if kind is not bool})
    return defaults | checked | {key: table[key] for key, kind in kinds.items() if kind is bool}


def _slip(at, table, config):
    """(serial, SlipConfig) of [slip]; thresholds are in newtons for an array's taxels, else in volts."""
    unit, of = ("n", "newtons") if config.kind == "array" else ("v", "volts")
    codes, times, rises = SLIP_CODES, ("hold", "refractory", "blank"), config.kind == "array"
    given = _with(
        at,
        table,
        dict.fromkeys((f"{key}_{unit}" for key in codes), float),
        SLIP | SWITCHES | {"contact_rises": rises, "serial": False, f"keep_threshold_{unit}": 0.0},
    )
    one_of(at, "level", given["level"], (1, 2, 3))
    if "hop" not in table:
        given["hop"] = given["window"]
    not_negative(at, given, ["hold_ms", "refractory_ms", "blank_ms"])
    units = replace(config.units, level=given["level"])
    keep = f"keep_threshold_{unit}"
    try:
        found = SlipConfig(
            **{key: given[key] for key in ("window", "hop", "level", *SWITCHES)},
            **{key: units.code(f"slip.{key}", of, given[f"{key}_{unit}"]) for key in codes},
            **{key: units.code(f"slip.{key}", "seconds", given[f"{key}_ms"] / 1000) for key in times},
            keep_threshold=units.code("slip.keep_threshold", of, given[keep]) if keep in table else None,
        )
    except ValueError as problem:
        raise ValueError(f"{at}: {problem}") from None
    if keep in table and given[keep] > given[f"threshold_{unit}"]:
        raise ValueError(f"{at}: {keep} = {given[keep]:g} must not be above threshold_{unit}")
    _levels(at, unit, given)
    return given["serial"], found


def _levels(at, unit, given):
    """ValueError if one level of [slip] contradicts the other; equal levels are allowed."""
    rises = given["contact_rises"]
    for upper, lower, way in (
        ("gross_threshold", "threshold", True),
        ("contact_level", "release_level", rises),
    ):
        upper, lower = f"{upper}_{unit}", f"{lower}_{unit}"
        if given[upper] != given[lower] and (given[upper] > given[lower]) != way:
            side, why = ("least", "") if way else ("most", ", as the code falls with the force")
            raise ValueError(
                f"{at}: {upper} = {given[upper]:g} must be at {side} {lower} = {given[lower]:g}{why}"
            )


def load(name, mhz=None, part=None, registers=None):
    """The Config of a named configuration or a TOML file; ``mhz``, ``part``, ``registers``: from a board."""
    path = Path(name)
    if FOLDER.joinpath(f"{name}.toml").is_file():
        path = FOLDER / f"{name}.toml"
    if not path.is_file():
        raise ValueError(f"'{name}' is neither a file nor one of the configurations {', '.join(names())}")
    try:
        tables = tomllib.loads(path.read_text("utf-8"))
    except RecursionError:
        raise ValueError(f"{path} is not a configuration: its lists are nested too deeply") from None
    except ValueError as problem:
        raise ValueError(f"{path} is not a TOML file: {problem}") from None
    for table, key, value in (("clock", "mhz", mhz), ("adc", "part", part), ("link", "registers", registers)):
        if value is not None and isinstance(tables.get(table), dict):
            tables[table] = tables[table] | {key: value}
    try:
        return read(path.stem, tables)
    except ValueError as problem:
        raise ValueError(f"{path.name}: {problem}") from None


def _sizes(tables):
    """ValueError for a number outside the range of any sensor, clock or converter."""
    for table, keys in tables.items():
        for key, value in keys.items() if isinstance(keys, dict) else ():
            if isinstance(value, (int, float)) and value and not SMALLEST <= abs(value) <= LARGEST:
                if not abs(value) < float("inf"):
                    raise ValueError(f"[{table}]: {key} = {value} must be a finite number")
                limits = f"{SMALLEST:g} .. {LARGEST:g} in size, or be 0"
                raise ValueError(f"[{table}]: {key} = {shown(value)} must lie in {limits}")


def read(name, tables):
    """The Config of ``tables``, in the form of a TOML file."""
    _sizes(tables)
    try:
        return _read(name, tables)
    except (OverflowError, ZeroDivisionError):
        raise ValueError("its numbers lead to an overflow or a division by zero") from None


def _read(name, tables):
    optional = ("link", "slip", "array", "health", "tare", "cop", "mesh", "load", "cop_slip", *STAGES)
    known = {"about": str, "clock": dict, "sensor": dict, "adc": dict}
    if "converter" in tables and "adc" not in tables:
        raise ValueError(
            "[converter] belongs in a file for `meissner process cop4` (docs/cop4.md); a build has [clock], "
            "[sensor] and [adc] instead"
        )
    for key in tables:
        if key not in known and key not in optional:
            raise ValueError(
                f"unknown table [{shown(key)[1:-1]}]; the tables are: {', '.join([*known, *optional])}"
            )
        if key in optional and not isinstance(tables[key], dict):
            raise ValueError(f"{key} = {shown(tables[key])} must be a table")
    top = fields("the top", {key: tables[key] for key in known if key in tables}, known)
    if not top["about"].isprintable():
        raise ValueError(f"about = {shown(top['about'])} must be one line of text")
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
    kind = sensor["kind"]
    allowed = {
        "array": ("link", "slip", "array", "health", "tare", "cop"),
        "channels": ("link", "slip", *STAGES),
        "electrodes": ("link", "mesh", "load", "cop_slip"),
    }[kind]
    for key in tables:
        if key in optional and key not in allowed:
            raise ValueError(f"[{key}] is not allowed with kind = '{kind}'")
    if kind == "array":
        limits = {"rows": (1, 256), "columns": (1, 256)}
        between("[sensor]", sensor, limits)
        array = _with("[array]", tables.get("array", {}), {}, ARRAY)
        positive("[array]", array, ["newtons_per_count", "pitch_mm"])
        one_of("[array]", "gains", array["gains"], ("taxel", "row_column"))
        cop = _with("[cop]", tables.get("cop", {}), {}, {"min_load_n": 0.0})
        not_negative("[cop]", cop, ["min_load_n"])
        health, tare = _tables(tables, array)
        base = replace(base, array=array, min_load_n=cop["min_load_n"], health=health, tare=tare)
    elif kind == "electrodes":
        base = replace(base, **_electrodes(tables, adc, base))
    else:
        between("[sensor]", sensor, {"channels": (1, 8)})
    if "slip" in tables:
        serial, slip = _slip("[slip]", tables["slip"], base)
        base = replace(base, serial=serial, slip=slip)
    elif kind == "channels":
        raise ValueError("[slip] is missing: single channels need it")
    stages = {}
    for name in (name for name in STAGES if name in tables):
        given = _with(f"[{name}]", tables[name], {}, STAGES[name].DEFAULTS)
        stages[name] = STAGES[name].config(f"[{name}]", given, base)
    return replace(base, stages=stages).check()


def _tables(tables, array):
    """[health] and [tare], each empty if the array has none."""
    for key in ("health", "tare"):
        if key in tables and not array[key]:
            raise ValueError(f"[{key}] is not allowed with {key} = false in [array]")
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
        raise ValueError(f"[adc]: part = '{adc['part']}' must be symmetric about 0 V: use the AD7606")
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
        positive(at, slip, ["lag_ms"])
        not_negative(at, slip, ["hold_ms", "refractory_ms"])
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


def command_list(_):
    width = max(map(len, names()))
    for name in names():
        print(f"{name:<{width}}  {plain(load(name).about)}")


def command_check(arguments):
    config = load(arguments.file)
    counts = f"{len(config.parameters)} parameters, {len(config.settings)} settings"
    print(f"{plain(config.name)}: {plain(config.about)}; {counts}")


def command_show(arguments):
    config = load(arguments.file)
    print(f"{plain(config.name)}: {plain(config.about)}\n\nparameters of msn_core")
    for name, value in verilog(config.parameters).items():
        print(f"  {name:<16} {value}")
    print("\nregisters after reset")
    for name, value in config.settings.items():
        print(f"  {name:<24} {value}")
