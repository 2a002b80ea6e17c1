"""From needs to a configuration: the shipped ones from their needs, the next point in each direction,
refusals."""

import itertools
import json
import tomllib

import pytest

from meissner import cli
from meissner.budget import array
from meissner.builds import config
from meissner.tables import toml
from meissner.tradeoff import area, choose, table
from meissner.tradeoff import command as tradeoff_command
from meissner.tradeoff.candidates import board_of, frames_on_line, rounded_rate, tables
from meissner.tradeoff.command import RECORD
from meissner.tradeoff.needs import NEEDS, Needs

MEASURED = json.loads(RECORD.read_text("utf-8"))["figures"]
RATES = {"fingertip": (5200.0, 4000.0)}  # chosen and shipped rates, where they differ; see docs/tradeoff.md


@pytest.mark.parametrize("name", NEEDS)
def test_the_shipped_configurations_from_their_needs(name, tmp_path):
    """Every parameter of the RTL and every register equals the board's; so does the rate, except for those in
    RATES."""
    needs = NEEDS[name]
    row, _, _ = choose.chosen(needs, MEASURED)
    made, board = tables(needs, row), board_of(needs.board)
    ships = board.config(name)
    assert (made["adc"]["rate_hz"], ships.rate_hz) == RATES.get(name, (ships.rate_hz, ships.rate_hz))
    made["adc"]["rate_hz"] = ships.rate_hz
    path = tmp_path / "mine.toml"
    path.write_text(toml(made), "utf-8")
    found = board.config(str(path))
    assert found.parameters == ships.parameters
    assert found.settings == ships.settings


def row_of(bits, rate_hz, window, kind, wrong, delay_ms, kbit_s, state_bits):
    point = {"rate_hz": rate_hz, "bits": bits, "noise_mv": 0.198, "level": 1, "window": window, "kind": kind}
    cost = {"kbit_s": kbit_s, "state_bits": state_bits, "clocks": 6}
    error = {"wrong": wrong, "delay_ms": delay_ms}
    return {"point": point | {"runs": 9}, "cost": cost, "error": error, "front": True, "shipped": False}


HAND = {
    "slip": {
        "points": [
            row_of(12, 5000, 64, "tumbling", 3.0, 24.0, 60.0, 28),
            row_of(12, 10000, 64, "tumbling", 0.0, 9.0, 120.0, 28),
            row_of(12, 10000, 64, "sliding", 0.0, 6.0, 120.0, 868),
            row_of(12, 20000, 64, "tumbling", 0.0, 4.0, 240.0, 28),
            row_of(10, 10000, 64, "tumbling", 1.0, 8.0, 100.0, 24),
        ]
    }
}


@pytest.mark.parametrize(
    ("needs", "expected"),
    [
        ({}, (5000, 12, "tumbling")),  # the cheapest
        ({"error": 3.0}, (5000, 12, "tumbling")),
        ({"error": 2.9}, (10000, 10, "tumbling")),
        ({"error": 0.9}, (10000, 12, "tumbling")),
        ({"error": 0.0, "latency_ms": 9.0}, (10000, 12, "tumbling")),
        ({"error": 0.0, "latency_ms": 8.9}, (10000, 12, "sliding")),
        ({"error": 0.0, "latency_ms": 5.0}, (20000, 12, "tumbling")),
        ({"adc": "MAX11124"}, (10000, 10, "tumbling")),
    ],
)
def test_the_cheapest_that_meets_the_needs(needs, expected):
    row, made, _ = choose.chosen(Needs("channels", **needs), HAND)
    point = row["point"]
    assert (point["rate_hz"], point["bits"], point["kind"]) == expected
    assert (made.rate_hz, made.slip.hop) == (expected[0], 2 if expected[2] == "sliding" else 64)
    assert made.serial == (expected[2] == "tumbling")


