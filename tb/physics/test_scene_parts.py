"""The parts of a scene: features determine which stages exist, each part has a reason, memory is checked, and
--full adds everything else.

Space: an extra feature, a missing one, a repeated one, and an unknown one; a stage that the features do not
name; every scene's parts compared with what its recordings model; arrays larger than the machine; results
that --full must not change.
"""

import copy
import importlib.util
import subprocess
import sys
import tomllib

import numpy as np
import pytest

from meissner import cli, engines, run, scenes
from meissner.engines.stages import Stages
from meissner.scenes import full, parts, saved
from meissner.scenes.chain import Chain
from meissner.scenes.sensor import sensor, sensors


def scene(name, **changed):
    table = copy.deepcopy(tomllib.loads(scenes.source(name)))
    for key, value in changed.items():
        at = table
        *path, last = key.split("__")
        for part in path:
            at = at[part]
        at[last] = value
    return scenes.build("mine", table)


@pytest.mark.parametrize(
    "name, features, words",
    [
        (
            "acrylic_slip",
            [],
            "features must name 'slip': its flag is judged against the truth",
        ),
        (
            "cop_slip",
            ["cop4"],
            r"must name 'cop_slip': its flag and direction are judged; \[slip\] configures it",
        ),
        ("cop_slip", ["cop_slip"], "must name 'cop4'"),
        ("grip_pour", ["slip"], "must name 'grip': it closes the loop"),
        (
            "capacitive_cell",
            ["demod", "calibrate", "cop"],
            "names 'cop', which a scene of kind cell does not use",
        ),
        (
            "capacitive_crosstalk",
            ["demod", "calibrate"],
            "'calibrate', which a scene of kind crosstalk does not use",
        ),
        ("capacitive_shapes", ["demod", "calibrate"], "must name 'cop'"),
        ("fsr_3x3", ["cop", "calibrate", "cop"], "names 'cop' twice"),
        ("walk_25x5", ["cop", "haptics"], "features = 'haptics' must be one of: cop"),
    ],
)
def test_features_that_say_too_little_or_too_much_are_refused(name, features, words):
    with pytest.raises(ValueError, match=f"scene mine: .*{words}"):
        scene(name, features=features)


def test_a_stage_that_the_features_do_not_name_is_not_there(monkeypatch):
    loaded = []
    monkeypatch.setattr(
        "meissner.engines.stages.load", lambda name: loaded.append(name) or engines.load(name)
    )
    core = Stages("fixed", ("cop4",))
    with pytest.raises(ValueError, match="the core is built without slip: features lists cop4"):
        core.watch(np.zeros((1, 64), dtype=np.int64), None)
    with pytest.raises(AttributeError):
        core.taste  # noqa: B018
    assert loaded == [] and core.cop4 is engines.load("fixed").cop4 and loaded == ["fixed"]
    with pytest.raises(ValueError, match="without calibrate: features lists demod"):
        Chain("fixed", ("demod",)).calibrate(np.zeros((1, 2, 3), dtype=np.int64), None)


def test_every_part_has_a_reason():
    for name in sensors():
        of = __import__(f"meissner.scenes.{name}.parts", fromlist=["parts"])
        assert set(sensor(name).COMPONENTS) <= set(of.WHY), name
        assert set(of.FEATURES) <= set(parts.FEATURES)
    for name in scenes.names():
        one = scenes.load(name)
        assert set(parts.of(one).uses(one)) == set(one.features), name
        assert parts.reasons(one) and parts.of(one).memory(one)[0] > 0


@pytest.mark.parametrize(
    "name, condition",
    [
        *(("normal_force", 0), ("grip_slip", 6), ("walk_25x5", None), ("fsr_3x3", None), ("cop_slip", 0)),
        *(("cop_circle", None), ("shear_amount", 0), ("capacitive_crosstalk", None)),
    ],
)
def test_the_reasons_are_of_what_is_modelled(name, condition):
    one = scenes.load(name)
    if condition is None:
        found = scenes.simulate(one, seed=1)
    else:
        which = one.conditions[condition] if name == "cop_slip" else condition
        found = scenes.simulate(one, which, 1)
    modelled = found[0].modelled if isinstance(found, list) else found.modelled
    assert set(parts.reasons(one)) == set(modelled)


