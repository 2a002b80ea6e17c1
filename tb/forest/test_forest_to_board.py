"""docs/forest_to_board.md: its lines run in their order, with the pins in place of the bitstream, and the RTL
in place of the board; its classes are scikit-learn's."""

import re
import subprocess
import sys

import numpy as np
import pytest
import skops.io
from sklearn.datasets import load_wine

from harness.command import meissner
from meissner.builds.toolchain import ROOT

PAGE = (ROOT / "docs/forest_to_board.md").read_text("utf-8")
BUILT, HOST = re.findall(r"^```python\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
LINES = [re.split(r"  +", line.strip())[0] for line in PAGE.splitlines() if line.startswith("    ")]
LINES = [line for line in LINES if re.match("meissner|printf|make|python|openFPGALoader", line)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """After the first block and the lines up to the bitstream."""
    folder = tmp_path_factory.mktemp("board")
    subprocess.run([sys.executable, "-c", BUILT], cwd=folder, check=True)
    x, _ = load_wine(return_X_y=True)
    np.savetxt(folder / "rows.csv", x[::20], delimiter=",", fmt="%.17g")
    export, table, make, load = LINES[:4]
    done = meissner(*export.split()[1:], cwd=folder)
    assert done.returncode == 0, done.stderr
    subprocess.run(["sh", "-c", table], cwd=folder, check=True)
    assert make == "make synth BOARD=ulx3s CONFIG=wine.toml"
    assert load == "openFPGALoader -b ulx3s build/synth/ulx3s-wine/ulx3s_top.bit"
    return folder


def test_it_takes_ten_lines():
    assert len(BUILT.strip().splitlines()) - BUILT.count("\n\n") + 4 <= 10


@pytest.mark.parametrize("line", LINES[4:])
def test_what_comes_before_the_build(folder, line):
    program, *words = line.replace("--engine rtl", "--engine fixed").split()
    if program == "python":
        done = subprocess.run(
            [sys.executable, ROOT / words[0], *words[1:]], cwd=folder, capture_output=True, text=True
        )
    else:
        done = meissner(*words, *["--overwrite"] * ("--out" in words), cwd=folder)
    assert done.returncode == 0, done.stderr
    if "--out" in words:
        model = skops.io.load(folder / "wine.skops", trusted=["sklearn.tree._tree.Tree"])
        rows = np.loadtxt(folder / "rows.csv", delimiter=",")
        assert np.load(folder / "OUT.npz")["class"].tolist() == model.predict(rows).tolist()
    else:
        assert ("wine" in done.stdout) != ("forest-budget" in words)


@pytest.mark.long
def test_the_host_reads_scikit_learns_classes(folder):
    text = HOST.replace("serial:/dev/ttyUSB0", "core:wine.toml")
    assert text != HOST
    done = subprocess.run([sys.executable, "-c", text], cwd=folder, capture_output=True, text=True)
    model = skops.io.load(folder / "wine.skops", trusted=["sklearn.tree._tree.Tree"])
    assert done.stdout.strip() == str(model.predict(load_wine().data[::20])), done
