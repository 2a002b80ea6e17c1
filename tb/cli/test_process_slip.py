"""``meissner process slip`` of recordings by a configuration: one command from a scope's CSV to a flag.
States against the core's own (engine rtl) and against the loop written from docs/slip.md."""

import numpy as np
import pytest

from cli.test_cli import meissner
from meissner import calibration, engines
from meissner.builds import config
from meissner.builds.toolchain import ROOT
from reference.slip import GROSS, INCIPIENT, NUMBERS, SlipPathReference

BUILD = """about = "two rubbers"
[clock]
mhz = 24.0
[sensor]
kind = "channels"
channels = 2
[adc]
part = "MCP3208"
volts = 4.096
rate_hz = 8000.0
[slip]
window = 64
hop = 32
threshold_p2p_v = 0.1
gross_threshold_p2p_v = 0.2
keep_threshold_p2p_v = 0.07
contact_level_v = 3.0
release_level_v = 3.2
hold_ms = 8.0
refractory_ms = 9.0
blank_ms = 3.0
"""
LENGTH = 12_000


def volts():
    """[2, LENGTH]: presses and tremors of several sizes, on the 1 mV grid of the converter."""
    rng = np.random.default_rng(4)
    pressed = np.repeat(rng.random((2, LENGTH // 1000)) < 0.8, 1000, axis=1)
    tremor = np.repeat(rng.choice([5, 20, 55, 130], (2, LENGTH // 100)), 100, axis=1)
    return (3400 - 700 * pressed + rng.integers(-tremor, tremor + 1)) / 1000


@pytest.fixture
def own(tmp_path):
    """own.csv as a PicoScope with a German Windows writes it; mine.toml."""
    rows = (f"{k / 8:.8f};{a:.8f};{1000 * b:.8f}".replace(".", ",") for k, (a, b) in enumerate(volts().T))
    text = "Zeit;Kanal A;Kanal B\n(ms);(V);(mV)\n\n" + "\n".join(rows) + "\n"
    (tmp_path / "own.csv").write_text(text)
    (tmp_path / "mine.toml").write_text(BUILD)
    return tmp_path


def by_loop(codes, settings):
    """state and raised_at [channels, windows] by the loop from the page."""
    states, raised = [], []
    for channel in codes.tolist():
        loop, was, first = SlipPathReference(settings), False, -1
        states.append([])
        raised.append([])
        for at, sample in enumerate(channel):
            found = loop.sample(sample, False, False)
            if found is None:
                continue
            slips = found[0] in (INCIPIENT, GROSS)
            first = at if slips and not was and first < 0 else first
            was = slips
            if found[4]:
                states[-1].append(NUMBERS[found[0]])
                raised[-1].append(first)
                first = -1
    return states, raised


@pytest.mark.parametrize("engine", ["float", "fixed", "rtl"])
def test_a_recording_in_volts_to_flags(own, engine):
    arguments = ("own.csv", "--config", "mine.toml", "--engine", engine, "--out", f"{engine}.npz")
    done = meissner("process", "slip", *arguments, cwd=own)
    assert (done.returncode, done.stderr) == (0, "")
    codes = np.rint(1000 * volts()).astype(int)  # 4.096 V over 4096 codes
    settings = config.load(own / "mine.toml").slip
    found = np.load(own / f"{engine}.npz")
    state, raised = by_loop(codes, settings)
    assert {*np.ravel(state)} == {0, 1, 2, 3, 4} and (np.array(raised) >= 0).sum() > 5
    assert found["state"].tolist() == state and found["raised_at"].tolist() == raised
    core = engines.load(engine).watch(codes[:1], settings)
    assert found["state"][0].tolist() == core.state[0, core.end].tolist()
    plain = engines.process_slip(codes, settings, "fixed")
    for name in plain:  # the floats of engine float miss whole numbers by their rounding
        assert found[name] == pytest.approx(plain[name], abs=1e-9 * (engine == "float")), name
    first, second = done.stdout.splitlines()
    assert first == (
        "own.csv: semicolon, decimal comma; 12000 rows of Kanal A, Kanal B in V, mV; Zeit left out, times in "
        "ms; "
        "8000 Hz from Zeit; volts to the codes 0 .. 4095 of a converter of 0 to 4.096 V"
    )
    raised = np.array(raised)
    flags = (raised >= 0).sum()
    at = raised[raised >= 0].min() / 8000
    assert f", {flags} flags raised by the rules of [slip] (first at {at:.4f} s), " in second


def test_an_array_takes_forces_or_calibrated_codes(own):
    """fingertip: a sample is the force of a taxel, 2 mN a code; nine columns are its taxels."""
    rng = np.random.default_rng(6)
    codes = rng.integers(0, 2, (4000, 1)).cumsum(0) % 300 + rng.integers(0, 40, (4000, 9))
    lines = calibration.Calibration(
        np.arange(9).reshape(3, 3), np.full((3, 3), 2048), 12, np.zeros((3, 3), bool), 0.002
    )
    with open(own / "cal.npz", "wb") as file:
        lines.save(file)
    forces = np.clip((codes - np.arange(9) + 1) // 2, 0, None)  # half, rounded half up
    for name, values, unit in (
        ("codes", codes, ""),
        ("forces", forces, ""),
        ("newtons", forces * 0.002, " (N)"),
    ):
        text = ",".join(f"t{k}{unit}" for k in range(9)) + "\n"
        text += "\n".join(",".join(f"{v:g}" for v in row) for row in values)
        (own / f"{name}.csv").write_text(text)
    settings = config.load("fingertip").slip
    expected = engines.process_slip(forces.T, settings, "fixed", states=True)
    assert len(np.unique(expected["state"])) > 2
    for name, more in (("codes", ("--calibration", "cal.npz")), ("forces", ()), ("newtons", ())):
        done = meissner(
            *("process", "slip", f"{name}.csv", "--config", "fingertip", "--out", f"{name}.npz", *more),
            cwd=own,
        )
        assert (done.returncode, done.stderr) == (0, ""), name
        found = np.load(own / f"{name}.npz")
        assert all(np.array_equal(found[key], expected[key]) for key in expected), name
        assert "4000 Hz by fingertip" in done.stdout


REFUSED = r"""
threshold: own.csv --volts-per-code 0.001
volts: own.csv --threshold 40
rate: codes.csv --threshold 40
window: own.csv --config mine.toml --window 64
threshold: own.csv --config mine.toml --threshold 4
slip: own.csv --config cop4
8000: codes.csv --config mine.toml --rate 10000
--column: own.csv --config slip1
converter: codes.csv --config mine.toml --unit codes --column 2
calibration: own.csv --config fingertip --rate 4000
--config: own.csv --threshold 4 --calibration cal.npz
Kanal C: own.csv --config mine.toml --column "Kanal C"
codes: music.wav --threshold 40
"""


@pytest.mark.parametrize("row", REFUSED.strip().splitlines())
def test_what_a_configuration_and_a_recording_refuse(own, row):
    import shlex

    word, text = row.split(": ", 1)
    (own / "codes.csv").write_text("a,b\n" + "1,5000\n" * 64)
    (own / "music.wav").write_bytes(b"RIFF" + bytes(3))
    from readers.test_readers import wav

    (own / "music.wav").write_bytes(wav(np.arange(200).reshape(100, 2), 44100))
    before = sorted(own.iterdir())
    done = meissner("process", "slip", *shlex.split(text), "--out", "out.npz", cwd=own)
    assert (done.returncode, done.stdout) == (2, "") and word in done.stderr, done
    assert len(done.stderr.splitlines()) == 1 and sorted(own.iterdir()) == before


def test_forces_of_an_array_from_columns(tmp_path):
    """process cop and calibrate of a table: taxels as columns, the load cell as one in newtons."""
    force = np.arange(8.0)
    codes = np.rint(50 + np.outer(force, [100, 200, 300, 400])).astype(int)
    rows = (f"{k},{','.join(map(str, row))},{f}" for k, (row, f) in enumerate(zip(codes, force)))
    (tmp_path / "press.csv").write_text("index,a,b,c,d,load (N)\n" + "\n".join(rows))
    done = meissner("calibrate", "press.csv", "--shape", "2x2", "--out", "cal.npz", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    found = np.load(tmp_path / "cal.npz")
    assert found["offset"].tolist() == [[50, 50], [50, 50]] and not found["dead"].any()
    arguments = ("press.csv", "--shape", "2x2", "--calibration", "cal.npz", "--out", "cop.npz")
    done = meissner("process", "cop", *arguments, "--column", "a,b,c,d", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert np.load(tmp_path / "cop.npz")["load_n"] == pytest.approx(4 * force, abs=0.01)
    volts = "a (V),b (V),c (V),d (V),load (N)\n" + "\n".join(
        ",".join(f"{code * 5 / 4096:.7g}" for code in row) + f",{f:g}" for row, f in zip(codes, force)
    )
    (tmp_path / "volts.csv").write_text(volts)
    two = (ROOT / "model/meissner/builds/configs/fingertip.toml").read_text()
    two = (
        two.replace("rows = 3", "rows = 2")
        .replace("columns = 3", "columns = 2")
        .replace("channels = 3", "channels = 2")
    )
    (tmp_path / "two.toml").write_text(two)
    done = meissner("calibrate", "volts.csv", "--config", "two.toml", "--out", "again.npz", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    again = np.load(tmp_path / "again.npz")
    assert all(np.array_equal(again[name], found[name]) for name in found.files)
    arguments = ("volts.csv", "--config", "two.toml", "--calibration", "again.npz", "--out", "cop2.npz")
    done = meissner("process", "cop", *arguments, "--column", "a,b,c,d", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    one, other = np.load(tmp_path / "cop.npz"), np.load(tmp_path / "cop2.npz")
    assert all(np.array_equal(one[name], other[name]) for name in one.files)
