"""Pairwise coverage: few combinations in which every pair of two parameters' values occurs."""

from itertools import combinations, product
from random import Random


def _pairs(names, row):
    return {((a, row[a]), (b, row[b])) for a, b in combinations(names, 2)}


def wanted(axes, allowed=lambda **row: True, limit=200_000):
    """Every pair of values that some allowed combination of ``axes`` {name: values} has.

    Few combinations are looked at one by one; beyond ``limit`` of them a pair counts as possible.
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
    """Rows {name: value} that together have every pair that is possible; greedy, the same for a seed.

    ``allowed``: whether a row may be built. A single axis gives its values.
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
        if best is None:  # no row with it was drawn: the limits leave almost none
            left.discard(first)
            continue
        rows.append(best)
        left -= _pairs(names, best)
    return rows
