"""The latency budget of scanned arrays: its terms add up and follow the parameters they depend on, the number
of converters it gives is sufficient and the smallest, the command prints the terms and refuses what cannot be
built. tb/sensor/test_array_pins.py shows that the clocks are those at the pins.
"""

import itertools
import json

import pytest

from harness.command import meissner
from meissner import cli
from meissner.budget import array as budget
from meissner.twins.frontend.adc_spi import AD7606, AD7606C, MAX11125, MCP3208, PARTS


@pytest.mark.parametrize("rows, columns", [(1, 1), (3, 3), (16, 16), (64, 64), (5, 100)])
@pytest.mark.parametrize("part", [AD7606, AD7606C, MCP3208, MAX11125], ids=lambda part: part.name)
def test_terms_add_up_and_follow_what_they_stand_for(rows, columns, part):
    given = {"converters": 2, "channels": 8, "settle_us": 1.0}
    found = budget.budget(rows, columns, 50e6, part, **given)
    assert sum(found["terms_clocks"].values()) == found["total_clocks"]
    places = rows * -(-columns // 16)
    assert found["frame_clocks"] == places * found["slot_clocks"]
    assert found["terms_clocks"]["scan"] == (places - 1) * found["slot_clocks"]
    later = budget.budget(rows, columns, 50e6, part, **given | {"settle_us": 1000.0})
    assert later["slot_clocks"] >= 50_000 and later["total_clocks"] >= found["total_clocks"]
    # A wait of up to the converters' own time costs nothing; the rest is a term of its own.
    assert found["terms_clocks"]["settle"] == 0
    waits = (places - 1) * (later["slot_clocks"] - found["slot_clocks"])
    assert later["terms_clocks"] == found["terms_clocks"] | {"settle": waits}
    bare = budget.budget(rows, columns, 50e6, part, **given, health=False, tare=False)
    assert found["total_clocks"] - bare["total_clocks"] == 2


@pytest.mark.parametrize(
    "mhz, settle_us, clocks",
    # 25.0025, 13.37, 57 and 230 clocks, up; in floating point 230.00000000000003.
    [(24, 1.0, 24), (25, 1.0001, 26), (13.37, 1.0, 14), (100, 0.57, 57), (100, 2.3, 230), (100, 0.0, 1)],
)
def test_settling_is_never_shorter(mhz, settle_us, clocks):
    """As the register of the same build (docs/config.md)."""
    found = budget.budget(4, 4, mhz * 1e6, AD7606, converters=1, channels=4, settle_us=settle_us)
    assert found["settle_clocks"] == clocks


def test_the_converters_it_asks_for_are_enough_and_fewer_are_not():
    fewest = {}
    for side, settle_us in itertools.product((8, 16, 32, 64, 100), (1.0, None)):
        found = budget.budget(side, side, 100e6, AD7606, settle_us=settle_us, settle_share=0.005)
        lanes = fewest[side, settle_us] = found["converters_needed"]
        for other in budget.LANES:
            given = {"converters": other, "settle_us": settle_us, "settle_share": 0.005}
            within = budget.budget(side, side, 100e6, AD7606, **given)["total_s"] < 1e-3
            assert within == (lanes is not None and other >= lanes), (side, other)
    # Digital side; with 84.7 us for each place: eight take 680 us, sixteen 1.4 ms.
    assert [fewest[side, 1.0] for side in (16, 64, 100)] == [1, 8, None]
    assert [fewest[side, None] for side in (8, 16, 64)] == [1, None, None]


def test_settling_by_hand():
    """ln(sqrt(2)/share)/(sqrt(2) pi f): half a code, 2^-17, at 15 kHz 182.015 us; 0.5 % at 23 kHz 55.240 us.
    From then on at most the next extremes are left, exp(-4 pi) and exp(-6 pi), or exp(-2 pi). A place lasts
    that and five clocks: 2 of hold, 2 of lines, 1."""
    for given, us, left in (
        ({}, 182.02, [3.487e-6, 6.512e-9]),
        ({"settle_share": 0.005, "volts": 10.0}, 55.25, [1.867e-3]),
        ({"settle_share": 0.005, "volts": 5.0}, 84.71, [1.867e-3]),
        ({"settle_us": 5.0, "volts": 5.0}, 5.0, [0.9116]),
    ):
        found = budget.budget(64, 64, 100e6, AD7606, 8, channels=8, **given)
        assert found["settle_clocks"] == pytest.approx(100 * us, abs=1.01)
        assert [row["left"] for row in found["old_row"]] == pytest.approx(left, rel=1e-3)
        assert found["settled"] == (us > 5) and found["within_1_ms"] == (us == 5)
        slow = 64 * (found["settle_clocks"] + 5)
        assert found["frame_clocks"] == max(slow, 66_304)


def test_a_line_for_each_part(capsys):
    cli.main(["budget", "--adc", "all", "--settle-share", "0.005", "--source-ohm", "2500"])
    _, *lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == [part.name.upper() for part in PARTS.values()]
    line = dict(zip((line.split()[0] for line in lines), lines))
    assert line["AD7606"].split()[1:4] == ["84.71", "8", "8"] and line["AD7606"].endswith("above 1 ms")
    assert "source_ohm = 2500 is too large" in line["MAX11125"]
    cli.main(["budget", "--adc", "all", "--json"])
    found = json.loads(capsys.readouterr().out)
    assert found["max11125"] == budget.budget(64, 64, 100e6, MAX11125)


@pytest.mark.parametrize(
    "lanes, needs, slot, transfer", [(1, 4, 618, 543), (2, 3, 505, 275), (4, 3, 505, 141), (8, 3, 505, 74)]
)
def test_an_ad7606c_on_any_number_of_lines(lanes, needs, slot, transfer):
    """At 100 MHz a bit is four clocks and a word 17 bits, so 8 words take 544. BUSY is low after 71, the
    words begin 3 later. 5 us, one clock and the 4 until the inputs may change are 505: only one line takes
    longer. The last sample comes after 3 clocks, the words but the last rest, and a clock for each sample of
    the other lines. Three converters take 3 · 64 slots: 970 us, or 1.19 ms on one line."""
    found = budget.budget(64, 64, 100e6, AD7606C, 4, settle_us=5.0, adc_lanes=lanes)
    assert (found["converters_needed"], found["slot_clocks"]) == (needs, slot)
    assert found["terms_clocks"]["transfer"] == transfer
    assert found == budget.budget(64, 64, 100e6, AD7606C, 4, settle_us=5.0) or lanes != 2


# An MCP3208 at 1 MHz and 24 MHz: a bit is 24 clocks, a conversion 19 bits and one of rest, 480 clocks. A
# place of c inputs takes 480·c + 1 clocks; the word of its input w arrives after 480·w - 24. 10 rows of 16
# columns are 10·ceil(16 / (converters·c)) places, and the last place's w is c, or what is left of a row: 4
# where four converters with eight inputs have only four columns each, 2, 1 and 3 with three, five and seven
# converters. After that come 5 clocks of buffer, 1 of health, 1 of tare, and 14, 15, 16 or 17 of force, sums
# and division with one, two, up to four, and more lanes (docs/cop.md).
@pytest.mark.parametrize(
    "converters, inputs, clocks",
    [
        (1, 8, 19 * 3841 + 3816 + 21),
        (1, 4, 39 * 1921 + 1896 + 21),
        (2, 8, 9 * 3841 + 3816 + 22),
        (2, 4, 19 * 1921 + 1896 + 22),
        (4, 1, 39 * 481 + 456 + 23),
        (4, 2, 19 * 961 + 936 + 23),
        (4, 4, 9 * 1921 + 1896 + 23),
        (4, 8, 9 * 3841 + 1896 + 23),
        (3, 4, 19 * 1921 + 936 + 23),
        (5, 3, 19 * 1441 + 456 + 24),
        (7, 8, 9 * 3841 + 1416 + 24),
    ],
)
def test_clocks_worked_out_by_hand(converters, inputs, clocks):
    found = budget.budget(10, 16, 24e6, MCP3208, converters=converters, channels=inputs)
    assert found["total_clocks"] == clocks


def test_the_inputs_used_are_searched_too():
    """Four converters with four inputs each: 9·1921 + 1896 + 23 = 19,208 clocks, 800.3 us. Fewer are too slow
    with any number of inputs: 10·16 conversions of 20 us take 3.2 ms with one, 1.6 ms with two and, for six
    columns each, 1.2 ms with three."""
    found = budget.budget(10, 16, 24e6, MCP3208)
    chosen = {key: found[key] for key in ("converters", "channels", "converters_needed", "total_clocks")}
    assert chosen == {"converters": 4, "channels": 4, "converters_needed": 4, "total_clocks": 19_208}
    assert found["within_1_ms"]
    two = budget.budget(10, 16, 24e6, MCP3208, converters=2)
    assert (two["channels"], two["converters_needed"], two["within_1_ms"]) == (8, 4, False)
    # Eight inputs, of which three have no column, would take 5 places of 3841 clocks instead of 2401.
    assert budget.budget(5, 5, 24e6, MCP3208, converters=1)["channels"] == 5
    done = meissner("budget", "--rows", "10", "--cols", "16", "--adc", "MCP3208", "--clock", "24e6").stdout
    first, second, *_ = done.splitlines()
    assert first == "from first convert to CoP 800.333 us, within 1 ms"
    assert second == "10×16 taxels, 4 MCP3208s with 4 inputs used, 24 MHz, settle 24 clocks"


def test_a_carrier_takes_its_samples():
    short, long = (
        budget.budget(8, 8, 100e6, MAX11125, 1, carrier={"sample_period": 500, "periods": periods, "skip": 4})
        for periods in (4, 8)
    )
    assert long["terms_clocks"]["burst"] - short["terms_clocks"]["burst"] == 4 * 4 * 500


# 3 kohm with 15 pF behind 300 ohm for 120 ns keep k = exp(-120/49.5) = 0.088546 at each sample; the pin is
# off by p = exp(-1000/150) = 0.0012726 after 1 us and by nothing 5 us later: k^(skip+1) + k^skip p. Half a
# code is 1.2207e-4.
@pytest.mark.parametrize("skip, left", [(0, 8.9819e-2), (2, 7.0420e-4), (3, 6.2355e-5), (4, 5.5213e-6)])
def test_what_remains_of_a_row_behind_skipped_samples(skip, left):
    carrier = {"sample_period": 500, "periods": 4, "skip": skip}
    found = budget.budget(8, 8, 100e6, MAX11125, 1, carrier=carrier, source_ohm=3000.0)
    assert [row["left"] for row in found["old_row"]] == pytest.approx([left], rel=1e-3)
    assert found["settled"] == (skip > 2)
    assert f"{skip} skipped samples" in found["settling"] or skip == 0


def test_the_command_prints_what_the_function_finds():
    done = meissner("budget", "--rows", "16", "--cols", "16", "--json")
    assert json.loads(done.stdout) == budget.budget(16, 16, 100e6, AD7606)
    text = meissner("budget", "--rows", "64", "--cols", "64", "--adc", "mcp3208").stdout
    assert "above 1 ms" in text and "no number of these converters" in text
    few = meissner("budget", "--rows", "64", "--cols", "64", "--converters", "2", "--settle-us", "1").stdout
    assert "1 ms needs 8 of these" in few


@pytest.mark.parametrize(
    "given, change",
    [
        ("--no-health", {"health": False}),
        ("--no-tare", {"tare": False}),
        ("--sclk-khz 8000", {"sclk_khz": 8000}),
        ("--read during", {"read_during": True}),
        ("--settle-us 2.5", {"settle_us": 2.5}),
        ("--settle-share 0.02", {"settle_share": 0.02}),
        ("--volts 10", {"volts": 10.0}),
        ("--adc max11125 --source-ohm 300", {"part": MAX11125, "source_ohm": 300.0}),
        ("--channels 3", {"channels": 3}),
        ("--converters 4", {"converters": 4}),
        ("--bits-per-clock 1", {"bits_per_clock": 1}),
        ("--clock 50e6", {"clock_hz": 50e6}),
        ("--adc max11125", {"part": MAX11125}),
        (
            "--demod --sample-period 600 --periods 5 --skip 3 --adc max11125",
            {"carrier": {"sample_period": 600, "periods": 5, "skip": 3}, "part": MAX11125},
        ),
    ],
)
def test_every_option_of_the_command_counts(capsys, given, change):
    usual = {"rows": 6, "columns": 10, "clock_hz": 100e6, "part": AD7606}
    cli.main(["budget", "--rows", "6", "--cols", "10", "--json", *given.split()])
    assert json.loads(capsys.readouterr().out) == budget.budget(**usual | change) != budget.budget(**usual)


def test_a_millisecond_is_within_one(monkeypatch):
    total_s = budget.budget(8, 8, 100e6, AD7606, 1)["total_s"]
    for most_s, within in ((total_s, True), (total_s * (1 - 1e-12), False)):
        monkeypatch.setattr(budget, "BUDGET_S", most_s)
        assert budget.budget(8, 8, 100e6, AD7606, 1)["within_1_ms"] is within


@pytest.mark.parametrize(
    "converters, needs, says",
    [
        (4, 4, "within 1 ms"),
        (8, 4, "within 1 ms; 1 ms needs 4 of these converters"),
        (2, 4, "above 1 ms; 1 ms needs 4 of these converters"),
        (8, None, "above 1 ms; no number of these converters reaches 1 ms: scan a smaller array or "
         "take a faster part"),
    ],
)  # fmt: skip
def test_the_verdict_comes_first(converters, needs, says):
    found = budget.budget(16, 24, 40e6, AD7606, converters=converters)
    found |= {"total_clocks": 39_999, "within_1_ms": says.startswith("within"), "converters_needed": needs}
    lines = budget.tell(found)
    assert lines[0] == f"from first convert to CoP 999.975 us, {says}"
    inputs = found["channels"]
    assert lines[1].startswith(f"16×24 taxels, {converters} AD7606s with {inputs} inputs used, 40 MHz")
