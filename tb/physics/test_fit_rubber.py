"""``meissner fit-rubber``: known constants are recovered, exactly without noise, and lie inside the intervals
as often as these state; the papers' Table 2 gives the papers' line; bad input is refused with one sentence.

The known constants are not those of meissner.physics.rubber, and the recordings are written here by a plain
loop.
"""

import csv
import tomllib

import numpy as np
import pytest

from meissner import cli, fit_rubber
from meissner.builds import config
from meissner.builds.toolchain import ROOT
from meissner.fit_rubber import STEPS, Steps, fit, read, steps_of

K0, K1, N = 1.31, -0.19, 0.17
RESTS, SPEEDS = (1.6, 2.5, 3.7), (0.013, 0.07, 0.4, 1.1, 2.9)
RATE = 500
STEP_RATE = 2000  # of recordings of one step
BUILD = ROOT / "model/meissner/builds/configs/grip.toml"  # without [shear_speed], an MCP3208 at 5 V


def steps(k0=K0, k1=K1, n=N, rests=RESTS, speeds=SPEEDS, share=lambda: 1.0):
    rows = [(rest, (k0 + k1 * rest) * speed**n * share(), speed) for rest in rests for speed in speeds]
    return Steps(*np.array(rows).T)


def recording(rows, rest_s=0.25, moved_mm=0.2):
    """Columns of a recording: at rest at Vi, then at Vi + dV while the stage moves."""
    time_s, volts, speed_mm_s = [], [], []
    for rest_v, step_v, speed in zip(*rows):
        for count, level, moving in (
            (round(rest_s * RATE), rest_v, 0.0),
            (round(moved_mm / speed * RATE), rest_v + step_v, speed),
        ):
            for _ in range(count):
                time_s.append(len(time_s) / RATE)
                volts.append(level)
                speed_mm_s.append(moving)
    return np.array(time_s), np.array(volts), np.array(speed_mm_s)


def write(path, names, columns):
    with path.open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(names)
        table.writerows(zip(*(np.asarray(column).tolist() for column in columns)))
    return path


def test_without_noise_the_constants_come_back_exactly():
    found = fit(steps())
    assert found.value == pytest.approx([K0, K1, N], rel=1e-9)
    assert np.abs(found.residual).max() < 1e-10 and (found.high - found.low).max() < 1e-8
    # 1.31 - 0.19·3 = 0.74; 0.5^0.17 = 0.888843; its inverse gives 0.5 back.
    assert found.step_v(3.0, 0.5) == pytest.approx(0.74 * 0.888843, abs=1e-6)
    assert found.speed_mm_s(3.0, 0.74 * 0.888843) == pytest.approx(0.5, rel=1e-5)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_recording_gives_its_steps(sign):
    """Rests and steps as written, either way of shear; the first step's level is Vi + dV by hand."""
    time_s, volts, speed_mm_s = recording(steps())
    found = steps_of(time_s, volts, sign * speed_mm_s)
    for ours, written in zip(found, steps()):
        assert ours == pytest.approx(written, abs=1e-12)
    assert volts[round(0.25 * RATE)] == pytest.approx(1.6 + (1.31 - 0.304) * 0.013**0.17, abs=1e-12)
    assert fit(found).value == pytest.approx([K0, K1, N], rel=1e-9)


def test_the_rest_is_its_last_tenth_of_a_second_and_the_end_of_a_step_its_last_twentieth():
    """Earlier samples do not count: a press during the rest, the rise at the beginning of the step."""
    time_s = np.arange(1000) / 1000
    speed = np.where(time_s >= 0.5, 0.3, 0.0)
    volts = np.where(time_s < 0.399, 5.0, 2.0)  # 0.4 s is the first sample that counts; 0.399 s is at 2 V too
    volts[500:975], volts[975:] = 2.4, 2.7
    assert np.array(steps_of(time_s, volts, speed)).ravel() == pytest.approx([2.0, 0.7, 0.3], abs=1e-12)
    volts[400] = 3.0  # one of a hundred samples
    assert steps_of(time_s, volts, speed).rest_v == pytest.approx([2.01])
    volts[975 - 1 : 987] = 2.4  # fewer than half of the last 25: the median is that of the others
    assert steps_of(time_s, volts, speed).step_v == pytest.approx([0.69])


