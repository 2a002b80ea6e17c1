"""`make regress` in a short form: two sizes of a small block in one build; a planted bug is found, reduced
and reported with its command; Dask's workers do the same; sizes are legal and reproducible by their seed."""

import random
import sys
import types
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

import pytest

import regress as tool
from meissner.builds import toolchain
from verify import regress


def test_two_sizes_pass():
    one, other = regress.sizes("frame_owed", 2, 5)
    runs = [(one, 5, None), (one, 6, None), (other, 7, None)]
    assert regress.some("frame_owed", [(one, [5, 6]), (other, [7])]) == runs


def test_a_planted_bug_is_found_and_made_small(monkeypatch, tmp_path, capsys):
    paths = list(toolchain.sources_of("msn_compare"))
    paths[-1] = Path(tmp_path) / "msn_compare.sv"
    text = toolchain.sources_of("msn_compare")[-1].read_text()
    wrong = text.replace("(Width + 1)'(b_i) - (Width + 1)'(a_i)", "(Width + 1)'(a_i) - (Width + 1)'(b_i)")
    assert wrong != text
    paths[-1].write_text(wrong)
    monkeypatch.setattr(toolchain, "sources_of", lambda _: paths)
    monkeypatch.setattr(sys, "argv", ["regress.py", "2", "compare", "--jobs", "1"])
    with pytest.raises(SystemExit, match="failed"):
        tool.main()
    told = capsys.readouterr().out
    assert "smallest: python tools/regress.py --seed 1" in told
    assert int(told.split("Width=")[-1].split()[0]) <= 2


class Client:
    """The part of Dask's client that tools/regress.py uses, in this process."""

    def __init__(self, address, timeout):
        if address == "nobody":
            raise OSError("nobody there")
        self.pool = ThreadPoolExecutor(1)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.pool.shutdown()

    def submit(self, function, *arguments, pure):
        return self.pool.submit(function, *arguments)


def test_through_a_scheduler(monkeypatch, capsys):
    stub = types.ModuleType("dask.distributed")
    stub.Client, stub.as_completed = Client, as_completed
    monkeypatch.setitem(sys.modules, "dask", types.ModuleType("dask"))
    monkeypatch.setitem(sys.modules, "dask.distributed", stub)
    monkeypatch.setattr(sys, "argv", ["regress.py", "1", "frame_owed", "--scheduler", "tcp://here:8786"])
    tool.main()
    assert "1 runs of 1 blocks pass, 0 fail" in capsys.readouterr().out
    monkeypatch.setattr(sys, "argv", ["regress.py", "1", "frame_owed", "--scheduler", "nobody"])
    with pytest.raises(SystemExit, match="no scheduler answers at nobody"):
        tool.main()


def test_sizes_repeat():
    for block in regress.blocks():
        assert regress.sizes(block, 5, 3) == regress.sizes(block, 5, 3)
        assert regress._tests(block).SPACE(random.Random(1))


def test_nothing_is_no_success(monkeypatch):
    monkeypatch.setattr(sys, "argv", ["regress.py", "0", "frame_owed"])
    with pytest.raises(SystemExit, match="nothing ran"):
        tool.main()
