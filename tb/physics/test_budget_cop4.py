"""The resolution budget of a four-wire sensor against brute force: solved circuits whose electrodes are
converted one by one, every corner of the converter's errors, and the core's twin on the codes. Square, narrow
and tiny meshes, 8 to 24 bits, with and without difference amplifiers; loads so large or so small that nothing
is resolved; one row, one column, one taxel; the command's output, picture and refusals."""

import itertools
import json
import re

import numpy as np
import pytest

from harness.command import meissner
from meissner.budget import cop4 as budget
from meissner.budget import cop4_report
from meissner.physics.adc import Adc
from meissner.physics.cop4_registers import cop4_registers
from meissner.physics.mesh import Mesh
from meissner.twins.cop.cop4 import cop4

MESHES = [Mesh(41, 41, 10.0), Mesh(5, 5, 47.0), Mesh(3, 7, 150.0, R0=4.7e3)]


def scenes(mesh, count=3000, seed=1):
    """Single points anywhere with 0.5 to 20 N, solved."""
    rng = np.random.default_rng(seed)
    load = np.zeros((count, mesh.m, mesh.n))
    place = rng.integers(mesh.m, size=count), rng.integers(mesh.n, size=count)
    load[np.arange(count), *place] = 0.5 * 40.0 ** rng.random(count)
    return mesh.solve(load, "fast")


def converter(mesh, bits):
    return Adc(bits, -budget.ROOM * mesh.V0, budget.ROOM * mesh.V0)


def read(mesh, solution, bits, gain):
    """The converted volts of E1..E4 and of both differences, amplified if there are amplifiers."""
    adc = converter(mesh, bits)
    volts = np.stack([solution.E1, solution.E2, solution.E3, solution.E4])
    e = adc.volts_of(adc.convert(volts)[0])
    if gain == 1:
        return *e, e[0] - e[2], e[1] - e[3]
    differences = volts[0] - volts[2], volts[1] - volts[3]
    assert max(np.abs(d).max() for d in differences) * gain < adc.high_v
    return *e, *(adc.volts_of(adc.convert(gain * d)[0]) / gain for d in differences)


def formula(mesh, e1, e2, e3, e4, dx, dy):
    """The published equations on voltages."""
    v = 2 * mesh.V0
    x, y = mesh.Cx * dx / (v - e1 - e3), mesh.Cy * dy / (v + e2 + e4)
    return np.clip(x, -1, 1), np.clip(y, -1, 1), mesh.Kf * (v - e1 - e3) / (e1 + e3 - e2 - e4)


@pytest.mark.parametrize("bits, gain", [(12, 1), (16, 1), (20, 1), (10, 4), (12, 9.5), (16, 64)])
@pytest.mark.parametrize("mesh", MESHES, ids=repr)
def test_converted_circuits_lie_within_the_budget_and_reach_it(mesh, bits, gain):
    gain = min(gain, 0.9 * budget.greatest_gain(mesh))
    s = scenes(mesh)
    got = formula(mesh, *read(mesh, s, bits, gain))
    q, n = budget.code_v(mesh, bits), s.current * mesh.R0
    d = mesh.Kf * n / s.load
    cases = [
        (np.abs(got[0] - s.x), budget.position(mesh.Cx, s.x, n, q, gain)),
        (np.abs(got[1] - s.y), budget.position(mesh.Cy, s.y, n, q, gain)),
        (np.abs(got[2] / s.load - 1), budget.load(mesh.Kf, n, d, q)),
    ]
    for wrong, (step, greatest, rms) in cases:
        assert (wrong <= greatest * (1 + 1e-9) + 1e-10).all()
        assert (wrong / greatest).max() > 0.8
        # Only where the errors are small and x, y do not saturate.
        free = (greatest < 0.2) & (np.abs(s.x) + greatest < 1) & (np.abs(s.y) + greatest < 1)
        for C, at in ((mesh.Cx, s.x), (mesh.Cy, s.y)):  # otherwise E1 and E3 share their code and error
            free &= np.abs(at) * n / C > 2 * q
        if free.sum() > 500:
            assert np.sqrt(np.mean((wrong / rms)[free] ** 2)) == pytest.approx(1, abs=0.1)
        assert (rms < greatest).all() and (step < 2.1 * greatest).all()


