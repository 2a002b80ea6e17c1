"""The rules for every block: its header names its model, which has its name or, of several small blocks, says
which it models; it has a testbench of its name, and both source lists name it."""

import re

import blocks
from meissner.builds.toolchain import ROOT, sources

TOPS = ("msn_core", "msn_axis")


def test_every_block_has_its_twin_and_its_testbench():
    for path in sources():
        stage, block = path.parent.name, path.stem.removeprefix("msn_")
        folder = "model/meissner/twins/" if path.stem in TOPS else f"model/meissner/twins/{stage}/"
        stage = "core" if path.stem in TOPS else stage
        if not path.stem.endswith("_pkg") and path.stem != "msn_check":  # it has no output
            named = re.findall(rf"{folder}\w+\.py", path.read_text())
            assert named and all((ROOT / twin).exists() for twin in named), f"the header of {block}"
            own = path.stem in TOPS or f"{folder}{block}.py" in named
            assert own or any(f"{path.stem}.sv" in (ROOT / twin).read_text() for twin in named), block
            assert (ROOT / f"tb/{stage}/test_{block}.py").exists(), block


def test_fusesoc_s_file_lists_the_same_sources():
    text = (ROOT / "meissner.core").read_text()
    assert blocks.core(text) == text, "`make blocks`"
