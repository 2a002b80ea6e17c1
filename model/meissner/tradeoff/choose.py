"""From needs to the cheapest configuration that meets them, with the cost of improving each figure.

Every measured point is filtered by the needs; only then the cheapest is taken. The cost of improving a figure
is read off the front of the points with that converter and window.
"""

import tempfile
from pathlib import Path

from meissner.builds import config
from meissner.report.words import number
from meissner.tables import toml
from meissner.tradeoff import area, pareto
from meissner.tradeoff.candidates import (
    AXIS,
    ERROR,
    LATENCY,
    base_of,
    board_of,
    candidates,
    tables,
)
from meissner.tradeoff.sweep import figure_of
from meissner.tradeoff.table import named

ASKED = 6  # distinct reasons of failed builds before it gives up


def broken(needs, row):
    """The needs that a row does not meet, in words."""
    found, axis = [], named(AXIS[needs.sensor])
    key = ERROR[needs.sensor]
    if needs.error is not None and key:
        found += _above(axis.figure(key), figure_of(row, key), needs.error)
    key, scale = LATENCY[needs.sensor]
    if needs.latency_ms is not None and key:
        found += _above(axis.figure(key), figure_of(row, key), needs.latency_ms / scale)
    return found


def _above(figure, value, most):
    if value is not None and value <= most:
        return []
    unit = f" {figure.unit}" if figure.unit else ""
    what = "nothing measured" if value is None else f"{number(value)}{unit}"
    return [f"{figure.label} {what} is above {number(most)}{unit}"]


def built(needs, row):
    """The Config of a row, checked on the board; ValueError with the reason if it cannot be built."""
    found = tables(needs, row)
    made = config.read(base_of(needs), found)
    board = board_of(needs.board)
    if board is not None:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "chosen.toml"
            path.write_text(toml(found), "utf-8")
            board.plan(str(path))
    return made


def lut_of(needs):
    """(LUTs, name) of the nearest configuration placed on the board; None without one."""
    base = base_of(needs)
    kept = area.of_board(needs.board, base)
    return kept and (kept["lut"], f"{needs.board}-{base}")


def _words(point, other):
    """The parameters in which a point differs from another, in words."""
    return (
        ", ".join(f"{key} {value}" for key, value in point.items() if other.get(key) != value) or "the same"
    )


def chosen(needs, results):
    """(row, Config, lines with the reasons) of the cheapest row that meets the needs and can be built."""
    rows = candidates(needs, results)
    fits = [row for row in rows if not broken(needs, row)]
    if not fits:
        nearest = min(rows, key=lambda row: len(broken(needs, row)))
        why = "; ".join(broken(needs, nearest))
        raise ValueError(f"no measured point meets the requirements; for the nearest one, {why}")
    refused = []
    for row in fits:
        try:
            made = built(needs, row)
        except ValueError as problem:
            if str(problem) not in refused:
                refused.append(str(problem))
            if len(refused) == ASKED:
                break
            continue
        return row, made, _why(needs, rows, row, made)
    raise ValueError(
        f"{len(fits)} measured points meet the requirements, but none can be built: {refused[0]}"
    )


def _why(needs, rows, row, made):
    axis = named(AXIS[needs.sensor])
    point = row["point"]
    judged = [[figure_of(one, key) for key in axis.judged] for one in rows]
    rows = [one for one, on in zip(rows, pareto.front(judged)) if on]
    lines = [f"{axis.title.lower()}: {_words(point, {})}"]
    if made.array:
        lines.append(made.settling.told(made.settle_clocks))
    for figure in axis.figures:
        value = figure_of(row, figure.key)
        if figure.judged and value is not None:
            lines.append(f"  {figure.label}: {number(value)} {figure.unit}".rstrip())
    for figure in axis.figures:
        if figure.judged:
            lines.append(_next(needs, axis, rows, row, figure))
    if needs.board or needs.lut:
        lines += _area(needs)
    return lines


def _next(needs, axis, rows, row, figure):
    """A line about the nearest row with a smaller figure, and its cost."""
    own = figure_of(row, figure.key)
    less = [
        other
        for other in rows
        if None not in (own, figure_of(other, figure.key)) and figure_of(other, figure.key) < own
    ]
    if not less:
        return f"less of '{figure.label}': no measured point has it"
    other = min(less, key=lambda each: (len(broken(needs, each)), own - figure_of(each, figure.key)))
    reasons = broken(needs, other)
    worse = [
        f"{number(figure_of(other, one.key))} instead of {number(figure_of(row, one.key))} {one.unit} of "
        f"'{one.label}'"
        for one in axis.figures
        if one.judged
        and None not in (figure_of(other, one.key), figure_of(row, one.key))
        and figure_of(other, one.key) > figure_of(row, one.key)
    ]
    part = f" on {other['part']}" if other["part"] != row["part"] else ""
    text = f"less of '{figure.label}': {number(figure_of(other, figure.key))} {figure.unit}".rstrip()
    text += f" with {_words(other['point'], row['point'])}{part}"
    if reasons:
        return f"{text}, but {'; '.join(reasons)}"
    return (
        f"{text}, for {'; '.join(worse)}"
        if worse
        else f"{text}: its cost is in figures that are not judged here"
    )


def _area(needs):
    """A line about the LUTs as far as known; ValueError if they are known to be too many."""
    if needs.board is None:
        raise ValueError("--lut applies to a board's chip: name the board with --board")
    found = lut_of(needs)
    if found is None:
        return [f"LUTs: no similar configuration was placed on {needs.board} (docs/boards.md)"]
    lut, name = found
    if needs.lut is not None and lut > needs.lut:
        raise ValueError(f"lut = {needs.lut} is too few: {name}, the nearest configuration placed, has {lut}")
    return [
        f"LUTs: {lut} of {name}, the nearest configuration placed; `make synth` reports those of this one"
    ]
