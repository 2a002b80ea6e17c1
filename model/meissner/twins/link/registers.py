"""Twin of rtl/link/msn_registers.sv: the answer to each access, and the values that the core sees.

An access is an error, and changes nothing, at an address that is not a multiple of four or has no register in
this build, and for a write to a read-only register or, while its block is on, to one that applies while
off. A build may have fewer bits for a setting than its field: the register keeps the written bytes, but a
read and the core get the value saturated to the build's bits.
"""

from meissner.twins.link.register_map import GROUPS
from meissner.twins.shared import one_of, within


def settings():
    """(group, register, field) of every setting, in the order of the parameter Resets of msn_registers."""
    return [(g, r, f) for g in GROUPS for r in g.registers for f in r.fields if f.kind == "setting"]


FIELDS = {(g.name, r.name, f.name): f for g in GROUPS for r in g.registers for f in r.fields}
ADDRESSES = {f"{g.name}.{r.name}": r.address for g in GROUPS for r in g.registers}
WIDTHS = {f.held_to: f.width for f in FIELDS.values() if f.held_to}  # the most bits a build can have
RESET_BITS = sum(field.width for _, _, field in settings())


def held(field, bits, widths):
    """``bits`` of ``field`` saturated as the core takes them; ``widths``: {name in core.widths: bits}."""
    if widths is None or not field.held_to:
        return bits
    least, most = field.ends(widths[field.held_to])
    return min(max(field.number(bits), least), most) & field.most


def reset_word(values, widths=None):
    """The parameter Resets: the map's reset values, except ``values``
    {"group.register" or "group.register.field": value}.

    ValueError for a name that is not a setting, and for a value that does not fit its register or the
    build's ``widths`` {name in core.widths: bits}.
    """
    left, word, at = dict(values), 0, 0
    for group, register, field in settings():
        name = f"{group.name}.{register.name}" + ("" if field.name == "value" else f".{field.name}")
        value = int(left.pop(name)) if name in left else None
        least, most = field.ends(widths[field.held_to] if widths and field.held_to else None)
        if value is None:
            value = field.reset
        else:
            within(**{name: (value, least, most)})
        word |= (value & field.most) << at
        at += field.width
    if left:
        raise ValueError(f"'{next(iter(left))}' is not a setting; docs/registers.md lists them")
    return word


def members(name):
    """{member: field} of the settings in msn_registers_pkg::<name>_cfg_t, highest bits first."""
    [group] = [group for group in GROUPS if group.name == name]
    return {
        register.name if field.name == "value" else f"{register.name}_{field.name}": field
        for register in group.registers
        for field in register.fields
        if field.kind == "setting"
    }


def words(name, values, widths):
    """{address: word} that writes {member: value} to registers of a group that have one field.

    ``widths``: as in ``reset_word``; ValueError for a value that does not fit them.
    """
    given = {member: field for member, field in members(name).items() if member in values}
    return {
        ADDRESSES[f"{name}.{member}"]: _bits(f"{name}.{member}", values[member], field, widths)
        for member, field in given.items()
    }


def _bits(name, value, field, widths):
    least, most = field.ends(widths[field.held_to] if field.held_to else None)
    if not least <= value <= most:
        raise ValueError(f"{name} = {value} is wider than the core has bits for")
    return value & field.most


def struct_word(name, values, widths):
    """The packed struct of a group, one without strobes and commands, with {member: value}, as a number.

    ``widths``: as in ``reset_word``; ValueError for a value that does not fit them.
    """
    word = 0
    for member, field in members(name).items():
        word = word << field.width | _bits(f"{name}.{member}", values[member], field, widths)
    return word


def struct_bytes(name, values, widths):
    """``struct_word`` padded to words of 32 bits, lowest byte first, as the simulation drivers take it."""
    bits = sum(field.width for field in members(name).values())
    return struct_word(name, values, widths).to_bytes(4 * -(-bits // 32), "little")


class Registers:
    """The registers of a build with the groups named in ``features`` (None: all).

    ``resets``: the build's parameter Resets, None for the map's own values; ``widths``: {name in core.widths:
    bits}, None for the map's widths.
    """

    def __init__(self, features=None, resets=None, widths=None):
        within(**{name: (bits, 1, WIDTHS[name]) for name, bits in (widths or {}).items()})
        self.widths = WIDTHS | (widths or {})
        known = [group.name for group in GROUPS if group.feature]
        for name in features or ():
            one_of(known, feature=name)
        self._groups = [g for g in GROUPS if not g.feature or features is None or g.name in features]
        self._bits = sum(1 << bit for bit, name in enumerate(known) if features is None or name in features)
        self.addresses = {register.address for g in self._groups for register in g.registers}
        self._at = {register.address: (g, register) for g in self._groups for register in g.registers}
        self.resets = reset_word({}) if resets is None else resets
        self.reset()

    def reset(self):
        """Every setting at its reset value, nothing pending."""
        self._written, self._seen, at = {}, {}, 0
        for group, register, field in settings():  # the ports of an absent group keep their reset values
            key = (group.name, register.name, field.name)
            given = self.resets >> at & field.most
            self._written[key], self._seen[key] = given, self._held(key, given)
            at += field.width
        self._waits = False  # a setting was written that takes effect at a frame's start

    def _held(self, key, bits):
        return held(FIELDS[key], bits, self.widths)

    def access(self, write, address, data=0, strobe=15, status=None):
        """(data, error, pulses) of one access.

        ``status``: {(group, register, field): value} from the core; pulses: the commands given.
        """
        if address not in self._at:
            return 0, True, set()
        group, register = self._at[address]
        if write:
            return (0, *self._write(group, register, data, strobe))
        word = 0
        for field in register.fields:
            key = (group.name, register.name, field.name)
            value = {
                "setting": self._held(key, self._written.get(key, 0)),
                "status": (status or {}).get(key, 0),
                "constant": field.reset,
                "features": self._bits,
                "width": self.widths.get(field.name),
                "command": 0,
            }[field.kind]
            word |= value << field.low
        return word, False, set()

    def _write(self, group, register, data, strobe):
        if not register.writable:
            return True, set()
        if register.applies == "while_off" and self.setting(group.name, "enable"):
            return True, set()
        mask = sum(255 << 8 * byte for byte in range(4) if strobe >> byte & 1)
        pulses = set()
        for field in register.fields:
            key = (group.name, register.name, field.name)
            given, kept = data >> field.low & field.most, mask >> field.low & field.most
            if not kept:
                continue
            if field.acts and mask >> field.low & 1:
                pulses.add((group.name, register.name, "written"))
            if field.kind == "command" and given & kept:
                pulses.add(key)
            elif field.kind == "setting":
                self._written[key] = (self._written[key] & ~kept) | (given & kept)
                if register.applies == "at_frame":
                    self._waits = True
                else:
                    self._seen[key] = self._held(key, self._written[key])
        return False, pulses

    @property
    def pending(self):
        """Whether a frame's start would change a setting."""
        return self._waits and not self.setting("core", "hold")

    def commit(self):
        """A frame's start: all settings that wait for it take effect, unless the host holds them."""
        if not self.setting("core", "hold"):
            self._seen = {key: self._held(key, value) for key, value in self._written.items()}
            self._waits = False

    def setting(self, group, register, field="value"):
        """The value that the core sees, as wide as the map's field."""
        return self._seen[group, register, field]
