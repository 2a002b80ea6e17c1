"""A mesh with parts missing against plain nodal analysis in exact fractions, written from docs/mesh.md alone;
against the complete mesh's solver; and the extremes of missing parts."""

from fractions import Fraction

import numpy as np
import pytest

from meissner.physics.mesh import Mesh
from meissner.physics.mesh.cut import CutMesh

R, R0, V0, K = 47, 10_000, 15, 4320


def by_hand(m, n, load, gone=(), bare=(), cut=()):
    """E1..E4 in volts: Kirchhoff's current law at every node, one equation each, solved by elimination.

    ``gone``, ``bare``: (row, column); ``cut``: pairs of nodes, ("A" or "B", row, column) or ("E1",) ..
    ("E4",).
    """
    wires = []  # (node, node, siemens)
    for i in range(m):
        for j in range(n):
            for layer in "AB":
                if j + 1 < n:
                    wires.append(((layer, i, j), (layer, i, j + 1), Fraction(1, R)))
                if i + 1 < m:
                    wires.append(((layer, i, j), (layer, i + 1, j), Fraction(1, R)))
            if load[i][j] and (i, j) not in bare:
                wires.append((("A", i, j), ("B", i, j), Fraction(load[i][j]) / K))
    for i in range(m):
        wires += [(("E1",), ("A", i, 0), Fraction(1, R)), (("E3",), ("A", i, n - 1), Fraction(1, R))]
    for j in range(n):
        wires += [(("E2",), ("B", 0, j), Fraction(1, R)), (("E4",), ("B", m - 1, j), Fraction(1, R))]
    for name in ("E1", "E2", "E3", "E4"):
        wires.append(((name,), ("+" if name in ("E1", "E3") else "-",), Fraction(1, R0)))
    lost = {(layer, i, j) for i, j in gone for layer in "AB"}
    cut = {frozenset(pair) for pair in cut}
    wires = [w for w in wires if not {w[0], w[1]} & lost and frozenset(w[:2]) not in cut]
    known = {("+",): Fraction(V0), ("-",): Fraction(-V0)}
    # Only nodes with a path to a rail have a voltage.
    reached = set(known)
    for _ in range(2 * m * n + 6):
        reached |= {b for a, b, _ in wires if a in reached} | {a for a, b, _ in wires if b in reached}
    nodes = sorted(reached - set(known))
    at = {node: k for k, node in enumerate(nodes)}
    rows = [[Fraction(0)] * (len(nodes) + 1) for _ in nodes]
    for a, b, g in wires:
        for own, other in ((a, b), (b, a)):
            if own in at:
                rows[at[own]][at[own]] += g
                if other in at:
                    rows[at[own]][at[other]] -= g
                else:
                    rows[at[own]][-1] += g * known[other]
    for k in range(len(nodes)):
        pivot = next(i for i in range(k, len(nodes)) if rows[i][k])
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [value / rows[k][k] for value in rows[k]]
        for i in range(len(nodes)):
            if i != k and rows[i][k]:
                rows[i] = [value - rows[i][k] * own for value, own in zip(rows[i], rows[k])]
    return [rows[at[(name,)]][-1] for name in ("E1", "E2", "E3", "E4")]


def reported(m, n, E):
    """x, y and load from four voltages, by docs/mesh.md."""
    E1, E2, E3, E4 = E
    x = Fraction(2 * m * R0, R) + n + 1
    y = Fraction(2 * n * R0, R) + m + 1
    return (
        x / (n - 1) * (E1 - E3) / (2 * V0 - E1 - E3),
        y / (m - 1) * (E2 - E4) / (2 * V0 + E2 + E4),
        Fraction(2 * K, R0) * (2 * V0 - E1 - E3) / (E1 + E3 - E2 - E4),
    )


