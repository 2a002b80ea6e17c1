"""One file for a build: RTL parameters, register values and units from the sensor's own quantities.

    config = load("fingertip")          a name in model/meissner/builds/configs, or the path of a TOML file
    config.parameters                   {name: int} of rtl/msn_core.sv
    config.settings                     {"slip.threshold": code, ...}, every setting that the file determines
    config.units                        meissner.builds.units.Units

docs/config.md describes the tables. Every mistake raises ValueError in one sentence with file and place.
"""

from argparse import Namespace
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec

from meissner.builds import four_wires, input_range, keys
from meissner.builds.build import Config, verilog
from meissner.builds.features import FEATURES
from meissner.physics.adc import Adc
from meissner.tables import Table, naming, one_of, parse
from meissner.tables import read as read_table
from meissner.terminal import plain
from meissner.twins.frontend.adc_spi import AdcSpi

FOLDER = Path(__file__).parent / "configs"


def names() -> list[str]:
    """The named configurations."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def _path(name: str | Path) -> Path:
    """The file of a named configuration, or ``name`` itself."""
    path = FOLDER / f"{name}.toml"
    path = path if path.is_file() else Path(name)
    if not path.is_file():
        raise ValueError(f"'{name}' is neither a file nor one of the configurations {', '.join(names())}")
    return path


def tables(
    name: str | Path, mhz: float | None = None, part: str | None = None, registers: bool | None = None
) -> dict[str, Any]:
    """The tables of a build's file, with the clock, converter and registers of a board."""
    found = parse(_path(name), "a configuration")
    for table, key, value in (("clock", "mhz", mhz), ("adc", "part", part), ("link", "registers", registers)):
        if value is not None and isinstance(found.get(table), dict):
            found[table] = found[table] | {key: value}
    forest = found.get("forest")
    if isinstance(forest, dict) and isinstance(forest.get("file"), str):
        found["forest"] = forest | {"file": str(_path(name).parent / forest["file"])}
    return found


def load(
    name: str | Path, mhz: float | None = None, part: str | None = None, registers: bool | None = None
) -> Config:
    """A build from its name or file; ValueError with one sentence that names the file and the place.

    Parameters
    ----------
    name : str or Path
        A named configuration, or the path of a TOML file.
    mhz, part, registers : optional
        Of the board, in place of the file's: clock in MHz, converter, whether the core has registers.

    Returns
    -------
    Config
        Parameters, settings and units of the build.
    """
    path, found = _path(name), tables(name, mhz, part, registers)
    try:
        return read(path.stem, found)
    except ValueError as problem:
        raise ValueError(f"{path.name}: {problem}") from None


class _Top(Table, frozen=True, forbid_unknown_fields=False):
    """What decides on the other tables."""

    sensor: dict[str, Any]


def read(name: str, tables: dict[str, Any]) -> Config:
    """A build from its tables.

    Parameters
    ----------
    name : str
        What the build is called.
    tables : dict
        The content of a TOML file.

    Returns
    -------
    Config
        Parameters, settings and units of the build.
    """
    try:
        kind = read_table(_Top, tables).sensor.get("kind")
        with naming("[sensor]"):
            one_of("kind", kind, keys.FILES)
        adc = tables.get("adc")
        fastest = isinstance(adc, dict) and adc.get("rate_hz") == "max"
        if fastest:
            tables = tables | {"adc": {**tables["adc"], "rate_hz": 1.0}}
        return _read(name, read_table(keys.FILES[str(kind)], tables), fastest)
    except (OverflowError, ZeroDivisionError):
        raise ValueError("its numbers lead to an overflow or a division by zero") from None