# Of a request for each converter: its bits, and the most that a run may fail and wait.
OF_PART = {
    "MAX11123": (8,),
    "MAX11124": (10,),
    "MCP3208": (12,),
    "MAX11125": (12,),
    "MAX11131": (12,),
    "AD7606": (15,),
    "AD7606C-16": (15,),
}
WRONG = (None, 0.0, 0.5, 1.0, 3.0, 20.0, 99.0)
DELAYS = (None, 0.3, 3.6, 5.0, 5.3, 5.54821888, 10.0, 24.0, 60.0)


@pytest.mark.parametrize("adc", [None, *OF_PART])
def test_what_is_chosen_is_the_cheapest_of_every_measured_point(adc):
    """A loop over all of them, for 63 requests of each window: the least data, then the least state, then the
    fewest wrong runs, then the least delay."""
    points, sizes = MEASURED["slip"]["points"], table.named("slip").values
    assert len(points) == len(table.named("slip").points()) > 1000
    bits = OF_PART.get(adc, (8, 10, 12, 15))
    for window, wrong, delay in itertools.product((None, *sizes["window"]), WRONG, DELAYS):
        best = None
        for row in points:
            point, error = row["point"], row["error"]
            fits = point["noise_mv"] == 0.198 and point["bits"] in bits and window in (None, point["window"])
            fits = fits and (wrong is None or error["wrong"] <= wrong)
            if delay is not None:
                fits = fits and error["delay_ms"] is not None and error["delay_ms"] <= delay
            late = float("inf") if error["delay_ms"] is None else error["delay_ms"]
            price = (row["cost"]["kbit_s"], row["cost"]["state_bits"], error["wrong"], late)
            if fits and (best is None or price < best[0]):
                best = price, point
        needs = Needs("channels", error=wrong, latency_ms=delay, adc=adc, window=window)
        if best is None:
            with pytest.raises(ValueError, match="no measured point meets"):
                choose.chosen(needs, MEASURED)
            continue
        row, made, _ = choose.chosen(needs, MEASURED)
        found = row["cost"]["kbit_s"], row["cost"]["state_bits"], row["error"]["wrong"]
        assert found == best[0][:3] and row["point"] == best[1], needs
        assert (made.rate_hz, made.slip.window) == (best[1]["rate_hz"], best[1]["window"])


def test_a_delay_that_the_shipped_window_misses_is_met_at_the_same_rate():
    row, _, _ = choose.chosen(Needs("channels", error=0.0, latency_ms=5.3, adc="MCP3208"), MEASURED)
    assert {key: row["point"][key] for key in ("rate_hz", "window")} == {"rate_hz": 10000, "window": 128}
    row, _, _ = choose.chosen(Needs("channels", latency_ms=10.0, error=0.0, adc="AD7606"), MEASURED)
    assert row["cost"]["kbit_s"] == 160


SIZES = [(3, 3), (6, 10), (5, 12), (16, 16), (7, 41), (40, 24), (64, 64)]


@pytest.mark.parametrize(
    "adc, share", [("MCP3208", None), ("AD7606", None), ("AD7606", 0.005), ("MAX11125", None)]
)
def test_as_many_converters_as_the_budget_asks_for(adc, share):
    """For a centre of pressure within a millisecond: the budget of the chosen configuration, and that of the
    same array with nothing chosen, need as many as were chosen; the times are the same."""
    for rows, columns in SIZES:
        needs = Needs("array", latency_ms=1.0, rows=rows, columns=columns, adc=adc, settle_share=share)
        part = array.part_of(adc)
        small = rows * columns <= 64  # the configuration fingertip, whose dividers find a bit a clock
        clock_hz, given = 24e6 if small else 100e6, {"bits_per_clock": 2 - small, "settle_share": share}
        least = array.budget(rows, columns, clock_hz, part, health=False, **given)
        least = least["converters_needed"]
        if least is None:
            with pytest.raises(ValueError, match="is above 1,000"):
                choose.chosen(needs, {})
            continue
        row, made, _ = choose.chosen(needs, {})
        found = array.of_config(made)
        assert made.adc.converters == found["converters"] == found["converters_needed"] == least, (
            rows,
            columns,
        )
        assert found["within_1_ms"] and found["settled"] and made.adc.settle_share == share
        assert 1e6 * found["total_s"] == pytest.approx(row["error"]["latency_us"])