def test_the_fit_is_the_least_sum_of_squares_of_logs():
    rng = np.random.default_rng(4)
    rows = steps(share=lambda: np.exp(0.1 * rng.standard_normal()))
    found = fit(rows)

    def squares(k0, k1, n):
        return sum(
            (np.log(step) - np.log((k0 + k1 * rest) * speed**n)) ** 2 for rest, step, speed in zip(*rows)
        )

    least = squares(*found.value)
    for place in range(3):
        for by in (0.999, 1.001):
            moved = found.value.copy()
            moved[place] *= by
            assert squares(*moved) > least
    # The reported residuals have the same sum of squares, so they belong to the same line.
    assert (np.log1p(found.residual) ** 2).sum() == pytest.approx(least, rel=1e-9)


def test_the_intervals_hold_the_constants_as_often_as_they_say():
    """Of 600 recordings with a deviation of 4.4 % of the step, 95 % are 570; four standard deviations are
    21."""
    inside = np.zeros(3, int)
    for seed in range(600):
        rng = np.random.default_rng([20, seed])
        found = fit(steps(share=lambda rng=rng: np.exp(0.044 * rng.standard_normal())))
        inside += (found.low < [K0, K1, N]) & (found.high > [K0, K1, N])
    assert ((inside >= 549) & (inside <= 591)).all(), inside
    narrow = fit(steps(share=lambda: 1 + 0.01 * rng.standard_normal()), confidence=0.5)
    wide = fit(narrow.steps, confidence=0.95)
    # Student's t for 15 - 3 = 12: 2.17881 at 95 %, 0.69548 at 50 %.
    assert (wide.high - wide.low) / (narrow.high - narrow.low) == pytest.approx(2.17881 / 0.69548, rel=1e-4)


def test_table_2_gives_the_papers_line():
    """k·v^n of its three rows at 0.01 to 3 mm/s. The papers' line: 1.55, -0.27, 0.11; its own rows of k give
    1.54 (mean 0.73 at 3 V, -0.27 per volt), and n is the mean of 0.12, 0.11, 0.11."""
    rows = [
        (rest, k * speed**n, speed)
        for rest, k, n in ((2.0, 0.99, 0.12), (3.0, 0.75, 0.11), (4.0, 0.45, 0.11))
        for speed in np.geomspace(0.01, 3.0, 13)
    ]
    found = fit(Steps(*np.array(rows).T))
    assert found.value == pytest.approx([1.55, -0.27, 0.1133], abs=0.015)
    assert found.value[2] == pytest.approx(0.34 / 3, abs=1e-6)  # equal speeds in each row, so the plain mean
    assert found.low[0] < 1.55 < found.high[0] and found.low[1] < -0.27 < found.high[1]


@pytest.mark.parametrize("kind", ["csv", "npz", "steps.csv", "steps.npz"])
def test_every_form_of_file(tmp_path, kind):
    """Columns in any order, an extra column, comments and a byte order mark in a .csv."""
    columns = dict(zip(fit_rubber.RECORDING, recording(steps())))
    if kind.startswith("steps"):
        columns = dict(zip(STEPS, steps()))
    columns = {"note": np.ones(len(columns["speed_mm_s"])), **dict(reversed(columns.items()))}
    path = tmp_path / f"r.{kind}"
    if kind.endswith("npz"):
        np.savez(path, **columns)
    else:
        write(path, columns, columns.values())
        path.write_text("\ufeff# of lot 7\n" + path.read_text(), "utf-8")
    assert fit(read(path)).value == pytest.approx([K0, K1, N], rel=1e-9)


