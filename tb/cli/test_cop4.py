"""``meissner process cop4``: the arrays it writes on every engine, what it prints, and the one sentence for
every mistake in its file, codes or arguments; in that case nothing is written."""

import re
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
    assert done.stdout.splitlines()[1].startswith(
        "6 samples, 4 with a load; faults: 1 saturated, 1 open, 1 out of balance; "
    )
    assert f"on engine {engine}" in done.stdout
    result = np.load(tmp_path / "out.npz")
    expected = engines.process_cop4(codes, cop4_file.load(tmp_path / "c.toml"), engine)
    assert set(result.files) == {"x", "y", "load", "valid"}
    for field in expected:
        assert np.array_equal(result[field], expected[field])
    assert result["valid"].tolist() == [False, True, True, True, True, False]
    assert np.abs(result["x"][1:5] / 16384 - 0.5).max() < 1e-3 and np.abs(result["y"][1:5]).max() < 16
    assert result["load"][1:4] / 1e3 == pytest.approx([1, 2, 5], rel=0.03)


def test_volts_of_the_electrodes_become_codes(tmp_path, codes):
    """With a unit, and as a LabJack writes them; what lies beyond the range is said."""
    volts = cop4_file.load(tmp_path / "c.toml").adc.volts_of(codes[:5]) / 0.3
    rows = "".join(f"{k / 100},{','.join(map(repr, row))}\n" for k, row in enumerate(volts.tolist()))
    for head in ("t (s),E1 (V),E2 (V),E3 (V),E4 (V)\n", "Time,AIN0,AIN1,AIN2,AIN3\n"):
        (tmp_path / "v.csv").write_text(head + rows)
        done = meissner(*cop4("v.csv", "--overwrite"), cwd=tmp_path)
        assert (done.returncode, done.stderr) == (
            0,
            "",
        ) and "of a converter of -16.6667 to 16.6667 V" in done.stdout
        expected = engines.process_cop4(codes[:5], cop4_file.load(tmp_path / "c.toml"), "fixed")
        assert all(np.array_equal(np.load(tmp_path / "out.npz")[name], expected[name]) for name in expected)
    (tmp_path / "v.csv").write_text("1.5,17,-17,0.1\n")
    assert "2 beyond its range cut" in meissner(*cop4("v.csv", "--overwrite"), cwd=tmp_path).stdout
    done = meissner(*cop4("v.csv", "--overwrite", "--volts-per-code", "0.125"), cwd=tmp_path)
    assert "volts, to codes of 0.125 V, -136 .. 136" in done.stdout
    (tmp_path / "t.csv").write_text("t (s),u (s),a,b,c,d\n0,0,1,2,3,4\n1,1,2,3,4,5\n")
    assert "give the rate with --rate" in meissner(*cop4("t.csv", "--overwrite"), cwd=tmp_path).stderr
    assert not meissner(*cop4("t.csv", "--overwrite", "--rate", "5"), cwd=tmp_path).stderr


def test_process_cop4_counts_each_kind_of_fault(tmp_path, codes):
    """E1 without its current, which unbalances N too; then N alone twice; then no load and no fault."""
    faulty = codes[[2, 2, 2, 0]].copy()
    faulty[0, 0] = codes[0, 0]
    faulty[1:3, [0, 2]] -= 60_000
    np.save(tmp_path / "in.npy", faulty)
    done = meissner(*cop4(), cwd=tmp_path)
    assert done.stdout.splitlines()[1].startswith(
        "4 samples, 0 with a load; faults: 0 saturated, 1 open, 3 out of balance; "
    )


# Keys with bad values; in brackets the word that the sentence must hold, if it is not the key.
MISTAKES = """
rows = 0 | 1025 | "41" | 40.5
columns = -3
r_ohm = 0 | -10 | nan | inf | [10, 47]
R0_ohm = 0 | -1e4
V0_v = -15 | nan
V0_v = 18 (V0)
k_n_ohm = nan
bits = 25 | 7
reference_v = 0
gain = -1 | # = 0 | 0.3\\ngian = 0.3
gain = = 3 (TOML)
lsb_n = 0
lsb_n = 1e-12 (Kf)
min_n = -0.05 | nan
min_n = 70 (min_n)
correction = "palm" | true
"""


@pytest.mark.parametrize("line", MISTAKES.strip().splitlines())
def test_every_mistake_in_the_file_gets_its_sentence(tmp_path, line):
    key, values, word = re.fullmatch(r"(\w+) = (.+?)(?: \((\w+)\))?", line).groups()
    path = tmp_path / "c.toml"
    for value in values.split(" | "):
        text, count = re.subn(rf"(?m)^{key} = .*", f"{key} = {value}", EXAMPLE)
        assert count == 1
        path.write_text(text.replace(f"{key} = #", "#"))
        with pytest.raises(ValueError) as caught:
            cop4_file.load(path)
        said = str(caught.value)
        assert (word or key) in said and "c.toml" in said and "\n" not in said, said


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
    """The same sensor in both forms of file, the second also by name: 16 bits of 5 V, gains of 0.3 and 16."""
    build = tomllib.loads((config.FOLDER / "cop4.toml").read_text())
    own = "[mesh]\n" + "".join(f"{key} = {value}\n" for key, value in build["mesh"].items())
    own += "[converter]\nbits = 16\nreference_v = 5.0\ngain = 0.3\ndifference_gain = 16.0\n"
    own += '[load]\nlsb_n = 0.001\nmin_n = 0.3\ncorrection = "none"\n'
    (tmp_path / "own.toml").write_text(own)
    np.save(tmp_path / "in.npy", codes.astype(np.int64) >> 8)  # codes are of 24 bits
    (tmp_path / "build.toml").write_text((config.FOLDER / "cop4.toml").read_text())
    found = []
    for name in ("own.toml", "build.toml", "cop4"):
        done = meissner(*cop4("in.npy", "--overwrite", config=name), cwd=tmp_path)
        assert (done.returncode, done.stderr) == (0, ""), done.stderr
        found.append(np.load(tmp_path / "out.npz"))
    for other in found[1:]:
        assert all(np.array_equal(found[0][name], other[name]) for name in ("x", "y", "load", "valid"))
