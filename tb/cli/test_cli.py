"""The command line as scripts use it: exit codes, one sentence per error, output files that are complete or
absent."""

import json
import os
import resource
import subprocess
import sys
import zipfile

import numpy as np
import pytest

from command import meissner
from meissner import cli, engines, files, run, scenes
from meissner.builds.toolchain import ROOT
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


def header(shape):
    """The header of a .npy file of 64-bit integers, by NEP 1."""
    text = f"{{'descr': '<i8', 'fortran_order': False, 'shape': {shape}}}".ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode()


def archive(path, **shapes):
    """A .npz whose arrays are headers followed by a few zeros."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name, shape in shapes.items():
            file.writestr(f"{name}.npy", header(shape) + bytes(800))


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


BAD = {
    "window 48": (slip("in.npy", "--window", 48), "window = 48 must be a power of two"),
    "window 2": (slip("in.npy", "--window", 2), "window = 2 must be a power of two, 4 or more"),
    "hop odd": (slip("in.npy", "--hop", 5), "hop = 5"),
    "hop 0": (slip("in.npy", "--hop", 0), "hop = 0"),
    "level": (slip("in.npy", "--level", 4), "level = 4"),
    "threshold negative": (
        ("process", "slip", "in.npy", "--rate", "1", "--threshold", "-1", "--out", "out.npz"),
        "threshold = -1 must not be negative",
    ),
    "threshold wide": (
        ("process", "slip", "in.npy", "--rate", "1", "--threshold", 1 << 32, "--out", "out.npz"),
        "threshold = 4294967296 must be below 262144",
    ),
    "threshold not a number": (
        ("process", "slip", "in.npy", "--rate", "1", "--threshold", "4.5", "--out", "out.npz"),
        "invalid int value: '4.5'",
    ),
    "rate": (
        ("process", "slip", "in.npy", "--rate", "0", "--threshold", "1", "--out", "out.npz"),
        "rate = 0",
    ),
    "rate NaN": (
        ("process", "slip", "in.npy", "--rate", "nan", "--threshold", "1", "--out", "out.npz"),
        "rate = nan must be a number",
    ),
    "engine": (slip("in.npy", "--engine", "warp"), "unknown engine 'warp'"),
    "missing": (slip("nowhere.npy"), "there is no file nowhere.npy"),
    "not an array": (slip("text.npy"), "text.npy is not a .npy file"),
    "other kind": (slip("in.txt"), "must be a .npy or a .csv file"),
    "archive": (slip("archive.npy"), "archive.npy is not a .npy file"),
    "broken archive": (slip("broken.npy"), "broken.npy is not a .npy file"),
    "empty": (slip("empty.csv"), "empty.csv holds no numbers"),
    "single number": (slip("single.npy"), "shape"),
    "complex": (slip("complex.npy"), "must be integers, not complex128"),
    "window too long": (slip("in.npy", "--window", 2048), "1000 samples do not fill one window of 2048"),
    "words": (slip("words.csv"), "words.csv is not a table of numbers"),
    "no folder": (slip("in.npy", out="no/out.npz"), "there is no folder no"),
    "not a file": (slip("in.npy", out="pipe"), "pipe is not a regular file"),
    "out a folder": (slip("in.npy", out="folder"), "folder is a folder; name a file"),
    "out of another kind": (slip("in.npy", out="out.npy"), "out.npy must be a .npz or a .csv file"),
    "out without a kind": (cop("cube.npy", out="out"), "out must be a .npz or a .csv file"),
    "calibrate out": (calibrate("press.npz", out="cal.csv"), "cal.csv must be a .npz file"),
    "in a pipe": (slip("pipe"), "pipe is a pipe or a device; name a file"),
    "in a pipe of a kind": (slip("pipe.npy"), "pipe.npy is a pipe or a device; name a file"),
    "in a folder": (cop("folder"), "folder is a folder; name a file"),
    "in a folder of a kind": (cop("folder.csv"), "folder.csv is a folder; name a file"),
    "in a device": (slip("/dev/zero"), "/dev/zero is a pipe or a device"),
    "calibration a pipe": (cop("cube.npy", "--calibration", "pipe"), "pipe is a pipe or a device"),
    "calibrate a pipe": (calibrate("pipe"), "contains only codes"),
    "calibrate a pipe of a kind": (calibrate("pipe.npz"), "pipe.npz is a pipe or a device"),
    "calibrate forces a pipe": (calibrate("cube.npy", "--force", "pipe.npy"), "pipe.npy is a pipe or a"),
    "cop4 config a pipe": (
        ("process", "cop4", "in.npy", "--config", "pipe", "--out", "out.npz"),
        "pipe is a pipe or a device",
    ),
    "config a pipe": (("config", "check", "pipe"), "'pipe' is neither a file nor one of"),
    "config a folder": (("config", "show", "folder"), "'folder' is neither a file nor one of"),
    "replay a pipe": (("replay", "pipe.npz", "--out", "out.npz"), "pipe.npz is a pipe or a device"),
    "replay a folder": (("replay", "folder", "--out", "out.npz"), "folder is a folder; name a file"),
    "replay out": (("replay", "press.npz", "--out", "out.txt"), "press.npz is not a log of a core"),
    "log a pipe": (("log", "file:pipe", "--out", "out.npz"), "pipe is a pipe or a device; name a file"),
    "live a folder": (("live", "file:folder"), "folder is a folder; name a file"),
    "run into a pipe": (("run", "acrylic_slip", "--out", "pipe"), "pipe is a file; name a folder"),
    "says more than it has": (slip("tall_header.npy"), "tall_header.npy is not a .npy file"),
    "cop calibration inflated": (
        cop("cube.npy", "--calibration", "bomb.npz"),
        "bomb.npz is not a calibration: offset is 20000×20000, beyond 1024×1024",
    ),
    "cop calibration long": (
        cop("cube.npy", "--calibration", "bomb1.npz"),
        "bomb1.npz is not a calibration: gain is 400000000, beyond 1024×1024",
    ),
    "cop calibration header": (
        cop("cube.npy", "--calibration", "bomb2.npz"),
        "bomb2.npz is not a .npz file of arrays",
    ),
    "calibrate inflated": (calibrate("bomb3.npz"), "bomb3.npz would take 9007199.3 GB of memory, more than"),
    "replay inflated": (("replay", "bomb3.npz", "--out", "out.npz"), "bomb3.npz would take 9007199.3 GB of"),
    "escapes in a name": (slip("\x1b[2J\u202e\n.npy"), "there is no file \\x1b[2J\\u202e\\n.npy"),
    "escapes in an option": (("run", "x", "--\x1b[2J"), "unrecognized arguments: --\\x1b[2J"),
    "NaN": (slip("nan.npy"), "NaN"),
    "fractions": (slip("half.npy"), "not integers"),
    "range": (slip("wide.npy"), "outside"),
    "channels": (slip("many.npy"), "more than the core's 4096"),
    "shape": (slip("cube.npy"), "shape"),
    "cop negative": (cop("negative.npy"), "the forces lie in -1 .. 9, outside 0 .. 65535"),
    "cop range": (cop("high.npy"), "the forces lie in 0 .. 65536, outside"),
    "cop flat": (cop("in.npy"), "must have the shape [frames, rows, columns], not (2, 1000)"),
    "cop csv": (cop("in.csv"), "must have the shape"),
    "cop empty": (cop("empty.npy"), "must have the shape [frames, rows, columns], not (3, 0, 5)"),
    "cop rows": (cop("tall.npy"), "1025 rows are more than the core's 1024"),
    "cop columns": (cop("broad.npy"), "1025 columns are more than"),
    "cop NaN": (cop("nan3.npy"), "NaN"),
    "cop fractions": (cop("half3.npy"), "not integers"),
    "cop complex": (cop("complex3.npy"), "must be integers, not complex128"),
    "cop min load": (cop("cube.npy", "--min-load", -1), "min-load = -1 must not be negative"),
    "cop min load high": (cop("cube.npy", "--min-load", 1 << 23), "must lie in 0 .. 8388607"),
    "cop calibration missing": (cop("cube.npy", "--calibration", "c.npz"), "there is no file c.npz"),
    "cop calibration kind": (cop("cube.npy", "--calibration", "in.npy"), "in.npy is not a .npz file"),
    "cop calibration other": (
        cop("cube.npy", "--calibration", "other.npz"),
        "other.npz is not a calibration: it has no offset",
    ),
    "cop calibration gain": (
        cop("cube.npy", "--calibration", "gain.npz"),
        "gain.npz is not a calibration: the gains must lie in 0 .. 65535",
    ),
    "cop calibration size": (
        cop("cube.npy", "--calibration", "cal.npz"),
        "the codes have 2×64 cells but the calibration has 3×2",
    ),
    "cop calibration codes": (
        cop("far.npy", "--calibration", "cal.npz"),
        "the codes lie in 0 .. 65536, outside -65536 .. 65535",
    ),
    "cop calibration NaN": (cop("nan32.npy", "--calibration", "cal.npz"), "the codes hold NaN"),
    "calibrate missing": (calibrate("nowhere.npz"), "there is no file nowhere.npz"),
    "calibrate text": (calibrate("text.npz"), "text.npz is not a .npz file"),
    "calibrate other": (calibrate("other.npz"), "other.npz is not a press recording: it has no codes"),
    "calibrate no force": (
        calibrate("cube.npy"),
        "cube.npy contains only codes: give the forces with --force",
    ),
    "calibrate two forces": (
        calibrate("press.npz", "--force", "in.npy"),
        "press.npz already contains forces",
    ),
    "calibrate force shape": (
        calibrate("cube.npy", "--force", "in.npy"),
        "force_n must have the shape [2] or [2, 2, 64] as the codes have, not (2, 1000)",
    ),
    "calibrate too few": (calibrate("few.npz"), "too few presses for 2 cells (row, column): (0, 1), (2, 0)"),
    "calibrate lsb": (calibrate("press.npz", "--lsb", "1e-9"), "lsb = 1e-09 N must be"),
    "calibrate lsb NaN": (calibrate("press.npz", "--lsb", "nan"), "lsb = nan N must be"),
    "calibrate folder": (calibrate("press.npz", out="no/cal.npz"), "there is no folder no"),
    "fit-rubber missing": (("fit-rubber", "nowhere.csv"), "there is no file nowhere.csv"),
    "fit-rubber codes": (("fit-rubber", "x.csv", "--codes-per-v", "0"), "codes-per-v = 0 must be a number"),
    "fit-rubber a pipe": (("fit-rubber", "pipe"), "pipe is a pipe or a device"),
    "fit-rubber words": (("fit-rubber", "words.csv"), "words.csv has no column time_s; a recording has"),
    "fit-rubber text": (("fit-rubber", "text.npz"), "text.npz is not a .npz file of numbers"),
    "fit-rubber inflated": (("fit-rubber", "bomb.npz"), "bomb.npz has no column time_s"),
    "cop engine": (cop("cube.npy", "--engine", "warp"), "unknown engine 'warp'"),
    "cop missing": (cop("nowhere.npy"), "there is no file nowhere.npy"),
    "scene": (("run", "nope", "--out", "results"), "unknown scene 'nope'"),
    "run into a file": (("run", "acrylic_slip", "--out", "in.npy/results"), "in.npy is a file"),
    "run engine": (("run", "acrylic_slip", "--engine", "warp", "--out", "results"), "unknown engine"),
    "run waves": (("run", "acrylic_slip", "--waves", "--out", "results"), "--waves requires --engine rtl"),
    "run seed": (("run", "acrylic_slip", "--seed", "-1", "--out", "results"), "seed = -1"),
    "run cop waves": (("run", "walk_25x5", "--waves", "--out", "results"), "--waves requires --engine rtl"),
    "run mesh engine": (
        ("run", "cop_load", "--engine", "warp", "--out", "results"),
        "unknown engine 'warp'",
    ),
    "no command": ((), "required: COMMAND"),
}


@pytest.fixture(scope="module")
def inputs(tmp_path_factory):
    """A folder with the files that BAD names: no command of these changes it."""
    folder = tmp_path_factory.mktemp("inputs")
    recorded(folder)
    (folder / "text.npy").write_text("not an array")
    (folder / "in.txt").write_text("1\n")
    (folder / "words.csv").write_text("a,b\n")
    (folder / "empty.csv").write_text("# nothing\n")
    (folder / "broken.npy").write_bytes(b"PK\x03\x04 and no more")
    with open(folder / "archive.npy", "wb") as file:
        np.savez(file, x=np.zeros(100, int))
    for name in ("pipe", "pipe.npy", "pipe.npz"):
        os.mkfifo(folder / name)
    for name in ("folder", "folder.csv"):
        (folder / name).mkdir()
    (folder / "tall_header.npy").write_bytes(header((1 << 40,)) + bytes(64))
    archive(folder / "bomb.npz", offset=(20_000, 20_000), gain=(3, 2))
    archive(folder / "bomb1.npz", offset=(3, 2), gain=(400_000_000,))
    archive(folder / "bomb3.npz", codes=(1 << 40, 32, 32), force_n=(5,))
    with zipfile.ZipFile(folder / "bomb2.npz", "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("offset.npy", b"\x93NUMPY\x02\x00" + (1 << 24).to_bytes(4, "little") + bytes(1 << 24))
    for name, x in {
        "single": np.int64(5),
        "complex": np.zeros(100, complex),
        "nan": np.full(100, np.nan),
        "half": np.full(100, 0.5),
        "wide": np.full(100, 1 << 20),
        "many": np.zeros((4097, 64), int),
        "cube": np.zeros((2, 2, 64), int),
        "negative": np.arange(-1, 10).reshape(1, 1, 11),
        "high": np.array([[[0, 65536]]]),
        "empty": np.zeros((3, 0, 5), int),
        "tall": np.zeros((1, 1025, 1), int),
        "broad": np.zeros((1, 1, 1025), int),
        "nan3": np.full((1, 2, 2), np.nan),
        "half3": np.full((1, 2, 2), 0.5),
        "complex3": np.zeros((1, 2, 2), complex),
    }.items():
        np.save(folder / f"{name}.npy", x)
    (folder / "text.npz").write_text("not an archive")
    np.save(folder / "far.npy", np.full((1, 3, 2), 65536) * [0, 1])
    np.save(folder / "nan32.npy", np.full((1, 3, 2), np.nan))
    np.savez(folder / "other.npz", x=np.zeros(3))
    np.savez(folder / "press.npz", **presses())
    np.savez(folder / "few.npz", **presses(few=True))
    lines = {"offset": np.zeros((3, 2), int), "gain": np.ones((3, 2), int), "gain_shift": 12}
    lines |= {"dead": np.zeros((3, 2), bool), "force_lsb_n": 1e-3}
    np.savez(folder / "cal.npz", **lines)
    np.savez(folder / "gain.npz", **lines | {"gain": np.full((3, 2), 65536)})
    return folder


def state(folder):
    """What a folder holds, and when each file was written."""
    return sorted((path, path.stat().st_mtime_ns) for path in folder.rglob("*"))


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_one_sentence_and_writes_nothing(inputs, case):
    before = state(inputs)
    arguments, sentence = BAD[case]
    done = meissner(*arguments, cwd=inputs)
    assert done.returncode == 2
    assert sentence in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert done.stdout == ""
    assert state(inputs) == before


@pytest.mark.parametrize("engine", engines.NAMES)
def test_calibrate_and_then_process_cop(tmp_path, engine):
    np.savez(tmp_path / "press.npz", **presses())
    done = meissner(*calibrate("press.npz", out="cal.npz"), cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith(
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


def test_calibrate_takes_the_forces_from_another_file(tmp_path):
    press = presses()
    np.save(tmp_path / "codes.npy", press["codes"])
    np.save(tmp_path / "force.npy", press["force_n"])
    np.savetxt(tmp_path / "force.csv", press["force_n"][:, 0, 0])
    np.savez(tmp_path / "press.npz", **press)
    assert meissner(*calibrate("press.npz", out="a.npz"), cwd=tmp_path).returncode == 0
    for name in ("force.npy", "force.csv"):
        done = meissner(*calibrate("codes.npy", "--force", name, out="b.npz"), cwd=tmp_path)
        assert (done.returncode, done.stderr) == (0, "")
        a, b = (np.load(tmp_path / out) for out in ("a.npz", "b.npz"))
        assert a.files == b.files and all(np.array_equal(a[key], b[key]) for key in a.files)


def test_calibrate_names_the_dead_cells(tmp_path):
    press = presses()
    press["codes"][:, 1, 1] = 7
    np.savez(tmp_path / "press.npz", **press)
    done = meissner(*calibrate("press.npz", out="cal.npz"), cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "1 dead" in done.stdout and done.stdout.endswith("dead (row, column): (1, 1)\n")
    assert np.argwhere(np.load(tmp_path / "cal.npz")["dead"]).tolist() == [[1, 1]]


def test_ctrl_c_ends_in_one_sentence_and_leaves_nothing(tmp_path, monkeypatch, recording, capsys):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(engines, "process_slip", interrupted)
    before = sorted(tmp_path.iterdir())
    with pytest.raises(SystemExit, match="130"):
        cli.main([*map(str, slip(tmp_path / "in.npy", out=tmp_path / "out.npz"))])
    assert capsys.readouterr() == ("", "meissner: interrupted\n")
    assert sorted(tmp_path.iterdir()) == before


def test_csv_of_a_spreadsheet(tmp_path):
    """A name in capital letters, a byte order mark, CR LF, numbers with a decimal point."""
    (tmp_path / "IN.CSV").write_bytes(b"\xef\xbb\xbf" + b"1.0,2\r\n" * 64)
    assert np.array_equal(files.read_array(tmp_path / "IN.CSV"), np.tile([[1], [2]], 64))


def test_scenes_are_listed_one_line_each(tmp_path):
    done = meissner("scenes", cwd=tmp_path)
    assert done.returncode == 0
    assert [line.split()[0] for line in done.stdout.splitlines()] == [
        "acrylic_slip",
        "capacitive_cell",
        "capacitive_crosstalk",
        "capacitive_select",
        "capacitive_shapes",
        "cop_circle",
        "cop_impulse",
        "cop_impulse_place",
        "cop_load",
        "cop_one_point",
        "cop_six_random",
        "cop_slip",
        "cop_two_point",
        "dense_1024",
        "dense_64",
        "fsr_3x3",
        "fsr_64x64",
        "grip_disturb",
        "grip_pour",
        "grip_release",
        "grip_slip",
        "grip_water",
        "normal_force",
        "plantar_step",
        "shear_amount",
        "shear_recover",
        "shear_speed",
        "slip_first_event",
        "slip_forces",
        "slip_materials",
        "stick_slip",
        "walk_25x5",
    ]


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


def test_run_finds_the_slip_on_the_core(tmp_path):
    done = meissner("run", "acrylic_slip", "--engine", "rtl", "--json", "--out", "results", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    summary = json.loads(done.stdout)
    assert summary["twin_mismatches"] == 0
    assert summary["missed"] == 0
    assert summary["false_alarms"] == 0
    assert summary["runs"] >= 100
    assert "at the pins of the MCP3208" in "\n".join(run.tell(scenes.load("acrylic_slip"), summary))
    assert 0 <= summary["delay_s"] < summary["gross_s"] - summary["onset_s"]


def test_run_draws_the_centre_of_pressure_on_the_core(tmp_path):
    done = meissner("run", "walk_25x5", "--engine", "rtl", "--json", "--out", "results", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    summary = json.loads(done.stdout)
    assert summary == json.loads((tmp_path / "results/summary.json").read_text())
    assert summary["twin_mismatches"] == 0
    assert 0 < summary["position_error"]["mean"] < summary["position_error"]["maximum"] < 0.01
    assert 0 < summary["load_error"]["mean"] < summary["load_error"]["maximum"] < 0.01
    names = {path.name for path in (tmp_path / "results").iterdir()}
    assert names == {"summary.json", "result.npz", "report.html", "walk_25x5.png"}


def test_run_says_what_came_of_it(tmp_path):
    done = meissner("run", "cop_six_random", "--engine", "float", "--out", "results", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("cop_six_random: four-wire mesh: ")
    assert "engine float, 4 runs, 1.6 s simulated" in done.stdout
    assert "position error, of the range -1 to 1: 0.322 % in the mean" in done.stdout


@pytest.mark.parametrize("engine", ["fixed", "rtl"])
def test_run_a_mesh_scene_on_the_core(tmp_path, engine):
    done = meissner("run", "cop_load", "--engine", engine, "--json", "--out", "results", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    summary = json.loads(done.stdout)
    assert summary == json.loads((tmp_path / "results/summary.json").read_text())
    assert summary["twin_mismatches"] == (0 if engine == "rtl" else None)
    assert 0 < summary["position_error"]["mean"] < summary["position_error"]["maximum"] < 0.001
    assert 0.1 < summary["load_error"]["maximum"] < 0.15
    names = {path.name for path in (tmp_path / "results").iterdir()}
    assert names == {"summary.json", "result.npz", "report.html", "cop_load.png"}


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
        [*command[:5], "-m", "meissner.cli", "process", "cop", "é.npy", "--out", "out.npz"],
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