def test_columns_of_other_names_and_units(tmp_path):
    """Times in ms and millivolts by the header, or the three columns by name and number."""
    time_s, volts, speed = recording(steps())
    path = write(
        tmp_path / "a.csv", ("t (ms)", "Vc [mV]", "stage (mm/s)"), (1e3 * time_s, 1e3 * volts, speed)
    )
    assert fit(read(path)).value == pytest.approx([K0, K1, N], rel=1e-6)
    path = write(tmp_path / "b.csv", ("v", "s", "t_ms"), (volts, speed, 1e3 * time_s))
    assert fit(read(path, ["t,v", "2"])).value == pytest.approx([K0, K1, N], rel=1e-6)
    with pytest.raises(ValueError, match="2 columns are named"):
        read(path, ["1", "2"])


def test_the_command_prints_constants_intervals_residuals_and_toml(tmp_path, capsys):
    rng = np.random.default_rng(2)
    rows = steps(share=lambda: np.exp(0.03 * rng.standard_normal()))
    path = write(tmp_path / "lot.csv", fit_rubber.RECORDING, recording(rows))
    cli.main(["fit-rubber", str(path)])
    text = capsys.readouterr().out
    assert text.startswith(
        f"{path}: comma; time_s is time in s, volts is volts in V, speed_mm_s is speed_mm_s\n"
    )
    found = fit(rows)
    for name, value, low, high in zip(("k0", "k1", "n"), found.value, found.low, found.high):
        assert f"{name:<2} = {value:8.4f}   95 % interval {low:.4f} to {high:.4f}" in text
    assert "15 steps from 1.60 to 3.70 V at 0.013 to 2.9 mm/s" in text and "12 degrees of freedom" in text
    printed = text[text.index("# dV =") :]
    written = tomllib.loads(printed)["shear_speed"]
    assert [written[name] for name in ("k0_v", "k1", "n")] == pytest.approx(found.value, rel=1e-5)
    assert [written[name] for name in ("vi_min_v", "vi_max_v", "limit_mm_s")] == [1.6, 3.7, 2.9]
    build = tmp_path / "build.toml"
    build.write_text(BUILD.read_text() + printed)
    cli.main(["config", "check", str(build)])  # a configuration takes what was printed, as it was printed
    told = text[text.index("# cfg_k0 = ") :].strip("# \n").replace("cfg_", "shear_speed.")
    settings = config.load(build).settings  # for 819.2 codes a volt, as the build's MCP3208 at 5 V
    for name, value in (word.split(" = ") for word in told.split(", ")):
        # 6 digits were printed of each constant
        assert settings[name] == pytest.approx(int(value), rel=1e-5, abs=1), name


def test_what_is_said_of_a_fit():
    """1.01^(1/0.17) is 1.0603, and 1.31/0.19 is 6.895. The seventh step, 2.5 V at 0.07 mm/s, is raised."""
    told = fit_rubber.tell(fit(steps()))
    assert "1 % of dV is 6 % of v" in told and "k0 + k1·Vi is 0 at Vi = 6.89 V" in told
    rows = steps()
    rows.step_v[6] *= 1.1
    found = fit(rows)
    k0, k1, n = found.value
    off = [step / ((k0 + k1 * rest) * speed**n) - 1 for rest, step, speed in zip(*rows)]
    assert (
        f"residuals of dV: {100 * (sum(x * x for x in off) / 12) ** 0.5:.2g} % rms (12 degrees of freedom), "
        f"{100 * off[6]:+.2g} % at most, step 7 (2.50 V, 0.07 mm/s)"
    ) in fit_rubber.tell(found)


