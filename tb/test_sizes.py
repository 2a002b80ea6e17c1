"""Blocks in sizes drawn at random, against their own tests.

A block takes part if its test file has a function ``SPACE``, which returns parameters from a random.Random;
MEISSNER_SEED draws other sizes and other stimulus.
"""

import importlib
import random

import pytest

from bench import SEED, run
from meissner.builds import toolchain
from nightly import benches


def spaces():
    """{block: its SPACE}."""
    found = {}
    for block in benches.blocks():
        name = f"{benches.stage_of(block)}/test_{block}"
        if "\nSPACE = " in (toolchain.ROOT / f"tb/{name}.py").read_text("utf-8"):
            found[block] = importlib.import_module(name.replace("/", ".")).SPACE
    return found


@pytest.mark.long
@pytest.mark.parametrize("block", spaces := spaces())
def test_a_random_size(block):
    draw = random.Random(f"{block} {SEED}")
    for _ in range(2):
        size = spaces[block](draw)
        print(f"MEISSNER_SEED={SEED}: {size}")
        run(benches.stage_of(block), block, size)
