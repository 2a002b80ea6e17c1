"""Boards: each board is built with each named configuration; cells and Fmax (worst of three seeds) are
compared with constraints/resources.json by `tools/make/synth.py --check`."""

import subprocess
import sys

from meissner.builds import boards as offered
from meissner.builds import toolchain


def blocks():
    """Not blocks but the pairs, as "board-configuration"."""
    return [f"{board.name}-{config}" for board, config in offered.pairs()]


def run(pair, limits, jobs=1):
    """The facts of a pair."""
    command = [sys.executable, "tools/make/synth.py", "--check", *pair.split("-", 1)]
    done = subprocess.run(command, cwd=toolchain.ROOT, capture_output=True, text=True)
    said = done.stdout.strip().splitlines()
    broken = done.stderr.strip().splitlines() if done.returncode else []
    return {"text": said[-1] if said else "", "broken": broken or (["failed"] if done.returncode else [])}