def test_what_no_core_holds_is_no_table():
    """A speed of 20 mm/s is beyond the register's 16; an exponent of 1/0.02 beyond 32."""
    fast = fit(steps(speeds=[8 * speed for speed in SPEEDS]))
    assert fast.steps.speed_mm_s.max() == pytest.approx(23.2)
    assert tomllib.loads("\n".join(fit_rubber.tell(fast)[-10:]))["shear_speed"]["limit_mm_s"] == 15.9999
    assert fit_rubber.registers(fast)["cfg_limit"] == 16777111  # floor(15.9999·2^20)
    steep = "\n".join(fit_rubber.tell(fit(steps(n=0.02))))
    assert "# no registers of msn_shear_speed: exponent = 102400 must lie in 0 .. 65535" in steep
    assert tomllib.loads(steep[steep.index("# dV =") :]) == {} and "# k0_v = " in steep


def test_the_registers_by_hand(tmp_path, capsys):
    """A level has 512 per code, k1 has 16 bits of fraction, 1/n 11, the limit 20: 1.31·100·512 = 67072,
    -0.19·65536 = -12451.84, 2048/0.17 = 12047.06; 1.6 and 3.7 V: 81920 and 189440; 2.9·2^20 = 3040870.4."""
    words = fit_rubber.registers(fit(steps()), codes_per_v=100)
    names = ("cfg_k0", "cfg_k1", "cfg_exponent", "cfg_vi_min", "cfg_vi_max", "cfg_limit")
    assert words == dict(zip(names, (67072, -12452, 12047, 81920, 189440, 3040870)))
    told = "\n".join(fit_rubber.tell(fit(steps()), 100))
    assert "# cfg_k0 = 67072, cfg_k1 = -12452, cfg_exponent = 12047, cfg_vi_min = 81920" in told
    path = write(tmp_path / "steps.csv", STEPS, steps())
    cli.main(["fit-rubber", str(path), "--codes-per-v", "100"])
    assert "# cfg_k0 = 67072, cfg_k1 = -12452, cfg_exponent = 12047" in capsys.readouterr().out


def refused(path):
    with pytest.raises(ValueError) as problem:
        fit(read(path))
    sentence = str(problem.value)
    assert "\n" not in sentence and len(sentence) < 200
    return sentence


def of_steps(**columns):
    rows = steps()._asdict() | columns
    return list(rows), list(rows.values())


GOOD = recording(steps())


def of_recording(change):
    columns = {name: column.copy() for name, column in zip(fit_rubber.RECORDING, GOOD)}
    change(columns)
    return list(columns), list(columns.values())


def put(name, row, value):
    def change(columns):
        columns[name][row] = value

    return change


REST = round(0.25 * RATE)  # in samples
SECOND = REST + round(0.2 / 0.013 * RATE)  # the first of the second rest, at 15.634 s
BAD = {
    "no volts": (of_recording(lambda c: c.pop("volts")), "volts"),
    "no speed of steps": ((of_steps()[0][:2], of_steps()[1][:2]), "speed_mm_s"),
    "NaN": (of_recording(put("volts", 70, np.nan)), "row 71"),
    "infinity": (of_recording(put("time_s", 4, np.inf)), "row 5"),
    "unsorted": (of_recording(put("time_s", 9, 0.0)), "row 10"),
    "twice the same time": (of_recording(put("time_s", 9, 8 / RATE)), "row 10"),
    "no shear": (of_recording(lambda c: c["speed_mm_s"].fill(0)), "speed_mm_s"),
    "no rest": (of_recording(put("speed_mm_s", slice(SECOND, SECOND + REST), 0.5)), "step 2"),
    "begins moving": (of_recording(put("speed_mm_s", slice(0, 9), 0.5)), "step 1"),
    "speed 0 of a step": (of_steps(speed_mm_s=np.array([0.0, *SPEEDS * 3][:15])), "speed_mm_s"),
    "a fall": (of_steps(step_v=-steps().step_v), "step_v"),
    "one rest": (of_steps(rest_v=np.full(15, 2.2)), "k1"),
    "one speed": (of_steps(speed_mm_s=np.full(15, 0.3)), "so n"),
    "four steps": ((STEPS, [column[[0, 4, 7, 14]] for column in steps()]), "4 steps"),
    "one step": ((STEPS, [column[:1] for column in steps()]), "1 step"),
    "slower is more": (of_steps(step_v=steps(n=-N).step_v), "fits"),
}


