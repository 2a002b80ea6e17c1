"""The parts of a register map, and ``read``, which makes them of the table in register_map.py."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Field:
    """Bits high .. low. ``kind``: setting (of the host), status (of the core), constant, command (a pulse),
    features (one bit per group that a build may omit, the first group lowest), width (of ``held_to``).

    ``signed``: two's complement; ``held_to``: the field of core.widths with the number of bits that a build
    has for it; the core saturates the value to these bits. ``acts``: each write of its lowest byte
    acts, even of the same value.
    """

    name: str
    high: int
    low: int
    kind: str
    reset: int
    signed: bool = False
    held_to: str = ""
    acts: bool = False

    @property
    def width(self):
        return self.high - self.low + 1

    @property
    def most(self):
        return (1 << self.width) - 1

    def number(self, bits):
        """The number that the field's bits encode."""
        return bits - (self.signed and bits > self.most >> 1) * (self.most + 1)

    def ends(self, width=None):
        """(smallest, largest) number of ``width`` bits; None: of all the field's bits."""
        width = self.width if width is None else min(width, self.width)
        return (-(1 << width - 1), (1 << width - 1) - 1) if self.signed else (0, (1 << width) - 1)


@dataclass(frozen=True)
class Register:
    """``applies``: when a written value takes effect, at_once, at_frame, at_scan, while_off or at_reset."""

    name: str
    address: int  # in bytes
    applies: str
    fields: tuple

    @property
    def strobe(self):
        return any(field.acts for field in self.fields)

    @property
    def writable(self):
        return self.applies != "at_reset" and any(f.kind in ("setting", "command") for f in self.fields)


@dataclass(frozen=True)
class Group:
    """Registers of one feature; ``feature``: a build may have none of them."""

    name: str
    title: str
    feature: bool
    registers: tuple


def read(table):
    """The groups of a table. A line at the margin is a group: its name, "always" or "feature", its title.

    The others are fields: address, register ("." and field if that is not "value"), bits, kind, reset value,
    when it applies, and what else it is: signed, written, or the name of a width that holds it.
    """
    groups = []
    for line in table.strip().splitlines():
        if not line.startswith(" "):
            name, feature, title = line.split(maxsplit=2)
            groups.append((name, title, feature == "feature", {}))
            continue
        address, name, bits, kind, reset, applies, *more = line.split()
        register, _, field = name.partition(".")
        high, low = (int(bit) for bit in bits.split(":"))
        held_to = "".join(word for word in more if word not in ("signed", "written"))
        flags = "signed" in more, held_to, "written" in more
        found = Field(field or "value", high, low, kind, int(reset, 16), *flags)
        groups[-1][3].setdefault(register, (int(address, 16), applies, []))[2].append(found)
    return tuple(
        Group(
            name,
            title,
            feature,
            tuple(
                Register(register, address, applies, tuple(fields))
                for register, (address, applies, fields) in registers.items()
            ),
        )
        for name, title, feature, registers in groups
    )
