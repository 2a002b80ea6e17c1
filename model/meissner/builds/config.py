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


def load(
    name: str | Path, mhz: float | None = None, part: str | None = None, registers: bool | None = None
) -> Config:
    """A build from its name or file; ValueError with one sentence that names the file and the place.

    Parameters
    ----------
    name : str or Path
        A named configuration, or the path of a TOML file.
    mhz : float, optional
        Clock of the board in MHz, in place of the file's.
    part : str, optional
        Converter of the board, in place of the file's.
    registers : bool, optional
        Whether the board's core has registers, in place of the file's key.

    Returns
    -------
    Config
        Parameters, settings and units of the build.
    """
    path = Path(name)
    if FOLDER.joinpath(f"{name}.toml").is_file():
        path = FOLDER / f"{name}.toml"
    if not path.is_file():
        raise ValueError(f"'{name}' is neither a file nor one of the configurations {', '.join(names())}")
    tables = parse(path, "a configuration")
    for table, key, value in (("clock", "mhz", mhz), ("adc", "part", part), ("link", "registers", registers)):
        if value is not None and isinstance(tables.get(table), dict):
            tables[table] = tables[table] | {key: value}
    forest = tables.get("forest")
    if isinstance(forest, dict) and isinstance(forest.get("file"), str):
        tables["forest"] = forest | {"file": str(path.parent / forest["file"])}
    try:
        return read(path.stem, tables)
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
        return _read(name, read_table(keys.FILES[str(kind)], tables))
    except (OverflowError, ZeroDivisionError):
        raise ValueError("its numbers lead to an overflow or a division by zero") from None


def _read(name: str, file: Any) -> Config:
    """``file``: one of keys.FILES."""
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
    )
    with naming("[adc]"):
        limits = base.input
    if isinstance(file, keys.ArrayFile):
        array = file.array
        base = replace(
            base,
            array=array,
            min_load_n=file.cop.min_load_n,
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
            base = replace(base, serial=file.slip.serial, slip=file.slip.codes(base.units))
    features = {}
    for feature, module in FEATURES.items():
        given = getattr(file, feature, None)
        if given:
            with naming(f"[{feature}]"):
                features[feature] = module.config(given, base)
    return replace(base, features=features).check()


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
    print(f"{plain(config.name)}: {plain(config.about)}\n\nparameters of msn_core")
    for name, value in verilog(config.parameters).items():
        print(f"  {name:<16} {value}")
    print("\nregisters after reset")
    for name, code in config.settings.items():
        print(f"  {name:<24} {code}")