@pytest.mark.parametrize(
    "bits, gain, pairs",
    [(8, 1, False), (14, 1, False), (12, 16, False), (24, 4, False), (12, 16, True), (9, 5, True)],
)
def test_budget_is_the_worst_corner_of_the_worst_place(bits, gain, pairs):
    """All sixteen (or, amplified on channels of their own, sixty-four) corners of the errors, added to the
    voltages of the reference solver; with pairs, to half a sum and g half differences."""
    mesh = Mesh(7, 12, 30.0)
    found = budget.budget(mesh, bits, gain, 3.0, pairs=pairs)
    h = budget.code_v(mesh, bits) / 2
    rows, columns = (0, 2, 3, 4, 6), (0, 3, 6, 8, 11)
    for row in found["loads"]:
        worst = np.zeros(3)
        for place in itertools.product(rows, columns):
            load = np.zeros((7, 12))
            load[place] = row["load_n"]
            s = mesh.solve(load, "lu")
            corners = np.array(list(itertools.product((-h, h), repeat=6))).T
            e = np.array([s.E1, s.E2, s.E3, s.E4])[:, None] + corners[:4]
            if gain == 1:
                dx, dy = e[0] - e[2], e[1] - e[3]
            elif pairs:
                half = gain * (s.E1 - s.E3) / 2, gain * (s.E2 - s.E4) / 2
                mean = (s.E1 + s.E3) / 2, (s.E2 + s.E4) / 2
                e = np.array([mean[0] + half[0], mean[1] + half[1], mean[0] - half[0], mean[1] - half[1]])
                e = e[:, None] + corners[:4]
                dx, dy = (e[0] - e[2]) / gain, (e[1] - e[3]) / gain
            else:
                dx, dy = s.E1 - s.E3 + corners[4] / gain, s.E2 - s.E4 + corners[5] / gain
            x, y, newtons = formula(mesh, *e, dx, dy)
            wrong = np.abs(x - s.x) / 2, np.abs(y - s.y) / 2, np.abs(newtons / s.load - 1)
            worst = np.maximum(worst, [w.max() for w in wrong])
        wanted = [row[what]["greatest"] for what in ("x", "y", "load")]
        assert wanted == pytest.approx(worst, rel=1e-5)
        assert found["places"] == 25


@pytest.mark.parametrize("bits, gain", [(12, 1), (16, 1), (20, 1), (12, 16), (16, 16)])
@pytest.mark.parametrize("mesh", MESHES[:2], ids=repr)
def test_the_core_adds_only_its_rounding(mesh, bits, gain):
    """msn_cop4's twin on the codes. Amplified differences are combined as g (c1 + c3) +- d, steps of q/2g."""
    s = scenes(mesh, 500, seed=2)
    adc = converter(mesh, bits)
    c = np.stack([adc.convert(e)[0] for e in (s.E1, s.E2, s.E3, s.E4)], axis=1)
    wide = adc
    if gain > 1:
        dx, dy = (adc.convert(gain * (a - b))[0] for a, b in ((s.E1, s.E3), (s.E2, s.E4)))
        upper, lower = gain * (c[:, 0] + c[:, 2]), gain * (c[:, 1] + c[:, 3])
        c = np.stack([upper + dx, lower + dy, upper - dx, lower - dy], axis=1)
        wide = converter(mesh, bits + 1 + gain.bit_length() - 1)
    got = cop4(c, cop4_registers(mesh, wide, load_lsb=1e-3, sample_bits=24), 24)
    assert got.pressed.all()
    q, n = budget.code_v(mesh, bits), s.current * mesh.R0
    codes = n / wide.lsb_v
    for C, ours, at in ((mesh.Cx, got.x, s.x), (mesh.Cy, got.y, s.y)):
        core = (0.5 + np.abs(ours / 16384) * (1 / 8 + 8192 / (codes - 2 * gain))) / 16384
        assert (np.abs(ours / 16384 - at) <= budget.position(C, at, n, q, gain)[1] + core + 1e-9).all()
    greatest = budget.load(mesh.Kf, n, mesh.Kf * n / s.load, q)[1]
    assert (np.abs(got.load * 1e-3 / s.load - 1) <= greatest + 0.5e-3 / s.load + 1 / codes + 1e-5).all()


def test_a_pair_of_amplifiers_by_hand():
    """C = 20 at 0.25 of 1 V, codes of 1 mV, g = 4. One code half a step up, the other down: 20 (0.0125 +
    0.00025) is 0.005 off; both up: 0.25/0.999, less. Two more channels: (0.25 + 20 0.5/4 mV)/0.999. A step is
    20 mV/4 / 1 V."""
    given = 20.0, np.array([0.25]), np.array([1.0]), 1e-3, 4
    rms = 1e-3 / 12**0.5 * (5.25**2 + 4.75**2) ** 0.5
    assert budget.position(*given, pairs=True)[:, 0] == pytest.approx([5e-3, 5e-3, rms])
    assert budget.position(*given)[1, 0] == pytest.approx(0.2525 / 0.999 - 0.25)
    mesh = Mesh(7, 7, 100.0, R0=1e3)
    assert budget.greatest_gain(mesh, 5.0, pairs=True) == mesh.Cx == pytest.approx(24.7, abs=0.05)


