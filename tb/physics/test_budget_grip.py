"""The budget of the grip reflex, by the numbers of docs/grip.md: 10 clocks with tumbling windows, 12 with a
sliding window of 64, and one more if a period ends just before; tb/core/test_grip_core.py shows that a core
needs 10. The command prints the terms, and refuses a configuration without a reflex."""

import json
import re
import tomllib
from dataclasses import replace

import pytest

from harness.command import meissner
from meissner import cli
from meissner.budget import grip
from meissner.builds import config


def build(immediate=True, **slip):
    table = tomllib.loads((config.FOLDER / "grip.toml").read_text())
    table["slip"] |= slip
    table["grip"]["immediate"] = immediate
    return config.read("mine", table)


@pytest.mark.parametrize(
    "slip, clocks",
    [
        ({}, 10),
        ({"hop": 32}, 11),
        ({"hop": 2}, 12),
        ({"level": 2}, 11),
        ({"level": 3}, 12),
        ({"level": 3, "hop": 8}, 13),  # eight details: 1 + log4(8), rounded up
        ({"window": 4096, "hop": 2}, 15),
    ],
)
def test_the_terms_are_those_of_the_pages(slip, clocks):
    found = grip.of_config(build(immediate=False, **slip))
    assert found["total_clocks"] == sum(found["terms_clocks"].values()) == clocks
    assert found["within_16"] and found["wait_clocks"] == 240_000
    found = grip.of_config(build(**slip))
    assert found["total_clocks"] == clocks + 1 <= 16 and found["wait_clocks"] == 0 and found["within_16"]
    assert found["total_s"] == pytest.approx((clocks + 1) / 24e6)


def test_a_window_too_long_for_16_clocks_is_reported():
    """4096 details: filter 1, level 3, 1 + log4(4096) = 7, slip 2, reflex 4, after another command 1."""
    found = grip.of_config(build(level=3, window=32_768, hop=8))
    assert found["total_clocks"] == 18 and not found["within_16"]
    assert "above the limit of 16" in grip.tell(found)[0]


def test_the_terms_of_a_core_as_it_is_shipped():
    found = grip.of_config(config.load("grip"))
    assert found["terms_clocks"] == {
        **{"frame_filter": 1, "haar": 1, "peak_to_peak": 2, "slip": 2, "count": 1, "join": 1, "goal": 1},
        **{"command": 1, "after another": 1},
    }
    assert set(found["terms_clocks"]) <= set(grip.NAMES)
    # Two channels at 24 MHz, SCLK 1 MHz: one and a half words of 24 bits and the rest between them.
    assert found["cycle_clocks"] == 240_000 and 24 * 19 < found["convert_clocks"] < 2 * 24 * 24


def test_the_command_prints_it():
    told = meissner("budget", "--config", "grip").stdout.splitlines()
    assert told[0] == (
        "from the sample that shows slip to the command word: at most 11 clocks (0.458 us), "
        "within the limit of 16"
    )
    assert any(line.split()[:2] == ["haar", "1"] for line in told)
    found = json.loads(meissner("budget", "--config", "grip", "--json").stdout)
    assert found == grip.of_config(config.load("grip"))
    for arguments, said in (
        (("--config", "grip", "--cop4"), "--config must go without --cop4 and --out"),
        (("--config", "nothing"), "'nothing' is neither a file nor one of the configurations"),
    ):
        done = meissner("budget", *arguments)
        assert done.returncode != 0 and said in done.stderr and "Traceback" not in done.stderr


def test_the_waits_of_a_speed_of_shear(tmp_path, capsys):
    """Windows of 64 samples at 4 kHz; eight of them at rest; 0.02 mm at 2.5 mm/s and at 0.025."""
    text = (config.FOLDER / "grip.toml").read_text()
    (tmp_path / "mine.toml").write_text(
        re.sub("rate_hz = .*", "rate_hz = 4000.0", text)
        + "[shear_speed]\nlimit_mm_s = 2.5\ntravel_mm = 0.02\n"
    )
    cli.main(["budget", "--config", str(tmp_path / "mine.toml"), "--json"])
    both = json.loads(capsys.readouterr().out)
    assert set(both) == {"grip", "shear_speed"}
    found = both["shear_speed"]
    assert (found["total_clocks"], found["window_s"], found["settle_s"]) == (60, 0.016, 0.128)
    assert [found["travel_mm"], *found["travel_s"]] == pytest.approx([0.02, 0.008, 0.8], rel=1e-5)
    cli.main(["budget", "--config", str(tmp_path / "mine.toml")])
    assert (
        "before it: a window of 16 ms; 128 ms at rest;\n0.02 mm of shear, 0.008 s at the limit, 0.8 s at"
        in capsys.readouterr().out
    )


def test_a_window_that_waits_says_for_how_long():
    one = build(immediate=False)
    told = grip.tell(grip.of_config(replace(one, name="slow")))
    assert "up to 240000 clocks" in told[-1]