def test_the_next_in_each_direction_and_why():
    _, _, lines = choose.chosen(Needs("channels", error=0.0, latency_ms=10.0, adc="MCP3208"), HAND)
    assert lines[5:] == [
        "less of 'converter's data': 60 kbit/s with rate_hz 5000, but missed rate + false-alarm rate 3 % is "
        "above 0 %; onset to flag, median 24 ms is above 10 ms",
        "less of 'state of a channel': no measured point has it",
        "less of 'missed rate + false-alarm rate': no measured point has it",
        "less of 'onset to flag, median': 6 ms with kind sliding, for 868 instead of 28 bits of 'state of a "
        "channel'",
    ]


def test_what_is_printed_is_a_configuration(tmp_path, capsys):
    cli.main(["choose", "electrodes", "--error", "0.05"])
    printed = capsys.readouterr().out
    assert tomllib.loads(printed)["mesh"]["R0_ohm"] == 1000.0, "comments say why"
    path = tmp_path / "mine.toml"
    cli.main(["choose", "electrodes", "--error", "0.05", "--out", str(path)])
    assert config.load(str(path)).cop4.mesh.R0 == 1000.0
    assert (
        "less of 'taken from the rails at 5 N': 212.1 mW with R0_ohm 3300.0, but" in capsys.readouterr().out
    )


def test_a_rate_of_two_digits():
    rates = {1432.8: 1400.0, 99.9: 99.0, 100.0: 100.0, 10.0: 10.0, 9.99: 9.9, 9.6: 9.6, 7.26: 7.2, 0.3: 0.3}
    assert {rate: rounded_rate(rate) for rate in rates} == rates


@pytest.mark.parametrize(
    ("sensor", "key", "most"),
    [
        ("channels", "channels", 8),
        ("channels", "window", 4096),
        ("array", "rows", 256),
        ("array", "columns", 256),
    ],
)
def test_the_ends_of_a_need(sensor, key, most):
    for value in (1, most):
        assert getattr(Needs(sensor, **{key: value}), key) == value
    for value in (0, most + 1):
        with pytest.raises(ValueError, match=f"{key} = {value} must lie in 1 .. {most}"):
            Needs(sensor, **{key: value})


def test_frames_beside_an_image_a_second():
    """A CoP packet has 27 bytes, an image of 9 taxels 38, one of 4096 64 packets of 148; 10 bits each."""
    assert frames_on_line(115_200, 3, 3) == (11_520 - 38) / 27
    assert frames_on_line(3_000_000, 64, 64) == (300_000 - 9472) / 27


@pytest.mark.parametrize("columns, lanes", [(4, 1), (5, 2), (8, 2)])
def test_an_ad7606_has_a_lane_for_four_inputs(columns, lanes):
    """A column at an input of its own needs no switch."""
    _, made, _ = choose.chosen(Needs("array", rows=3, columns=columns, adc="AD7606"), {})
    assert (made.adc.converters, made.adc.channels, made.adc.lanes) == (1, columns, lanes)


def test_a_missing_record_is_named_with_the_command_that_writes_it(tmp_path, monkeypatch, capsys):
    for module, name, command in (
        (area, "BOARDS", "make resources"),
        (tradeoff_command, "RECORD", 'make figures FIGURES="tradeoff"'),
    ):
        monkeypatch.setattr(module, name, tmp_path / "none.json")
        with pytest.raises(SystemExit) as ended:
            cli.main(["choose", "channels", "--board", "icebreaker"])
        said = capsys.readouterr().err
        assert ended.value.code == 2 and f"none.json is missing; `{command}" in said, said
        monkeypatch.undo()
