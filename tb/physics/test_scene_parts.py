"""What a scene needs: the features of the core follow from the scene, each part has a reason, memory is
checked, and only modules of what runs are imported.

Space: a line ``features`` of an older file that is right, and four that are not; every scene's parts compared
with what its recordings model; arrays larger than the machine; scenes of every sensor in fresh processes.
"""

import copy
import subprocess
import sys
import tomllib

import numpy as np
import pytest

from meissner import cli, run, scenes
from meissner.scenes import features
from meissner.scenes.sensor import sensor, sensors, used
from meissner.scenes.timed import TimedEngine

# From docs/scenes.md: what each scene asks of the core.
USED = {
    **{"acrylic_slip": "slip", "shear_amount": "slip", "shear_speed": "slip shear_speed"},
    **{"grip_pour": "slip grip", "cop_load": "cop4", "cop_slip": "cop4 cop_slip", "walk_25x5": "cop"},
    **{"fsr_3x3": "calibrate cop", "capacitive_crosstalk": "demod", "capacitive_cell": "demod calibrate"},
    "capacitive_shapes": "demod calibrate cop",
    **{
        "rope_pull": "forest_features",
        "fingertip_cop": "calibrate cop",
        "fingertip_hardness": "forest_features",
    },
    "optacon_free": "pin_display",
    "touch_to_touch": "demod calibrate cop4 cop_slip render pin_display",
}


def scene(name, **changed):
    table = copy.deepcopy(tomllib.loads(scenes.source(name)))
    for key, value in changed.items():
        at = table
        *path, last = key.split("__")
        for part in path:
            at = at[part]
        at[last] = value
    return scenes.build("mine", table)


@pytest.mark.parametrize("name", USED)
def test_the_features_follow_from_the_scene(name):
    assert set(scenes.load(name).features) == set(USED[name].split())
    right = USED[name].split()
    assert scene(name, features=right).features == scene(name, features=right[::-1]).features


@pytest.mark.parametrize(
    "name, line, wrong",
    [
        ("acrylic_slip", [], "slip"),
        ("cop_slip", ["cop4"], "cop_slip"),
        ("capacitive_cell", ["demod", "calibrate", "cop"], "cop"),
        ("walk_25x5", ["cop", "haptics"], "haptics"),
        ("walk_25x5", "cop", "features"),
    ],
)
def test_an_older_files_line_that_is_wrong_is_refused_by_its_name(name, line, wrong):
    with pytest.raises(ValueError, match=wrong):
        scene(name, features=line)


def test_a_feature_that_the_scene_does_not_use_is_not_there():
    with pytest.raises(ValueError, match="calibrate"):
        TimedEngine("fixed", ("demod",)).calibrate(np.zeros((1, 2, 3), dtype=np.int64), None)


def test_every_part_has_a_reason():
    for name in sensors():
        of = sensor(name)
        assert set(of.COMPONENTS) <= set(of.WHY), name
        assert set(of.FEATURES) <= set(features.FEATURES)
    for name in scenes.names():
        one = scenes.load(name)
        of = sensor(one.sensor)
        assert used(one) and set(of.modelled(one)) <= set(of.WHY) and of.memory(one)[0] > 0


