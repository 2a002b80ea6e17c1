"""``meissner config new``, and ``rate_hz = "max"``: the shortest period by the formulas of docs/adc.md and
docs/scan.md, and what is one clock shorter is refused."""

import builtins
import re
import sys
import tomllib
from itertools import chain, combinations

import numpy as np
import pytest

from meissner import cli
from meissner.builds import boards, config
from meissner.builds.flash import EVERY
from meissner.builds.keys import PARTS
from meissner.forest import file


def tables(name, rate_hz, **changes):
    found = config.tables(name)
    found["adc"] = found["adc"] | {"rate_hz": rate_hz}
    for key, value in changes.items():
        found[key] = found.get(key, {}) | value
    return found


@pytest.mark.parametrize(
    "name, changes, clocks, why",
    [
        ("grip", {}, 2 * 12 * 20 * 2 + 1, "conversion"),  # 24 MHz, SCLK 1 MHz: half 12; two channels
        ("slip1", {}, 20 * 16 + 1, "conversion"),  # 12 clocks of a bit are 16 of msn_adc_single
        ("array64", {}, 64 * 1036, "scan"),  # the slot of two lanes at 100 MHz, read after
        # 27 bytes of 10 bits at 3 Mbaud are 2250 clocks of 25 MHz; the converter would take 365 for eight.
        ("cop4", {}, 2251, None),
        # Frames of 27 bytes on a line of 20,000 bytes a second, beside an image a second.
        ("fingertip", {"link": {"baud": 200_000}}, None, "images"),
        # A conversion of one channel takes 41 clocks of 2 MHz; the computation of a window 70.
        (
            "grip",
            {"clock": {"mhz": 2.0}, "sensor": {"channels": 1}, "link": {"baud": 100_000}},
            70,
            "shear_speed",
        ),
        # 25 × 4 pins of two channels: (1 + 24)(2 + 3) overlaps, 23 clocks a pin, 8 more; a conversion 961.
        ("grip", {"display": {"rows": 25, "columns": 4}}, 125 + 100 * 23 + 8, "display"),
    ],
)
def test_the_greatest_rate_by_hand(name, changes, clocks, why):
    found = tables(name, "max", **changes)
    if why == "shear_speed":
        found["shear_speed"] = {}
    made = config.read(name, found)
    if clocks is not None:
        assert made.period_clocks == clocks
    assert made.rate_hz == 1000 * made.clk_khz / made.period_clocks
    if why:
        found["adc"] = found["adc"] | {"rate_hz": 1000 * made.clk_khz / (made.period_clocks - 1)}
        most = "" if why == "images" else rf"at most {int(made.rate_hz)}[.\d]* Hz"
        with pytest.raises(ValueError, match=f"{why}.*{most}"):
            config.read(name, found)


def test_a_rate_is_a_number_or_max(tmp_path, monkeypatch, capsys):
    with pytest.raises(ValueError, match="rate_hz = 'fast' must be a number"):
        config.read("grip", tables("grip", "fast"))
    (tmp_path / "m.toml").write_text(
        config._path("slip1").read_text().replace("rate_hz = 10_000.0", 'rate_hz = "max"')
    )
    cli.main(["config", "show", str(tmp_path / "m.toml")])
    assert "\n37383.1775701 samples of each channel a second\n" in capsys.readouterr().out  # 12 MHz / 321


def test_the_rate_that_a_refusal_names_is_taken():
    """Of a long frame, of 7 a second."""
    found = tables("array64", "max", sensor={"rows": 256, "columns": 256})
    del found["slip"]
    found["adc"] |= {"part": "AD7606C-16", "converters": 1, "channels": 7}
    least = config.read("m", found).least_period
    with pytest.raises(ValueError, match=r"at most [\d.]+ Hz") as problem:
        config.read("m", found | {"adc": found["adc"] | {"rate_hz": 1e8 / (least - 1)}})
    most = float(str(problem.value).split()[-2])
    assert 0 <= config.read("m", found | {"adc": found["adc"] | {"rate_hz": most}}).period_clocks - least < 20


def new(*words):
    cli.main(["config", "new", *words, "--out", "mine.toml", "--overwrite"])
    return config.load("mine.toml")


