"""Which points no other one beats: at least as good in everything that is judged, and better in something."""


def dominates(a, b):
    """Of two sequences of numbers of which less is better."""
    return all(x <= y for x, y in zip(a, b)) and any(x < y for x, y in zip(a, b))


def front(rows):
    """A bool for each row of numbers: whether no other dominates it. Equal rows are all on the front.

    A row with None was not measured in something: it is never on the front, and beats nobody.
    """
    whole = [row for row in rows if None not in row]
    best = []  # of ``whole``: sorted, a row can only be dominated by one before it
    for row in sorted(set(map(tuple, whole))):
        if not any(dominates(other, row) for other in best):
            best.append(row)
    best = set(best)
    return [tuple(row) in best for row in rows]


def stairs(points):
    """The corners of the front of (x, y) pairs, by x: what a chart's line joins."""
    kept = front(points)
    return sorted({point for point, on in zip(map(tuple, points), kept) if on})
