"""The tables of a user's TOML file as typed structs, and every mistake in it as one plain sentence.

A subclass of Table declares its keys: type, limits and default. ``parse`` reads a file, ``read`` converts a
table. msgspec checks; the sentence comes from the declared type and from what the file has:

    scene mine, [[world.conditions]]: normal_n = -2 must be above 0

Numbers stay as Python's floats, whose shortest decimal is what the file says; ``exact`` gives that decimal.
"""

import json
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from reprlib import Repr
from typing import Annotated, Any, ClassVar, NamedTuple, TypeVar

import msgspec
from msgspec import Meta
from msgspec import inspect as kinds

from meissner.arrays import LARGEST

SMALLEST = 1e-12  # with LARGEST, the sizes of any sensor, clock, converter and time
_SHORT = Repr()
_SHORT.maxstring = _SHORT.maxother = _SHORT.maxlong = 40
_SHORT.maxlevel = 2
_KEY = re.compile(r"Object (contains unknown|missing required) field `(.*)`", re.DOTALL)
_STEP = re.compile(r"\.([^.\[]+)|\[(\d+)\]")
_NAMES: dict[type, tuple[str, str]] = {
    kinds.IntType: ("a whole number", "whole numbers"),
    kinds.FloatType: ("a number", "numbers"),
    kinds.StrType: ("text", "texts"),
    kinds.BoolType: ("true or false", "switches"),
    kinds.StructType: ("a table", "tables"),
    kinds.DictType: ("a table", "tables"),
}
Positive = Annotated[float, Meta(gt=0)]
NotNegative = Annotated[float, Meta(ge=0)]
Share = Annotated[float, Meta(ge=0, le=1)]
Count = Annotated[int, Meta(gt=0)]