def test_what_does_not_fit_the_machine_is_refused_before_it_is_computed(monkeypatch):
    large = scene("cop_six_random", world__draws=10**6, mesh__rows=1024, mesh__columns=1024)
    assert parts.of(large).memory(large)[0] == 32 * 4 * 10**6 * 2**20  # four totals
    words = (
        r"mine: 4000000 loads of 1048576 taxels need about 1.34e\+05 GB, but this machine has 16.0 GB free"
    )
    monkeypatch.setattr(parts, "free_bytes", lambda: 16 * 10**9)
    with pytest.raises(ValueError, match=words):
        run.check(large, "fixed")
    small = scene("cop_six_random", world__draws=100)
    need = 32 * 400 * 41 * 41
    monkeypatch.setattr(parts, "free_bytes", lambda: need * 5 // 4)  # of which exactly 0.8 is needed
    run.check(small, "fixed")
    monkeypatch.setattr(parts, "free_bytes", lambda: need * 5 // 4 - 2)
    with pytest.raises(ValueError, match="reduce them"):
        run.check(small, "fixed")


def told(capsys, *arguments):
    with pytest.raises(SystemExit) as end:
        cli.main([*map(str, arguments)])
        raise SystemExit(0)
    return end.value.code, capsys.readouterr()


def test_scene_check_says_why(capsys, tmp_path):
    code, out = told(capsys, "scene", "check", "cop_two_point")
    assert code == 0 and "  cop4 (msn_cop4): position and load of the electrodes" in out.out
    assert "  left out: random points, rubber response, hemispherical cover\n" in out.out
    text = scenes.source("cop_two_point")
    mine = tmp_path / "mine.toml"
    mine.write_text(text.replace('features = ["cop4"]', "features = []"))
    code, out = told(capsys, "scene", "check", mine)
    assert (code, out.out) == (2, "") and out.err.count("\n") == 1 and "mine: features must name" in out.err
    for wrong, words in (
        ("nothing", "unknown scene"),
        (tmp_path / "no.toml", "no.toml"),
        (mine, "not a TOML"),
    ):
        mine.write_text("= 3")
        code, out = told(capsys, "scene", "check", wrong)
        assert code == 2 and words in out.err and out.err.count("\n") == 1


@pytest.mark.usefixtures("undrawn")
def test_everything_on_changes_nothing_and_is_compared(tmp_path, monkeypatch):
    """The same summary and result.npz, except for times; two other scenes stand for all."""
    monkeypatch.setattr(full, "EVERYTHING", (("cop_circle", None), ("walk_25x5", None)))
    monkeypatch.setattr(full, "CORE_FRAMES", {"fixed": 1, "rtl": 1})
    one = scenes.load("cop_two_point")
    plain = run.run(one, "fixed", tmp_path / "plain")
    compared = run.full(one, "fixed")
    whole = run.run(one, "fixed", tmp_path / "full", compared=compared)
    times = ("seconds_taken", "samples_per_second", "saved")
    assert {k: v for k, v in plain.items() if k not in times} == {
        k: v for k, v in whole.items() if k not in times
    }
    first, second = (np.load(tmp_path / name / "result.npz") for name in ("plain", "full"))
    assert set(first) == set(second)
    for name in first:
        assert first[name].dtype == second[name].dtype and first[name].tobytes() == second[name].tobytes()
    assert set(whole["saved"]["full"]) == {"cop_circle", "walk_25x5", "core: full"}
    assert whole["saved"]["full_ms_per_s"] == sum(whole["saved"]["full"].values())
    assert "measured now" in saved.tell("cop_two_point", "fixed", whole["saved"])


def test_everything_has_every_component_and_feature():
    modelled, features = {}, set()
    for name, _ in full.EVERYTHING:
        one = scenes.load(name)
        features |= set(one.features)
        modelled.setdefault(one.sensor, set()).update(parts.reasons(one))
    assert features == set(parts.FEATURES)
    for name in sensors():
        of = __import__(f"meissner.scenes.{name}.parts", fromlist=["parts"])
        assert set(of.WHY) - modelled[name] <= {"changing mass"}, name  # full.HAND adds it


@pytest.mark.parametrize("engine", ["fixed", "rtl"])
def test_what_is_recorded_is_ten_times_and_more(engine):
    names = scenes.names() if engine == "fixed" else ["acrylic_slip", "cop_two_point", "normal_force"]
    for name in names:
        found = saved.of(scenes.load(name), engine)
        assert found["engine"] == engine and found["full_ms_per_s"] > found["scene_ms_per_s"]
        if name in ("acrylic_slip", "cop_two_point", "normal_force"):
            assert found["times_faster"] >= 10


# Twins and drivers of features that the scene does not name and so must not import.
FOREIGN = {
    "cop_two_point": {
        "slip.slip_path",
        "cop.cop_slip",
        "cop.cop_divide",
        "frontend.calibrate_taxels",
        "rtl_slip",
    },
    "acrylic_slip": {"cop.cop_divide", "frontend.calibrate_taxels", "rtl_cop4", "rtl_cop", "rtl_frontend"},
    "walk_25x5": {
        "slip.slip_path",
        "cop.cop4",
        "frontend.calibrate_taxels",
        "rtl_slip",
        "rtl_cop4",
        "rtl_frontend",
    },
}
IMPORTED = """
import sys
from meissner import engines, run, scenes
one = scenes.load(sys.argv[1])
run.check(one, sys.argv[2])
engines.load(sys.argv[2])
assert "meissner.scenes." + one.sensor + ".run" in sys.modules
print(*(name for name in sys.modules if name.startswith("meissner.")))
"""


@pytest.mark.parametrize("name", FOREIGN)
@pytest.mark.parametrize("engine", ["fixed", "rtl"])
def test_an_engine_imports_no_stage_that_no_feature_names(name, engine):
    done = subprocess.run(
        [sys.executable, "-c", IMPORTED, name, engine], capture_output=True, text=True, check=True
    )
    for module in FOREIGN[name]:
        whole = f"meissner.{'engines' if module.startswith('rtl') else 'twins'}.{module}"
        assert importlib.util.find_spec(whole) and whole not in done.stdout.split(), whole
