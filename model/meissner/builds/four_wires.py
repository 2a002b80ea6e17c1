"""Tables of the four-wire sensor in scenes, builds and files of ``meissner process cop4`` (docs/cop4.md)."""

from meissner.check import between, fields, one_of, positive
from meissner.physics.adc import Adc
from meissner.physics.cop4_config import MAX_BITS, MIN_BITS, TOUCHES, Cop4Config
from meissner.physics.mesh import Mesh

TABLES = {"mesh": dict, "converter": dict, "load": dict}
_SIZE = {"rows": int, "columns": int}
_CIRCUIT = dict.fromkeys(("R0_ohm", "V0_v", "k_n_ohm"), float)
_CONVERTER = {"bits": int, "reference_v": float, "gain": float}
_LOAD = {"lsb_n": float, "min_n": float, "correction": str}


def mesh_table(where, table, r_ohm=float):
    """The checked [mesh]; ``r_ohm``: the kind of that key, float, or list, which the caller checks."""
    table = fields(where, table, _SIZE | {"r_ohm": r_ohm} | _CIRCUIT)
    between(where, table, {"rows": (1, 1024), "columns": (1, 1024)})
    positive(where, table, [*(["r_ohm"] if r_ohm is float else []), *_CIRCUIT])
    return table


def config(where, mesh, converter, load, noise=False):
    """``Cop4Config`` of three tables; ``mesh``: as returned by ``mesh_table``, with a number for r_ohm.

    ``noise``: the converter also has ``noise_v``, as in a scene.
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
