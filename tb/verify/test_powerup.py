"""The tool that starts blocks with random register values finds their tests, and a block without tests
fails."""

import powerup as tool
from meissner.builds import toolchain


def test_starts_a_block_as_often_as_asked():
    path = toolchain.ROOT / "tb/common/test_frame_gate.py"
    assert tool.builds(path)
    found = tool.start("frame_gate", 2)
    assert found["passed"] and found["seeds"] >= 2
    assert tool.total([found]).endswith("1 of 1 blocks pass")


def test_fails_where_nothing_is_started(monkeypatch):
    monkeypatch.setattr(tool, "builds", lambda path: [])
    found = tool.start("frame_gate", 2)
    assert not found["passed"] and tool.summary(found) == "no test"
