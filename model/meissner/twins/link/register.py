"""The parts of a register map; the map itself is register_map.py."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Field:
    """Bits high .. low. ``kind``: setting (of the host), status (of the core), constant, command (a pulse),
    features (one bit per group that a build may omit, the first group lowest), width (of ``held_to``).

    ``signed``: two's complement; ``held_to``: the field of core.widths with the number of bits that a build
    has for it; the core saturates the value to these bits.
    """

    name: str
    high: int
    low: int
    kind: str
    reset: int
    signed: bool = False
    held_to: str = ""

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
    name: str
    address: int  # in bytes
    text: str
    fields: tuple
    strobe: bool = False  # every write acts, even of the same value

    @property
    def writable(self):
        return any(field.kind in ("setting", "command") for field in self.fields)


@dataclass(frozen=True)
class Group:
    """Registers of one feature; ``at_frame``: a write takes effect at a frame boundary."""

    name: str
    title: str
    feature: bool
    at_frame: bool
    registers: tuple
