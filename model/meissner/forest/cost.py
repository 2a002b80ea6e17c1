"""What a forest costs in hardware: block RAMs, and clocks of a decision (docs/forest.md, "Budget")."""

import numpy as np

from meissner.forest import words

LANES = 4  # of classes that an engine adds in a clock
SHARE = 0.95  # of the clocks in which an engine of block RAM compares a node
SDRAM_CLOCKS = 4.2  # a node (tb/forest/test_forest_sdram.py)
WALK_CLOCKS = 28  # from a node to its child, through the SDRAM
RESERVE = 4  # block RAMs for what else a core has


def rams(count, bits, cells):
    """Block RAMs for ``count`` words of ``bits``, in the shape that takes the fewest."""
    size, widest = {"ice40": (4096, 16), "ecp5": (16384, 32), "gowin": (16384, 32)}[cells]
    extra = 9 / 8 if widest == 32 else 1  # bits of parity, which hold data too
    shapes = [(size // width, int(width * (extra if width >= 8 else 1))) for width in (1, 2, 4, 8, 16, 32)]
    return min(-(-count // deep) * -(-bits // wide) for deep, wide in shapes if wide <= widest * extra)


def word_bits(model):
    """Bits of a node in block RAM (rtl/forest/msn_forest_memory.sv): kind, feature, threshold, low half."""
    most = max((int(np.abs(tree.threshold).max(initial=0)) for tree in model.trees), default=0)
    threshold = min((most + 1).bit_length() + 1, words.THRESHOLD_BITS)
    return 2 + max((columns(model) - 1).bit_length(), 1) + threshold + 32


def columns(model):
    """Values of a row that the engines get, those for missing values among them."""
    return len(words.without_missing(model)[0].features)


def sizes(model, engines):
    """(words, trees) of each engine."""
    own = [max(len(tree.feature), 1) for tree in model.trees]
    return [(sum(own[tree] for tree in trees), len(trees)) for trees in words.spread(model, engines)]


def needs(model, cells, engines, banks):
    """Block RAMs of a forest's nodes, roots and leaves: as many for each engine as for the fullest."""
    nodes, trees = (max(each) for each in zip(*sizes(model, engines)))
    size = nodes, word_bits(model), trees, len(model.classes), len(model.leaves)
    return engines * of_engine(*size, cells, banks)


def of_engine(nodes, bits, trees, classes, leaves, cells, banks, lanes=LANES):
    """Block RAMs of an engine with room for so many nodes of ``bits``, trees and leaves."""
    each = rams(banks * nodes, bits, cells) + rams(banks * trees, max((nodes - 1).bit_length(), 1), cells)
    if classes != 2:
        each += min(classes, lanes) * rams(banks * -(-classes // lanes) * leaves, 16, cells)
    return each


def depths(tree):
    """Nodes of the longest path of a tree."""
    below = np.ones(len(tree.feature), np.int64)
    for node in reversed(range(len(below))):
        for child in (tree.left[node], tree.right[node]):
            if child >= 0:
                below[node] = max(below[node], 1 + below[child])
    return int(below[0]) if len(below) else 0


def clocks(model, walked, engines):
    """{"block RAM", "SDRAM"}: (mean, worst) clocks of a decision; ``walked``: as ``walks`` gives them."""
    found = [_clocks(model, steps, engines) for steps in walked]
    return {name: (round(found[0][name].mean()), round(found[1][name].max())) for name in found[0]}


def _clocks(model, steps, engines):
    busiest = np.max([steps[:, own].sum(1) for own in words.spread(model, engines)], axis=0)
    ends = columns(model) + len(model.classes) * (engines + 4)
    outside = np.maximum(steps.sum(1) * SDRAM_CLOCKS, WALK_CLOCKS * steps.max(1)) + ends
    return {"block RAM": busiest / SHARE + ends, "SDRAM": outside}
