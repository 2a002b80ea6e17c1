"""How ``meissner run`` evaluates an engine's output: the verdict on one run by hand, the differences from the
twin, the table of conditions, and that each run gets its own seed and its own motion."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from msgspec import structs

from meissner import engines, scenes
from meissner.engines import Watched, fixed
from meissner.run import run
from meissner.scenes.rubber import judge as judging
from meissner.scenes.rubber import run as slip_run
from meissner.scenes.timed import mismatches
from meissner.twins.slip.config import SlipConfig
from meissner.twins.slip.slip import State

N, C, I, G = State.NONE, State.CONTACT, State.INCIPIENT, State.GROSS  # noqa: E741


def recording(onset_s, gross_s=None):
    scene, codes = SimpleNamespace(rate_hz=1000), np.zeros(200, dtype=np.int64)
    pressed = np.arange(200) > 3  # two pairs are known before the press
    return SimpleNamespace(scene=scene, codes=codes, onset_s=onset_s, gross_s=gross_s, normal_n=0.3 * pressed)


@pytest.mark.parametrize(
    "states, wrong",
    [
        ([N, N, C, I, G], 0),
        ([N, C, C, I, G], 1),
        ([C, N, State.RELEASE, I, N], 3),
        ([G, I, N, N, State.RELEASE], 5),
    ],
)
def test_contact_that_is_wrong_by_hand(states, wrong):
    """Pairs are known at 1, 3, 5, 7, 9 ms; the plate presses from the sample at 4 ms on."""
    verdict = judging.judge(recording(0.006, 0.1), np.array(states), SlipConfig())
    assert verdict["contact_wrong_share"] == wrong / 5
    others = [verdict | {"contact_wrong_share": share} for share in (0.25, 0.5)]
    assert judging.contact_wrong(others) == 0.375


@pytest.mark.parametrize(
    "states, onset_s, flag_s, false_alarms",
    [
        # Pair k of samples is known at sample 2k + 1, here at 1, 3, 5, 7, 9 ms.
        ([N, C, C, I, G], 0.006, 0.007, 0),
        ([N, C, C, I, G], 0.007, 0.007, 0),  # at the onset itself: no false alarm
        ([N, C, C, I, G], 0.0071, None, 1),
        ([C, I, C, G, C], 0.004, 0.007, 1),  # the second rise is the flag, the first is false
        ([I, C, I, C, G], 0.020, None, 3),  # the first detail counts
        ([C, C, C, C, C], 0.004, None, 0),
        ([C, I, C, G, G], None, None, 2),
    ],
)
def test_judge_by_hand(states, onset_s, flag_s, false_alarms):
    verdict = judging.judge(recording(onset_s, onset_s and 0.1), np.array(states), SlipConfig())
    assert verdict["flag_s"] == flag_s
    assert verdict["false_alarms"] == false_alarms
    assert verdict["missed"] == (onset_s is not None and flag_s is None) and not verdict["late"]
    if flag_s is None:
        assert verdict["delay_s"] is verdict["lead_s"] is None
    else:
        assert verdict["delay_s"] == pytest.approx(flag_s - onset_s)
        assert verdict["lead_s"] == pytest.approx(0.1 - flag_s)


@pytest.mark.parametrize("gross_s, missed", [(0.006, True), (0.007, True), (0.0071, False)])
def test_a_flag_that_does_not_come_before_the_whole_contact_slips_is_a_miss(gross_s, missed):
    """The flag is that of the fourth pair, known at 7 ms."""
    verdict = judging.judge(recording(0.002, gross_s), np.array([N, C, C, I, G]), SlipConfig())
    assert (verdict["missed"], verdict["late"]) == (missed, missed)
    assert verdict["lead_s"] == pytest.approx(gross_s - 0.007) and verdict["delay_s"] == 0.005
    assert verdict["false_alarms"] == 0


def test_judge_counts_details_of_any_level():
    assert judging.judge(recording(0.0, 0.1), np.array([C, C, G]), SlipConfig(level=3))["flag_s"] == 0.023


@pytest.mark.parametrize(
    "states, gross_s, sliding_s, share",
    [
        # Pair k of samples is known at sample 2k + 1, here at 1, 3, 5, 7, 9 ms.
        ([N, C, I, C, G], 0.005, 0.006, 1 / 3),
        ([N, C, I, C, G], 0.0051, 0.004, 0.5),  # the detail of 5 ms was known earlier
        ([N, C, I, State.RELEASE, N], 0.001, 0.010, 4 / 5),
        ([C, C, I, G, I], 0.0049, 0.006, 0.0),
        ([C, C, I, G, C], 0.0091, 0.0, None),
        ([C, C, I, G, C], None, None, None),
    ],
)
def test_the_share_of_sliding_by_hand(states, gross_s, sliding_s, share):
    verdict = judging.judge(recording(gross_s and 0.0005, gross_s), np.array(states), SlipConfig())
    assert (verdict["sliding_s"], verdict["contact_share_of_sliding"]) == pytest.approx((sliding_s, share))


def test_crossing_is_the_reference_window_s():
    """A step of 41 codes inside the pair of samples 60 and 61 crosses 40 once that pair is known."""
    run_ = recording(0.050, 0.1)
    run_.codes[61:] = 41
    states = np.repeat([C, I], [40, 60])
    verdict = judging.judge(run_, states, SlipConfig())
    assert verdict["crossing_s"] == 0.061
    assert verdict["flag_s"] == 0.081
    assert judging.judge(recording(0.050, 0.1), states, SlipConfig())["crossing_s"] is None


def test_every_difference_from_the_twin_counts():
    details = {"p2p": np.arange(6).reshape(2, 3), "over": np.zeros((2, 3), bool), "state": np.ones((2, 3))}
    twin = Watched(**details, end=np.array([False, True, False]), blanked=4)
    assert mismatches(twin, twin) == 0
    for field in ("p2p", "over", "state"):
        changed = getattr(twin, field).copy()
        changed[1, 2] = not changed[1, 2]
        assert mismatches(dataclasses.replace(twin, **{field: changed}), twin) == 1, field
    assert mismatches(dataclasses.replace(twin, end=~twin.end), twin) == 3
    assert mismatches(dataclasses.replace(twin, blanked=5), twin) == 1


def test_statistics_are_of_all_runs():
    none = dict.fromkeys(("flag_s", "crossing_s", "delay_s", "lead_s")) | {"missed": True, "false_alarms": 1}
    none |= {"contact_wrong_share": 0.25, "onset_s": 0.6, "late": False, "false_alarms_masked": 3}
    found = {"onset_s": 0.6, "delay_s": 0.003, "lead_s": 0.2, "missed": False, "false_alarms": 2}
    found |= {"late": False, "false_alarms_masked": 0, "contact_wrong_share": 0.5}
    found |= {"flag_s": 0.7, "crossing_s": 0.698, "sliding_s": 0.5, "contact_share_of_sliding": 0.2}
    none |= {"sliding_s": 1.5, "contact_share_of_sliding": 1.0}
    later = found | {"delay_s": 0.005, "lead_s": 0.1, "false_alarms": 0, "crossing_s": None}
    later |= {"sliding_s": 0.0, "contact_share_of_sliding": None}  # the run ends before the object slides
    row = judging.statistics(SimpleNamespace(name="x"), [found, none, later, none])
    assert (row["runs"], row["missed"], row["false_alarms"], row["false_alarms_masked"]) == (4, 2, 4, 6)
    # 2 of 4 runs are missed: 1 - (1 - p)^4 - 4 p (1 - p)^3 = 0.025 at p = 0.0676; 3 have an alarm.
    assert row["missed_interval"] == [0.067586, 0.932414]
    assert row["false_alarm_interval"] == [0.194120, 0.993691]
    assert (row["delay_ms_median"], row["delay_ms_mean"], row["delay_ms_max"]) == (4.0, 4.0, 5.0)
    assert (row["lead_ms_median"], row["lead_ms_min"]) == (150.0, 100.0)
    assert row["detector_ms_max"] == 2.0 and row["contact_wrong_share"] == 0.375
    assert row["contact_share_of_sliding"] == round(3.1 / 3.5, 6)
    far = found | {"delay_s": 0.013, "lead_s": 0.9}
    row = judging.statistics(SimpleNamespace(name="x"), [found, later, far])
    assert (row["delay_ms_median"], row["delay_ms_mean"], row["lead_ms_median"]) == (5.0, 7.0, 200.0)
    tardy = found | {"missed": True, "late": True, "delay_s": 0.5, "lead_s": -0.3}
    row = judging.statistics(SimpleNamespace(name="x"), [tardy, found])
    assert (row["missed"], row["late"], row["delay_ms_max"], row["lead_ms_min"]) == (1, 1, 500.0, -300.0)
    still = later | {"sliding_s": None}
    assert judging.statistics(SimpleNamespace(name="x"), [still])["contact_share_of_sliding"] is None
    assert "detector_ms_max" not in judging.statistics(SimpleNamespace(name="x"), [later])


def test_rows_of_the_table_have_the_same_columns():
    """One condition was missed in every run, another was not."""
    assert slip_run._table([{"a": 1}, {"a": 2, "b": 3}]) == [{"a": 1, "b": None}, {"a": 2, "b": 3}]


def watched_by(tmp_path, monkeypatch, engine, seed, spoil=lambda watched: watched):
    """Run acrylic_slip with 2 seeds; returns the summary and the engine's inputs."""
    scene = dataclasses.replace(scenes.load("acrylic_slip"), seeds=2)
    module, seen = engines.load(engine), []
    watch = module.watch

    def spy(codes, config, moving=None):
        seen.append((codes, moving))
        return spoil(watch(codes, config, moving))

    monkeypatch.setattr(module, "watch", spy)
    return run(scene, engine, tmp_path, seed), seen[1:]  # the first call only warms up


