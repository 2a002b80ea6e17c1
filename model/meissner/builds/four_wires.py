"""Tables of the four-wire sensor, in scenes and in the file of ``meissner process cop4``: docs/cop4.md."""

import tomllib
from pathlib import Path

from meissner.check import between, fields, one_of, positive
from meissner.files import check_in
from meissner.physics.adc import Adc
from meissner.physics.cop4_config import MAX_BITS, MIN_BITS, TOUCHES, Cop4Config
from meissner.physics.mesh import Mesh

BUILD = {"about", "clock", "sensor", "adc"}  # that a build's configuration has and these files have not
TABLES = {"mesh": dict, "converter": dict, "load": dict}
_SIZE = {"rows": int, "columns": int}
_CIRCUIT = dict.fromkeys(("R0_ohm", "V0_v", "k_n_ohm"), float)
_CONVERTER = {"bits": int, "reference_v": float, "gain": float}
_LOAD = {"lsb_n": float, "min_n": float, "correction": str}


def mesh_table(where, table, r_ohm=float):
    """The checked [mesh]; r_ohm is a number, or by its kind a list that the caller checks."""
    table = fields(where, table, _SIZE | {"r_ohm": r_ohm} | _CIRCUIT)
    between(where, table, {"rows": (1, 1024), "columns": (1, 1024)})
    positive(where, table, [*(["r_ohm"] if r_ohm is float else []), *_CIRCUIT])
    return table


def config(where, mesh, converter, load, noise=False):
    """``Cop4Config`` of three tables, ``mesh`` one that ``mesh_table`` checked, r_ohm a number.

    ``noise``: the converter has ``noise_v`` too, as a scene's has.
    """
    at = f"{where}, [converter]"
    converter = fields(at, converter, _CONVERTER | ({"noise_v": float} if noise else {}))
    between(at, converter, {"bits": (MIN_BITS, MAX_BITS)} | ({"noise_v": (0, 1)} if noise else {}))
    positive(at, converter, ["reference_v", "gain"])
    at = f"{where}, [load]"
    load = fields(at, load, _LOAD)
    positive(at, load, ["lsb_n", "min_n"])
    one_of(at, "correction", load["correction"], TOUCHES)
    full = converter["reference_v"]
    try:
        return Cop4Config(
            mesh=Mesh(*(mesh[key] for key in (*_SIZE, "r_ohm", *_CIRCUIT))),
            adc=Adc(converter["bits"], -full, full, converter.get("noise_v", 0.0)),
            gain=converter["gain"],
            load_lsb_n=load["lsb_n"],
            min_load_n=load["min_n"],
            touch=load["correction"],
        )
    except ValueError as problem:
        raise ValueError(f"{where}: {problem}") from None


def load(path):
    """``Cop4Config`` of a TOML file; ValueError with one sentence that names the file and the place.

    Of these tables, or of a build with kind = "electrodes": its file, or its name (docs/config.md).
    """
    from meissner.builds import config as build  # which has these tables, too

    if not Path(path).is_file() and str(path) in build.names():
        return _of_build(path)
    path = check_in(path)
    try:
        table = tomllib.loads(path.read_text("utf-8"))
    except RecursionError:
        raise ValueError(f"{path} is no configuration: its lists are nested too deep") from None
    except ValueError as problem:
        raise ValueError(f"{path} is not a TOML file: {problem}") from None
    if not TABLES.keys() & table.keys() - {"mesh", "load"} and BUILD & table.keys():
        return _of_build(path)
    table = fields(str(path), table, TABLES)
    return config(str(path), mesh_table(f"{path}, [mesh]", table["mesh"]), table["converter"], table["load"])


def _of_build(path):
    """Of a build's configuration."""
    from meissner.builds import config as build

    found = build.load(path)
    if found.cop4 is None:
        raise ValueError(f"{path}: [sensor] has kind = '{found.kind}', which must be 'electrodes' here")
    return found.cop4
