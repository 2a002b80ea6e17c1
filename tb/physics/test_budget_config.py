"""``meissner budget --config`` of any sensor's build, by clocks that are worked out by hand, and what it and
``config check`` say about what remains of the old row."""

import json
import re
import tomllib

import pytest

from harness.command import meissner
from meissner.budget import array, channels, electrodes
from meissner.builds import config


def build(name, **changes):
    """A named configuration with ``changes`` {table: {key: value}}."""
    table = tomllib.loads((config.FOLDER / f"{name}.toml").read_text("utf-8"))
    for key, values in changes.items():
        table[key] |= values
    if not table.get("array", {}).get("tare", True):
        table.pop("tare", None)
    return config.read("mine", table)


# slip1 at 12 MHz and 1 MHz SCLK: 19 bits of 16 clocks (a power of two, and 12 are too few) and one more, then
# two passes over eight pairs of bits, one clock to take the sample, one to decide. Two fingers of grip at
# 24 MHz: one word of 20 bits of 24 clocks, and the 19 bits of the second.
@pytest.mark.parametrize(
    "of, clocks",
    [
        (build("slip1"), {"convert": 0, "transfer": 19 * 16 + 1, "serial": 2 * 8 + 2}),
        (build("slip1", adc={"sclk_khz": 2000}), {"convert": 0, "transfer": 19 * 8 + 1, "serial": 18}),
        (
            build("grip"),
            {"convert": 0, "transfer": 20 * 24 + 19 * 24, "frame_filter": 1, "haar": 1, "peak_to_peak": 2}
            | {"slip": 2},
        ),
        (
            build("grip", slip={"level": 3, "hop": 8}),
            {"convert": 0, "transfer": 936, "frame_filter": 1, "haar": 3, "peak_to_peak": 3, "slip": 2},
        ),
    ],
)
def test_channels_by_hand(of, clocks):
    found = channels.of_config(of)
    assert found["terms_clocks"] == clocks and found["total_clocks"] == sum(clocks.values())
    assert found["total_s"] == pytest.approx(sum(clocks.values()) / (1000 * of.clk_khz))
    assert found["group_s"] == pytest.approx((2**of.slip.level - 1) / 10_000)
    assert channels.tell(found)[0].startswith(
        f"from convert start to the slip decision: {sum(clocks.values())}"
    )


@pytest.mark.parametrize("touch, clocks", [("none", 17), ("point", 37)])
def test_electrodes_by_hand(touch, clocks):
    """An AD7606 at 25 MHz: 4.2 us of conversion are 105 clocks. The fourth word of one lane comes 96 clocks
    after the first, which docs/adc.md has 138 clocks after convert start, for a conversion of 4.15 us (104).
    docs/cop4.md has the clocks after it. A code is 10 V/65536/0.3, and the noise 117 uV/0.3; a code of an
    amplified difference is a sixth of that."""
    changed = {"correction": touch, "difference_gain": 6.0}
    found = electrodes.of_config(build("cop4", load=changed))
    words = found["terms_clocks"].pop("transfer")
    assert found["terms_clocks"] == {"convert": 105, "cop4": clocks, "cop_slip": 5}
    assert words == 138 - 104 + 1 + 3 * 32
    assert found["total_clocks"] == words + 110 + clocks
    of = found["resolution"]
    assert of["code_v"] == pytest.approx(10 / 65536 / 0.3) and of["noise_v"] == pytest.approx(117e-6 / 0.3)
    # The noise, 0.77 steps, adds to the 1/sqrt(12) steps rms of the quantisation; it has no greatest value.
    quiet = electrodes.cop4.budget(build("cop4").cop4.mesh, 16, 6.0, range_v=5 / 0.3, pairs=True)
    assert of["gain"] == 6.0
    for one in of["loads"]:
        assert one["x"]["step"] == pytest.approx(of["Cx"] * 10 / 65536 / 0.3 / 6 / one["n_v"] / 2)
    for one, other in zip(of["loads"], quiet["loads"]):
        for axis in ("x", "y", "load"):
            ratio = (1 + 12 * (117e-6 / (10 / 65536)) ** 2) ** 0.5
            assert one[axis]["rms"] == pytest.approx(ratio * other[axis]["rms"], rel=1e-9)
            assert one[axis]["greatest"] == other[axis]["greatest"]


