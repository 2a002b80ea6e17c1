"""The rewriting of assertions ahead of the workers: pytest's import takes what was written, unless the file
changed since; a failed assertion shows its values."""

import pytest
from _pytest.assertion import rewrite

import ahead

SOURCE = "def f(a):\n    assert a == 2\n"


def test_what_is_written_is_what_pytest_reads(tmp_path, request):
    path = tmp_path / "test_one.py"
    path.write_text(SOURCE)
    ahead.rewritten(request.config, [path])
    code, space = rewrite._read_pyc(path, ahead.cached(path)), {}
    exec(code, space)
    with pytest.raises(AssertionError, match=r"assert 3 == 2"):
        space["f"](3)
    assert code.co_filename == str(path)
    path.write_text(SOURCE.replace("2", "4"))
    assert rewrite._read_pyc(path, ahead.cached(path)) is None
    ahead.rewritten(request.config, [path])
    exec(rewrite._read_pyc(path, ahead.cached(path)), space)
    space["f"](4)
