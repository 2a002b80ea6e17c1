"""The rules for every block: it has one model and one testbench of the same name, and both source lists name
it."""

import blocks
from meissner.builds.toolchain import ROOT, sources

TOPS = ("msn_core", "msn_axis")


def test_every_block_has_its_twin_and_its_testbench():
    for path in sources():
        stage, block = path.parent.name, path.stem.removeprefix("msn_")
        twin = f"model/meissner/twins/{stage}/{block}.py"
        if path.stem in TOPS:
            stage, twin = "core", "model/meissner/twins/core.py"
        if not path.stem.endswith("_pkg"):
            assert (ROOT / twin).exists() and (ROOT / f"tb/{stage}/test_{block}.py").exists(), block
            assert twin in path.read_text(), f"the header of {block} does not name its model"


def test_fusesoc_s_file_lists_the_same_sources():
    text = (ROOT / "meissner.core").read_text()
    assert blocks.core(text) == text, "`make blocks`"