@pytest.mark.parametrize("health", [False, True])
@pytest.mark.parametrize("gains, more", [("taxel", 0), ("row_column", 12)])
def test_an_array_is_that_of_the_same_numbers(gains, more, health):
    """fingertip: 3 rows of one place with three inputs; a word of 20 bits of 24 clocks, 480 clocks, and a
    clock in which all rows are low; 2 us to settle cost nothing. Two places and nearly three words, then 5
    clocks of buffer, 1 of zeros, 1 of health and 21 of force, sums and division, 15 bits of a bit a clock."""
    of = build("fingertip", array={"gains": gains, "health": health})
    found = array.of_config(of)
    assert found["total_clocks"] == 2 * 1441 + 3 * 480 - 24 + 5 + 1 + health + 21 + more
    bare = array.of_config(build("fingertip", array={"health": health, "tare": False}))
    assert bare["total_clocks"] == found["total_clocks"] - more - 1 and bare["terms_clocks"]["tare"] == 0
    assert (found["converters"], found["channels"], found["converters_needed"]) == (1, 3, 1)
    assert found["frames_per_second"] == pytest.approx(24e6 / 3 / 1441)


@pytest.mark.parametrize("change, least", [({}, 1), ({"sclk_khz": 100}, None), ({"settle_us": 300.0}, None)])
def test_the_converters_needed_are_those_of_its_own_clock_and_settling(change, least):
    """Four rows of four inputs: 16 words of 20 bits at 100 kHz are 3.2 ms, four settlings 1.2 ms."""
    adc = {"rate_hz": 120.0, "channels": 4} | change
    found = array.of_config(build("fingertip", adc=adc, sensor={"rows": 4, "columns": 4}))
    assert found["converters_needed"] == least


def test_every_named_configuration_and_a_file_of_ones_own_have_a_budget(tmp_path):
    for name in config.names():
        assert meissner("budget", "--config", name).stdout.splitlines()[0].startswith("from ")
    text = (config.FOLDER / "fingertip.toml").read_text("utf-8").replace("rows = 3", "rows = 5")
    text = text.replace("rate_hz = 4000.0", "rate_hz = 3000.0")
    (tmp_path / "mine.toml").write_text(text, "utf-8")
    done = meissner("budget", "--config", "mine.toml", "--json", cwd=tmp_path)
    found = json.loads(done.stdout)
    assert (found["config"], found["rows"], found["converters"]) == ("mine", 5, 1)


