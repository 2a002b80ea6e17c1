"""The four electrodes on the three engines: fixed equals rtl in every field, float agrees within the bounds
that the twin states. Converters of 8 to 24 bits, meshes of one taxel, one row and 41×41, every correction;
codes of pressed meshes, codes next to them, full scale of every sign, zeros, random codes; refused input."""

from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest

from meissner import engines
from meissner.builds import cop4_file
from meissner.builds.toolchain import ROOT
from meissner.engines import float_cop4
from meissner.physics import mesh_loads
from meissner.physics.adc import Adc
from meissner.physics.cop4_config import TOUCHES, Cop4Config
from meissner.physics.mesh import Mesh
from meissner.twins.cop.cop4 import faults

EXAMPLE = ROOT / "docs/cop4.toml"


MESH = Mesh(5, 5, 47.0)


def config(mesh=MESH, bits=16, touch="none", **more):
    return Cop4Config(mesh, Adc(bits, -5.0, 5.0), 0.3, touch=touch, **more)


def codes_of(config, count=60, seed=1):
    """Codes of pressed meshes, the same with small errors, corners and random codes; the count; and the
    solution."""
    rng = np.random.default_rng(seed)
    mesh, full = config.mesh, 1 << config.adc.bits - 1
    load = mesh_loads.touches(mesh.m, mesh.n, "uneven points", seed)[:count]
    answer = mesh.solve(load)
    volts = np.stack([answer.E1, answer.E2, answer.E3, answer.E4], axis=1)
    pressed = config.convert(volts)
    near = pressed + rng.integers(-2, 3, pressed.shape)
    rail = config.registers.rail // 2
    corners = np.array(
        [[0, 0, 0, 0], [full - 1] * 4, [-full] * 4, [full - 1, -full] * 2, [rail, -rail] * 2, [1, -1, 1, -1]]
    )
    anything = rng.integers(-full, full, (count, 4))
    return np.concatenate([pressed, near, corners, anything]).clip(-full, full - 1), count, answer


def differing(a, b):
    return [name for name in a._fields if not np.array_equal(getattr(a, name), getattr(b, name))]


CONFIGS = [
    config(bits=8, load_lsb_n=0.5, min_load_n=0.5),
    config(bits=12),
    config(),
    config(Mesh(41, 41, 10.0), 24),
    config(Mesh(41, 41, 150.0), 24, "uneven points"),
    config(Mesh(5, 9, 100.0, R0=1e3), 16, "cover"),
    config(Mesh(1, 6, 47.0), 18, "point"),
    config(Mesh(7, 7, 100.0, R0=1e3), 16, difference_gain=16.0),
    config(Mesh(5, 9, 100.0, R0=1e3), 16, "uneven points", difference_gain=12.5),
    config(Mesh(1, 1, 47.0), 20),
]


@pytest.mark.parametrize("which", range(len(CONFIGS)))
def test_fixed_equals_rtl(which):
    codes, pressed, _ = codes_of(CONFIGS[which])
    fixed, rtl = (engines.load(name).cop4(codes, CONFIGS[which]) for name in ("fixed", "rtl"))
    assert differing(fixed, rtl) == []
    assert [a.dtype for a in fixed] == [a.dtype for a in rtl]
    if CONFIGS[which].adc.bits > 8:
        assert fixed.pressed[:pressed].all() and fixed.saturated.any() and fixed.imbalance.any()


@pytest.mark.parametrize("which", range(1, len(CONFIGS)))
def test_float_is_the_same_within_a_step(which):
    """Within the twin's bounds; with a correction, whose terms are rounded to 18 bits, one part in a
    thousand."""
    given = CONFIGS[which]
    codes, pressed, answer = codes_of(given)
    fixed, floating = (engines.load(name).cop4(codes, given) for name in ("fixed", "float"))
    for name in ("pressed", "over", "saturated", "imbalance", "open"):
        assert np.array_equal(getattr(fixed, name), getattr(floating, name)), name
    volts = codes[:pressed] * given.volts_per_code
    n = (2 * given.mesh.V0 - volts[:, 0] - volts[:, 2]) / given.volts_per_code
    for name in ("x", "y"):
        ours, theirs = getattr(fixed, name)[:pressed], getattr(floating, name)[:pressed]
        assert (abs(ours - theirs) <= 1 + abs(ours) / 16384 * (1 / 8 + 8192 / n)).all()
    room = 1e-3 if given.terms else 0.5 / given.registers.kf + 0.5 / n
    assert (abs(fixed.load - floating.load)[:pressed] <= 1 + fixed.load[:pressed] * room).all()
    assert [a.dtype for a in fixed] == [a.dtype for a in floating]
    if given.adc.bits == 24 and not given.terms:
        assert np.abs(floating.x[:pressed] / 16384 - answer.x).max() < 5e-4
        assert np.abs(floating.load[:pressed] * given.load_lsb_n / answer.load - 1).max() < 1e-3


def test_float_is_the_formula_in_fractions():
    given = config(Mesh(3, 3, 64.0, R0=2048.0, k=4096.0), 12)  # constants exact in binary
    mesh, lsb = given.mesh, Fraction(given.adc.lsb_v) / Fraction(given.gain)
    codes, pressed, _ = codes_of(given, seed=4)
    result = engines.load("float").cop4(codes[: 2 * pressed], given)
    for k in np.flatnonzero(result.pressed):
        e1, e2, e3, e4 = (int(code) * lsb for code in codes[k])
        n, m, d = 30 - e1 - e3, 30 + e2 + e4, e1 + e3 - e2 - e4
        wanted = Fraction(mesh.Cx) * (e1 - e3) / n, Fraction(mesh.Cy) * (e2 - e4) / m
        for value, got in zip(wanted, (result.x[k], result.y[k])):
            assert abs(max(-1, min(1, value)) * 16384 - int(got)) <= Fraction(1, 2) + Fraction(1, 10**6)
        load = Fraction(mesh.Kf) * n / d / Fraction(given.load_lsb_n)
        assert abs(load - int(result.load[k])) <= Fraction(1, 2) + Fraction(1, 10**6)


