"""Registers by name, as docs/registers.md lists them: "slip.threshold", "core.size", "core.size.rows"."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from difflib import get_close_matches

from meissner.twins.link.register import Field, Group, Register
from meissner.twins.link.register_map import GROUPS

CONSTANTS = {
    f"{group.name}.{register.name}.{field.name}": field.reset
    for group in GROUPS
    for register in group.registers
    for field in register.fields
    if field.kind == "constant"
}
FEATURES = [group.name for group in GROUPS if group.feature]  # in the order of their bits, lowest first
WIDTHS = ("detail", "timer", "load", "offset")  # fields of core.widths
WORDS = ("tare.word", "calibrate.word")  # their value is the index of a beat in a frame


@dataclass(frozen=True)
class Place:
    """A register or one of its fields; ``field`` None: the whole word of a register with several fields."""

    name: str
    group: Group
    register: Register
    field: Field | None

    @property
    def address(self) -> int:
        return self.register.address

    @property
    def signed(self) -> bool:
        return self.field is not None and self.field.signed

    @property
    def writable(self) -> bool:
        return self.register.writable and (self.field is None or self.field.kind in ("setting", "command"))

    @property
    def setting(self) -> bool:
        """Whether a write only stores the value, and so can safely be repeated."""
        kinds = [field.kind for field in self.register.fields]
        return "setting" in kinds and "command" not in kinds and not self.register.strobe

    def value(self, word: int) -> int:
        """The value of this place in ``word``."""
        if self.field is None:
            return word
        return self.field.number(word >> self.field.low & self.field.most)

    def ends(self, build: Mapping[str, int] | None = None) -> tuple[int, int]:
        """(least, greatest) value; ``build``: {name of WIDTHS or "beats": number} as the core reports it."""
        if self.field is None:
            return 0, 0xFFFFFFFF
        if build and self.name in WORDS:
            return 0, max(0, build["beats"] - 1)
        return self.field.ends(build[self.field.held_to] if build and self.field.held_to else None)

    def into(self, word: int, value: int, build: Mapping[str, int] | None = None) -> int:
        """``word`` with ``value`` at this place; ValueError if it lies outside ``ends``."""
        least, most = self.ends(build)
        if not least <= value <= most:
            raise ValueError(f"{self.name} = {value} must lie in {least} .. {most}")
        if self.field is None:
            known = sum(field.most << field.low for field in self.register.fields)
            if value & ~known:
                raise ValueError(
                    f"{self.name} = {value} sets bits outside its fields, whose bits are 0x{known:x}"
                )
            return value
        most, low = self.field.most, self.field.low
        return word & ~(most << low) & 0xFFFFFFFF | (value & most) << low


def _places() -> Iterator[Place]:
    for group in GROUPS:
        for register in group.registers:
            name = f"{group.name}.{register.name}"
            single = register.fields[0] if len(register.fields) == 1 else None
            yield Place(name, group, register, single)
            if single is None:
                for field in register.fields:
                    yield Place(f"{name}.{field.name}", group, register, field)


PLACES = {place.name: place for place in _places()}


def place(name: str) -> Place:
    """The Place of that name; ValueError with similar names if there is none."""
    if name not in PLACES:
        near = get_close_matches(name, PLACES, 3, 0.5)
        raise ValueError(
            f"there is no register {name!r}" + (f"; did you mean {', '.join(near)}?" if near else "")
        )
    return PLACES[name]
