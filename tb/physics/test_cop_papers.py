"""The pages' modules of the four-wire sensors: the papers' numbers are as printed, ours are as worked out
here by hand or by another method; every constant that a row refers to exists; pictures are small enough for a
phone."""

import math

import numpy as np
import pytest

from meissner.physics import grip
from published import Row, Table, _mesh, _net, cop_slip_and_net


def rows(parts):
    return {(part.figure, part.what): part for part in parts if isinstance(part, Row)}


def find(parts, figure, start=""):
    (row,) = [row for (where, what), row in rows(parts).items() if where == figure and what.startswith(start)]
    return row


@pytest.fixture(scope="module")
def mesh():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(_mesh, "DRAWS", 100)
        return _mesh.compute()


@pytest.fixture(scope="module")
def net():
    return _net.compute()


@pytest.fixture(scope="module")
def slip():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cop_slip_and_net, "SEEDS", range(1, 2))
        patch.setattr(cop_slip_and_net._net, "compute", list)
        return cop_slip_and_net.compute()


def test_r0_and_one_code(mesh):
    """By hand: I R0 = 30 c/(1+c) V with c = R0/864 ohms, without the layers' voltage drop; one code is 31.5
    V/65536, and x is Cx times it over I R0; half of that is its share of the range, -1 to 1."""
    for r0, share in ((1e3, 0.00311), (10e3, 0.0179)):
        across = (2 * 41 * r0 / 10 + 42) / 40
        n_v = 30 * (r0 / 864) / (1 + r0 / 864)
        assert _mesh.resolved(r0)[0] == pytest.approx(across * 31.5 / 65536 / n_v / 2, rel=0.02)
        assert _mesh.resolved(r0)[0] == pytest.approx(share, rel=2e-3)
    ours = find(mesh, "IV-D", "R0 and signal").ours
    assert "1.79 % of the range at 10 kΩ" in ours and "0.311 % at 1 kΩ" in ours


def test_the_position_settles_by_hand():
    """f/(f + a) = 0.95/(1 + a), t = -tau ln(1 - f): for a = 0.1 at f = 0.6333, for a = 1 at 0.9048."""
    for rest_n, f in ((0.5, 0.6333), (5.0, 0.9048)):
        wanted = -0.2e-3 * math.log(1 - f)
        assert _mesh.blow(rest_n)[2] == pytest.approx(wanted, rel=0.03)
        assert _mesh.rubber_for(rest_n) == pytest.approx(0.6e-3 * 0.6e-3 / wanted, rel=0.03)
    assert _mesh.blow(0.0)[2] <= 2 / _mesh.RATE_HZ and _mesh.rubber_for(0.0) is None


def test_a_cover_s_radius_turns_the_circle(mesh):
    round_by = {radius: 100 * locus["roundness"] for radius, (locus, _) in _mesh.covers().items()}

    # By hand, R = 1: on the axis the force is sqrt(0.75) pitches high, halfway from the middle to the edge's
    # taxel; the far column, the middle and the near one each have one taxel on the axis and two beside it.
    def column(d2):
        return sum(count * (1 + (d2 + beside) / 0.75) ** -2.5 for count, beside in ((1, 0), (2, 1)))

    far, near = column(2.25), column(0.25)
    on_axis = (near - far) / (far + 2 * near)
    assert _mesh.covers()[1.0][1].x[0] == pytest.approx(on_axis, abs=0.01)  # r = 47: the layers' voltage drop
    assert [round(round_by[radius], 2) for radius in (0.8, 1.0, 1.5, 2.0)] == [25.51, 11.0, 0.04, 1.33]
    table = next(part for part in mesh if isinstance(part, Table) and part.title.startswith("The cover"))
    assert dict((row[0], row[2]) for row in table.rows)["1.5"] == "0.0449 %"


def test_two_points_go_with_the_current_s_shares(net):
    x, centre, straight = _net.two_points(r=1e-3)
    assert x == pytest.approx(centre, abs=1e-5)  # 3 N against F: (3-F)/(3+F)
    assert straight[3] == 0.5 and centre[3] == pytest.approx(1 / 3)
    assert _net.two_points()[0][3] == pytest.approx(0.314, abs=5e-4)
    assert find(net, "fig. 9").ours.startswith("0.314 of the half range")


def test_the_loop_closes_and_is_as_wide_as_its_share(net):
    """Falling at half the force, ln F is ln 2 < 1 below its peak: the load differs by all of that times the
    share."""
    _, force_n, load = _net.cycle()
    quarter = len(load) // 4
    up, down = load[2 * quarter : 3 * quarter], load[3 * quarter :][::-1]
    at = int(np.argmin(np.abs(force_n[2 * quarter : 3 * quarter] - 1.5)))
    assert down[at] / up[at] == pytest.approx(2**_net.HYSTERESIS, rel=0.015)  # less the layers' voltage drop
    assert (down - up).min() > -1e-9 and down[-1] == pytest.approx(up[-1], rel=2e-3)


def test_sheets_with_elements_cut_out(net):
    """Four corners missing: layer A is a chain of four resistors from E1 through three elements to E3. With
    the last one pressed, the path to E1 is 3r + R0 and to E3 r + R0: E1-E3 = R0 I 2r/(2 R0 + 4r). The
    complete mesh's constant, (6 R0/r + 4)/2, makes nearly 3 of it."""
    _, found, gains, plain, fitted = _net.pressed(*_net.CUTS["3×3, all four corners"])
    r0 = 1e4 / 150
    wanted = (6 * r0 + 4) / 2 * 2 / (2 * r0 + 4)
    assert found.x.max() == pytest.approx(wanted, rel=1e-9)
    assert gains == pytest.approx([1 / wanted] * 2) and fitted.max() < 1e-9
    assert plain.max() == pytest.approx((wanted - 1) / 2)
    assert _net.pressed(*_net.CUTS["3×3, none"])[3].max() < 1e-9


def test_what_cop_slip_finds(slip):
    assert find(slip, "fig. 4 (a)").difference == "between the two"
    assert "0 of 7 runs" in find(slip, "III-A", "flag before").ours
    ours = find(slip, "III-A", "a layer of silicone").ours
    assert ours.startswith("0.2 mm of silicone: 2.0") or ours.startswith("0.2 mm of silicone: 1.9")
    assert "7 of 7 pulls" in find(slip, "III-A", "flags of the two").ours
    assert "2.05 V: restored" in find(slip, "figs. 6-8").ours  # 2 + 1.01 exp(-3), plus its rise meanwhile
    tables = {part.title: part for part in slip if isinstance(part, Table)}
    one = next(part for title, part in tables.items() if title.startswith("Voltage step"))
    # 2 V: k = 1.55 - 0.54 = 1.01, times 0.05^0.11, 0.1^0.11 and 1.
    assert [row[3] for row in one.rows] == ["0.73 V", "0.78 V", "1.01 V"]
    assert [row[1] for row in one.rows] == ["1.4 V", "1.6 V", "2.1 V"]
    cover = tables["CoP slip with a cover"]
    assert [row[0] for row in cover.rows] == ["0 mm", "0.2 mm", "0.6 mm"] and grip.LEVER_MM == 0.2
    assert sum(row.ours == "no counterpart" for row in rows(slip).values()) == 5
