"""Every example of examples/ runs as a user starts it, and prints what it is meant to show."""

import runpy
import sys

import numpy as np
import pytest

from meissner.builds.toolchain import ROOT

EXAMPLES = {
    ("stream_recording.py",): ["s: channel 0, incipient, p2p ", "slip events"],
    ("set_threshold.py",): [
        "slip.threshold = 23 codes",
        "1 V, peak to peak, are 1158 codes",
        "\n2 slip events in 11 s\n",
        "\n0 slip events in 11 s\n",
    ],
    ("read_cop.py",): ["an array of 25×5", "x -0.3", "██"],
    ("grip_on_slip.py",): ["s: it begins to slip, the hand tightens\n", "the glass was held with 2.0 N"],
    ("grip_on_slip.py", "--hold"): ["s: it begins to slip\n", "the glass fell with 1.2 N"],
}


@pytest.fixture
def run(monkeypatch, capsys):
    """A function that runs an example as the main program of this process; returns its output."""

    def run(*arguments):
        path = str(ROOT / "examples" / arguments[0])
        monkeypatch.setattr(sys, "argv", [path, *arguments[1:]])
        runpy.run_path(path, run_name="__main__")
        out, err = capsys.readouterr()
        assert err == ""
        return out

    return run


@pytest.mark.parametrize("arguments", EXAMPLES, ids=" ".join)
def test_example(run, arguments):
    out = run(*arguments)
    for part in EXAMPLES[arguments]:
        assert part in out, out


def test_a_recording_of_ones_own(run, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    codes = np.zeros((2, 10_000), int)
    codes[1, 5001] = 41  # one sample, which gives a peak-to-peak of 41
    np.save(tmp_path / "in.npy", codes)
    touched = "".join(f"0.0001 s: channel {channel}, contact, p2p 0\n" for channel in (0, 1))
    slip = "0.5001 s: channel 1, incipient, p2p 41\n0.5057 s: channel 1, contact, p2p 0\n"
    assert run("stream_recording.py", "in.npy") == f"{touched}{slip}1 slip events\n"
    assert run("stream_recording.py", "in.npy", "41") == f"{touched}0 slip events\n"


def test_every_example_is_tested():
    assert {path.name for path in (ROOT / "examples").glob("*.py")} == {name for name, *_ in EXAMPLES}
