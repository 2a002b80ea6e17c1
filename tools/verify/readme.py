"""README's paragraph about the evidence: results, what failed, then their limits, then what is stale."""

import formal
from verify import benches, sums

KINDS = {"formal": "proofs", "mutants": "mutants", "coverage": "coverage", "equivalence": "netlists"}
BOXES = "memories as registers and products and inner blocks as black boxes"


def paragraph(current, stale, failed):
    """``current``: {kind: facts of its blocks that are not stale}; ``stale``: {kind: how many are stale};
    ``failed``: {name of a kind: names of blocks}."""
    rows = formal.held(row for facts in current["formal"] for row in facts["proofs"].values())
    unbounded = sum(row["kind"].startswith("k") for row in rows)
    cells, source = sums.kinds(current["mutants"])
    points, netlists = sums.points(current["coverage"]), sums.netlists(current["equivalence"])
    gone = ", ".join(f"{kind} {stale[key]}" for key, kind in KINDS.items())
    reached = f"{_percent(points.hit, points.reachable)} of {points.reachable:,}"
    share = _percent(points.excluded, points.reachable + points.excluded, 0)
    blocks = f"{len(current['coverage'])} blocks"
    return (
        f"{unbounded} unbounded proofs hold, in two solvers each; the netlist is proven equal to the RTL for "
        f"{netlists.ecp5} (ECP5) and {netlists.ice40} (iCE40) of {len(benches.blocks())} blocks, for "
        f"{netlists.slang} of them as slang reads the RTL, and the reset is proven for {netlists.reset}. "
        f"The blocks' own tests killed {_killed(cells)} mutants of cells and {_killed(source)} of source, "
        f"and reached {reached} coverage points. {_failed(failed)}Limits: the mutants are samples "
        f"({_drawn(cells)}; {_drawn(source)}), coverage is of {blocks} and excludes {points.excluded:,} "
        f"points ({share} of all), and the netlist proofs treat {BOXES}. Stale blocks are not counted "
        f"({gone}); [docs/trust.md](docs/trust.md) shows every kind of evidence and what each does not show."
    )


def _percent(some, every, digits=2):
    if every and some == every:
        return "100 %"
    return f"{100 * some / max(1, every):.{digits}f} %"


def _failed(blocks):
    said = [f"{kind} of {', '.join(names)}" for kind, names in blocks.items() if names]
    return f"**Not passed: {'; '.join(said)}.** " if said else ""


def _killed(parts):
    of = sums.mutants(parts)
    return f"{of.killed:,} of {of.drawn - of.equivalent:,}"


def _drawn(parts):
    of = sums.mutants(parts)
    there = "" if of.there is None else f" of {of.there:,}"
    return f"{of.drawn:,}{there} in {len(parts)} blocks, {of.equivalent} of them equivalent"
