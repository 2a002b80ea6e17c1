"""docs/grip_scenes.md has exactly what docs/grip.json records, and marks stale rows."""

import json

import pytest

from published import grip
from meissner import scenes

ROW = {
    "condition": "first event at 0.5, 10 ms",
    "runs": 40,
    "dropped": 0,
    "dropped_interval": [0.0, 0.088097],
    "grip_ratio_mean": 1.0936,
    "grip_ratio_max": 1.176,
    "runs_above_ratio": 3,
    "moved_mm_max": 0.1219,
    "sag_mm_max": 0.0954,
    "ring_mm_max": 0.0312,
    "slip_mm_max": 0.0004,
    "tightenings": 6840,
    "false_tightenings": 50,
}


def test_the_page_has_what_is_recorded():
    text = grip.PAGE.read_text("utf-8")
    assert grip.page(text, json.loads(grip.RECORD.read_text("utf-8"))) == text, (
        "`python tools/published/grip.py --page`"
    )
    assert text.count(grip.HEAD) == 1


def test_every_record_is_of_a_condition_that_is_there():
    kept = json.loads(grip.RECORD.read_text("utf-8"))
    assert set(kept) == set(scenes.names("hand"))
    for name, found in kept.items():
        names = [condition.name for condition in scenes.load(name).conditions]
        assert [row["condition"] for row in found] == [
            one for one in names if one in {r["condition"] for r in found}
        ]


def test_a_row_says_what_fell_and_whether_it_is_stale():
    fresh = {"of": grip.digest("grip_pour")} | ROW
    assert grip.cells("grip_pour", fresh) == [
        "grip_pour, 0.5, 10 ms",
        *("40", "0 (at most 8.81 %)", "1.094 / 1.18", "3", "0.122 mm", "0.095 / 0.031 / 0.000 mm"),
        "171, 1.2 a run",
    ]
    fell = fresh | {"dropped": 2, "dropped_interval": [0.0061, 0.1692], "of": "before"}
    assert grip.cells("grip_pour", fell)[:3] == [
        *("grip_pour, 0.5, 10 ms (stale)", "40", "**2** (0.61 to 16.9 %)"),
    ]


def test_settings_are_set_by_name():
    scene = grip.changed(scenes.load("grip_pour"), ["step_mm=0.03", "slip.threshold_share=0.011"])
    assert {condition.step_mm for condition in scene.conditions} == {0.03}
    assert scene.slip["threshold_share"] == 0.011 and scene.slip["window"] == 64
    with pytest.raises(SystemExit):
        grip.main(["grip_pour", "--record", "--first", "1001"])
