"""The command line as scripts use it: exit codes, one sentence per error, output files that are complete or
absent."""

import json
import os
import re
import resource
import subprocess
import sys

import numpy as np
import pytest

from harness.command import meissner
from meissner import calibration, cli, engines, readers, run, scenes
from meissner.builds.toolchain import ROOT
from meissner.parser import parser
from meissner.twins.slip.config import SlipConfig


def slip(source, *extra, out="out.npz"):
    return ("process", "slip", source, "--rate", 10000, "--threshold", 40, "--out", out, *extra)


def cop(source, *extra, out="out.npz"):
    return ("process", "cop", source, "--out", out, *extra)


def calibrate(source, *extra, out="new.npz"):
    return ("calibrate", source, "--out", out, *extra)


def presses(few=False):
    """A press recording of 3×3 cells, each cell on its own line; ``few``: two cells have too few presses."""
    force_n = np.arange(5.0)[:, None, None] * np.ones((3, 3))
    own = np.arange(9).reshape(3, 3)
    codes = np.rint(100 + 10 * own + (300 + own) * force_n)
    if few:
        force_n[2:, 0, 1] = force_n[1:, 2, 0] = np.nan
    return {"codes": codes.astype(int), "force_n": force_n}


def recorded(folder):
    x = np.random.default_rng(1).integers(-20, 21, (2, 1000))
    np.save(folder / "in.npy", x)
    np.savetxt(folder / "in.csv", x.T, fmt="%d", delimiter=",")
    return x


@pytest.fixture
def recording(tmp_path):
    return recorded(tmp_path)


