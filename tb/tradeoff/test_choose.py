"""From needs to a configuration: the shipped ones from their needs, the next point in each direction,
refusals."""

import json
import tomllib

import pytest

from meissner import cli
from meissner.builds import config
from meissner.tradeoff import area, choose
from meissner.tradeoff import command as tradeoff_command
from meissner.tradeoff.candidates import board_of, rounded_rate, tables
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
    path.write_text(choose.toml(made), "utf-8")
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
    assert [rounded_rate(rate) for rate in (1432.8, 99.9, 100.0, 7.26)] == [1400.0, 99.0, 100.0, 7.2]


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
