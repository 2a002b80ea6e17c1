"""The tables of blocks' clocks and areas in the pages; tools/figures.py writes them from the records.

A row belongs to an entry of fmax.TABLE: by its label in ``TABLES``, by the name in backticks, or by its whole
first cell. A row whose entry was never recorded is marked (not recorded) and keeps the figures of an earlier
run of the page's command.
"""

import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

import fmax
from meissner.builds import toolchain

NOT_RECORDED = "not recorded"
MARK = re.compile(rf" \((?:stale|{NOT_RECORDED})\)")
CELLS = {  # {heading: the text from a record}
    "clocks": lambda r: str(r["clocks"]),
    "MHz": lambda r: f"{r['mhz_worst']:.1f}",
    "ns": lambda r: f"{r['ns']:.1f}",
    "LUT": lambda r: str(r["area"]["lut"]),
    "cells": lambda r: str(r["area"]["lut"]),
    "FF": lambda r: str(r["area"].get("ff", "")),
    "RAM": lambda r: str(r["area"]["ram"]),
    "block RAM": lambda r: str(r["area"]["ram"]),
    "DSP": lambda r: str(r["area"]["dsp"]),
}


class Table(NamedTuple):
    """A table in docs/``page`` that begins with ``head``; ``target`` where it has no such column."""

    page: str
    head: str
    target: str = ""
    names: Mapping[str, str] = MappingProxyType({})  # {label: name of the entry}


TABLES = (
    Table(
        "array.md",
        "| configuration | target | clocks | MHz | ns | LUT | FF | RAM | DSP |",
        names={"cop_array-1024x1024x8, rows × columns": "cop_array-1024x1024x8"},
    ),
    Table("cop.md", "| configuration | target | clocks | MHz | ns | LUT | FF |"),
    Table(
        "cop4.md",
        "| configuration | target | clocks | MHz | ns | LUT | FF | RAM | DSP |",
        names={
            "cop4, 17 bits, 2 bits a clock": "cop4",
            "cop4, 17 bits, 1 bit a clock": "cop4-turn1",
            "cop4, 13 bits, 2 bits a clock": "cop4-13",
            "cop4, 13 bits, 1 bit a clock": "cop4-13-turn1",
            "cop4 with the correction, 17 bits": "cop4-correct",
            "cop4_correct alone": "cop4_correct",
            "cop_slip, a lag of 16": "cop_slip",
        },
    ),
    Table(
        "slip.md",
        "| window 64 | clocks | MHz | LUT | FF | block RAM | state per channel |",
        "ecp5",
        {
            "tumbling, 1024 channels": "slip-1024",
            "tumbling": "slip-64",
            "half-overlapped": "slip-64-half",
            "sliding, exact": "slip-64-sliding",
        },
    ),
    Table("slip.md", "| entry | ADC | slip path | cells | block RAM | MHz |", "up5k"),
    Table(
        "shear_speed.md",
        "| block | table bits | sample bits | LUT | FF | RAM | DSP | MHz |",
        "ecp5",
        {
            "`msn_shear_speed`": "shear_speed",
            "`msn_log2` alone, 27 bits": "log2",
            "`msn_exp2` alone": "exp2",
        },
    ),
)


def cells(row):
    return [cell.strip() for cell in row.strip().removeprefix("|").removesuffix("|").split("|")]


def rows(table, text):
    """The table's rows in a page's ``text``: [(row, {heading: cell}, key of its record)]."""
    assert text.count(f"\n{table.head}\n") == 1, table
    headings, found = cells(table.head), []
    for row in text.partition(f"\n{table.head}\n")[2].partition("\n\n")[0].splitlines()[1:]:
        of = dict(zip(headings, cells(row), strict=True))
        label = MARK.sub("", of[headings[0]])
        [quoted] = re.findall(r"`(.+?)`", label)[:1] or [label]
        name, target = table.names.get(label, quoted), of.get("target", table.target)
        if target not in fmax.TABLE[name][3].split():
            raise ValueError(f"docs/{table.page}: {name} has no target {target}")
        found.append((row, of, f"{name} {target}"))
    return found


def page(name, text, records):
    """The page's ``text`` with the recorded figures in its tables. ``records``: figures.Records."""
    for table in (table for table in TABLES if table.page == name):
        first = cells(table.head)[0]
        for row, of, key in rows(table, text):
            label = MARK.sub("", of[first])
            if key not in records.blocks:
                now = of | {first: f"{label} ({NOT_RECORDED})"}
            else:
                made = {head: CELLS[head](records.blocks[key]) for head in of if head in CELLS}
                now = of | made | {first: label + " (stale)" * records.stale(key)}
            text = text.replace(f"\n{row}\n", f"\n| {' | '.join(now.values())} |\n")
    return text


def write(records):
    for path in paths():
        path.write_text(page(path.name, path.read_text("utf-8"), records), "utf-8")


def paths():
    return [toolchain.ROOT / "docs" / name for name in dict.fromkeys(table.page for table in TABLES)]


def unrecorded(records):
    """Keys of rows without a record."""
    texts = {path.name: path.read_text("utf-8") for path in paths()}
    keys = [key for table in TABLES for _, _, key in rows(table, texts[table.page])]
    return [key for key in keys if key not in records.blocks]
