"""Which runs of evidence are due, in which order, and how long they take.

A piece is a run of one tool for one block. A block's evidence rests on all RTL inside it, so a changed block
also makes the evidence of the blocks around it stale. Pieces for blocks that contain no other stale block
come first: these are the changed blocks. The others follow; in both groups the slowest piece comes last.
"""

import os
import signal
import statistics
import subprocess
import sys
import time
from typing import NamedTuple

from meissner.builds import toolchain
from verify import benches

UNKNOWN_S = 30.0  # assumed for a kind without any record


class Piece(NamedTuple):
    step: object
    block: str
    around: bool  # whether the block contains a stale block
    seconds: float  # CPU time as recorded, or the median of the kind's blocks


def took(facts):
    """CPU seconds that a block's facts took; None if they do not state it."""
    if "cpu_s" in facts:
        return facts["cpu_s"]
    if "proofs" in facts:
        return sum(sum(row.get("seconds", {}).values()) for row in facts["proofs"].values())
    parts = [part for part in (facts, *facts.values()) if isinstance(part, dict)]
    known = [part[key] for part in parts for key in ("seconds", "cpu_s") if key in part]
    return sum(known) if known else None


def inner(block):
    """Names of the blocks inside a block; empty if the name is not a block."""
    if block not in benches.blocks():
        return set()
    return {path.stem.removeprefix("msn_") for path in toolchain.sources_of(f"msn_{block}")} - {block}


def pieces(due, recorded):
    """The pieces of ``due`` [(step, blocks)] in the order in which to run them."""
    stale = {block for _, blocks in due for block in blocks}
    found = []
    for step, blocks in due:
        facts = recorded.get(step.kind, {"blocks": {}})["blocks"]
        known = [seconds for row in facts.values() if (seconds := took(row)) is not None]
        usual = statistics.median(known) if known else UNKNOWN_S
        for block in blocks:
            seconds = took(facts.get(block, {}))
            seconds = usual if seconds is None else seconds
            found.append(Piece(step, block, bool(inner(block) & stale), seconds))
    return sorted(found, key=lambda piece: (piece.around, piece.seconds))


def within(listed, budget_s, run, clock=time.monotonic):
    """Call ``run(piece, seconds left)`` for the pieces within ``budget_s`` (None: all); return the rest.

    A piece whose recorded time exceeds the time left is skipped; ``run`` stops one that does not end in time.
    """
    begun, left = clock(), []
    for piece in listed:
        rest = None if budget_s is None else budget_s - (clock() - begun)
        if rest is not None and piece.seconds > rest:
            left.append(piece)
        else:
            run(piece, rest)
    return left


def limited(command, seconds):
    """Run ``command`` and its child processes for at most so many seconds (None: to the end); the exit code,
    None if it was stopped."""
    process = subprocess.Popen([sys.executable, *command], cwd=toolchain.ROOT, start_new_session=True)
    try:
        return process.wait(seconds)
    except subprocess.TimeoutExpired:
        return None
    finally:
        if process.poll() is None:  # also after an interrupt by the user
            os.killpg(process.pid, signal.SIGTERM)
            process.wait()
