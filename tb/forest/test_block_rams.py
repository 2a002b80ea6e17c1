"""The block RAMs of a forest in a core, as Yosys maps msn_classify: forest-budget says the same number."""

import re

import pytest

from meissner.builds.yowasp import ROOT, chparam, read_rtl, yosys
from meissner.forest.cost import Size, block_rams

# Synthesis up to the memories, and their cells.
UNTIL = {
    "ecp5": ("synth_ecp5 -run begin:map_gates", "DP16KD"),
    "ice40": ("synth_ice40 -device u -run begin:map_ffram", "SB_RAM40_4K"),
    "gowin": ("synth_gowin -family gw2a -run begin:map_ffram", "SP|SDPB|SDPX9B|DPB|DPX9B"),
}
SMALL = Size(features=3, classes=3, trees=20, nodes=300, leaves=40, bits=9)
HOST = Size(features=16, classes=3, trees=100, nodes=1024, leaves=256, bits=12)
WIDE = Size(features=9, classes=2, trees=50, nodes=8192, leaves=1, bits=11)
DEEP = Size(features=72, classes=2, trees=200, nodes=60_000, leaves=1, bits=13)
MANY = Size(features=200, classes=10, trees=100, nodes=3000, leaves=900, bits=22)
CASES = [
    ("ecp5", SMALL, {}, 2),
    ("ice40", SMALL, {}, 15),
    ("gowin", SMALL, {}, 2),
    ("ecp5", WIDE, {"engines": 8}, 200),
    ("ecp5", DEEP, {}, 183),
    ("ecp5", MANY, {"engines": 3, "banks": 2}, 199),
    ("ecp5", MANY, {"lanes": 8, "banks": 2, "sdram": True}, 36),
    ("ice40", HOST, {}, 23),
    ("ice40", WIDE, {"banks": 2}, 204),
    ("ice40", MANY, {"engines": 2, "lanes": 2}, 190),
    ("gowin", MANY, {"engines": 2}, 51),
    ("gowin", WIDE, {}, 24),
]


def mapped(cells, size, engines=1, banks=1, lanes=4, sdram=False):
    """What Yosys takes for a forest whose rows a host writes."""
    given = {"Frames": 0, "Engines": engines, "Banks": banks, "Lanes": lanes, "Sdram": int(sdram)}
    names = {"bits": "FeatureBits"}
    given |= {names.get(key, key.capitalize()): value for key, value in vars(size).items()}
    command, cell = UNTIL[cells]
    folder = "build/tb/block_rams"
    (ROOT / folder).mkdir(parents=True, exist_ok=True)
    top = "msn_classify"
    script = f"{read_rtl(cells, top)}; {chparam(top, given)}{command} -top {top}; tee -o {folder}/stat stat"
    yosys(script, f"{folder}/{cells}.log")
    found = re.findall(rf"(?m)^ +(\d+) +({cell})$", (ROOT / folder / "stat").read_text())
    return sum({kind: int(count) for count, kind in found}.values())


@pytest.mark.parametrize(
    "cells, size, of, expected",
    [pytest.param(*case, marks=[pytest.mark.long] * (at > 0)) for at, case in enumerate(CASES)],
)
def test_yosys_takes_as_many(cells, size, of, expected):
    assert mapped(cells, size, **of) == expected


@pytest.mark.parametrize("cells, size, of, expected", CASES)
def test_the_budget_says_as_many(cells, size, of, expected):
    assert block_rams(size, cells, **of) == expected
