"""The parts of a register map; the map itself is register_map.py."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Field:
    """Bits high .. low. ``kind``: setting (the host's), status (the core's), constant, command (a pulse),
    features (a bit for each group that a build may leave out, the first lowest), width (of ``held_to``).

    ``signed``: two's complement; ``held_to``: the field of core.widths that says how many bits a build has
    for it, at whose ends the core holds it.
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
        """The number that the field's bits stand for."""
        return bits - (self.signed and bits > self.most >> 1) * (self.most + 1)

    def ends(self, width=None):
        """(least, greatest) number of ``width`` bits, None: of all."""
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
    """Registers of one feature; ``at_frame``: what is written takes effect at a frame's boundary."""

    name: str
    title: str
    feature: bool
    at_frame: bool
    registers: tuple