@pytest.mark.parametrize("engine", engines.NAMES)
@pytest.mark.parametrize("name", ["in.npy", "in.csv"])
def test_process_slip(tmp_path, recording, engine, name):
    done = meissner(*slip(name, "--engine", engine, "--hop", 32), cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert f"on engine {engine}" in done.stdout
    result = np.load(tmp_path / "out.npz")
    expected = engines.process_slip(recording, SlipConfig(threshold=40, hop=32), engine)
    assert sorted(result.files) == sorted(expected)
    for field in expected:
        assert np.array_equal(result[field], expected[field])


def test_process_slip_says_when_the_first_flag_rises_in_any_channel(tmp_path, monkeypatch, capsys):
    """Windows of 64 samples: a step before sample 11 of the second channel, before 139 of the first."""
    monkeypatch.chdir(tmp_path)
    x = np.zeros((2, 256), int)
    x[0, 139:] = x[1, 11:] = 100
    np.save("in.npy", x)
    cli.main([str(word) for word in slip("in.npy")])
    assert "\n2 channels, 4 windows, 2 slips (first at 0.0011 s); " in capsys.readouterr().out


def test_process_cop_takes_the_least_load(tmp_path, monkeypatch):
    """Loads of 9, 10 and 11 codes, given as forces and as codes with a gain of 1."""
    monkeypatch.chdir(tmp_path)
    np.save("in.npy", np.array([[[4, 5]], [[5, 5]], [[5, 6]]]))
    one = np.ones((1, 2), int)
    with open("cal.npz", "wb") as file:
        calibration.Calibration(0 * one, 4096 * one, 12, one < 0, 0.5).save(file)
    for more in ((), ("--calibration", "cal.npz")):
        cli.main([*cop("in.npy", *more), "--min-load", "10", "--overwrite"])
        assert np.load("out.npz")["valid"].tolist() == [False, True, True]
        assert "load_n" not in np.load("out.npz") or np.load("out.npz")["load_n"].tolist() == [4.5, 5, 5.5]
    cli.main([*cop("in.npy"), "--overwrite"])
    assert np.load("out.npz")["valid"].all()


@pytest.mark.parametrize("engine", engines.NAMES)
def test_process_cop(tmp_path, engine):
    x = np.random.default_rng(1).integers(0, 65536, (7, 25, 5))
    x[3] = 0
    np.save(tmp_path / "in.npy", x.astype(float))
    done = meissner(*cop("in.npy", "--engine", engine, "--min-load", 9), cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "7 frames of 25×5, 6 with a load; " in done.stdout and f"on engine {engine}" in done.stdout
    result = np.load(tmp_path / "out.npz")
    expected = engines.process_cop(x, "fixed", min_load=9)
    kinds = {"sum": "i8", "mx": "i8", "my": "i8", "x": "i4", "y": "i4", "valid": "?"}
    assert {name: result[name].dtype for name in result.files} == kinds
    for field in kinds:
        assert np.array_equal(result[field], expected[field])


@pytest.mark.parametrize("rows, columns", [(1, 1), (1, 7), (7, 1), (2, 2), (1024, 1024)])
def test_process_cop_of_every_shape(tmp_path, rows, columns):
    """All zero; full scale; one LSB in a corner and full scale elsewhere; one LSB in that corner alone."""
    x = np.zeros((4, rows, columns), dtype=np.uint16)
    x[1:3] = 65535
    x[2:, 0, 0] = 1
    np.save(tmp_path / "in.npy", x)
    done = meissner(*cop("in.npy"), cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    result = np.load(tmp_path / "out.npz")
    assert result["valid"].tolist() == [False, True, True, True]
    assert result["sum"].tolist() == [0, 65535 * rows * columns, 65535 * (rows * columns - 1) + 1, 1]
    assert result["x"][[0, 1, 3]].tolist() == [0, 0, -16384 * (columns > 1)]
    assert result["y"][[0, 1, 3]].tolist() == [0, 0, 16384 * (rows > 1)]
    assert (result["x"][2] > 0) == (1 < columns < 100) and (result["y"][2] < 0) == (1 < rows < 100)


@pytest.mark.parametrize("engine", engines.NAMES)
def test_calibrate_and_then_process_cop(tmp_path, engine):
    np.savez(tmp_path / "press.npz", **presses())
    done = meissner(*calibrate("press.npz", out="cal.npz"), cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines()[1].startswith(
        "3×3 cells from 5 frames, none dead; one code of force is 0.0005 N; deviation from the line: "
    )
    np.save(tmp_path / "in.npy", presses()["codes"])
    arguments = cop("in.npy", "--calibration", "cal.npz", "--engine", engine, "--min-load", 10)
    done = meissner(*arguments, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "5 frames of 3×3, 4 with a load; sum in units of 0.0005 N; " in done.stdout
    result = np.load(tmp_path / "out.npz")
    assert result["sum"] * 5e-4 == pytest.approx(9 * np.arange(5.0), abs=0.005)
    assert np.abs(result["x"]).max() < 5 and np.abs(result["y"]).max() < 5
    assert result["load_n"] == pytest.approx(result["sum"] * 5e-4, rel=1e-12)


def test_calibrate_tells_what_is_not_on_a_line(tmp_path):
    """A converter of 10 bits, whose end the first cell reaches from 9 N on; the other two bend."""
    newtons = np.repeat(np.arange(12.0), 2)
    rise = 100 * newtons, 800 * (1 - np.exp(-newtons / 2)), 700 * (1 - np.exp(-newtons / 1))
    codes = np.rint(np.minimum(180 + np.stack(rise, axis=-1), 1023)).astype(int)[:, None]
    np.savez(tmp_path / "press.npz", codes=codes, force_n=newtons)
    np.save(tmp_path / "codes.npy", codes)
    done = meissner(*calibrate("press.npz"), cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    _, *told = done.stdout.splitlines()
    assert told[0].startswith("1×3 cells from 24 frames, none dead; ") and len(told) == 3
    assert told[1] == "left out: 6 readings at the converter's end, code 1023, from 9 N on"
    lines = calibration.load(tmp_path / "new.npz")
    read = [np.interp(codes[:, 0, k], lines.knot_codes[:, 0, k], lines.knot_n[:, 0, k]) for k in (1, 2)]
    apart = [((one - newtons) ** 2).mean() ** 0.5 for one in read]
    assert told[2] == (
        "2 cells bend: load_n of `process cop` reads their tables, which deviate by "
        f"{sum(apart) / 2:.3g} N rms in the median, {max(apart):.3g} N at most"
    )
    done = meissner(*cop("codes.npy", "--calibration", "new.npz"), cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    result, early = np.load(tmp_path / "out.npz"), slice(10)
    assert result["load_n"][early] == pytest.approx(3 * newtons[early], abs=0.05)
    straight = result["sum"] * calibration.load(tmp_path / "new.npz").force_lsb_n
    assert (straight - result["load_n"])[2:10].min() > 1


def test_calibrate_takes_the_forces_from_another_file(tmp_path):
    press = presses()
    np.save(tmp_path / "codes.npy", press["codes"])
    np.save(tmp_path / "force.npy", press["force_n"])
    np.savetxt(tmp_path / "force.csv", press["force_n"][:, 0, 0])
    np.savez(tmp_path / "press.npz", **press)
    assert meissner(*calibrate("press.npz", out="a.npz"), cwd=tmp_path).returncode == 0
    for name in ("force.npy", "force.csv"):
        done = meissner(*calibrate("codes.npy", "--force", name, "--overwrite", out="b.npz"), cwd=tmp_path)
        assert (done.returncode, done.stderr) == (0, "")
        a, b = (np.load(tmp_path / out) for out in ("a.npz", "b.npz"))
        assert a.files == b.files and all(np.array_equal(a[key], b[key]) for key in a.files)


ONE = """about = "one taxel"
clock = {mhz = 12.0}
sensor = {kind = "array", rows = 1, columns = 1}
adc = {part = "MCP3208", channels = 1, volts = 5.0, rate_hz = 100.0}
"""


def test_calibrate_takes_an_lsb_and_the_converters_bits(tmp_path):
    """Codes up to 511 look like a full converter of 9 bits; of 12 bits they are no end."""
    force_n = np.arange(6.0)[:, None, None]
    np.savez(tmp_path / "press.npz", codes=(11 + 100 * force_n).astype(int), force_n=force_n)
    (tmp_path / "one.toml").write_text(ONE)
    cases = (
        ((), 0.001, 1),
        (("--adc-bits", 12, "--lsb", 0.01), 0.01, 0),
        (("--config", "one.toml"), 0.001, 0),
    )
    for more, lsb_n, left_out in cases:
        done = meissner(*calibrate("press.npz", *more, "--overwrite"), cwd=tmp_path)
        assert (done.returncode, done.stdout.count("left out: 1 readings")) == (0, left_out), done.stderr
        lines = calibration.load(tmp_path / "new.npz")
        assert (lines.force_lsb_n, lines.gain[0, 0]) == (lsb_n, round(40.96 / lsb_n))
    np.savez(tmp_path / "high.npz", codes=(11 + 900 * force_n).astype(int), force_n=force_n)
    for given, says in (("high.npz", "outside 0 .. 4095"), ("press.npz", "1×1 cells and fingertip 3×3")):
        config = "one.toml" if given == "high.npz" else "fingertip"
        assert says in meissner(*calibrate(given, "--config", config, "--overwrite"), cwd=tmp_path).stderr


def test_calibrate_names_the_dead_cells(tmp_path):
    press = presses()
    press["codes"][:, 1, 1] = 7
    np.savez(tmp_path / "press.npz", **press)
    done = meissner(*calibrate("press.npz", out="cal.npz"), cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "1 dead" in done.stdout and done.stdout.endswith("dead (row, column): (1, 1)\n")
    assert np.argwhere(np.load(tmp_path / "cal.npz")["dead"]).tolist() == [[1, 1]]


def test_ctrl_c_ends_in_one_sentence_and_leaves_nothing(tmp_path, monkeypatch, recording, capsys):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(engines, "process_slip", interrupted)
    before = sorted(tmp_path.iterdir())
    with pytest.raises(SystemExit, match="130"):
        cli.main([*map(str, slip(tmp_path / "in.npy", out=tmp_path / "out.npz"))])
    assert capsys.readouterr() == ("", "meissner: interrupted\n")
    assert sorted(tmp_path.iterdir()) == before
    monkeypatch.setattr("meissner.parser.parser", interrupted)  # while the command begins
    with pytest.raises(SystemExit, match="130"):
        cli.main(["scenes"])
    assert capsys.readouterr() == ("", "meissner: interrupted\n")


def test_an_output_is_replaced_only_where_that_is_asked_for(tmp_path):
    """test_refusals has every command that refuses; what --overwrite replaces is complete."""
    np.savez(tmp_path / "press.npz", **presses())
    (tmp_path / "new.npz").write_text("an earlier file")
    done = meissner(*calibrate("press.npz", "--overwrite"), cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert calibration.load(tmp_path / "new.npz").gain.shape == (3, 3)


def test_every_command_with_an_output_protects_earlier_ones():
    """But for tradeoff, which continues an earlier sweep in its folder."""
    found, open_ = set(), [("", parser())]
    while open_:
        name, one = open_.pop()
        for action in one._actions:
            if isinstance(action.choices, dict):
                open_ += [(f"{name} {word}".strip(), inner) for word, inner in action.choices.items()]
        options = {text for action in one._actions for text in action.option_strings}
        if "--out" in options:
            found.add(name)
            assert ("--overwrite" in options) == (name != "tradeoff"), name
    assert len(found) == 18 and "process cop4" in found


def test_csv_of_a_spreadsheet(tmp_path):
    """A name in capital letters, a byte order mark, CR LF, numbers with a decimal point."""
    (tmp_path / "IN.CSV").write_bytes(b"\xef\xbb\xbf" + b"1.0,2\r\n" * 64)
    assert np.array_equal(readers.read(tmp_path / "IN.CSV").values, np.tile([[1], [2]], 64))


def test_run_writes_its_results_and_prints_the_same(tmp_path):
    done = meissner("run", "normal_force", "--json", "--out", "results", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    printed = json.loads(done.stdout)
    assert printed == json.loads((tmp_path / "results/summary.json").read_text())
    keys = "scene engine seed seconds_simulated seconds_taken samples_per_second twin_mismatches"
    keys += " modelled left_out onset_s flag_s delay_s missed false_alarms contact_share_of_sliding"
    assert set(keys.split()) <= set(printed)
    assert printed["scene"] == "normal_force"
    assert printed["contact_share_of_sliding"] is None
    assert printed["false_alarms"] == 0
    assert printed["onset_s"] is None
    assert "stick-slip" in printed["left_out"]
    names = {path.name for path in (tmp_path / "results").iterdir()}
    assert {"summary.json", "result.npz", "report.html"} < names
    assert any(name.endswith(".png") for name in names)
    assert "nothing slips here, so each flag is a false alarm: no flag in any run" in "\n".join(
        run.tell(scenes.load("normal_force"), printed)
    )


def test_run_begins_with_the_seed_given_or_1(tmp_path, monkeypatch):
    seen = []

    def stop(scene, engine, out, seed, *_):
        seen.append(seed)
        raise ValueError("enough")

    monkeypatch.setattr(run, "run", stop)
    for more in ((), ("--seed", "0"), ("--seed", "7")):
        with pytest.raises(SystemExit):
            cli.main(["run", "walk_25x5", "--out", str(tmp_path / "x"), *more])
    assert seen == [1, 0, 7]


def test_run_finds_the_slip_on_the_core(tmp_path):
    fewer = scenes.source("acrylic_slip").replace("seeds = 100", "seeds = 4")
    (tmp_path / "mine.toml").write_text(fewer, "utf-8")
    done = meissner("run", "mine.toml", "--engine", "rtl", "--json", "--out", "results", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    summary = json.loads(done.stdout)
    assert summary["twin_mismatches"] == 0
    assert summary["missed"] == 0
    assert summary["false_alarms"] == 0
    assert summary["runs"] >= 4
    assert "at the pins of the MCP3208" in "\n".join(run.tell(scenes.load("acrylic_slip"), summary))
    assert 0 <= summary["delay_s"] < summary["gross_s"] - summary["onset_s"]


def own_scene(folder, phase_s=None):
    """A user's scene in ``folder``: one press, one seed, and a title that is no formula; its phases as
    published, or of ``phase_s``."""
    text = scenes.source("normal_force").replace("seeds = 100", "seeds = 1")
    text = text.replace('title = "', "title = 'mine: $5^{ ").replace('slip"\n', "slip'\n", 1)
    if phase_s:
        text = re.sub(r"^((press|rest|unload|after)_s) = .*", rf"\1 = {phase_s}", text, flags=re.M)
    (folder / "mine.toml").write_text(text, "utf-8")


def test_a_scene_of_ones_own_runs_by_its_file(tmp_path):
    own_scene(tmp_path)
    done = meissner("run", "mine.toml", "--seed", 7, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("mine: mine: $5^{ ") and "2 runs, seeds 7 to 7" in done.stdout
    assert {path.name for path in (tmp_path / "build/run/mine").iterdir()} >= {"report.html", "mine_1.png"}
    for arguments, said in (
        (("mine.toml", "--waves"), "--waves requires --engine rtl"),
        (("other.toml",), "other.toml"),
        (("mine",), "unknown scene 'mine'; name a .toml file, or one of: acrylic_slip"),
    ):
        done = meissner("run", *arguments, cwd=tmp_path)
        assert done.returncode == 2 and said in done.stderr and done.stderr.count("\n") == 1
    for name in scenes.names():
        copy = tmp_path / f"{name}.toml"
        copy.write_text(scenes.source(name), "utf-8")
        assert repr(scenes.load(str(copy))) == repr(scenes.load(name))


def test_a_core_that_differs_from_its_twin_ends_the_run_with_an_error(tmp_path, monkeypatch, capsys):
    """With every option; then with one state of the twin changed, whether or not JSON is asked for. The
    scene is brief: waves show every clock."""
    own_scene(tmp_path, 0.2)
    monkeypatch.chdir(tmp_path)
    arguments = ["run", "mine.toml", "--engine", "rtl", "--seed", "7"]
    arguments += ["--out", "here", "--overwrite"]
    cli.main([*arguments, "--waves", "--json"])
    found = json.loads(capsys.readouterr().out)
    assert (found["scene"], found["seeds"], found["twin_mismatches"]) == ("mine", [7, 7], 0)
    assert "waves.vcd" in found["files"] and (tmp_path / "here/waves.vcd").stat().st_size > 1000
    right = engines.fixed.watch

    def wrong(*given):
        watched = right(*given)
        watched.state[0, -1] += 1
        return watched

    monkeypatch.setattr(engines.fixed, "watch", wrong)
    for more in ([], ["--json"]):
        with pytest.raises(SystemExit) as ended:
            cli.main([*arguments, *more])
        said = capsys.readouterr()
        assert (
            ended.value.code == 1 and "mine: the core differs from its integer twin in 4 values" in said.err
        )
        assert json.loads((tmp_path / "here/summary.json").read_text())["twin_mismatches"] == 4


def test_run_says_what_came_of_it(tmp_path):
    done = meissner("run", "cop_six_random", "--engine", "float", "--out", "results", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("cop_six_random: four-wire mesh: ")
    assert "engine float, 4 runs, 1.6 s simulated" in done.stdout
    assert "position error, of the range -1 to 1: 0.322 % in the mean" in done.stdout


def test_process_writes_a_table(tmp_path):
    """One row per frame or window, channels side by side, flags as 0 and 1."""
    frames = np.zeros((2, 2, 3), int)
    frames[0, 1] = [7, 0, 21]
    np.save(tmp_path / "in.npy", frames)
    done = meissner(*cop("in.npy", out="out.CSV"), cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    rows = "sum,mx,my,x,y,valid", "28,28,-28,8192,-16384,1", "0,0,0,0,0,0", ""
    assert (tmp_path / "out.CSV").read_bytes().decode() == "\r\n".join(rows)
    x = np.zeros((2, 8), int)
    x[1, 4:6] = 30, -20
    np.save(tmp_path / "slip.npy", x)
    done = meissner(*slip("slip.npy", "--window", 4, out="slip.csv"), cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "slip.csv").read_text().splitlines() == [
        "p2p_0,p2p_1,window_end,slip_0,slip_1,fired_at_0,fired_at_1",
        "0,0,3,0,0,-1,-1",
        "0,50,7,0,1,-1,7",
    ]


def test_words_of_a_file_move_no_cursor(tmp_path):
    source = (ROOT / "model/meissner/builds/configs/slip1.toml").read_text("utf-8")
    about = [text for text in source.splitlines() if text.startswith("about")]
    text = source.replace(about[0], 'about = "\\u001b]0;title\\u0007\\u001b[2Jnice\\u009b\\u202e"')
    (tmp_path / "c.toml").write_text(text, "utf-8")
    for action in ("check", "show"):
        done = meissner("config", action, "c.toml", cwd=tmp_path)
        assert (done.returncode, done.stdout) == (2, "")
        said = r"about = '\x1b]0;title\x07\x1b[2Jnice\x9b\u202e' must be one line of text"
        assert done.stderr == f"meissner: c.toml: {said}\n"


@pytest.mark.parametrize("locale", ["C", "POSIX"])
def test_a_terminal_without_unicode(tmp_path, locale):
    """With UTF-8 disabled in Python, signs are printed as letters, and no file is read in another
    encoding."""
    np.save(tmp_path / "in.npy", np.ones((2, 3, 4), int))
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("LC_", "LANG"))}
    environment |= {"LC_ALL": locale, "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    for arguments, said in (
        (cop("in.npy"), b"2 frames of 3x4, 2 with a load; "),
        (("config", "list"), b"fingertip"),
        (("scenes",), b"walk_25x5"),
        (("budget", "--rows", "3", "--cols", "4"), b"3x4 taxels, "),
    ):
        command = [sys.executable, "-X", "warn_default_encoding", "-W", "error::EncodingWarning"]
        command += ["-m", "meissner.cli", *map(str, arguments)]
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True)
        assert (done.returncode, done.stderr) == (0, b"")
        assert said in done.stdout
    done = subprocess.run(
        [*command[:5], "-m", "meissner.cli", "process", "cop", "é.npy", "--out", "no.npz"],
        cwd=tmp_path, env=environment, capture_output=True,
    )  # fmt: skip
    assert done.returncode == 2 and done.stderr.startswith(b"meissner: there is no file ")
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize("out", ["out.npz", "out.csv"])
def test_a_full_disk_is_one_sentence(tmp_path, out):
    np.save(tmp_path / "in.npy", np.ones((3000, 2, 2), np.uint8))
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
    command = [sys.executable, "-m", "meissner.cli", *cop("in.npy", out=out)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, preexec_fn=limit)
    assert done.returncode == 2 and done.stdout == ""
    assert done.stderr == f"meissner: {out} could not be written: the file may not grow any more\n"
    assert [path.name for path in tmp_path.iterdir()] == ["in.npy"]


RUN = ("run", "walk_25x5", "--engine", "fixed", "--out", "out")


@pytest.mark.parametrize(("arguments", "what"), [(("scenes",), "the output"), (RUN, "the results in out")])
def test_a_full_disk_names_what_was_being_written(tmp_path, arguments, what):
    """Standard output on a full device; a run's picture or table that exceeds the limit on a file's size."""
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
    full = arguments is not RUN
    with open("/dev/full" if full else os.devnull, "w") as out:
        done = subprocess.run(
            [sys.executable, "-m", "meissner.cli", *arguments],
            cwd=tmp_path,
            stdout=out,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=None if full else limit,
        )
    assert done.returncode == 2
    why = "the disk is full" if full else "the file may not grow any more"
    (line,) = done.stderr.splitlines()
    assert line.startswith("meissner: ") and line.endswith(f" could not be written: {why}")
    assert what in line
