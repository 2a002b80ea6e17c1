"""``meissner process cop4``: the arrays it writes on every engine, what it prints, and the one sentence for
every mistake in its file, codes or arguments; in that case nothing is written."""

import tomllib

import numpy as np
import pytest

from cli.test_cli import meissner
from meissner import engines
from meissner.builds import config, cop4_file
from meissner.builds.toolchain import ROOT

EXAMPLE = (ROOT / "docs/cop4.toml").read_text()
"""Each value that the tests spoil stands in it once, as `key = value`."""


def cop4(source="in.npy", *extra, config="c.toml", out="out.npz"):
    return ("process", "cop4", source, "--config", config, "--out", out, *extra)


@pytest.fixture
def codes(tmp_path):
    (tmp_path / "c.toml").write_text(EXAMPLE)
    config = cop4_file.load(tmp_path / "c.toml")
    load = np.zeros((6, 41, 41))
    load[1:, 20, 30] = 1, 2, 5, 10, 20
    answer = config.mesh.solve(load)
    codes = config.convert(np.stack([answer.E1, answer.E2, answer.E3, answer.E4], axis=1))
    codes[5, 0] = config.adc.max_code
    np.save(tmp_path / "in.npy", codes.astype(float))
    np.savetxt(tmp_path / "in.csv", codes, fmt="%d", delimiter=",")
    return codes


