"""What a forest costs in hardware: block RAMs, and clocks of a decision (docs/forest.md, "Budget")."""

from dataclasses import dataclass

import numpy as np

from meissner.forest import file, words
from meissner.twins.shared import index_width

LANES = 4  # of classes that an engine adds in a clock
# Clocks of a node if others fill the time, and from a node to its child.
CLOCKS = {"block RAM": (1.0, 11), "SDRAM": (4.2, 28)}  # tb/forest/test_forest_sdram.py
END_CLOCKS = 13  # of a decision, beside the features, classes and engines
RESERVE = 1  # block RAM for what else a core has; one that reads a sensor may need more
SDRAM_ADDRESS = 22  # bits

# What Yosys chooses from for a memory: (price of one, bits of a write enable, bits of a word for each depth).
# A price is in LUT RAMs of 16 by 4 as 4, and a bit in a flip-flop as 1.
WIDE = {16384: 1, 8192: 2, 4096: 4, 2048: 9, 1024: 18, 512: 36}
BLOCKS = {
    "ice40": (64, 1, {2048: 2, 1024: 4, 512: 8, 256: 16}),
    "ecp5": (128, 9, WIDE),
    "gowin": (128, 9, WIDE),
}
LUT_RAM = (4, 4, {16: 4})


@dataclass(frozen=True)
class Size:
    """What a forest needs, or a core has room for; ``trees`` and ``nodes``: of each engine."""

    features: int
    classes: int
    trees: int
    nodes: int
    leaves: int
    bits: int


def columns(model):
    """Values of a row that the engines get, those for missing values among them."""
    return len(words.without_missing(model)[0].features)


def bits_of(model: file.Model) -> int:
    """Bits of a feature with which no threshold and no value on either side of it is lost."""
    every = np.concatenate([tree.threshold for tree in model.trees])
    ends = (int(every.min()), int(every.max())) if every.size else (0,)
    return max(2, *(max(-end - 1, end + 1).bit_length() + 1 for end in ends))


def size_of(model: file.Model, engines: int) -> Size:
    """What ``model`` needs of each of ``engines``."""
    own = [max(len(tree.feature), 1) for tree in model.trees]
    shares = words.spread(model, engines)
    return Size(
        features=len(model.features),
        classes=len(model.classes),
        trees=max(map(len, shares)),
        nodes=max(sum(own[tree] for tree in trees) for trees in shares),
        leaves=len(model.leaves) if len(model.classes) != 2 else 1,
        bits=bits_of(model),
    )


def inferred(count: int, bits: int, cells: str) -> int:
    """Block RAMs that Yosys takes for a memory of ``count`` words of ``bits`` with one port to write and one
    to read with a register: the cheapest of block RAM in one of its shapes, LUT RAM and flip-flops.

    For each shape the words are cut into ``deep`` parts, whose bits share RAMs but no write enable; a bit of
    the multiplexer behind the parts costs a half, as does a part's write enable.
    """
    best, found = count * bits, 0
    for number, (price, byte, shapes) in ((0, LUT_RAM), (1, BLOCKS[cells])):
        if number == 0 and cells == "ice40":  # which has no LUT RAM
            continue
        cheapest = None
        for depth, width in shapes.items():
            deep, step = -(-count // depth), min(byte, width)
            each = -(-deep * (-(-bits // step) * step) // width)
            cost = price * each + (deep - 1) * bits / 2 + (deep / 2 if deep > 1 else 0) + 2
            if cheapest is None or cost < int(cheapest[0]):
                cheapest = cost, number * each
        if cheapest[0] < best:
            best, found = int(cheapest[0]), cheapest[1]
    return found


def rams(count: int, bits: int, cells: str) -> int:
    """Block RAMs of a msn_ram: on an ECP5 that of rtl/ecp5, which has no multiplexer behind its cells."""
    if cells == "ecp5" and count <= max(WIDE) and -(-count // 16) * -(-bits // 4) > 16:
        fits = [(depth, width) for depth, width in WIDE.items() if depth >= count]
        _, width = fits[-1] if fits[-1][1] < 36 or bits > 18 else fits[-2]
        return -(-bits // width)
    return inferred(count, bits, cells)


def block_rams(size: Size, cells: str, engines=1, banks=1, lanes=LANES, sdram=False) -> int:
    """Block RAMs of msn_classify with a forest of that size (rtl/forest): every memory that is read through
    a register."""
    context, tag = (2, 5) if sdram else (1, 4)  # bits: decisions under way, walkers
    address = SDRAM_ADDRESS if sdram else index_width(size.nodes)
    index = index_width(size.features)
    memory, fifo = (lambda *of: rams(*of, cells)), (lambda depth, bits: inferred(depth, bits, cells))
    each = 0 if sdram else memory(banks * size.nodes, 2 + index + size.bits + 32)
    each += memory(banks * size.trees, address) + memory(1 << index + context, size.bits)
    if size.classes != 2:
        rows = banks * size.leaves * -(-size.classes // lanes)
        each += min(size.classes, lanes) * memory(rows, 16)
    # Places of the walkers; queues of nodes, leaves and tags. A bit beside the context tells two rows apart.
    queued = context + 1 + address, context + 1 + address + tag, context + 1 + 17 + tag, tag
    each += sum(fifo(1 << tag, bits) for bits in queued)
    queues = 4 * fifo(1 << tag, 20 + tag) if sdram else 0
    row_votes_times = memory(size.features, size.bits) + memory(size.classes, 32) + fifo(1 << context, 48)
    return engines * each + queues + row_votes_times


def needs(model: file.Model, cells: str, engines=1, banks=1, sdram=False) -> int:
    """Block RAMs of ``model`` in a core, as many for each engine as for the fullest."""
    size = size_of(words.without_missing(model)[0], engines)
    return block_rams(size, cells, engines, banks, sdram=sdram)


def in_words(model: file.Model) -> bool:
    """Whether the words of nodes have room for what ``model`` consists of."""
    try:
        words.check(words.without_missing(model)[0])
    except ValueError:
        return False
    return True


def depths(tree):
    """Nodes of the longest path of a tree."""
    below = np.ones(len(tree.feature), np.int64)
    for node in reversed(range(len(below))):
        for child in (tree.left[node], tree.right[node]):
            if child >= 0:
                below[node] = max(below[node], 1 + below[child])
    return int(below[0]) if len(below) else 0


def clocks(model, walked, engines, lanes=LANES):
    """{"block RAM", "SDRAM"}: (mean, worst) clocks of a decision; ``walked``: as ``walks`` gives them."""
    found = [of_rows(model, steps, engines, lanes) for steps in walked]
    return {name: (round(found[0][name].mean()), round(found[1][name].max())) for name in found[0]}


def of_rows(model, steps, engines, lanes=LANES):
    """The same of each row alone, from its first feature to its last vote; ``steps`` [rows, trees].

    What takes longest: the longest walk by itself; all nodes of the busiest engine, and half the longest walk
    while it has no other left; the first leaf, then the votes of all leaves, ``lanes`` classes a clock."""
    found = {}
    for name, (node, child) in CLOCKS.items():
        count = engines if name == "block RAM" else 1
        shares = words.spread(model, count)
        each = [steps[:, own] for own in shares if own]
        walk, groups = child * steps.max(1), -(-len(model.classes) // lanes)
        busiest = [node * own.sum(1) + walk / 2 for own in each]
        votes = [child * own.min(1) + groups * own.shape[1] for own in each]
        found[name] = (
            np.max([walk, *busiest, *votes], axis=0)
            + columns(model)
            + len(model.classes)
            + count
            + END_CLOCKS
        )
    return found