@pytest.mark.parametrize(
    "name, condition",
    [
        *(("normal_force", 0), ("grip_slip", 6), ("walk_25x5", None), ("fsr_3x3", None), ("cop_slip", 0)),
        *(
            ("cop_circle", None),
            ("shear_amount", 0),
            ("capacitive_crosstalk", None),
            ("fingertip_cop", 1),
            ("optacon_burst", None),
        ),
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
    assert set(sensor(one.sensor).modelled(one)) == set(modelled)


def test_what_does_not_fit_the_machine_is_refused_before_it_is_computed(monkeypatch):
    large = scene("cop_six_random", world__draws=10**6, mesh__rows=1024, mesh__columns=1024)
    assert sensor("mesh").memory(large)[0] == 32 * 4 * 10**6 * 2**20  # four totals
    monkeypatch.setattr(run, "free_bytes", lambda: 16 * 10**9)
    with pytest.raises(ValueError, match=r"1.34e\+05 GB, but this machine has 16.0 GB free"):
        run.check(large, "fixed")
    small = scene("cop_six_random", world__draws=100)
    need = 32 * 400 * 41 * 41
    monkeypatch.setattr(run, "free_bytes", lambda: need * 5 // 4)  # of which exactly 0.8 is needed
    run.check(small, "fixed")
    monkeypatch.setattr(run, "free_bytes", lambda: need * 5 // 4 - 2)
    with pytest.raises(ValueError, match="GB free"):
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
    mine = tmp_path / "mine.toml"
    mine.write_text('features = ["cop"]\n' + scenes.source("cop_two_point"))
    code, out = told(capsys, "scene", "check", mine)
    assert (code, out.out) == (2, "") and out.err.count("\n") == 1 and "'cop'" in out.err
    for wrong, words in (
        ("nothing", "unknown scene"),
        (tmp_path / "no.toml", "no.toml"),
        (mine, "not a TOML"),
    ):
        mine.write_text("= 3")
        code, out = told(capsys, "scene", "check", wrong)
        assert code == 2 and words in out.err and out.err.count("\n") == 1


# What a scene may import of physics and twins, a folder with all in it; and EVERY.
EVERY = ("slip.config", "common", "shared")
_MESH = "mesh mesh_loads cop4_config cop4_registers / cop.cop4 cop.cop4_correct"
_SLIP = "slip.haar slip.peak_to_peak slip.slip slip.slip_path"
_TAXELS = "mesh_loads patches plantar / cop.cop"
IMPORTS = {
    "acrylic_slip": f"rubber plate disturbances / {_SLIP}",
    "shear_amount": f"rubber plate disturbances / {_SLIP}",
    # With the converter's codes that mean a fault.
    "grip_pour": f"rubber plate hand slide stepped / {_SLIP} actuate frontend",
    "cop_two_point": _MESH,
    # With all that reads a build's configuration, which gives it mesh, converter and detector.
    "cop_slip": f"grip plate rubber {_MESH} cop.cop_slip frontend link slip actuate",
    "walk_25x5": _TAXELS,
    "fsr_3x3": f"fsr {_TAXELS} frontend",  # with the scan
    "capacitive_crosstalk": "capacitive footprints mesh_loads / frontend.am_demod frontend.calibrate",
    "fingertip_hardness": f"rope fsr {_TAXELS} frontend forest.forest_features",
    "fingertip_cop": f"rope fsr {_TAXELS} frontend",
    "optacon_burst": "pins receptors / actuate.pin_display",
}
# For each line "<scene> <engine>" of the input, a line of the modules that a new process then has; what it
# imports from others, most of its time, is imported before.
RUNS = """
import os, sys, tempfile
from dataclasses import replace
import matplotlib.backends.backend_agg, scipy.interpolate, scipy.optimize, scipy.signal, scipy.sparse.linalg
from matplotlib.figure import Figure
from msgspec import structs
Figure.savefig = lambda _, path, **__: path.write_bytes(b"no picture")
for line in sys.stdin:
    if os.fork():
        if os.wait()[1]:  # it failed
            print(flush=True)
        continue
    name, engine = line.split()
    from meissner import run, scenes
    one = scenes.load(name)
    if hasattr(one, "seeds"):
        one = replace(one, seeds=1)
    for name in "conditions", "cases":  # each imports what the first one does
        if len(getattr(one, name, ())) > 1:
            one = replace(one, **{name: getattr(one, name)[:1]})
    if one.sensor == "hand":
        one = replace(one, conditions=(structs.replace(one.conditions[0], duration_s=0.5),))
        one = replace(one, world=one.world | {"hold_from_s": 0.0})
    with tempfile.TemporaryDirectory() as out:
        run.run(one, engine, out)
    print(*(name for name in sys.modules if name.startswith("meissner.")), flush=True)
    os._exit(0)
"""


@pytest.fixture(scope="module")
def runs():
    """The process of RUNS."""
    streams = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen([sys.executable, "-c", RUNS], **streams) as process:
        yield process
        process.stdin.close()


@pytest.mark.parametrize("engine", ["fixed", "float"])
@pytest.mark.parametrize("name", IMPORTS)
def test_a_scene_imports_only_what_it_runs(runs, name, engine):
    print(name, engine, file=runs.stdin, flush=True)
    found = {module.removeprefix("meissner.") for module in runs.stdout.readline().split()}
    assert f"scenes.{scenes.load(name).sensor}.run" in found

    physics, twins = (part.split() for part in IMPORTS[name].split("/"))
    allowed = [
        *(f"physics.{part}" for part in ("adc", "front", *physics)),
        "engines.features",
        "engines.protocol",
    ]
    allowed += [
        *(f"twins.{part}" for part in (*EVERY, *twins)),
        f"engines.{engine}",
    ]
    assert not [
        module
        for module in found
        if module.startswith(("physics.", "twins.", "engines."))
        and not any(f"{module}.".startswith(f"{part}.") or part.startswith(f"{module}.") for part in allowed)
        and not module.startswith("engines.float_")  # also judge the other engines
    ]