@pytest.mark.parametrize("board", boards.BOARDS)
def test_what_is_written_can_be_built_on_the_board(board, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    few = board == "icebreaker"
    made = new("--sensor", "channels", "--channels", "3", "--board", board)
    assert (made.channels, made.rate_hz, made.adc.volts) == (3, 10_000, 3.3)
    assert made.link.registers is not few
    # floor(0.0132 · 4096/3.3 · sqrt(2)) = floor(23.17); 0.9 of the range, of sums of two samples.
    assert made.settings["slip.threshold"] == 23 and made.settings["slip.contact_level"] == round(
        2 * 0.9 * 4096
    )
    made = new("--sensor", "array", "--rows", "4", "--cols", "6", "--board", board)
    assert made.shape == (4, 6) and made.period_clocks == made.least_period
    boards.BOARDS[board].plan("mine.toml")
    if not few:
        made = new("--sensor", "electrodes", "--board", board)
        assert made.cop4.difference_gain == 16  # 0.65 of Cx = (2·7·10 + 8)/6 = 24.7
    text = (tmp_path / "mine.toml").read_text()
    assert text.count("# ") > 8 and tomllib.loads(text)["about"]


def test_the_smallest_build_for_one_sensor_on_an_icebreaker(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = new("--board", "icebreaker")
    assert made.serial and made.link.slip_only and not made.link.statistics
    assert new("--board", "none") == new()  # as the question's answer


OFFERED = {
    "channels": ("grip", "forest", "shear_speed"),
    "array": ("grip", "forest", "display"),
    "electrodes": ("forest", "display"),
    "none": (),
}


def refused(sensor, features, adc, board):
    """Why that cannot be built, as part of a sentence; None if it can."""
    if board == "icebreaker" and sensor == "electrodes":
        return "10 multipliers, and a UP5K has 8"
    if sensor == "electrodes" and not adc.startswith("AD7606"):
        return "symmetric"
    if board == "icebreaker" and set(features) - {"display"}:
        return "it needs registers"
    if sensor == "array" and "grip" in features and "forest" not in features:
        return "must go with .forest."
    if (sensor, board, features) == ("array", "tangnano20k", OFFERED["array"]) and adc.startswith("AD7606"):
        return "needs 1[78] header pins .* has only 16"
    return None


@pytest.mark.parametrize("board", [None, *EVERY])
@pytest.mark.parametrize("sensor", OFFERED)
def test_every_combination_passes_the_check_or_says_why_not(sensor, board, tmp_path, monkeypatch, capsys):
    """Every set of features with one converter, and all features with every converter. A named board differs
    in its clock and its pins."""
    monkeypatch.chdir(tmp_path)
    every = OFFERED[sensor]
    counts = range(len(every) + 1) if board in (None, "icebreaker") else {0, len(every)}
    subsets = chain.from_iterable(combinations(every, count) for count in counts)
    usual = "AD7606" if sensor == "electrodes" else "MCP3208"
    pairs = [(features, usual) for features in subsets]
    pairs += [(every, adc) for adc in PARTS if adc != usual and sensor != "none"]
    for features, adc in pairs:
        words = ["--sensor", sensor] + (["--board", board] if board else [])
        if sensor != "none":
            words += ["--adc", adc, "--features", ",".join(features)]
        if sensor == "channels":
            words += ["--channels", "2"]
        (tmp_path / "mine.toml").unlink(missing_ok=True)
        if why := refused(sensor, features, adc, board):
            with pytest.raises(SystemExit, match="2"):
                new(*words)
            assert re.search(why, capsys.readouterr().err) and not list(tmp_path.iterdir()), words
            continue
        made = new(*words)
        assert set(made.features) == set(features or ([] if sensor != "none" else ["forest"])), words
    if (tmp_path / "mine.toml").exists():
        cli.main(["config", "check", "mine.toml"])
        assert re.search(r"\nmine: .* settings\n", capsys.readouterr().out)


def test_a_forest_and_a_display_of_ones_own(tmp_path, monkeypatch, capsys):
    """The file as seen from the configuration, the window from its features, the second class for the reflex;
    so many pins take another number of chains."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "robot").mkdir()
    none = (np.zeros(0, np.int64),) * 4
    for classes in (["held", "slips"], ["a", "b", "c"]):
        leaves = np.array(
            [[65535] + [0] * (len(classes) - 1), [0, 65535] + [0] * (len(classes) - 2)], np.uint16
        )
        features = [file.Feature(f"x{k}") for k in range(24)]
        file.write(
            tmp_path / "F.json", file.Model("by hand", classes, features, leaves, [file.Tree(*none, leaf=1)])
        )
        words = (
            "--sensor array --rows 2 --columns 3 --forest F.json --features grip --pins 20x50 --board ulx3s"
        )
        cli.main(["config", "new", *words.split(), "--out", "robot/mine.toml", "--overwrite"])
        tables = tomllib.loads((tmp_path / "robot/mine.toml").read_text())
        assert (tables["forest"]["file"], tables["forest"]["window"]) == ("../F.json", 4)
        made = config.load("robot/mine.toml")
        assert made.settings["forest.slip"] == (2 if len(classes) == 2 else 0)
        # At 50 MHz a slot of 4 bits has 125,000 / 32 = 3906 clocks; chains of b bits take 1048 + 9 b, so 256
        # of them, in four chains, 3352, and 512 in two chains 5656.
        display = made.features["display"].size
        assert (display.pins, display.chains, display.amplitude_bits) == (1000, 4, 4)
    monkeypatch.chdir(tmp_path / "robot")
    with pytest.raises(SystemExit, match="2"):
        cli.main(["config", "new", "--channels", "5", "--forest", "../F.json", "--out", "no.toml"])
    assert "has 24 features but a row has 20" in capsys.readouterr().err


def test_it_asks_on_a_terminal_for_what_no_option_says(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for stream in (sys.stdin, sys.stdout):
        monkeypatch.setattr(stream, "isatty", lambda: True)
    answers = {
        "sensor": "array",
        "rows": "5",
        "columns": "",
        "converter:": "ad7606",
        "converters": "2",
        "features": "display, forest",
        "the forest": "none",
        "pins": "4x7",
        "board": "ulx3s",
    }
    asked = []

    def answer(question):
        asked.append(question)
        return next((said for word, said in answers.items() if question.startswith(word)), "")

    monkeypatch.setattr(builtins, "input", answer)
    cli.main(["config", "new", "--rate", "500", "--out", "mine.toml"])
    made = config.load("mine.toml")
    assert (made.shape, made.part.name, made.adc.converters, made.rate_hz) == ((5, 3), "ad7606", 2, 500)
    assert made.features["display"].grid == (4, 7) and made.features["forest"].size.classes == 2
    assert len(asked) == 10 and "[3]" in next(text for text in asked if text.startswith("columns"))
    assert "make synth BOARD=ulx3s CONFIG=mine.toml" in capsys.readouterr().out


@pytest.mark.parametrize(
    "words, says",
    [
        ("--sensor wires", "sensor = 'wires' must be one of: channels, array, electrodes"),
        ("--adc ADS1115", "adc = 'ADS1115' must be one of: MCP3208"),
        ("--board nano", "board = 'nano' must be one of: icebreaker"),
        ("--channels 9", r"channels = 9 must lie in 1 .. 8"),
        ("--channels 0", r"channels = 0 must be above 0"),
        ("--rows 4", "rows = 4 does not go with sensor = 'channels'"),
        ("--sensor array --channels 4", "channels = 4 does not go with sensor = 'array'"),
        ("--rate 60000", r"rate_hz = 60000 is too fast: a conversion takes"),
        ("--rate quick", "rate = 'quick' must be a number, or max"),
        ("--volts 12", r"volts = 12 must lie in 0.25 .. 5.5 for the MCP3208"),
        ("--sensor electrodes --adc MCP3208", "part = 'MCP3208' must be symmetric"),
        ("--sensor array --cols 64 --converters 8 --adc AD7606 --board tangnano20k", "lines without a pin: "),
        ("--features grip,taste", "features = 'taste' must be one of: grip, forest, shear_speed"),
        ("--sensor electrodes --features grip", "features = 'grip' must be one of: forest, display"),
        ("--sensor array --pins 5", "pins = '5' must be rows x columns"),
        ("--sensor array --pins 90x90", r"pins = 8100 must"),
        ("--channels 2 --pins 5x20", "features = 'display' must be one of: grip, forest, shear_speed"),
        ("--rows 3", "rows = 3 does not go with sensor = 'channels'"),
        ("--sensor none --rate max", "rate = max does not go with sensor = 'none'"),
        ("--forest F.json", "F.json"),
        ("--sensor electrodes --pins 40x40 --rate 20000", r"too fast for \[display\]"),
        ("--sensor array --rows 128 --cols 128", r"window = 32 at rate_hz = .* must not last more than 5 s"),
    ],
)
def test_what_cannot_be_is_refused_and_nothing_is_written(words, says, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit, match="2"):
        cli.main(["config", "new", *words.split(), "--out", "mine.toml"])
    said = capsys.readouterr().err
    assert re.search(says, said) and said.count("\n") == 1 and not list(tmp_path.iterdir())
