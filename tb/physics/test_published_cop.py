"""docs/published_cop.md says what tools/published_cop.py prints, table by table."""

import subprocess
import sys

import pytest

from meissner.builds.toolchain import ROOT


@pytest.mark.parametrize("table", ["mesh", "load", "rubber"])
def test_docs_say_what_is_printed(table):
    command = [sys.executable, "tools/published_cop.py", table]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    printed = [line for line in done.stdout.splitlines() if line]
    assert len(printed) > 8
    text = (ROOT / "docs/published_cop.md").read_text().splitlines()
    missing = [line for line in printed if line not in text]
    assert not missing, f"put the output of {' '.join(command[1:])} there"
