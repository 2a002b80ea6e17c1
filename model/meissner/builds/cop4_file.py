"""The file of ``meissner process cop4``: only the tables of a four-wire sensor, or a build that has them."""

import tomllib
from pathlib import Path

from meissner.builds import config as builds
from meissner.builds import four_wires
from meissner.check import fields
from meissner.files import check_in

BUILD = {"about", "clock", "sensor", "adc"}  # only in a build's configuration


def load(path):
    """``Cop4Config`` of a TOML file; ValueError with one sentence that names the file and the place.

    ``path``: a file with these tables, or a build with kind = "electrodes", its file or its name
    (docs/config.md).
    """
    if not Path(path).is_file() and str(path) in builds.names():
        return _of_build(path)
    path = check_in(path)
    try:
        table = tomllib.loads(path.read_text("utf-8"))
    except RecursionError:
        raise ValueError(f"{path} is not a configuration: its lists are nested too deeply") from None
    except ValueError as problem:
        raise ValueError(f"{path} is not a TOML file: {problem}") from None
    if not four_wires.TABLES.keys() & table.keys() - {"mesh", "load"} and BUILD & table.keys():
        return _of_build(path)
    table = fields(str(path), table, four_wires.TABLES)
    mesh = four_wires.mesh_table(f"{path}, [mesh]", table["mesh"])
    return four_wires.config(str(path), mesh, table["converter"], table["load"])


def _of_build(path):
    """``Cop4Config`` of a build's configuration."""
    found = builds.load(path)
    if found.cop4 is None:
        raise ValueError(
            f"{path}: [sensor]: kind = '{found.kind}' must be 'electrodes' for `meissner process cop4`"
        )
    return found.cop4
