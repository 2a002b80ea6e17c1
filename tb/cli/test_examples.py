"""The example of each command's --help is a whole command, and runs: in a folder with the files that it
names, and with a simulated core behind a pty in place of the port. The commands of the pages in docs/start
exist."""

import re
import shlex
import shutil
import subprocess

import joblib
import numpy as np
import pytest
from sklearn.ensemble import RandomForestClassifier

from cli.test_start import EVERY
from meissner import cli
from meissner.builds import boards
from meissner.builds.toolchain import ROOT
from meissner.fit_rubber import STEPS
from meissner.host.pty import Pty
from meissner.host.simulated import of_scenes
from meissner.parser import parser

PORT = "/dev/ttyUSB1"
LOADER = "#!/bin/sh\nexit 0\n"
SLOW = {"tradeoff", "train-rope"}  # in `make test-long`
PAGES = sorted((ROOT / "docs/start").glob("*.md"))


def found(path):
    """The parser of a command."""
    at = parser()
    for name in path:
        at = next(action for action in at._actions if action.choices and name in action.choices).choices[name]
    return at


LEAVES = [path for path in EVERY if path and not any(other[: len(path)] == path != other for other in EVERY)]
EXAMPLES = {path: (found(path).epilog or "").removeprefix("example: meissner ") for path in LEAVES}


def test_every_command_has_an_example():
    assert {
        path: text for path, text in EXAMPLES.items() if shlex.split(text)[: len(path)] != list(path)
    } == {}


def forest_rows(rng):
    rows = rng.integers(0, 4096, (60, 90))
    return RandomForestClassifier(3, max_depth=3, random_state=1).fit(rows, rows[:, 0] > 2000)


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    """A folder with every file that an example reads, as small as it may be."""
    folder, rng = tmp_path_factory.mktemp("bench"), np.random.default_rng(1)
    np.save(folder / "IN.npy", rng.integers(0, 4096, 640))
    np.save(folder / "FRAMES.npy", rng.integers(0, 900, (3, 4, 5)))
    np.save(folder / "E1_E4.npy", rng.integers(100, 2000, (20, 4)))
    np.save(folder / "ROPE.npy", rng.integers(0, 4096, (60, 9)))
    force = np.arange(5.0)[:, None, None] * np.ones((2, 3))
    np.savez(folder / "PRESS.npz", codes=np.rint(100 + 300 * force).astype(int), force_n=force)
    quiet = 2000 + rng.normal(0, 1, 80_000)
    slips = quiet + 60 * (np.arange(80_000) // 2_000 % 2) * rng.normal(0, 1, 80_000)
    for name, values in (("QUIET", quiet), ("SLIP", slips)):
        rows = zip(np.arange(80_000) / 10_000, np.rint(values).astype(int))
        lines = ["Time (s),A (code)", *(f"{time:.4f},{code}" for time, code in rows)]
        (folder / f"{name}.csv").write_text("\n".join(lines))
    np.savetxt(folder / "X.csv", rng.integers(0, 4096, (7, 90)), fmt="%d", delimiter=",")
    joblib.dump(forest_rows(rng), folder / "MODEL.joblib")
    steps = [(rest, (1.31 - 0.19 * rest) * v**0.17, v) for rest in (1.6, 2.5, 3.7) for v in (0.01, 0.4, 2.9)]
    lines = [",".join(STEPS), *(",".join(map(str, step)) for step in steps)]
    (folder / "SHEAR.csv").write_text("\n".join(lines))
    (folder / "build/synth/icebreaker-slip1").mkdir(parents=True)
    (folder / "build/synth/icebreaker-slip1/icebreaker_top.bin").write_bytes(b"\x7e\xaa")
    (folder / "bin").mkdir()
    (folder / "bin/openFPGALoader").write_text(LOADER)
    (folder / "bin/openFPGALoader").chmod(0o755)
    return folder


def run(text, bench, monkeypatch, port):
    monkeypatch.chdir(bench)
    monkeypatch.setenv("PATH", f"{bench}/bin:/usr/bin:/bin")
    cli.main([port if word == PORT else word for word in shlex.split(text)])


ORDER = sorted(LEAVES, key=lambda path: (path[0] not in ("export-forest", "log"), path))


@pytest.mark.parametrize(
    "path",
    [pytest.param(path, marks=[pytest.mark.long] if path[0] in SLOW else []) for path in ORDER],
    ids=" ".join,
)
def test_the_example_of_a_command_runs(path, bench, monkeypatch, capsys):
    with Pty(of_scenes(speed="10")) as pty:
        run(EXAMPLES[path], bench, monkeypatch, pty.url)
    said = capsys.readouterr()
    assert said.out or path[0] == "bridge"
    assert not said.err or path[0] in ("bridge", "live", "log")
    for file in re.findall(r"--out (\S+)", EXAMPLES[path]):
        assert (bench / file).exists()


def commands(page):
    """The indented command lines of a page, without the text to their right."""
    return re.findall(r"^    (\S.*?)(?:   +.*)?$", page.read_text("utf-8"), re.M)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_commands_of_a_page_exist(page):
    lines = commands(page)
    assert len(lines) > 3
    for line in lines:
        words = shlex.split(line)
        if words[0] == ".venv/bin/meissner":
            parser().parse_args(words[1:])
        elif words[0] == "make":
            assert re.search(rf"^{words[1]}:.*## ", (ROOT / "Makefile").read_text("utf-8"), re.M), line
            given = dict(word.split("=") for word in words[2:])
            if "CONFIG" in given and not given["CONFIG"].endswith(".toml"):
                boards.pairs(given["BOARD"], given["CONFIG"])
        else:
            assert words[0] in ("sudo", "git", "cd", ".venv/bin/python", "apt"), line


def test_the_version_is_that_of_the_distribution(capsys):
    with pytest.raises(SystemExit, match="0"):
        cli.main(["--version"])
    [version] = re.findall(r'^version = "(.+)"$', (ROOT / "pyproject.toml").read_text(), re.M)
    assert capsys.readouterr().out == f"meissner {version}\n"


WORDS = {  # what is typed, the last word in parts: what bash then offers, among others
    "meissner con": {"config"},
    "meissner config ": {"check", "show", "new", "list"},
    "meissner run walk_": {"walk_25x5"},
    "meissner flash ice": {"icebreaker"},
    "meissner process slip IN.npy --thr": {"--threshold"},
    "meissner completion ": {"bash", "zsh", "fish"},
}


def test_bash_completes(tmp_path):
    """bash itself runs the script, as it would on a tab."""
    cli_script = tmp_path / "script"
    with cli_script.open("w") as out:
        from meissner.completion import script

        out.write(script("bash"))
    for line, offered in WORDS.items():
        words = line.split(" ")
        program = (
            f"source {cli_script}; COMP_WORDS=({shlex.join(words)}); COMP_CWORD={len(words) - 1}; "
            f"COMP_LINE={shlex.quote(line)}; COMP_POINT={len(line)}; "
            "$(complete -p meissner | sed 's/.*-F \\([^ ]*\\).*/\\1/') meissner; "
            "printf '%s\\n' \"${COMPREPLY[@]}\""
        )
        done = subprocess.run(["bash", "-c", program], capture_output=True, text=True)
        assert offered <= {word.strip() for word in done.stdout.split("\n")}, (line, done)


@pytest.mark.parametrize("shell", ["zsh", "fish"])
def test_the_other_shells_get_every_command(shell):
    from meissner.completion import script

    text = script(shell)
    for path in LEAVES:
        assert path[-1] in text
    if shutil.which(shell):
        subprocess.run([shell, "-n"], input=text, text=True, check=True)
