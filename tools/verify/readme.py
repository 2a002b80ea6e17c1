"""README's paragraph about the evidence: results, then their limits, then what is stale."""

import formal
from coverage_points import KINDS as POINTS
from verify import benches

KINDS = {"formal": "proofs", "mutants": "mutants", "coverage": "coverage", "equivalence": "netlists"}
BOXES = "memories as registers and products and inner blocks as black boxes"


def paragraph(current, stale):
    """``current``: {kind: facts of its blocks that are not stale}; ``stale``: {kind: how many are stale}."""
    rows = formal.held(row for facts in current["formal"] for row in facts["proofs"].values())
    unbounded = sum(row["kind"].startswith("k") for row in rows)
    cells = [facts for facts in current["mutants"] if "mutants" in facts]
    source = [facts["source"] for facts in current["mutants"] if "source" in facts]
    counts = [facts[kind] for facts in current["coverage"] for kind in POINTS if kind in facts]
    hit, reachable, excluded = (sum(count[at] for count in counts) for at in range(3))
    netlists = current["equivalence"]
    proven = {kind: sum(_proven(facts, kind) for facts in netlists) for kind in ("ecp5", "ice40", "reset")}
    slang = sum(all(facts.get(kind, {}).get("slang") for kind in ("ecp5", "ice40")) for facts in netlists)
    gone = ", ".join(f"{kind} {stale[key]}" for key, kind in KINDS.items())
    return (
        f"{unbounded} unbounded proofs hold, in two solvers each; the netlist is proven equal to the RTL for "
        f"{proven['ecp5']} (ECP5) and {proven['ice40']} (iCE40) of {len(benches.blocks())} blocks, for "
        f"{slang} of them as slang reads the RTL, and the reset is proven for {proven['reset']}. The blocks' "
        f"own tests killed {_killed(cells)} mutants of cells and {_killed(source)} of source, and reached "
        f"{_percent(hit, reachable)} of {reachable:,} coverage points. Limits: the mutants are samples "
        f"({_drawn(cells)}; {_drawn(source)}), coverage is of {len(current['coverage'])} blocks and excludes "
        f"{excluded:,} points ({_percent(excluded, reachable + excluded, 0)} of all), and the netlist proofs "
        f"treat {BOXES}. Stale blocks are not counted ({gone}); [docs/trust.md](docs/trust.md) shows every "
        "kind of evidence and what each does not show."
    )


def _percent(some, every, digits=2):
    if every and some == every:
        return "100 %"
    return f"{100 * some / max(1, every):.{digits}f} %"


def _proven(facts, kind):
    return bool(facts.get(kind, {}).get("proven"))


def _killed(parts):
    killed, made, equal = (sum(part[key] for part in parts) for key in ("killed", "mutants", "equivalent"))
    return f"{killed:,} of {made - equal:,}"


def _drawn(parts):
    made, equal = (sum(part[key] for part in parts) for key in ("mutants", "equivalent"))
    there = f" of {sum(part['there'] for part in parts):,}" if all("there" in part for part in parts) else ""
    return f"{made:,}{there} in {len(parts)} blocks, {equal} of them equivalent"
