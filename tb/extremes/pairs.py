"""Pairwise coverage: few combinations that contain every pair of values of two parameters."""

from itertools import combinations, product
from random import Random


def _pairs(names, row):
    return {((a, row[a]), (b, row[b])) for a, b in combinations(names, 2)}


def wanted(axes, allowed=lambda **row: True, limit=200_000):
    """Every pair of values that occurs in an allowed combination of ``axes`` {name: values}.

    All combinations are checked if there are at most ``limit``; otherwise every pair counts as possible.
    """
    names, count = list(axes), 1
    for values in axes.values():
        count *= len(values)
    if count > limit:
        return {((a, x), (b, y)) for a, b in combinations(names, 2) for x in axes[a] for y in axes[b]}
    found = set()
    for values in product(*axes.values()):
        row = dict(zip(names, values))
        if allowed(**row):
            found |= _pairs(names, row)
    return found


def covering(axes, allowed=lambda **row: True, seed=1, tries=60):
    """Rows {name: value} that together contain every possible pair; greedy, reproducible for a seed.

    ``allowed``: whether a row may be built. With a single axis, a row for each of its values.
    """
    names, draw = list(axes), Random(seed)
    if len(names) == 1:
        rows = [{names[0]: value} for value in axes[names[0]]]
        return [row for row in rows if allowed(**row)]
    left, rows = wanted(axes, allowed), []
    while left:
        first = min(left, key=repr)
        best, most = None, 0
        for attempt in range(tries * 20):
            row = {name: draw.choice(axes[name]) for name in names} | dict(first)
            if not allowed(**row):
                continue
            gained = len(left & _pairs(names, row))
            if gained > most:
                best, most = row, gained
            if best is not None and attempt >= tries:
                break
        if best is None:  # no row with the pair was drawn: almost none is allowed
            left.discard(first)
            continue
        rows.append(best)
        left -= _pairs(names, best)
    return rows
