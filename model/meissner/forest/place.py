"""Where the trees of a forest lie in an SDRAM of four banks, so that walks of several trees read from all of
them (rtl/forest/msn_sdram.sv).

A tree lies in one bank. Each goes, the longest walks first, to the bank with the shortest sum so far that has
room; they are walked in the order in which the banks' sums grow, so that all banks are busy until the end.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meissner.forest.file import Model
from meissner.forest.words import COUNT, NODE, ROOT, VOTE, pack
from meissner.twins.forest.sdram import BANK_WORDS, BANKS


class Placed(NamedTuple):
    """``order``: indices of the trees, as they are walked; ``roots``: word address of each of these;
    ``blocks``: (word address, words) of each bank; ``leaves``: as meissner.forest.words.Words."""

    order: NDArray[np.int64]
    roots: NDArray[np.int64]
    blocks: list[tuple[int, NDArray[np.uint64]]]
    leaves: NDArray[np.uint16]


def lengths(model: Model) -> NDArray[np.float64]:
    """Nodes that a walk of each tree meets if it goes left as often as right."""
    return np.array([_mean(tree) for tree in model.trees])


def _mean(tree: Any) -> float:
    if tree.leaf is not None:
        return 1.0  # a word of its own
    share = np.zeros(len(tree.feature))
    share[0] = 1.0
    for node in range(len(share)):  # children have greater numbers
        for child in (tree.left[node], tree.right[node]):
            if child >= 0:
                share[child] += share[node] / 2
    return float(share.sum())


def place(model: Model, walks: Any = None, room: int = BANK_WORDS) -> Placed:
    """``walks``: mean length of each tree's walks, as Forest.steps counts them; else ``lengths``. ``room``:
    words of a bank. ValueError if the forest does not fit."""
    walks = np.asarray(lengths(model) if walks is None else walks, np.float64)
    sizes = np.array([max(len(tree.feature), 1) for tree in model.trees])
    sums, used = np.zeros(BANKS), np.zeros(BANKS, np.int64)
    trees: list[list[int]] = [[] for _ in range(BANKS)]
    when = np.empty(len(sizes))
    for tree in np.argsort(-walks, kind="stable"):
        free = used + sizes[tree] <= room
        if not free.any():
            needed = f"the forest's {sizes.sum()} words"
            raise ValueError(f"{needed} do not fit {BANKS} banks of {room}: tree {tree} has no room")
        bank = int(np.argmin(np.where(free, sums, np.inf)))
        trees[bank].append(int(tree))
        when[tree] = sums[bank]
        sums[bank] += walks[tree]
        used[bank] += sizes[tree]
    order = np.argsort(when, kind="stable")
    roots, blocks, leaves = np.empty(len(sizes), np.int64), [], model.leaves[:0]
    for bank, own in enumerate(trees):
        base = bank * BANK_WORDS
        words = pack(model, own) if own else None
        if words is not None:
            inner = (words.nodes >> np.uint64(62)) == 0  # only these hold an address
            blocks.append((base, words.nodes + np.where(inner, np.uint64(base), np.uint64(0))))
            roots[own] = base + words.roots
            leaves = words.leaves
    return Placed(order, roots[order], blocks, leaves)


def loads(placed: Placed) -> list[tuple[int, int, int, int]]:
    """(kind, engine, address, data) of every write that loads the forest (rtl/forest/msn_forest_sdram.sv)."""
    rows = [
        (NODE, 0, base + at, word) for base, words in placed.blocks for at, word in enumerate(words.tolist())
    ]
    rows += [(ROOT, 0, index, root) for index, root in enumerate(placed.roots.tolist())]
    table = enumerate(placed.leaves.tolist())
    rows += [(VOTE, 0, label << 16 | row, value) for row, leaf in table for label, value in enumerate(leaf)]
    return [*rows, (COUNT, 0, 0, len(placed.order))]
