"""Sums over blocks of the evidence in docs/trust/*.json, which the pages and README put into words."""

from typing import NamedTuple

from coverage_points import KINDS as POINTS

CELLS = ("ecp5", "ice40")  # netlists' families of cells


class Mutants(NamedTuple):
    """``there``: all the mutants that the drawn ones were drawn from; None if a block does not record it."""

    drawn: int
    killed: int
    equivalent: int
    there: int | None


class Points(NamedTuple):
    hit: int
    reachable: int
    excluded: int


class Netlists(NamedTuple):
    """Blocks whose netlist is proven equal to the RTL, per family and as slang reads the RTL (both families);
    blocks whose reset is proven."""

    ecp5: int
    ice40: int
    slang: int
    reset: int


def kinds(blocks):
    """The blocks' results for the mutants of cells, and for those of source, as far as they exist."""
    return [b for b in blocks if "mutants" in b], [b["source"] for b in blocks if "source" in b]


def mutants(parts):
    """``parts``: the results for the cells, or for the source text, of some blocks."""
    drawn, killed, equivalent = (
        sum(part[key] for part in parts) for key in ("mutants", "killed", "equivalent")
    )
    known = all("there" in part for part in parts)
    return Mutants(drawn, killed, equivalent, sum(part["there"] for part in parts) if known else None)


def points(entries):
    """Coverage points of all kinds."""
    counts = [entry[kind] for entry in entries for kind in POINTS if kind in entry]
    return Points(*(sum(count[at] for count in counts) for at in range(3)))


def netlists(entries):
    proven = {kind: sum(bool(e.get(kind, {}).get("proven")) for e in entries) for kind in (*CELLS, "reset")}
    slang = sum(all(e.get(kind, {}).get("slang", False) for kind in CELLS) for e in entries)
    return Netlists(slang=slang, **proven)
