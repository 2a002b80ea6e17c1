"""The file of ``meissner process cop4``: only the tables of a four-wire sensor, or a build that has them."""

from pathlib import Path

from meissner.builds import config as builds
from meissner.builds import four_wires
from meissner.files import check_in
from meissner.physics.cop4_config import Cop4Config
from meissner.tables import Table, parse, read

BUILD = {"about", "clock", "sensor", "adc"}  # only in a build's configuration


class Keys(Table, frozen=True):
    """The file without a build."""

    mesh: four_wires.MeshKeys
    converter: four_wires.Converter
    load: four_wires.Load


def load(path: str | Path) -> Cop4Config:
    """The sensor in a TOML file; ValueError with one sentence that names the file and the place.

    Parameters
    ----------
    path : str or Path
        A file with the tables of docs/cop4.md, or a build with kind = "electrodes", its file or its name.

    Returns
    -------
    Cop4Config
        Mesh, converter, load's unit and correction.
    """
    if not Path(path).is_file() and str(path) in builds.names():
        return _of_build(path)
    path = Path(check_in(path))
    tables = parse(path, "a configuration")
    if "converter" not in tables and BUILD & tables.keys():
        return _of_build(path)
    keys = read(Keys, tables, str(path))
    mesh = keys.mesh.mesh(keys.mesh.r_ohm)
    return four_wires.config(str(path), mesh, keys.converter, keys.load)


def _of_build(path: str | Path) -> Cop4Config:
    found = builds.load(path)
    if found.cop4 is None:
        raise ValueError(
            f"{path}: [sensor]: kind = '{found.kind}' must be 'electrodes' for `meissner process cop4`"
        )
    return found.cop4