class Table(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A table of a file. ``RENAMED``: {key written so far: (its name now, factor of its value)}."""

    RENAMED: ClassVar[Mapping[str, tuple[str, int]]] = {}

    @classmethod
    def unknown(cls, key: str, value: Any) -> str | None:
        """The sentence for a key that is none of the table's; None for the usual one."""
        if key not in cls.RENAMED:
            return None
        name, factor = cls.RENAMED[key]
        number = isinstance(value, int | float) and not isinstance(value, bool)
        now = f"{name} = {float(factor * exact(value)):g}" if number else name
        return f"{key} = {shown(value)} is now written {now} (docs/config.md)"


T = TypeVar("T", bound=Table)


class _Place(NamedTuple):
    """Where a mistake is: the table's place, its value and type; below it the key, its value and type."""

    where: str
    table: Any
    struct: Any
    key: str
    value: Any
    kind: Any
    entry: bool  # the value is an entry of the key's list


def exact(value: float | Fraction) -> Fraction:
    """The exact value of a number as written in decimal: 0.57 is 57/100."""
    return Fraction(value) if isinstance(value, int | Fraction) else Fraction(repr(float(value)))


def whole(key: str, value: float, factor: Fraction, most: int = 65535) -> int:
    """``value``·``factor`` to the nearest; ValueError above ``most``, or where only rounding makes it 0."""
    found = round(exact(value) * factor)
    if found > most or (value and not found):
        least, most_value = float(1 / (2 * factor)), float(most / factor)
        raise ValueError(f"{key} = {value:g} must be 0, or above {least:g} and at most {most_value:g}")
    return found


def shown(value: object) -> str:
    """A wrong value as short text."""
    return f"{value:g}" if isinstance(value, float) else _SHORT.repr(value)


def parse(path: Path, what: str) -> dict[str, Any]:
    """The tables of the TOML file ``path``, which should be ``what``: "a scene"; ValueError if it is none."""
    try:
        return tomllib.loads(path.read_text("utf-8"))
    except RecursionError:
        raise ValueError(f"{path} is not {what}: its lists are nested too deeply") from None
    except ValueError as problem:
        raise ValueError(f"{path} is not a TOML file: {problem}") from None


def read(kind: type[T], table: object, where: str = "") -> T:
    """``table`` as a ``kind``; ValueError with one sentence that begins with ``where`` and the table's name.

    Parameters
    ----------
    kind : type
        The Table to read.
    table : object
        What tomllib has read.
    where : str
        The file, the scene or the table that ``table`` is: "scene mine", "[slip]".

    Returns
    -------
    T
        The struct, with defaults for the keys that the table leaves out.
    """
    _sizes(table, where, [])
    try:
        return msgspec.convert(table, kind)
    except msgspec.ValidationError as problem:
        raise ValueError(_sentence(problem, kind, table, where)) from None


@contextmanager
def naming(place: str) -> Iterator[None]:
    """The sentence of a check inside begins with ``place``: of a block, or of several keys together."""
    try:
        yield
    except ValueError as problem:
        raise ValueError(f"{place}: {problem}") from None


def values(struct: msgspec.Struct) -> dict[str, Any]:
    """The keys of a struct with their values."""
    return msgspec.structs.asdict(struct)


def _sizes(value: object, where: str, path: list[str]) -> None:
    """ValueError for a number outside the range of anything that a file describes."""
    for key, inner in value.items() if isinstance(value, dict) else ():
        entries = inner if isinstance(inner, list) else [inner]
        for entry in entries:
            if isinstance(entry, dict):
                _sizes(entry, where, [*path, f"[{key}]" if entries is inner else key])
            elif isinstance(entry, int | float) and entry and not SMALLEST <= abs(entry) <= LARGEST:
                limits = f"lie in {SMALLEST:g} .. {LARGEST:g} in size, or be 0"
                limits = limits if abs(entry) < float("inf") else "be a finite number"
                raise ValueError(f"{_where(where, path)}{key} = {shown(entry)} must {limits}")


def _where(where: str, path: list[str]) -> str:
    """The beginning of a sentence: "scene mine, [[world.conditions]]: "."""
    names = [name.strip("[]") for name in path]
    table = f"[{'.'.join(names)}]" if names else ""
    if path and path[-1].startswith("["):
        table = f"[{table}]"
    return f"{', '.join(filter(None, (where, table)))}: " if where or table else ""


def _chosen(kind: Any, value: Any) -> Any:
    """The member of a union that the value means: a table by its tag, else the one that is not None."""
    if not isinstance(kind, kinds.UnionType):
        return kind
    members: list[Any] = [each for each in kind.types if not isinstance(each, kinds.NoneType)]
    given = isinstance(value, dict) and len(members) > 1
    return next((each for each in members if given and each.tag == value.get(each.tag_field)), members[0])


def _find(problem: msgspec.ValidationError, kind: type, table: Any, where: str) -> tuple[str, _Place]:
    """(what msgspec says, where)."""
    said, _, at = str(problem).rpartition(" - at `$")
    said = said or at
    path: list[str] = []
    place = _Place(where, table, kinds.type_info(kind), "", table, kinds.type_info(kind), False)
    for name, index in _STEP.findall(at.rstrip("`")) if said != at else ():
        if index:
            inner = place.kind
            value = place.value[int(index)]
            inner = inner.item_types[int(index)] if isinstance(inner, kinds.TupleType) else inner.item_type
            place = place._replace(value=value, kind=inner, entry=True)
            continue
        if place.key:  # one table further down
            path.append(f"[{place.key}]" if place.entry else place.key)
        struct, value = _chosen(place.kind, place.value), place.value
        names = {field.encode_name: field.type for field in struct.fields}
        tag = place.kind if name == struct.tag_field else None
        place = _Place(where, value, struct, name, value.get(name), names.get(name, tag), False)
    if said.startswith("Object ") or problem.__cause__:
        path += [f"[{place.key}]" if place.entry else place.key] if place.key else []
        place = place._replace(table=place.value, struct=_chosen(place.kind, place.value))
    return said, place._replace(where=_where(where, path))


def _sentence(problem: msgspec.ValidationError, kind: type, table: Any, where: str) -> str:
    said, place = _find(problem, kind, table, where)
    if problem.__cause__:
        return f"{place.where}{problem.__cause__}"
    found = _KEY.fullmatch(said)
    if found is None:
        return f"{place.where}{_demand(place)}"
    key, struct = found[2], place.struct
    if found[1].startswith("missing"):
        if key == struct.tag_field:
            return f"{place.where}{_one_of(key, None, _tags(place.kind))}"
        inner = next(field for field in struct.fields if field.encode_name == key)
        return f"{place.where}{_missing(key, inner.type, place.where)}"
    own = struct.cls.unknown(key, place.table[key])
    known = [field.encode_name for field in struct.fields]
    known = [*([struct.tag_field] if struct.tag_field else []), *known]
    return place.where + (own or f"unknown key '{shown(key)[1:-1]}'; the keys are: {', '.join(known)}")


def _missing(key: str, kind: Any, where: str) -> str:
    if _is_rows(kind):
        return f"there must be at least one [[{_inside(where, key)}]]"
    return f"the key '{key}' is missing"


def _inside(where: str, key: str) -> str:
    """The full name of the table ``key`` in the place that begins the sentence."""
    outer = re.search(r"\[([^\[\]]+)\]+: $", where)
    return f"{outer[1]}.{key}" if outer else key


def _is_rows(kind: Any) -> bool:
    """Whether the type is a list of tables."""
    inner = getattr(kind, "item_type", None)
    return isinstance(_chosen(inner, None), kinds.StructType)


def _tags(kind: Any) -> list[Any]:
    members: Any = kind.types if isinstance(kind, kinds.UnionType) else (kind,)
    return [each.tag for each in members]


def one_of(key: str, value: object, allowed: Iterable[object]) -> None:
    """ValueError unless the value of ``key`` is one of those allowed."""
    if value not in (names := list(allowed)):
        raise ValueError(_one_of(key, value, names))


def _one_of(key: str, value: object, allowed: Iterable[object]) -> str:
    plain = isinstance(value, str) and len(value) < 40 and value.isprintable()
    given = value if plain else shown(value)
    return f"{key} = '{given}' must be one of: {', '.join(map(str, allowed))}"


def _demand(place: _Place) -> str:
    """What the place's value would have to be."""
    key, value, kind = place.key, place.value, place.kind
    if key == place.struct.tag_field:
        return _one_of(key, value, _tags(kind))
    kind = _chosen(kind, value)
    if isinstance(kind, kinds.LiteralType):
        return _one_of(key, value, kind.values)
    if isinstance(kind, kinds.ListType | kinds.VarTupleType | kinds.TupleType):
        if _is_rows(kind):
            return f"there must be at least one [[{_inside(place.where, key)}]]"
        several = kind.item_types if isinstance(kind, kinds.TupleType) else ()
        inner = _chosen(several[0] if several else getattr(kind, "item_type", None), None)
        many, of = len(several) or "one or more", _NAMES.get(type(inner), ("", "entries"))[1]
        return f"{key} = {shown(value)} must be a list of {many} {of}"
    fits = isinstance(value, int | float) and not isinstance(value, bool)
    fits = fits and (isinstance(value, int) or isinstance(kind, kinds.FloatType))
    if not (fits and isinstance(kind, kinds.IntType | kinds.FloatType)):
        return f"{key} = {shown(value)} must be {_NAMES[type(kind)][0]}"
    return f"{key} = {value:g} must {_limits(kind.gt, kind.ge, kind.le)}"


def _limits(above: float | None, least: float | None, most: float | None) -> str:
    """Of a whole number, msgspec states "above 0" as "at least 1"."""
    if above is not None:
        return f"be above {above:g}" + ("" if most is None else f" and at most {most:g}")
    if most is None and least is not None:
        return "not be negative" if least == 0 else "be above 0" if least == 1 else f"be at least {least:g}"
    return f"be at most {most:g}" if least is None else f"lie in {least:g} .. {most:g}"


def toml(found: Mapping[str, Any]) -> str:
    """Tables of numbers, texts and switches as a TOML file, for which JSON's forms of these are right."""
    lines = [f"{key} = {json.dumps(given)}" for key, given in found.items() if not isinstance(given, dict)]
    for name, table in found.items():
        if isinstance(table, dict):
            lines += ["", f"[{name}]", *(f"{key} = {json.dumps(given)}" for key, given in table.items())]
    return "\n".join([*lines, ""])