@pytest.mark.parametrize("engine", engines.NAMES)
@pytest.mark.parametrize("name", ["in.npy", "in.csv"])
def test_process_cop4(tmp_path, codes, engine, name):
    done = meissner(*cop4(name, "--engine", engine), cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("6 samples, 4 with a load; faults: 1 saturated, 1 open, 1 out of balance; ")
    assert f"on engine {engine}" in done.stdout
    result = np.load(tmp_path / "out.npz")
    expected = engines.process_cop4(codes, cop4_file.load(tmp_path / "c.toml"), engine)
    assert set(result.files) == {"x", "y", "load", "valid"}
    for field in expected:
        assert np.array_equal(result[field], expected[field])
    assert result["valid"].tolist() == [False, True, True, True, True, False]
    assert np.abs(result["x"][1:5] / 16384 - 0.5).max() < 1e-3 and np.abs(result["y"][1:5]).max() < 16
    assert result["load"][1:4] / 1e3 == pytest.approx([1, 2, 5], rel=0.03)


def spoiled(key, value):
    lines = [line for line in EXAMPLE.splitlines() if line.startswith(f"{key} = ")]
    assert len(lines) == 1, key
    return EXAMPLE.replace(lines[0], value if "=" in value else f"{key} = {value}")


MISTAKES = {
    "rows": ("rows", "0", "c.toml, [mesh]: rows = 0 must lie in 1 .. 1024"),
    "columns": ("columns", "-3", "c.toml, [mesh]: columns = -3 must lie in 1 .. 1024"),
    "many rows": ("rows", "1025", "rows = 1025 must lie in 1 .. 1024"),
    "rows as text": ("rows", '"41"', "rows = '41' must be a whole number"),
    "half a row": ("rows", "40.5", "rows = 40.5 must be a whole number"),
    "r": ("r_ohm", "0", "c.toml, [mesh]: r_ohm = 0 must be above 0"),
    "r negative": ("r_ohm", "-10", "r_ohm = -10 must be above 0"),
    "r NaN": ("r_ohm", "nan", "r_ohm"),
    "r infinite": ("r_ohm", "inf", "r_ohm"),
    "r list": ("r_ohm", "[10, 47]", "r_ohm = [10, 47] must be a number"),
    "R0": ("R0_ohm", "0", "R0_ohm = 0 must be above 0"),
    "R0 negative": ("R0_ohm", "-1e4", "R0_ohm = -10000 must be above 0"),
    "V0": ("V0_v", "-15", "V0_v = -15 must be above 0"),
    "V0 beyond the range": ("V0_v", "18", "leaves no room below 5 V"),
    "k": ("k_n_ohm", "nan", "k_n_ohm"),
    "bits": ("bits", "25", "c.toml, [converter]: bits = 25 must lie in 8 .. 24"),
    "few bits": ("bits", "7", "bits = 7 must lie in 8 .. 24"),
    "reference": ("reference_v", "0", "reference_v = 0 must be above 0"),
    "gain": ("gain", "-1", "gain = -1 must be above 0"),
    "load step": ("lsb_n", "0", "c.toml, [load]: lsb_n = 0 must be above 0"),
    "load step too fine": ("lsb_n", "1e-12", "Kf = 0.864 N at 1e-12 N is too large for its register"),
    "least load": ("min_n", "-0.05", "min_n = -0.05 must be above 0"),
    "least load NaN": ("min_n", "nan", "min_n"),
    "least load wide": ("min_n", "70", "min_load = 70000 must lie in 0 .. 65535"),
    "correction": ("correction", '"palm"', "correction = 'palm' must be one of: none, point, cover"),
    "correction as a flag": ("correction", "true", "correction = True must be text"),
    "missing key": ("gain", "# = 0", "c.toml, [converter]: the key 'gain' is missing"),
    "unknown key": ("gain", "gain = 0.3\ngian = 0.3", "[converter]: unknown key 'gian'"),
    "no TOML": ("gain", "gain = = 3", "c.toml is not a TOML file"),
}
BAD = {
    "flat": (cop4("flat.npy"), "must have the shape [samples, 4], not (100,)"),
    "turned": (cop4("turned.npy"), "must have the shape [samples, 4], not (4, 6)"),
    "five": (cop4("five.csv"), "must have the shape [samples, 4], not (2, 5)"),
    "none": (cop4("none.npy"), "must have the shape"),
    "NaN": (cop4("nan.npy"), "NaN"),
    "volts": (cop4("half.npy"), "not integers"),
    "complex": (cop4("complex.npy"), "must be integers, not complex128"),
    "range": (
        cop4("wide.npy"),
        "the codes lie in -8388609 .. 0, outside -8388608 .. 8388607 of 24 bits",
    ),
    "engine": (cop4("in.npy", "--engine", "warp"), "unknown engine 'warp'"),
    "no input": (cop4("nowhere.npy"), "there is no file nowhere.npy"),
    "no folder": (cop4(out="no/out.npz"), "there is no folder no"),
    "no file": (cop4(config="nowhere.toml"), "there is no file nowhere.toml"),
    "a table too few": (cop4(config="short.toml"), "short.toml, [mesh]: the key 'rows' is missing"),
    "a binary file": (cop4(config="in.npy"), "in.npy is not a TOML file"),
    "waves of a slip": (
        ("run", "cop_slip", "--waves", "--out", "results"),
        "--waves requires --engine rtl",
    ),
    "engine of a slip": (
        ("run", "cop_slip", "--engine", "warp", "--out", "results"),
        "unknown engine 'warp'",
    ),
    "no config": (("process", "cop4", "in.npy", "--out", "out.npz"), "required: --config"),
}


def refused(tmp_path, arguments, sentence):
    before = sorted(tmp_path.iterdir())
    done = meissner(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert sentence in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert done.stdout == ""
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_one_sentence_and_writes_nothing(tmp_path, codes, case):
    (tmp_path / "short.toml").write_text("[mesh]\n[converter]\n")
    (tmp_path / "five.csv").write_text("1,2,3,4,5\n" * 2)
    for name, x in {
        "flat": np.zeros(100, int),
        "turned": codes.T[:, :6],
        "none": np.zeros((0, 4), int),
        "nan": np.full((1, 4), np.nan),
        "half": np.full((1, 4), 0.5),
        "complex": np.zeros((1, 4), complex),
        "wide": np.array([[0, 0, 0, -(1 << 23) - 1]]),
    }.items():
        np.save(tmp_path / f"{name}.npy", x)
    refused(tmp_path, *BAD[case])


@pytest.mark.parametrize("case", ["rows", "r negative", "V0 beyond the range", "no TOML"])
def test_the_command_says_what_is_wrong_in_its_file(tmp_path, codes, case):
    key, value, sentence = MISTAKES[case]
    (tmp_path / "c.toml").write_text(spoiled(key, value))
    refused(tmp_path, cop4(), sentence)


@pytest.mark.parametrize("case", MISTAKES)
def test_every_mistake_in_the_file_gets_its_sentence(tmp_path, case):
    key, value, sentence = MISTAKES[case]
    path = tmp_path / "c.toml"
    path.write_text(spoiled(key, value))
    with pytest.raises(ValueError) as caught:
        cop4_file.load(path)
    assert sentence in str(caught.value) and "\n" not in str(caught.value)


def test_the_example_has_every_key_once():
    tables = tomllib.loads(EXAMPLE)
    assert set(tables) == {"mesh", "converter", "load"}
    for key in {key for table in tables.values() for key in table}:
        assert len([line for line in EXAMPLE.splitlines() if line.startswith(f"{key} = ")]) == 1


def test_every_value_of_the_file_arrives_in_its_place(tmp_path):
    values = {"rows": 3, "columns": 7, "r_ohm": 20, "R0_ohm": 5e3, "V0_v": 2, "k_n_ohm": 900}
    values |= {"bits": 18, "reference_v": 4, "gain": 1.5, "lsb_n": 0.002, "min_n": 0.4}
    text = EXAMPLE
    for key, value in values.items():
        (line,) = (line for line in text.splitlines() if line.startswith(f"{key} = "))
        text = text.replace(line, f"{key} = {value}")
    (tmp_path / "c.toml").write_text(text)
    config = cop4_file.load(tmp_path / "c.toml")
    assert repr(config.mesh) == "Mesh(3, 7, r=20, R0=5000, V0=2, k=900)"
    assert (config.adc.bits, config.adc.low_v, config.adc.high_v, config.adc.noise_v) == (18, -4, 4, 0)
    assert config.convert(np.array([[1.0, -1.0, 0.0, 2.0]])).tolist() == [[49152, -49152, 0, 98304]]
    assert (config.load_lsb_n, config.registers.min_load, config.sample_bits) == (0.002, 200, 18)


def test_a_builds_configuration_is_taken_too(tmp_path, codes):
    """The same sensor in both forms of file, the second also by name: 16 bits of 5 V, a gain of 0.3."""
    build = tomllib.loads((config.FOLDER / "cop4.toml").read_text())
    own = "[mesh]\n" + "".join(f"{key} = {value}\n" for key, value in build["mesh"].items())
    own += "[converter]\nbits = 16\nreference_v = 5.0\ngain = 0.3\n"
    own += '[load]\nlsb_n = 0.001\nmin_n = 0.1\ncorrection = "none"\n'
    (tmp_path / "own.toml").write_text(own)
    np.save(tmp_path / "in.npy", codes.astype(np.int64) >> 8)  # codes are of 24 bits
    (tmp_path / "build.toml").write_text((config.FOLDER / "cop4.toml").read_text())
    found = []
    for name in ("own.toml", "build.toml", "cop4"):
        done = meissner(*cop4(config=name), cwd=tmp_path)
        assert (done.returncode, done.stderr) == (0, ""), done.stderr
        found.append(np.load(tmp_path / "out.npz"))
    for other in found[1:]:
        assert all(np.array_equal(found[0][name], other[name]) for name in ("x", "y", "load", "valid"))


@pytest.mark.parametrize(
    "name, sentence",
    [
        ("fingertip", "fingertip: [sensor]: kind = 'array' must be 'electrodes' for `meissner process cop4`"),
        ("nothing", "there is no file nothing"),
        ("half.toml", "half.toml: the key 'sensor' is missing"),
    ],
)
def test_another_builds_configuration_is_refused(tmp_path, codes, name, sentence):
    (tmp_path / "half.toml").write_text('about = "half"\n[clock]\nmhz = 25.0\n')
    done = meissner(*cop4(config=name), cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert sentence.split(": ")[-1] in done.stderr and len(done.stderr.splitlines()) == 1