# exp(-v)(cos v + sin v) with v = sqrt(2) pi f t: 5 us at 15 and 23 kHz are v = 0.33322 and 0.51094.
@pytest.mark.parametrize(
    "part, volts, settle, says, passes",
    [
        ("AD7606", 5.0, {"us": 5.0}, "91.2 % (±5 V, 15 kHz) of the old row remain", False),
        ("AD7606", 5.0, {"us": 5.0, "share": 0.911}, "91.2 % (±5 V, 15 kHz)", False),
        ("AD7606", 5.0, {"us": 5.0, "share": 0.912}, "5 us after a switch 91.2 % (±5 V, 15 kHz)", True),
        ("AD7606", 10.0, {"us": 5.0, "share": 1.0}, "81.7 % (±10 V, 23 kHz)", True),
        ("AD7606", 10.0, {"us": 40.0, "share": 0.023}, "2.34 % (±10 V, 23 kHz)", False),  # an overshoot
        ("AD7606", 10.0, {"us": 40.0, "share": 0.024}, "2.34 % (±10 V, 23 kHz)", True),
        ("AD7606", 5.0, {}, "182 us are enough for half a code (0.000763 %)", True),
        ("AD7606", 5.0, {"share": 0.01}, "74.3 us are enough for 1 %", True),
        ("AD7606", 5.0, {"us": 166.0}, "0.00146 %", False),
        ("AD7606C-16", 5.0, {"us": 1.0, "share": 0.53}, "52.2 % (±5 V, 220 kHz)", True),
        ("AD7606C-16", 5.0, {"us": 5.0}, "12.41 us are enough for half a code (0.000763 %)", False),
        ("MAX11131", 5.0, {}, "0.04738 us are enough for half a code (0.0122 %)", True),
        ("MAX11125", 5.0, {"us": 1.0}, "0.04505 us are enough for half a code (0.0122 %)", True),
        ("MAX11125", 5.0, {"us": 0.04}, "0.0335 % (a source of 100 ohms)", False),
        ("MAX11125", 5.0, {"us": 1.0, "ohm": 2e3}, "sampling capacitor keeps 3.09 %", False),
        ("MCP3208", 5.0, {}, "1 us after a switch below 1e-06 % (a source of 100 ohms)", True),
    ],
)
def test_a_settle_time_that_is_too_short_is_refused_unless_it_is_meant(
    tmp_path, part, volts, settle, says, passes
):
    text = (config.FOLDER / "array64.toml").read_text("utf-8")
    keys = {"us": "settle_us", "share": "settle_share", "ohm": "source_ohm"}
    wait = "".join(f"{keys[key]} = {value}\n" for key, value in settle.items())
    for old, new in (
        (r'part = "AD7606"', f'part = "{part}"'),
        (r"volts = 5.0", f"volts = {volts}"),
        (r"settle_us = .*\nsettle_share = .*\n", wait),
        (r"rate_hz = 1400.0", "rate_hz = 20.0"),
        (r"hold_ms = 20.0", "hold_ms = 60.0"),
        (r"refractory_ms = 10.0", "refractory_ms = 70.0"),
        (r"blank_ms = 50.0", "blank_ms = 80.0"),
        (r"lanes = 2", f"lanes = {2 if part.startswith('AD') else 1}"),
    ):
        text, found = re.subn(old, new, text)
        assert found == 1, old
    (tmp_path / "mine.toml").write_text(text, "utf-8")
    for command in (("config", "check", "mine.toml"), ("budget", "--config", "mine.toml")):
        done = meissner(*command, cwd=tmp_path)
        assert done.returncode == (0 if passes else 2), done
        assert says in (done.stdout if passes else done.stderr)
        if not passes:
            assert done.stdout == "" and done.stderr.startswith("meissner: mine.toml: [adc]: ")
            assert len(done.stderr.splitlines()) == 1


def test_a_host_cannot_set_less():
    """AD7606 of ±10 V, 1 %: 48.458 us; 4 codes more or less by hand."""
    units = build(
        "array64", adc={"volts": 10.0, "settle_us": 60.0, "settle_share": 0.01, "rate_hz": 250.0}
    ).units
    assert units.code("scan.settle", "seconds", 48.46e-6) == 4846
    with pytest.raises(ValueError, match=r"scan\.settle: settle_us is too short"):
        units.code("scan.settle", "seconds", 43e-6)


def test_a_budget_without_a_configuration_knows_no_range():
    told = meissner("budget", "--settle-us", "5").stdout
    assert "warning: 5 us after a switch 91.2 % (±5 V, 15 kHz) or 81.7 % (±10 V, 23 kHz) of" in told
    assert told.splitlines()[0].endswith("within 1 ms; of the digital side only")
    assert "warning" not in meissner("budget", "--adc", "MAX11125").stdout
    told = meissner(
        "choose", "array", "--settle-share", "0.005", "--adc", "AD7606", "--rows", "8", "--cols", "8"
    )
    assert "# 84.71 us after a switch" in told.stdout and "84.7 us are enough for 0.5 %" in told.stdout


def test_the_terms_of_a_display():
    """4 x 4 taxels on 5 x 20 pins at 24 MHz: 8 · 23 overlaps, 23 clocks a pin and 8; a period of 230 Hz; a
    pass of 100 pins; 128 bits at 6 MHz with a pause of a bit after 8, and 48 clocks."""
    from meissner.budget import display

    found = display.of_config(config.load("display"))
    terms = {"render": 8 * 23 + 100 * 23 + 8, "wait": 104_348, "limits": 100, "shift": 16 * 9 * 4 + 48}
    assert found["terms_clocks"] == terms and found["within_2_ms"] and found["render_within_a_frame"]
    assert set(terms) <= set(display.NAMES)