LOAD = [[3, 0, 1], [0, 4, 2], [7, 0, 5], [0, 1, 6]]
CASES = {
    "nothing": ({}, {}),
    "the middle": ({"gone": [(1, 1)]}, {}),
    "a corner and an edge": ({"gone": [(0, 0), (3, 1)]}, {}),
    "a whole column but one": ({"gone": [(0, 0), (1, 0), (2, 0)]}, {}),
    "an element cut off": (
        {"gone": [(0, 1), (1, 0)]},
        {},
    ),  # the corner is connected to E1 in one layer, to E2 in the other
    "without rubber": ({"bare": [(1, 1), (3, 2)]}, {}),
    "resistors": (
        {"cut": [(("A", 1, 1), ("A", 1, 2)), (("B", 2, 0), ("B", 3, 0)), (("E1",), ("A", 2, 0))]},
        {"cut": [("A", 1, 1), ("B", 2, 0), ("A", 2, -1)]},
    ),
    "resistors across": (
        {"cut": [(("A", 0, 1), ("A", 1, 1)), (("B", 3, 1), ("B", 3, 2)), (("B", 3, 1), ("E4",))]},
        {"cut": [("A", 0, 1, "across"), ("B", 3, 1, "across"), ("B", 3, 1)]},
    ),
    "everything": (
        {"gone": [(1, 1)], "bare": [(0, 0)], "cut": [(("E3",), ("A", 3, 2))]},
        {"cut": [("A", 3, 2)]},
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_what_is_left_obeys_kirchhoff(name):
    hand, own = CASES[name]
    elements, rubber = np.ones((4, 3), bool), np.ones((4, 3), bool)
    for array, key in ((elements, "gone"), (rubber, "bare")):
        for at in hand.get(key, ()):
            array[at] = False
    wanted = by_hand(4, 3, LOAD, **hand)
    found = CutMesh(Mesh(4, 3, R, R0, V0, K), elements, rubber, **own).solve(np.array([LOAD], float))
    assert found.valid[0]
    assert [v[0] for v in found[:4]] == pytest.approx([float(v) for v in wanted], rel=1e-9)
    wanted = [float(v) for v in reported(4, 3, wanted)]
    assert [v[0] for v in found[4:7]] == pytest.approx(wanted, rel=1e-8)


def test_every_case_is_another_circuit():
    """Otherwise a case could pass although its cut is ignored."""
    volts = [tuple(by_hand(4, 3, LOAD, **hand)) for hand, _ in CASES.values()]
    assert len(set(volts)) == len(CASES)


def test_nothing_missing_is_the_whole_mesh():
    mesh, rng = Mesh(5, 9, 47.0), np.random.default_rng(2)
    load = rng.uniform(0, 3, (4, 5, 9)) * (rng.random((4, 5, 9)) < 0.4)
    found, whole = CutMesh(mesh).solve(load), mesh.solve(load)
    for name in ("E1", "E2", "E3", "E4", "x", "y", "load"):
        assert getattr(found, name) == pytest.approx(getattr(whole, name), rel=1e-9, abs=1e-11), name


def test_a_force_without_rubber_is_not_felt():
    """The remaining force is reported exactly as if it were alone, and as accurately as in a complete
    sheet."""
    mesh, rubber = Mesh(5, 5, 47.0), np.ones((5, 5), bool)
    rubber[1::2, :] = rubber[:, 1::2] = False
    load = np.zeros((2, 5, 5))
    load[:, 2, 4], load[0, 1, 1] = 3, 5
    found = CutMesh(mesh, rubber=rubber).solve(load)
    assert found.x[0] == found.x[1] == pytest.approx(1) and found.load[0] == found.load[1]


def test_one_pressed_element_is_reported_at_the_harmonic_place():
    """By reciprocity x = h, except for the gradient between the rails, which is negligible for R0 >> r."""
    elements = np.ones((4, 5), bool)
    elements[0, 0] = elements[2, 2] = False
    cut = CutMesh(Mesh(4, 5, 10.0, 1e7), elements)
    places = np.argwhere(elements)
    load = np.zeros((len(places), 4, 5))
    load[np.arange(len(places)), *places.T] = 2.0
    found, (right, up) = cut.solve(load), cut.harmonic()
    assert found.x == pytest.approx(right[elements] * ratio(cut, "x", 4, 5), abs=1e-4)
    assert found.y == pytest.approx(up[elements] * ratio(cut, "y", 5, 4), abs=1e-4)
    assert np.isnan(right[0, 0]) and np.abs(right[elements]).max() < 1


def ratio(cut, axis, across, along):
    """The factor that the complete mesh's constant applies to h, for R0 >> r: with I/2 from either electrode,
    E1-E3 is half of I h times the resistance between them, r 2/flow where 2 V between them drive ``flow``
    through resistors of 1 ohm; x = Cx (E1-E3) / (R0 I) with Cx = 2 across R0/r / (along - 1)."""
    right, up = cut.harmonic()
    if axis == "x":
        flow = sum(right[i, 0] + 1 for i in range(across) if cut.elements[i, 0])
    else:
        flow = sum(1 - up[0, j] for j in range(across) if cut.elements[0, j])
    return 2 * across / (along - 1) / flow


def test_what_cannot_be():
    mesh = Mesh(2, 3, 10.0)
    with pytest.raises(ValueError, match=r"elements"):
        CutMesh(mesh, np.ones((3, 2)))
    with pytest.raises(ValueError, match=r"cut"):
        CutMesh(mesh, cut=[("A", 0, 3)])
    with pytest.raises(ValueError, match="newtons"):
        CutMesh(mesh).solve(np.full((1, 2, 3), -1.0))
    # All wires to one electrode cut, nothing pressed, or only missing elements: no measurement, and no
    # exception.
    gone = np.ones((2, 3), bool)
    gone[0, 0] = False
    load = np.zeros((2, 2, 3))
    load[1, 0, 0] = 4
    assert CutMesh(mesh, gone).solve(load).valid.tolist() == [False, False]
    loose = [("A", 0, -1), ("A", 1, -1), ("A", 0, 2), ("A", 1, 2)]
    found = CutMesh(mesh, cut=loose).solve(np.ones((1, 2, 3)))
    assert not found.valid[0] and found.load[0] == 0 and np.isfinite([v[0] for v in found]).all()