@pytest.mark.parametrize("case", BAD)
@pytest.mark.parametrize("kind", ["csv", "npz"])
def test_bad_input_is_one_sentence(tmp_path, kind, case):
    (names, columns), sentence = BAD[case]
    path = tmp_path / f"bad.{kind}"
    if kind == "csv":
        write(path, names, columns)
    else:
        np.savez(path, **dict(zip(names, columns)))
    assert sentence in refused(path)


@pytest.mark.parametrize(
    "text, sentence",
    [
        ("", "bad.csv"),
        ("time_s,volts,speed_mm_s\n", "rows"),
        ("time_s,volts,speed_mm_s\n0,2\n", "line 2"),
        ("time_s,volts,speed_mm_s\n0,two,1\n", "volts"),
        ("time_s,volts,speed_mm_s\n0,,1\n", "volts"),
        ("0,2,1\n1,2,1\n", "time_s"),
        ("rest_v,speed_mm_s\n2,1\n", "step_v"),
    ],
)
def test_bad_text_is_one_sentence(tmp_path, text, sentence):
    (tmp_path / "bad.csv").write_text(text)
    assert sentence in refused(tmp_path / "bad.csv")


def test_files_that_are_none(tmp_path):
    (tmp_path / "x.csv").write_bytes(b"\xff\xfe\x00\x81")
    (tmp_path / "x.npz").write_bytes(b"PK no")
    (tmp_path / "x.pdf").write_text("rest_v")
    np.savez(tmp_path / "text.npz", rest_v=np.array(["a"]), step_v=[1], speed_mm_s=[1])
    np.savez(tmp_path / "flat.npz", rest_v=np.ones((2, 2)), step_v=[1], speed_mm_s=[1])
    np.savez(tmp_path / "long.npz", rest_v=np.ones(5), step_v=np.ones(6), speed_mm_s=np.ones(5))
    assert "x.csv" in refused(tmp_path / "x.csv")
    assert "x.npz" in refused(tmp_path / "x.npz")
    assert ".csv" in refused(tmp_path / "x.pdf")
    assert "rest_v" in refused(tmp_path / "text.npz")
    assert "rest_v" in refused(tmp_path / "flat.npz")
    assert "step_v" in refused(tmp_path / "long.npz")
    assert "gone.csv" in refused(tmp_path / "gone.csv")
    assert "folder" in refused(tmp_path)


def one_step(count, speed=0.5, rest=600, drift=0.0):
    time_s = np.arange(rest + count) / STEP_RATE
    volts = np.where(time_s < rest / STEP_RATE, 2.0 + drift * time_s, 2.5)
    return time_s, volts, np.where(time_s < rest / STEP_RATE, 0.0, speed)


def test_a_step_must_be_whole():
    """At 0.5 mm/s and 2000 samples per second, 0.01 mm are 40 samples, and 0.1 s of rest 200."""
    assert len(steps_of(*one_step(40)).step_v) == len(steps_of(*one_step(40, rest=200)).step_v) == 1
    with pytest.raises(ValueError, match=r"39 samples"):
        steps_of(*one_step(39))
    with pytest.raises(ValueError, match=r"4 samples"):
        steps_of(*one_step(4, speed=20.0))
    assert len(steps_of(*one_step(5, speed=20.0)).step_v) == 1
    with pytest.raises(ValueError, match=r"shorter than 0.1 s"):
        steps_of(*one_step(40, rest=180))


def test_a_rubber_that_still_recovers_is_no_rest():
    """0.1 s of a drift in volts per second; the step is about 0.5 V, and a tenth of it 0.05 V."""
    assert len(steps_of(*one_step(40, drift=-0.3)).step_v) == 1
    with pytest.raises(ValueError, match=r"0.07 V"):
        steps_of(*one_step(40, drift=-0.7))
