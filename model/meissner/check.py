"""Checks of the tables of a file; each raises ValueError with one sentence that names the place."""

from reprlib import Repr

_SHORT = Repr()
_SHORT.maxstring = _SHORT.maxother = _SHORT.maxlong = 40
_SHORT.maxlevel = 2
_KINDS = {str: "text", int: "a whole number", float: "a number", list: "a list", dict: "a table"}


def shown(value):
    """A wrong value as short text."""
    return _SHORT.repr(value)


def fields(where, table, expected):
    """Refuse unknown, missing and mistyped keys of one table; returns numbers converted to their kind."""
    for key in table:
        if key not in expected:
            raise ValueError(f"{where}: unknown key '{key}'; the keys are: {', '.join(expected)}")
    checked = {}
    for key, kind in expected.items():
        if key not in table:
            raise ValueError(f"{where}: the key '{key}' is missing")
        value = table[key]
        fits = isinstance(value, (int, float) if kind is float else kind) and not isinstance(value, bool)
        if not fits:
            raise ValueError(f"{where}: {key} = {shown(value)} must be {_KINDS[kind]}")
        if kind is float and value != value:
            raise ValueError(f"{where}: {key} = {value!r} must be a number")
        if isinstance(value, int) and kind in (int, float) and abs(value) >= 1 << 63:
            raise ValueError(f"{where}: {key} = {shown(value)} has more than 64 bits")
        checked[key] = float(value) if kind is float else value
    return checked


def positive(where, table, keys):
    for key in keys:
        if not (0 < table[key] < float("inf")):
            what = "finite" if table[key] == float("inf") else "above 0"
            raise ValueError(f"{where}: {key} = {table[key]:g} must be {what}")


def not_negative(where, table, keys):
    for key in keys:
        if table[key] < 0:
            raise ValueError(f"{where}: {key} = {table[key]:g} must not be negative")


def between(where, table, limits):
    """Refuse values outside ``limits``: {key: (least, most)}."""
    for key, (least, most) in limits.items():
        if not least <= table[key] <= most:
            raise ValueError(f"{where}: {key} = {table[key]:g} must lie in {least:g} .. {most:g}")


def one_of(where, key, value, allowed):
    if value not in list(allowed):  # an unhashable value cannot be looked up in a dict
        plain = isinstance(value, str) and len(value) < 40 and value.isprintable()
        given = value if plain else shown(value)
        raise ValueError(f"{where}: {key} = '{given}' must be one of: {', '.join(map(str, allowed))}")


def numbers(where, key, values, count=None, least=float("-inf"), most=float("inf")):
    """A list of ``count`` (or at least one) numbers in least .. most as floats."""
    fits = isinstance(values, list) and (len(values) == count if count else len(values) > 0)
    if not fits or not all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in values):
        raise ValueError(
            f"{where}: {key} = {shown(values)} must be a list of {count or 'one or more'} numbers"
        )
    for value in values:
        if not least <= value <= most:
            raise ValueError(f"{where}: {key} = {value:g} must lie in {least:g} .. {most:g}")
    return tuple(map(float, values))


def tables(where, key, rows):
    """Refuse anything but a list of at least one table."""
    if not isinstance(rows, list) or not rows or not all(isinstance(row, dict) for row in rows):
        raise ValueError(f"{where}: there must be at least one [[{key}]]")
    return rows
