"""Experiments of the four-wire sensors' papers, worked out by hand: a stroke on a cover, a cycle with
hysteresis, sheets with elements cut out."""

import numpy as np
import pytest

from published import _mesh, _net


def test_a_cover_s_radius_turns_the_circle():
    round_by = {radius: 100 * locus["roundness"] for radius, (locus, _) in _mesh.covers().items()}

    # By hand, R = 1: on the axis the force is sqrt(0.75) pitches high, halfway from the middle to the edge's
    # taxel; the far column, the middle and the near one each have one taxel on the axis and two beside it.
    def column(d2):
        return sum(count * (1 + (d2 + beside) / 0.75) ** -2.5 for count, beside in ((1, 0), (2, 1)))

    far, near = column(2.25), column(0.25)
    on_axis = (near - far) / (far + 2 * near)
    assert _mesh.covers()[1.0][1].x[0] == pytest.approx(on_axis, abs=0.01)  # r = 47: the layers' voltage drop
    assert [round(round_by[radius], 2) for radius in (0.8, 1.0, 1.5, 2.0)] == [25.51, 11.0, 0.04, 1.33]


def test_the_loop_closes_and_is_as_wide_as_its_share():
    """Falling at half the force, ln F is ln 2 < 1 below its peak: the load differs by all of that times the
    share."""
    _, force_n, load = _net.cycle()
    quarter = len(load) // 4
    up, down = load[2 * quarter : 3 * quarter], load[3 * quarter :][::-1]
    at = int(np.argmin(np.abs(force_n[2 * quarter : 3 * quarter] - 1.5)))
    assert down[at] / up[at] == pytest.approx(2**_net.HYSTERESIS, rel=0.015)  # less the layers' voltage drop
    assert (down - up).min() > -1e-9 and down[-1] == pytest.approx(up[-1], rel=2e-3)


def test_sheets_with_elements_cut_out():
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