def _read(name: str, file: Any, fastest: bool, least_period: int = 1) -> Config:
    """``file``: one of keys.FILES; ``fastest``: at the greatest rate, whatever the file's is, which
    ``least_period`` limits: features are known only when their settings have been made at a rate."""
    adc = getattr(file, "adc", keys.UNUSED)
    part, clk_khz = keys.PARTS[adc.part], round(1000 * file.clock.mhz)
    sclk_khz = adc.sclk_khz or part.sclk_default_khz
    base = Config(
        name=name,
        about=file.about,
        clk_khz=clk_khz,
        sensor=file.sensor,
        adc=msgspec.structs.replace(adc, sclk_khz=sclk_khz),
        link=file.link,
        rate_hz=adc.rate_hz,
        serial=bool(getattr(getattr(file, "slip", None), "serial", False)),
        array=getattr(file, "array", None),
    )
    with naming("[adc]"):
        limits = base.input
    if base.array:
        _ = base.scan  # whose limits are those of [adc]
    if fastest:
        base = replace(base, rate_hz=base.most_rate_hz(least_period))
    if isinstance(file, keys.ArrayFile):
        array = file.array
        base = replace(
            base,
            min_load_n=file.cop.min_load_n,
            cop_bits=file.cop.bits_per_clock,
            health=_filled(file.health or keys.Health(), _health(limits, base.rate_hz))
            if array.health
            else None,
            tare=_filled(file.tare or keys.Tare(), {"contact_codes": input_range.contact(limits)})
            if array.tare
            else None,
        )
    elif not isinstance(file, keys.NothingFile):
        with naming("[adc]"):
            AdcSpi(part, base.channels, adc.lanes, clk_khz, sclk_khz)
    if isinstance(file, keys.ElectrodesFile):
        bits, mesh, load = part.data_bits, file.mesh, file.load
        converter = four_wires.Converter(
            bits=bits,
            reference_v=adc.volts,
            gain=load.gain,
            difference_gain=load.difference_gain,
        )
        cop4 = four_wires.config("[load]", mesh.mesh(mesh.r_ohm), converter, load)
        base = replace(base, cop4=cop4)
        if file.cop_slip:
            with naming("[cop_slip]"):
                base = replace(base, cop_slip=file.cop_slip.codes(base.rate_hz, cop4.load_lsb_n))
    if getattr(file, "slip", None):
        with naming("[slip]"):
            base = replace(base, slip=file.slip.codes(base.units))
    features = {}
    for feature, module in FEATURES.items():
        given = getattr(file, feature, None)
        if given:
            with naming(f"[{feature}]"):
                features[feature] = module.config(given, base)
    base = replace(base, features=features)
    if fastest and base.period_clocks < base.slowest[0]:
        return _read(name, file, fastest, base.slowest[0])
    return base.check()


def _health(adc: Adc, rate_hz: float) -> dict[str, int]:
    """Defaults of [health]. A finger taps seven times a second at most: 14 jumps, which count 224.

    Where a second has not many more frames, which count it down, tapping is no different from blinking.
    """
    blink = 120 if rate_hz >= 250 else 0
    return {"band": input_range.band(adc), "jump": input_range.jump(adc), "blink": blink}


def _filled(table: Any, defaults: dict[str, int]) -> Any:
    """The table with ``defaults`` where it says nothing."""
    missing = {key: value for key, value in defaults.items() if getattr(table, key) is None}
    return msgspec.structs.replace(table, **missing)


def command_list(_: Namespace) -> None:
    width = max(map(len, names()))
    for name in names():
        print(f"{name:<{width}}  {plain(load(name).about)}")


def command_check(arguments: Namespace) -> None:
    config = load(arguments.file)
    counts = f"{len(config.parameters)} parameters, {len(config.settings)} settings"
    print(f"{plain(config.name)}: {plain(config.about)}; {counts}")
    if config.array:
        print(config.settling.told(config.settle_clocks))


def command_show(arguments: Namespace) -> None:
    config = load(arguments.file)
    print(f"{plain(config.name)}: {plain(config.about)}")
    if config.units.rate_hz:
        print(f"{config.rate_hz:.12g} {config.sampled} a second")
    print("\nparameters of msn_core")
    for name, value in verilog(config.parameters).items():
        print(f"  {name:<16} {value}")
    print("\nregisters after reset")
    for name, code in config.settings.items():
        print(f"  {name:<24} {code}")