def test_each_run_has_its_seed_and_its_motion(tmp_path, monkeypatch, undrawn):
    scene = scenes.load("acrylic_slip")
    _, seen = watched_by(tmp_path, monkeypatch, "fixed", seed=5)
    assert len(seen) == 4  # per seed one without motion, which counts, and one with it
    for number in range(2):
        truth = scenes.simulate(scene, 0, 5 + number)
        (codes, still), (same, moving) = seen[2 * number : 2 * number + 2]
        assert np.array_equal(codes, truth.codes[None]) and np.array_equal(same, codes)
        assert still is None and np.array_equal(moving, truth.moving) and moving.any()
    kept = np.load(tmp_path / "result.npz")
    truth = scenes.simulate(scene, 0, 5)
    assert np.array_equal(kept["state"], fixed.watch(truth.codes[None], scene.slip_config()).state[0])


def test_a_core_that_differs_is_reported(tmp_path, monkeypatch, undrawn):
    """One wrong detail in each of two runs, with and without motion, and in the pins' comparison with the
    first run."""

    def spoil(watched):
        watched.state[0, 10] = State.GROSS
        return watched

    summary, _ = watched_by(tmp_path, monkeypatch, "rtl", seed=5, spoil=spoil)
    assert summary["twin_mismatches"] == 5


def test_a_sliding_object_is_said_to_slip(tmp_path, monkeypatch, undrawn):
    """Paper, the worst condition: half the sliding time is lost without a lower threshold, none with it."""
    scene = scenes.load("slip_materials")
    scene = dataclasses.replace(scene, seeds=3, conditions=scene.conditions[3:])
    summary = run(scene, "fixed", tmp_path / "kept", 1)
    assert scene.conditions[0].name == "paper 2 N"
    assert summary["contact_share_of_sliding"] == summary["conditions"][0]["contact_share_of_sliding"] == 0
    slip = structs.replace(scene.slip, keep_threshold_p2p_v=scene.slip.threshold_p2p_v)
    summary = run(dataclasses.replace(scene, slip=slip), "fixed", tmp_path / "lost", 1)
    assert summary["contact_share_of_sliding"] > 0.4
    assert f"{100 * summary['contact_share_of_sliding']:.2f} %" in "\n".join(slip_run.tell(summary))
