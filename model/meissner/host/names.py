"""Registers by name, as docs/registers.md lists them: "slip.threshold", "core.size", "core.size.rows"."""

from dataclasses import dataclass
from difflib import get_close_matches

from meissner.host.register_map import GROUPS

VERSION = {
    field.name: field.reset
    for group in GROUPS
    for register in group.registers
    for field in register.fields
    if (group.name, register.name) == ("core", "version")
}
FEATURES = [group.name for group in GROUPS if group.feature]  # bit by bit, the first lowest


@dataclass(frozen=True)
class Place:
    """Bits of a register; ``field`` None: the whole word of a register with several fields."""

    name: str
    group: object
    register: object
    field: object

    @property
    def address(self):
        return self.register.address

    @property
    def signed(self):
        """The register's text says so; it is a number of two's complement then."""
        return self.register.text.endswith("signed.")

    @property
    def writable(self):
        return self.register.writable if self.field is None else self.field.kind in ("setting", "command")

    @property
    def setting(self):
        """What is written stays, and does nothing by being written: it can be written again."""
        kinds = [field.kind for field in self.register.fields]
        return "setting" in kinds and "command" not in kinds and not self.register.strobe

    def value(self, word):
        """What ``word`` holds here."""
        if self.field is None:
            return word
        value = word >> self.field.low & self.field.most
        return value - (self.signed and value > self.field.most >> 1) * (self.field.most + 1)

    def into(self, word, value):
        """``word`` with ``value`` here; ValueError if it does not fit."""
        most, low = (0xFFFFFFFF, 0) if self.field is None else (self.field.most, self.field.low)
        first, last = (-(most + 1 >> 1), most >> 1) if self.signed else (0, most)
        if not first <= value <= last:
            raise ValueError(f"{self.name} = {value} must lie in {first} .. {last}")
        return word & ~(most << low) & 0xFFFFFFFF | (value & most) << low


def _places():
    for group in GROUPS:
        for register in group.registers:
            name = f"{group.name}.{register.name}"
            single = register.fields[0] if len(register.fields) == 1 else None
            yield Place(name, group, register, single)
            if single is None:
                for field in register.fields:
                    yield Place(f"{name}.{field.name}", group, register, field)


PLACES = {place.name: place for place in _places()}


def place(name):
    """The Place of that name; ValueError with the likely ones if there is none."""
    if name not in PLACES:
        near = get_close_matches(name, PLACES, 3, 0.5)
        raise ValueError(
            f"there is no register {name!r}" + (f"; did you mean {', '.join(near)}?" if near else "")
        )
    return PLACES[name]
