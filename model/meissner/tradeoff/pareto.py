"""The Pareto front: a point dominates another if it is worse in no figure and better in at least one."""


def dominates(a, b):
    """Whether ``a`` dominates ``b``: sequences of numbers, less is better."""
    return all(x <= y for x, y in zip(a, b)) and any(x < y for x, y in zip(a, b))


def front(rows):
    """A bool for each row of numbers: whether no other row dominates it. Equal rows are all on the front.

    A row with None lacks a measurement: it is never on the front and dominates no row.
    """
    whole = [row for row in rows if None not in row]
    best = []  # front of ``whole``: in sorted order, only an earlier row can dominate a row
    for row in sorted(set(map(tuple, whole))):
        if not any(dominates(other, row) for other in best):
            best.append(row)
    best = set(best)
    return [tuple(row) in best for row in rows]


def stairs(points):
    """The corners of the front of (x, y) pairs, sorted by x, for the line of a chart."""
    kept = front(points)
    return sorted({point for point, on in zip(map(tuple, points), kept) if on})