def test_bits_and_gain_buy_resolution():
    found = budget.budget(Mesh(41, 41, 10.0))
    rows = {(row["bits"], row["gain"]): row for row in found["sweep"]}
    # One code of E1 - E3 moves x by Cx / N.
    assert rows[16, 1]["x"]["step"] == pytest.approx(2051.05 * found["code_v"] / 27.57 / 2, rel=1e-2)
    for (bits, gain), row in rows.items():
        assert row["x"] == pytest.approx(row["y"], rel=1e-9)  # a square mesh
        if bits > 12 and (bits, 4 * gain) in rows and gain < 64:
            assert rows[bits, 4 * gain]["x"]["greatest"] < 0.5 * row["x"]["greatest"]
        if bits > 12 and (bits + 2, gain) in rows:
            assert rows[bits + 2, gain]["x"]["greatest"] == pytest.approx(row["x"]["greatest"] / 4, rel=0.02)
            assert rows[bits + 2, gain]["load"]["greatest"] < 0.3 * row["load"]["greatest"]
    for need in found["needed"]:
        assert 8 <= need["bits"] <= 24
        below = budget.budget(Mesh(41, 41, 10.0), need["bits"], need["gain"])["loads"]
        assert next(row for row in below if row["load_n"] == 5)["x"]["greatest"] < found["half_pitch"]
    assert [need["bits"] for need in found["needed"]] == sorted(
        (n["bits"] for n in found["needed"]), reverse=True
    )


def test_the_most_bits_are_asked_for_too(monkeypatch):
    mesh = Mesh(5, 5, 47.0)
    bits = budget.budget(mesh)["needed"][0]["bits"]
    for most, needed in ((bits, bits), (bits - 1, None)):
        monkeypatch.setattr(budget, "BITS", (4, most))
        assert budget.budget(mesh, bits=most)["needed"][0] == {"gain": 1, "bits": needed}


@pytest.mark.parametrize("m, n", [(1, 1), (1, 9), (9, 1), (2, 2), (1024, 1024)])
def test_every_size_has_an_answer(m, n):
    found = budget.budget(Mesh(m, n, 10.0))
    text = json.dumps(found, allow_nan=False)
    assert found["places"] == min(m, 5) * min(n, 5) and "loads" in text
    for row in found["loads"]:
        assert (row["x"]["greatest"] == 0) == (n == 1) and (row["y"]["greatest"] == 0) == (m == 1)
    assert (found["half_pitch"] is None) == (m == n == 1) == (not found["needed"])
    assert all(isinstance(line, str) for line in cop4_report.tell(found))


def test_a_load_that_drowns_is_not_resolved():
    found = budget.budget(Mesh(5, 5, 1e-3), 8, 1, 1e5)  # 0.04 ohms: D is far below a code
    assert found["loads"][-1]["load"]["greatest"] is None
    assert "none" in "\n".join(cop4_report.tell(found))
    faint = budget.budget(Mesh(5, 5, 10.0), 8, 1, 1e-3)  # so little current that N is below one code
    assert faint["loads"][0]["x"]["greatest"] == pytest.approx(1.0)
    # Errors as large as the divisor: the result is undefined.
    assert budget.position(2.0, np.array([0.5]), np.array([0.9]), 1.0, 1)[1] == [1.5]
    assert budget.position(2.0, np.array([0.5]), np.array([0.9]), 1.0, 4)[1] == [1.5]
    assert budget.load(1.0, np.array([10.0]), np.array([1.5]), 1.0)[1] == [np.inf]
    with pytest.raises(ValueError, match="cannot be measured"):
        budget.solve(Mesh(5, 5, 10.0), 1e-320)


def test_the_command_prints_and_draws(tmp_path):
    done = meissner(
        "budget", "--cop4", "--rows", 5, "--cols", 7, "--r", 47, "--json", "--out", "new/folder", cwd=tmp_path
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout) == budget.budget(Mesh(5, 7, 47.0))
    assert (tmp_path / "new/folder/budget_cop4.png").stat().st_size > 30_000
    done = meissner("budget", "--cop4", "--out", "one.png", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "17 bits at gain 1, 14 bits at gain 4" in done.stdout and "picture: one.png" in done.stdout
    assert re.match(
        r"at 5 N, a position error below half a taxel's pitch .* needs: 17 bits at gain 1", done.stdout
    )
    assert (tmp_path / "one.png").read_bytes().startswith(b"\x89PNG")
