"""Packed structs inside a core, which a simulator shows as one number. Those of msn_registers_pkg (settings
and status) follow the register map: groups in the map's order and members in the group's order, the first in
the highest bits. Those that pass between blocks are defined in rtl/msn_pkg.sv.
"""

from cocotb.triggers import RisingEdge

from meissner.twins.link.register_map import GROUPS

CFG, STATUS = "cfg", "status"


def member(register, field):
    """Name of a field's member in its group's struct: the register, then "_<field>" unless it is "value"."""
    return register if field == "value" else f"{register}_{field}"


def _members(kind):
    """(group, member, bits) in the order of the map."""
    for group in GROUPS:
        for register in group.registers:
            for field in register.fields:
                if field.kind == "status" if kind == STATUS else field.kind in ("setting", "command"):
                    yield group.name, member(register.name, field.name), field.width
            if register.strobe and kind == CFG:
                yield group.name, f"{register.name}_written", 1


def _places(listed):
    """{name: (lowest bit, bits)} of (name, bits) from the highest to the lowest."""
    places, low = {}, 0
    for name, bits in reversed(list(listed)):
        places[name] = low, bits
        low += bits
    return places


PLACES = {kind: _places((f"{g}_{m}", bits) for g, m, bits in _members(kind)) for kind in (CFG, STATUS)}
for _kind in (CFG, STATUS):  # and of each group's own struct: PLACES["slip_cfg"]["threshold"]
    for _group in GROUPS:
        _listed = [(m, bits) for g, m, bits in _members(_kind) if g == _group.name]
        PLACES[f"{_group.name}_{_kind}"] = _places(_listed)
PLACES["decision"] = _places([("raised", 1), ("last", 1), ("state", 3), ("p2p", 24), ("id", 16)])
PLACES["change"] = _places([("start", 1), ("late", 1), ("told", 3), ("state", 3), ("p2p", 24), ("id", 16)])
PLACES["verdict"] = _places([("valid", 1), ("over", 1), ("last", 1), ("id", 16)])
PLACES["shear"] = _places([("valid", 1), ("ok", 1), ("id", 3), ("speed", 16)])
PLACES["cop"] = _places([("x", 24), ("y", 24), ("load", 40), ("pressed", 1)])
PLACES["class"] = _places([("stamp", 48), ("votes", 32), ("told", 16), ("label", 16)])
_commands = [(name, 1) for name in ("cke", "cs_n", "ras_n", "cas_n", "we_n")]
PLACES["sdram"] = _places([*_commands, ("ba", 2), ("a", 13), ("dqm", 2), ("dq", 16), ("dq_enable", 1)])
PLACES["health"] = _places([("id", 24), ("faults", 8)])


def of(kind, word):
    """{name: value} of the struct's ``word``."""
    return {name: word >> low & (1 << bits) - 1 for name, (low, bits) in PLACES[kind].items()}


def slip_word(config):
    """The word of slip_cfg for a SlipConfig; fields that are None become all ones."""
    values = {name: getattr(config, name) for name in PLACES["slip_cfg"]}
    return word("slip_cfg", {name: -1 if value is None else int(value) for name, value in values.items()})


def word(kind, values):
    """The struct's word of {name: value}, two's complement if below 0; members not given are 0."""
    found = 0
    for name, value in values.items():
        low, bits = PLACES[kind][name]
        assert -1 << bits - 1 <= value < 1 << bits, (name, value)
        found |= (value & (1 << bits) - 1) << low
    return found


class Settings:
    """The settings at a block's ``port``, a struct of ``kind``; members not given are 0."""

    def __init__(self, dut, kind, port="cfg_i", **values):
        self.port, self.kind, self.values = getattr(dut, port), kind, {}
        self.put(**values)

    def put(self, **values):
        """Change members; the others stay."""
        self.values |= {name: int(value) for name, value in values.items()}
        self.port.value = word(self.kind, self.values)

    async def pulse(self, clock, **values):
        """Change members for one clock, then back to 0."""
        self.put(**values)
        await RisingEdge(clock)
        self.put(**dict.fromkeys(values, 0))


def limits(given):
    """Members of health_cfg of a Limits, or of a dict of its fields."""
    renamed = {"over_range_enable": "use_user", "edges": "use_edges"}
    values = given if isinstance(given, dict) else vars(given)
    return {renamed.get(name, name): value for name, value in values.items()}
