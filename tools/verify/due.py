"""What of the evidence is due, in which order, and for how long.

A piece is a run of one tool for one block. Evidence of a block rests on all RTL in it, so a change of a block
makes that of the blocks around it stale, too. Pieces of blocks in which no other stale one lies come first:
these are what was changed. The others follow; in both, what takes longest is last.
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

UNKNOWN_S = 30.0  # of a kind of which nothing was recorded


class Piece(NamedTuple):
    step: object
    block: str
    around: bool  # there is a stale block in it
    seconds: float  # of a processor, as recorded, or what half of the blocks take less than


def took(facts):
    """Seconds of a processor that a block's facts took; None if they do not say."""
    if "cpu_s" in facts:
        return facts["cpu_s"]
    if "proofs" in facts:
        return sum(sum(row.get("seconds", {}).values()) for row in facts["proofs"].values())
    parts = [part for part in (facts, *facts.values()) if isinstance(part, dict)]
    known = [part[key] for part in parts for key in ("seconds", "cpu_s") if key in part]
    return sum(known) if known else None


def inner(block):
    """Names of the blocks in a block; none of what is no block."""
    if block not in benches.blocks():
        return set()
    return {path.stem.removeprefix("msn_") for path in toolchain.sources_of(f"msn_{block}")} - {block}


def pieces(due, recorded):
    """The pieces of ``due`` [(step, blocks)] in the order in which they are to be run."""
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
    """``run(piece, seconds left)`` of the pieces until ``budget_s`` have gone (None: all); what is left.

    A piece that took longer than what is left is passed over: ``run`` ends what does not end in time.
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
    """Run ``command`` for so many seconds (None: to its end) with all that it starts; its exit code, None if
    it was ended."""
    process = subprocess.Popen([sys.executable, *command], cwd=toolchain.ROOT, start_new_session=True)
    try:
        return process.wait(seconds)
    except subprocess.TimeoutExpired:
        return None
    finally:
        if process.poll() is None:  # also if a person ends this
            os.killpg(process.pid, signal.SIGTERM)
            process.wait()
