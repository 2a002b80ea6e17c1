"""``meissner budget``: the performance of a configuration, term by term, before anything is built.

Without ``--cop4`` it prints the latency of a scanned array (meissner.budget.array), with it the resolution of
a four-wire sensor (meissner.budget.cop4). With ``--config`` it prints the budget of each feature of a build
(meissner.builds.features), or that of its sensor, from the module here that has the name.
"""

import json
from importlib import import_module
from pathlib import Path

from meissner.files import written
from meissner.names import PICTURE


def _picture(out):
    """The file that ``out`` names, in a folder that exists; ValueError if that is impossible."""
    path = Path(out)
    if path.suffix.lower() == ".png":
        return path
    there = next(folder for folder in (path, *path.parents) if folder.exists())
    if not there.is_dir():
        raise ValueError(f"{there} is a file; name a folder or a .png file")
    path.mkdir(parents=True, exist_ok=True)
    return path / PICTURE


def command(arguments):
    """``meissner budget``."""
    if arguments.config is not None:
        _config(arguments)
        return
    side = 41 if arguments.cop4 else 64
    for name in ("rows", "columns"):
        if getattr(arguments, name) is None:
            setattr(arguments, name, side)
    if not arguments.cop4:
        _array(arguments)
        return
    from meissner.budget import cop4, cop4_report
    from meissner.physics.mesh import Mesh

    for name, value in (("rows", arguments.rows), ("columns", arguments.columns)):
        if not 1 <= value <= cop4.SIDE:
            raise ValueError(f"{name} = {value} must lie in 1 .. {cop4.SIDE}")
    mesh = Mesh(arguments.rows, arguments.columns, arguments.r, arguments.R0, arguments.V0, arguments.k)
    found = cop4.budget(mesh, arguments.adc_bits, arguments.gain, arguments.load)
    if arguments.out:
        with written(_picture(arguments.out)) as file:
            cop4_report.draw(file, found)
    if arguments.json:
        print(json.dumps(found, indent=2))
        return
    print(*cop4_report.tell(found), sep="\n")
    if arguments.out:
        print(f"\npicture: {_picture(arguments.out)}")


def _config(arguments):
    from meissner.builds import config

    if arguments.cop4 or arguments.out:
        raise ValueError("--config must go without --cop4 and --out")
    build = config.load(arguments.config)
    names = [name for name in build.features if name != "grip" or not build.array] or [build.kind]
    modules = {name: import_module(f"meissner.budget.{name}") for name in names}
    found = {name: module.of_config(build) for name, module in modules.items()}
    if arguments.json:
        print(json.dumps(found if len(found) > 1 else next(iter(found.values())), indent=2))
    else:
        print("\n\n".join("\n".join(modules[name].tell(one)) for name, one in found.items()))


def _array(arguments):
    from meissner.budget import array

    if arguments.out:
        raise ValueError(
            "--out writes the picture of --cop4; the budget of an array is only printed (--json: as JSON)"
        )
    for name in ("rows", "columns"):
        if not 1 <= getattr(arguments, name) <= 1024:
            raise ValueError(f"{name} = {getattr(arguments, name)} must lie in 1 .. 1024")
    if arguments.bits_per_clock not in (1, 2):
        raise ValueError(f"bits-per-clock = {arguments.bits_per_clock} must be 1 or 2")
    carrier = None
    if arguments.demod:
        names = ("sample_period", "periods", "skip")
        carrier = {name: getattr(arguments, name) for name in names}
    names = "converters settle_us channels sclk_khz bits_per_clock settle_share volts source_ohm adc_lanes"
    given = {name: getattr(arguments, name) for name in names.split()}
    given |= {"carrier": carrier, "health": not arguments.no_health, "tare": not arguments.no_tare}
    given["read_during"] = arguments.read == "during"
    size = arguments.rows, arguments.columns, arguments.clock
    if arguments.adc == "all":
        found, tell = array.of_parts(*size, **given), array.tell_parts
    else:
        found, tell = array.budget(*size, array.part_of(arguments.adc), **given), array.tell
    print(json.dumps(found, indent=2) if arguments.json else "\n".join(tell(found)))
