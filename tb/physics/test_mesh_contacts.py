"""Large meshes with few contacts: computing the contacts alone gives the same as all the network's equations.

Space: one layer's response by rows of modes against the closed form at 50 digits, near and far, on one line
and at both electrodes; a rectangle against nodal equations written here from docs/mesh.md; frames of many
taxels with few contacts; contacts given without a frame.
"""

import mpmath
import numpy as np
import pytest

from meissner.physics.mesh import Mesh, green, lines
from meissner.physics.mesh.apart import Apart
from meissner.physics.mesh.touched import LARGE, LINE


def response(free, along, pull, one, other):
    """The drop at ``one`` per ampere at ``other``, in units of r: the header of green.py at 50 digits."""
    with mpmath.workdps(50):
        (i, j), (k, n) = (map(mpmath.mpf, place) for place in (one, other))
        low, high, end = min(j, n) + 1, max(j, n) + 1, along + 1
        total = (low * (end - high) + (low - mpmath.mpf(end) / 2) * (high - mpmath.mpf(end) / 2) * pull) / (
            end * free
        )
        for p in range(1, free):
            t = 2 * mpmath.asinh(mpmath.sin(mpmath.pi * p / (2 * free)))
            g = mpmath.sinh(t * low) * mpmath.sinh(t * (end - high)) / mpmath.sinh(t) / mpmath.sinh(t * end)
            turned = [mpmath.cos(mpmath.pi * p * (place + mpmath.mpf(1) / 2) / free) for place in (i, k)]
            total += 2 * turned[0] * turned[1] * g / free
        return total


SIZES = (9, 83), (2, 130), (1, 40), (60, 1), (31, 47), (60, 30), (61, 30)


