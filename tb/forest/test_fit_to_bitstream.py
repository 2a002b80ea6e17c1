"""What --fit picks of a published forest becomes a bitstream that meets its clock. Skipped, with a message,
without the recordings."""

import re
import subprocess
import sys

import numpy as np
import pytest
from sklearn.ensemble import RandomForestClassifier

import meissner
from forest import recorded
from meissner.builds import boards, config
from meissner.builds.yowasp import ROOT
from meissner.cli import main


@pytest.mark.long
@pytest.mark.timeout(7200)
@pytest.mark.parametrize(
    "source, label, board",
    [("biotacsp", 0, "ulx3s"), ("biotacsp", 0, "icebreaker"), ("osu_slip", 3, "ulx3s")],
)
def test_what_fits_becomes_a_bitstream(source, label, board, tmp_path, monkeypatch, capsys):
    (x, y), (test_x, test_y) = recorded.read(source, label)
    trained = RandomForestClassifier(400, n_jobs=2, random_state=0).fit(x, y)
    meissner.Forest(trained, integer=source == "biotacsp" or ()).to_file(tmp_path / "F.json")
    np.savez(tmp_path / "rows.npz", x=test_x, y=test_y)
    np.savez(tmp_path / "training.npz", x=x, y=y)
    monkeypatch.chdir(tmp_path)
    name = f"{source}-{label}.toml"
    given = f"F.json --data rows.npz --training training.npz --fit {board} --out small.json --toml {name}"
    main(["forest-budget", *given.split()])
    said = capsys.readouterr().out
    command = re.search(r"make synth BOARD=(\S+) CONFIG=(\S+)(?: DEVICE=(\S+))?", said)
    assert (command[1], command[2]) == (board, name)
    device = ["--device", command[3]] if command[3] else []
    done = subprocess.run(
        [sys.executable, ROOT / "tools/make/synth.py", board, tmp_path / name, *device, "--seeds", "1"],
        capture_output=True,
        text=True,
    )
    print(said, done.stdout)
    assert done.returncode == 0, done.stdout + done.stderr
    found = re.search(r"(\d+) BRAM.*; ([\d.]+) MHz \(its clock is ([\d.]+)\)", done.stdout)
    used, mhz, clock = int(found[1]), float(found[2]), float(found[3])
    forest, place = config.load(tmp_path / name).features["forest"], boards.BOARDS[board]
    assert forest.rams(place.cells) <= used <= place.rams[command[3] or ""] and mhz >= clock
