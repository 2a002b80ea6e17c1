"""The rules for every block: it has one testbench of the same name and one model, which blocks may share."""

import re
from pathlib import Path

import pytest

import blocks
from meissner.builds import toolchain

TOPS = ("msn_core", "msn_axis")
BLOCKS = [path for path in toolchain.sources() if path.stem not in TOPS and not path.stem.endswith("_pkg")]


@pytest.mark.parametrize("path", BLOCKS, ids=lambda path: path.stem)
def test_every_block_has_its_twin_and_its_testbench(path):
    stage, block = path.parent.name, path.stem.removeprefix("msn_")
    assert (toolchain.ROOT / f"tb/{stage}/test_{block}.py").exists()
    twin = re.search(rf"model/meissner/twins/{stage}/\w+\.py", path.read_text())
    assert twin, "its header does not name its model"
    model = (toolchain.ROOT / twin[0]).read_text("utf-8")
    assert Path(twin[0]).stem == block or f"{path.stem}.sv" in model, "the model is another block's"


@pytest.mark.parametrize("top", TOPS)
def test_the_tops_share_a_twin(top):
    assert "model/meissner/twins/core.py" in (toolchain.ROOT / f"rtl/{top}.sv").read_text()
    assert (toolchain.ROOT / f"tb/core/test_{top.removeprefix('msn_')}.py").exists()


def test_the_core_file_lists_the_same_sources():
    """FuseSoC's meissner.core and rtl/rtl.f name the same files in the same order."""
    lines = (toolchain.ROOT / "meissner.core").read_text().splitlines()
    listed = [line.split("- ")[1] for line in lines if line.strip().startswith("- rtl/")]
    assert listed == (toolchain.ROOT / "rtl/rtl.f").read_text().split(), "`make blocks`"


def test_the_core_file_is_written_from_the_list(monkeypatch):
    top = toolchain.ROOT
    monkeypatch.setattr(toolchain, "sources", lambda: [top / "rtl/a/msn_a.sv", top / "rtl/msn_b.sv"])
    before = "files:\n      - rtl/a/msn_a.sv\n      - rtl/msn_c.sv\n    file_type: x\n"
    after = "files:\n      - rtl/a/msn_a.sv\n      - rtl/msn_b.sv\n    file_type: x\n"
    assert (blocks.core(before), blocks.core(after)) == (after, after)
