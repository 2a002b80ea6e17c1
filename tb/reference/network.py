"""Resistor networks in exact fractions: Kirchhoff's law at every node of docs/mesh.md and docs/fsr.md."""

from fractions import Fraction


def voltages(edges, sources):
    """{node: volts} of ``edges`` [(a, b, siemens)] with the fixed voltages ``sources`` {node: volts}.

    Eliminates nodes on conductances (star to mesh): only sums, products and quotients of positive numbers, no
    subtraction. A node that has no path to a source floats and is left out.
    """
    links = {}
    for a, b, g in edges:
        if g:
            for one, other in ((a, b), (b, a)):
                near = links.setdefault(one, {})
                near[other] = near.get(other, Fraction(0)) + Fraction(g)
    order = []
    free = [node for node in links if node not in sources]
    while free:
        node = min(free, key=lambda one: len(links[one]))
        free.remove(node)
        near = links.pop(node)
        total = sum(near.values())
        order.append((node, near, total))
        ends = list(near)
        for k, one in enumerate(ends):
            links[one].pop(node)
            for other in ends[k + 1 :]:
                g = near[one] * near[other] / total
                links[one][other] = links[one].get(other, Fraction(0)) + g
                links[other][one] = links[one][other]
    found = {node: Fraction(volts) for node, volts in sources.items()}
    for node, near, total in reversed(order):
        if total and all(other in found for other in near):
            found[node] = sum(g * found[other] for other, g in near.items()) / total
    return found


def mesh_edges(m, n, r, R0, k, load, elements=None):
    """The four-wire mesh's resistors; ``elements`` {(i, j)} are cut out."""
    cut, edges, g = elements or set(), [], Fraction(1) / Fraction(r)
    for i in range(m):
        for j in range(n):
            if (i, j) in cut:
                continue
            left = ("E1",) if j == 0 else ("a", i, j - 1)
            up = ("E2",) if i == 0 else ("b", i - 1, j)
            beside = [(left, ("a", i, j)), (up, ("b", i, j))]
            beside += [(("a", i, j), ("E3",))] if j == n - 1 else []
            beside += [(("b", i, j), ("E4",))] if i == m - 1 else []
            beside += [(("a", i - 1, j), ("a", i, j))] if i else []
            beside += [(("b", i, j - 1), ("b", i, j))] if j else []
            edges += [(p, q, g) for p, q in beside if p[1:] not in cut and q[1:] not in cut]
            if load[i][j]:
                edges.append((("a", i, j), ("b", i, j), Fraction(load[i][j]) / Fraction(k)))
    for wire, rail in (("E1", "+"), ("E3", "+"), ("E2", "-"), ("E4", "-")):
        edges.append(((wire,), rail, Fraction(1) / Fraction(R0)))
    return edges


def mesh(m, n, r, R0, V0, k, load, elements=None):
    """E1..E4, x, y, load of eq. 16 to 20 and 29 in exact fractions; the last three are None without a
    load."""
    r, R0, V0, k = map(Fraction, (r, R0, V0, k))
    found = voltages(mesh_edges(m, n, r, R0, k, load, elements), {"+": V0, "-": -V0})
    e1, e2, e3, e4 = (found[name,] for name in ("E1", "E2", "E3", "E4"))
    current = 2 * V0 - e1 - e3
    if not current:
        return e1, e2, e3, e4, None, None, None
    cx = (2 * m * R0 / r + n + 1) / (n - 1) if n > 1 else Fraction(0)
    cy = (2 * n * R0 / r + m + 1) / (m - 1) if m > 1 else Fraction(0)
    x, y = cx * (e1 - e3) / current, cy * (e2 - e4) / (2 * V0 + e2 + e4)
    return e1, e2, e3, e4, x, y, 2 * k / R0 * current / (e1 + e3 - e2 - e4)


def matrix_volts(siemens, supply, driver, column, floating, row):
    """Voltages of the columns of a resistive matrix while ``row`` is driven (docs/fsr.md)."""
    edges = [(("r", i), ("c", j), g) for i, line in enumerate(siemens) for j, g in enumerate(line)]
    edges += [(("c", j), "0", column) for j in range(len(siemens[0]))]
    for i in range(len(siemens)):
        if i == row:
            edges.append((("r", i), "V", driver))
        elif not floating:
            edges.append((("r", i), "0", driver))
    found = voltages(edges, {"V": Fraction(supply), "0": Fraction(0)})
    return [found.get(("c", j), Fraction(0)) for j in range(len(siemens[0]))]