FLAGS = [  # codes, then saturated, imbalance, open, by docs/cop4.md
    ([15000, -14500, 14000, -14500], (0, 0, 1)),
    ([14999, -14500, 14000, -14500], (0, 0, 0)),
    ([15000, -14500, 14001, -14500], (0, 0, 0)),
    ([14000, -14500, 15000, -14500], (0, 0, 4)),
    ([14501, -15001, 14501, -14001], (0, 0, 2)),
    ([14501, -15000, 14501, -14001], (0, 0, 0)),
    ([14501, -15001, 14501, -14002], (0, 0, 0)),
    ([14501, -14001, 14501, -15001], (0, 0, 8)),
    ([14010, -14000, 14010, -14000], (0, 0, 0)),
    ([14011, -14000, 14010, -14000], (0, 1, 0)),
    ([14000, -14010, 14000, -14010], (0, 0, 0)),
    ([14000, -14010, 14000, -14011], (0, 1, 0)),
    ([32766, -32766, 0, 0], (0, 0, 3)),
    ([32767, -32766, 0, 0], (1, 0, 3)),
    ([32766, -32767, 0, 0], (0, 0, 3)),
    ([32766, -32768, 0, 0], (1, 0, 3)),
]


def test_flags_by_hand():
    """Exactly at each level and one code beside it: the twin's flags, and engine float's own."""
    levels = SimpleNamespace(rail=30000, top=32767, idle=15000, busy=14000, imbalance=20)
    for codes, expected in FLAGS:
        for flags in (faults, float_cop4.flags):
            assert tuple(int(flag[0]) for flag in flags([codes], levels)) == expected, (codes, flags)


def test_float_at_and_beyond_every_limit():
    given = config()
    rail = given.registers.rail // 2
    codes = np.array([[rail, -rail] * 2, [rail + 9, -rail - 9] * 2, [0, 0, 0, 0], [-9, 9, -9, 9]])
    x, y, load, _ = float_cop4.measure(codes, given)
    assert not x.any() and not y.any()
    assert load[1] == 0 and np.isinf(load[2:]).all()
    assert engines.load("float").cop4(codes, given).load.tolist()[1:] == [0, 65535, 65535]
    edge = engines.load("float").cop4([[12000, -15000, -30000, -15000]], given)
    assert not edge.pressed[0] and np.abs(float_cop4.measure([[12000, 0, -30000, 0]], given)[0]) == 1


@pytest.mark.parametrize("touch", TOUCHES[1:])
def test_every_correction_helps_what_it_is_fitted_for(touch):
    mesh = Mesh(9, 9, 150.0)
    load = mesh_loads.touches(9, 9, touch, seed=2, total=10.0)[:50]
    answer, true = mesh.solve(load), mesh_loads.true_centre(load)[0]
    volts = np.stack([answer.E1, answer.E2, answer.E3, answer.E4], axis=1)
    plain, fixed = config(mesh, 24), config(mesh, 24, touch)
    before, after = (
        np.abs(engines.load("fixed").cop4(one.convert(volts), one).load * 1e-3 / true - 1).mean()
        for one in (plain, fixed)
    )
    assert after < before / 3
    assert plain.terms is plain.fix is None and fixed.terms is not None


def test_what_the_command_writes():
    given = config(bits=12)
    codes, *_ = codes_of(given)
    result = engines.process_cop4(codes, given, "fixed")
    assert {name: values.dtype.str[1:] for name, values in result.items()} == {
        **{"x": "i4", "y": "i4", "load": "i8", "valid": "b1"}
    }
    valid = result["valid"]
    assert not result["x"][~valid].any() and not result["y"][~valid].any()


def test_least_load():
    given = config(Mesh(5, 5, 47.0), 24, min_load_n=2.0)
    load = np.zeros((3, 5, 5))
    load[:, 2, 2] = 1.9, 2.1, 0.0
    answer = given.mesh.solve(load)
    codes = given.convert(np.stack([answer.E1, answer.E2, answer.E3, answer.E4], axis=1))
    for name in engines.NAMES:
        assert engines.process_cop4(codes, given, name)["valid"].tolist() == [False, True, False], name


def test_a_short_recording_and_a_long_one():
    given = config()
    codes, *_ = codes_of(given)
    many = np.tile(codes, (50, 1))
    for batch in (codes[:1], many):
        fixed, rtl = (engines.load(name).cop4(batch, given) for name in ("fixed", "rtl"))
        assert differing(fixed, rtl) == [] and len(rtl.x) == len(batch)


def test_refuses_configurations():
    for message, change in (
        ("bits", {"bits": 7}),
        ("correction", {"touch": "palm"}),
        ("too small|too large", {"load_lsb_n": 1e-12}),
        ("min_n", {"min_load_n": 1e5}),
        ("imbalance = 4 must lie in|leaves no room", {"mesh": Mesh(5, 5, 47.0, V0=20.0)}),
    ):
        with pytest.raises(ValueError, match=message):
            config(**change)


def test_the_example_of_the_documentation_is_the_published_mesh():
    given = cop4_file.load(EXAMPLE)
    assert repr(given.mesh) == repr(Mesh(41, 41, 10.0)) and given.touch == "none"
    assert given.sample_bits == 24 and replace(given, adc=Adc(12, -5.0, 5.0)).sample_bits == 17
