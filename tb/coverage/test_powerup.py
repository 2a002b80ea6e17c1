"""The power-up option of bench.run: if the reset of a register that rests at 1 is forgotten, the test passes
with all registers starting at 1, and fails with random start values."""

import pytest

import bench
from harness import runner
from meissner.builds import toolchain

RESET = "      restart     <= 1'b1;\n"


def test_finds_a_forgotten_reset(tmp_path, monkeypatch):
    package, block = (toolchain.ROOT / f"rtl/{name}.sv" for name in ("msn_pkg", "common/msn_frame_filter"))
    folder = tmp_path / "forgotten"
    folder.mkdir()
    text = block.read_text()
    assert text.count(RESET) == 1
    (folder / block.name).write_text(text.replace(RESET, ""))
    sources = [package, folder / block.name]

    def start():
        bench.run("common", "frame_filter", {"Channels": 2}, "rate=0.0/stall_rate=0.0$", sources=sources)

    monkeypatch.delenv("MEISSNER_COVERAGE", raising=False)
    monkeypatch.setattr(runner, "POWERUPS", 0)
    start()
    monkeypatch.setattr(runner, "POWERUPS", 6)
    with pytest.raises(SystemExit):  # from the runner, which prints the seed
        start()