@pytest.mark.parametrize("free, along", SIZES)
@pytest.mark.parametrize("limit", [0, 3_000_000])
def test_large_layers_equal_the_closed_form(monkeypatch, free, along, limit):
    """By rows of modes, and by distance if the layer is no more than twice as wide as it is long."""
    monkeypatch.setattr(green, "TABLE_LIMIT", 0)
    monkeypatch.setattr(green, "APART_LIMIT", limit)
    layer, pull = green.Layer(free, along, 0.75), mpmath.mpf(3) / 4
    by_distance = bool(limit) and (free, along) not in ((60, 1), (61, 30))
    assert layer.by_distance == by_distance and isinstance(layer.large, Apart if by_distance else lines.Lines)
    # Both electrodes, one line twice, neighbours, and a distance that no mode except the ladder reaches.
    columns = [0, along - 1, along // 2, along // 2, min(along // 2 + 1, along - 1), along // 3]
    rows = [0, free - 1, 0, free - 1, free // 2, free // 3]
    got = layer.between(np.array([rows, rows[::-1]]), np.array([columns, columns]))
    for scene, across in zip(got, (rows, rows[::-1])):
        places = list(zip(across, columns))
        want = [[response(free, along, pull, one, other) for other in places] for one in places]
        own = [float(want[k][k]) for k in range(6)]
        for k in range(6):
            for n in range(6):
                most = layer.rounding * np.sqrt(own[k] * own[n]) * 2
                assert abs(float(want[k][n] - mpmath.mpf(scene[k, n]))) <= most


def nodal(m, n, r, R0, k, load):
    """E1..E4 for V0 = 1 by Kirchhoff's law at each node of the sheet in docs/mesh.md."""
    size = 2 * m * n + 4
    G, current = np.zeros((size, size)), np.zeros(size)

    def join(p, q, conductance):
        G[p, p] += conductance
        G[q, q] += conductance
        G[p, q] -= conductance
        G[q, p] -= conductance

    def node(layer, i, j):
        return layer * m * n + i * n + j

    for layer in (0, 1):
        for i in range(m):
            for j in range(n):
                if j + 1 < n:
                    join(node(layer, i, j), node(layer, i, j + 1), 1 / r)
                if i + 1 < m:
                    join(node(layer, i, j), node(layer, i + 1, j), 1 / r)
    E1, E2, E3, E4 = range(2 * m * n, size)
    for i in range(m):
        join(E1, node(0, i, 0), 1 / r)
        join(E3, node(0, i, n - 1), 1 / r)
    for j in range(n):
        join(E2, node(1, 0, j), 1 / r)
        join(E4, node(1, m - 1, j), 1 / r)
    for i, j in np.argwhere(load > 0):
        join(node(0, i, j), node(1, i, j), load[i, j] / k)
    for electrode, volts in ((E1, 1), (E2, -1), (E3, 1), (E4, -1)):
        G[electrode, electrode] += 1 / R0
        current[electrode] += volts / R0
    return np.linalg.solve(G, current)[-4:]


@pytest.mark.parametrize("m, n", [(5, 61), (47, 7), (19, 23)])
@pytest.mark.parametrize("limit", [0, 3_000_000])
def test_a_rectangle_equals_its_nodal_equations(monkeypatch, m, n, limit):
    monkeypatch.setattr(green, "TABLE_LIMIT", 0)
    monkeypatch.setattr(green, "APART_LIMIT", limit)
    load = np.zeros((m, n))
    for place, force in zip(
        ((0, 0), (m - 1, n - 1), (1, 3), (2, n - 2), (m // 2, n // 2)), (1, 2.5, 4, 0.5, 9)
    ):
        load[place] = force
    got = Mesh(m, n, r=150.0, R0=700.0, V0=1.0, k=4320.0).solve(load, "fast")
    want = nodal(m, n, 150.0, 700.0, 4320.0, load)
    assert np.allclose([got.E1, got.E2, got.E3, got.E4], want, rtol=0, atol=1e-12)


def test_contacts_alone_are_the_frame():
    mesh = Mesh(301, 402, r=47.0)
    places = np.array([[0, 0], [300, 401], [150, 7], [150, 399], [3, 7]])
    force = np.array([[3.0, 1.0, 1e12, 0.25, 6.0], [1.0, 0.0, 5.0, 2.0, 8.0]])
    frame = np.zeros((2, 301, 402))
    frame[:, places[:, 0], places[:, 1]] = force
    both = mesh.solve(frame)
    one = mesh.press(*np.broadcast_to(places.T[:, None], (2, 2, 5)), force)
    mixed = mesh.press(*places[[4, 2, 0, 3, 1]].T, force[0, [4, 2, 0, 3, 1]])
    for name in ("E1", "E2", "E3", "E4", "x", "y", "load", "current"):
        assert np.array_equal(getattr(both, name), getattr(one, name))
        assert getattr(mixed, name) == getattr(both, name)[0]
    assert one.solver.tolist() == ["fast", "fast"] and mixed.solver == "fast"
    small = Mesh(3, 4, r=47.0)
    sparse = small.press([[2, 0], [1, 1]], [[1, 3], [0, 2]], [[4.0, 1.0], [2.0, 7.0]], "lu")
    load = np.zeros((2, 3, 4))
    load[0, 2, 1], load[0, 0, 3], load[1, 1, 0], load[1, 1, 2] = 4.0, 1.0, 2.0, 7.0
    assert np.array_equal(sparse.load, small.solve(load, "lu").load) and sparse.solver.tolist() == [
        "lu",
        "lu",
    ]
    assert not small.press([], [], []).valid


@pytest.mark.parametrize(
    "row, column, force, words",
    [
        ([3], [0], [1.0], "row"),
        ([0], [-1], [1.0], "column"),
        ([0.5], [0], [1.0], "row"),
        ([0, 1], [0], [1.0], "shapes"),
        ([1, 1], [2, 2], [1.0, 3.0], "twice"),
        ([0], [0], [-1.0], "negative"),
        ([0], [0], [np.nan], "NaN"),
        ([0], [0], ["press"], "newtons"),
    ],
)
def test_impossible_contacts_are_refused(row, column, force, words):
    with pytest.raises(ValueError, match=words):
        Mesh(3, 4, 10.0).press(row, column, force)


@pytest.mark.parametrize("rows", [LARGE // 97 - 1, LARGE // 97 + 1, 5 * LARGE // 97])
def test_few_taxels_of_a_large_frame_are_found(rows):
    """Just below and above the size from which frames are searched in lines; the last taxel, in an incomplete
    line."""
    mesh = Mesh(rows, 97, 10.0)
    load = np.zeros((rows, 97))
    load[0, 1], load[-1, -1], load[LINE // 97, LINE % 97] = 2.0, 1.0, 3.0
    load[7, 7] = -0.0
    assert mesh.solve(load, "constant").load == pytest.approx(6.0, rel=1e-14)
    load[rows // 2, 5] = 5e-324  # k / F overflows, so it is open
    assert mesh.solve(load, "constant").load == pytest.approx(6.0, rel=1e-14)
    refused = {np.nan: "NaN", -1e-300: "negative", -np.inf: "negative", np.inf: "at most", 1.1e12: "at most"}
    for wrong, words in refused.items():
        for place in ((rows // 2, 5), (rows - 1, 96)):
            bad = load.copy()
            bad[place] = wrong
            with pytest.raises(ValueError, match=words):
                mesh.solve(bad)


def test_the_same_taxels_with_another_force_are_not_computed_again(monkeypatch):
    mesh, calls = Mesh(200, 201, 10.0), []
    between = green.Layer.between
    monkeypatch.setattr(green.Layer, "between", lambda *a: (calls.append(1), between(*a))[1])
    first = [mesh.press([3, 190], [4, 100], [force, 2.0]).load for force in (1.0, 3.0)]
    assert len(calls) == 2  # one per layer
    mesh.press([3, 190], [5, 100], [1.0, 2.0])
    assert len(calls) == 4
    assert [Mesh(200, 201, 10.0).press([3, 190], [4, 100], [f, 2.0]).load for f in (1.0, 3.0)] == first
    for row in range(20):
        mesh.press([row], [0], [1.0])
    assert len(mesh.kept) <= 8


@pytest.mark.parametrize("pair", [((0, 0), (0, 0)), ((1023, 1023), (1022, 1023)), ((3, 700), (1000, 699))])
def test_a_thousand_lines_equal_the_closed_form(pair):
    """Both corners, where the differences cancel most, and two contacts on neighbouring lines far apart."""
    layer, (one, other) = green.Layer(1024, 1024, 0.75), pair
    assert layer.by_distance
    got = layer.between(np.array([one[0], other[0]]), np.array([one[1], other[1]]))[0, 1]
    want = response(1024, 1024, mpmath.mpf(3) / 4, one, other)
    assert abs(float(want - mpmath.mpf(got))) <= 32 * green.UNIT * layer.terms()[0]


def test_a_bound_of_distances_holds_all_their_terms():
    """For each pair in a row: |T| of the four look-ups and the ladder, summed, is below sqrt(terms
    terms')."""
    layer = green.Layer(130, 120, 0.75)
    one, other = np.meshgrid(np.arange(120), np.arange(120), indexing="ij")
    table, low, high = layer.large.table, np.minimum(one, other) + 1, np.maximum(one, other) + 1
    near = np.minimum(low + high, 2 * 121 - low - high)
    worst = layer.ladder(low, high) + 2 * abs(table).max(0)[high - low] + 2 * abs(table).max(0)[near]
    assert layer.by_distance and (worst <= np.sqrt(layer.terms()[one] * layer.terms()[other])).all()


@pytest.mark.parametrize("kind", ["f4", "f2", "u2", "u1", "i4", "u8"])
@pytest.mark.parametrize("side", [7, 211])
def test_a_frame_of_narrow_numbers_is_the_frame_of_newtons(kind, side):
    """Forces that each type holds exactly; 211 x 211 is searched in lines, 7 x 7 is solved by LU too."""
    load = np.zeros((2, side, side))
    load[0, 0, 1], load[0, -1, -1], load[1, side // 2, 3], load[1, 0, 0] = 2.0, 1.0, 255.0, 7.0
    got, want = (Mesh(side, side, 47.0).solve(frame, "auto") for frame in (load.astype(kind), load))
    assert np.array_equal(got.load, want.load) and np.array_equal(got.x, want.x) and want.valid.all()
    sparse = Mesh(7, 7, 47.0).solve(load[:, :7, :7].astype(kind), "lu").load
    assert np.array_equal(sparse, Mesh(7, 7, 47.0).solve(load[:, :7, :7], "lu").load)
    if kind[0] in "fi":
        load[1, side // 2, 4] = -1
        with pytest.raises(ValueError, match="negative"):
            Mesh(side, side, 47.0).solve(load.astype(kind))
