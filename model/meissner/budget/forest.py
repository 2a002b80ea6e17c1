"""``meissner forest-budget``: what a forest needs of each board, how long a decision takes, what a smaller
one costs, and the best that fits (docs/forest.md, "Budget")."""

import json
import os
from bisect import bisect_left
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from meissner.builds.boards import BOARDS
from meissner.builds.pins import description
from meissner.files import check_kept, check_out, written
from meissner.forest import file, words
from meissner.forest.cost import RESERVE, Size, block_rams, clocks, depths, in_words, needs, size_of
from meissner.forest.forest import Forest
from meissner.forest.place import lengths, place
from meissner.forest.reduce import Reducer
from meissner.forest.rows import read
from meissner.tables import toml
from meissner.terminal import columns, plain
from meissner.twins.forest.sdram import BANK_WORDS, BANKS

NODE_BITS = 64
SDRAM = "ulx3s"
MHZ = 25.0  # that a core reaches with as many nodes as fit; the board's next if it makes none as slow


def walks(forest, x=None):
    """Nodes that are read for the mean and for the worst decision, [rows, trees] each: of the rows ``x``,
    else of walks that go left as often as right, and of the longest path of every tree."""
    if x is not None:
        steps = np.maximum(forest.steps(x), 1)
        return steps, steps
    return lengths(forest.model)[None], np.array([[max(depths(tree), 1) for tree in forest.model.trees]])


def devices():
    """(name, board, device, block RAMs, MHz) of every board with a bitstream."""
    for board in BOARDS.values():
        makes = description(board.name).clock["core_mhz"]
        mhz = max((each for each in makes if each <= MHZ), default=min(makes))
        for device, count in board.rams.items():
            yield f"{board.name} {device}".strip(), board, device, count, mhz


def budget(model, walked, engines=1, banks=1):
    """What the forest needs, on every board and in the SDRAM."""
    spent = clocks(model, walked, engines)
    size = sum(max(len(tree.feature), 1) for tree in model.trees)
    found = {
        "trees": len(model.trees),
        "nodes": model.nodes,
        "bits": NODE_BITS * size,
        "classes": len(model.classes),
        "features": len(model.features),
        "leaves": len(model.leaves),
        "nodes_a_decision": [float(walked[0].sum(1).mean()), int(walked[1].sum(1).max())],
        "memories": [],
    }
    inside = in_words(model)
    for name, board, _, count, mhz in devices():
        need = needs(model, board.cells, engines, banks)
        found["memories"].append(_memory(name, need, count - RESERVE, spent["block RAM"], mhz, inside))
    # The leaves of three classes and more lie in block RAM.
    inside = inside and _placed(words.without_missing(model)[0], banks)
    need, room = needs(model, "ecp5", 1, banks, sdram=True), Room.of(SDRAM).rams
    row = _memory(f"{SDRAM} SDRAM", need, room, spent["SDRAM"], 100.0, inside)
    found["memories"].append(row | {"words": size, "room": BANKS * BANK_WORDS // banks})
    return found


def of_config(config):
    """The budget of the forest in a configuration's file."""
    forest = config.features["forest"]
    if forest.model is None:
        raise ValueError("[forest]: a budget needs the forest: file = 'F.json'")
    return budget(forest.model, walks(Forest(forest.model)), forest.engines, forest.banks)


def _placed(model, banks):
    try:
        place(model, room=BANK_WORDS // banks)
    except ValueError:
        return False
    return True


def _memory(name, need, room, spent, mhz, known):
    row = {"memory": name, "block_rams": need, "room": room, "fits": bool(known and need <= room)}
    return row | {"clocks": list(spent), "mhz": mhz, "us": [each / mhz for each in spent]}


def tell(found):
    mean, worst = found["nodes_a_decision"]
    text = [
        f"{found['trees']} trees, {found['nodes']} nodes, {found['bits'] / 1e6:.3g} Mbit, "
        f"{found['classes']} classes, {found['features']} features",
        f"nodes of a decision: mean {mean:.0f}, worst {worst}",
        "",
    ]
    rows = [("memory", "block RAMs", "clocks, mean", "worst", "MHz", "us, mean", "worst", "")]
    for each in found["memories"]:
        need = f"{each['block_rams']} of {each['room']}"
        if "words" in each:
            need = f"{each['block_rams']}, {each['words']} words"
        numbers = (*map(str, each["clocks"]), f"{each['mhz']:g}", *(f"{us:.1f}" for us in each["us"]))
        rows.append((each["memory"], need, *numbers, "fits" if each["fits"] else "too large"))
    return [*text, *columns(rows, numbers=True)]


def _number(label):
    """A label as a number, whatever a table writes for it: 1, 1.0 and True are one; or its text."""
    text = str(label).strip()
    text = {"True": "1", "False": "0"}.get(text, text)
    for kind in (int, float):
        with suppress(ValueError):
            return kind(text)
    return text


class Compared:
    """Labelled rows, and the classes that the whole forest gives them."""

    def __init__(self, forest, x, y):
        classes = forest.classes_.tolist()
        key = (lambda label: str(label).strip()) if isinstance(classes[0], str) else _number
        labels = {key(label): index for index, label in enumerate(classes)}
        self.truth = np.array([labels.get(key(each), -1) for each in y.tolist()])
        self.unknown = int((self.truth < 0).sum())
        if self.unknown == len(self.truth):
            raise ValueError(f"no label of the data is one of the forest's classes: {plain(str(y[0]))}")
        self.x, self.whole = x, forest.process(x).index

    def of(self, model):
        """(accuracy, share of the rows that have the whole forest's class)."""
        found = Forest(model).process(self.x).index
        return float(np.mean(found == self.truth)), float(np.mean(found == self.whole))


def smaller(reducer, compared):
    """[(what, nodes, accuracy, same class)] of forests with fewer trees, less depth and fewer leaf bits."""
    model, everything = reducer.model, np.ones(len(reducer.tree), bool)
    count, depth = len(model.trees), len(reducer.levels)
    made = [("as it is", model)]
    for trees in dict.fromkeys(max(count * part // 8, 1) for part in (4, 2, 1)):
        made.append((f"first {trees} trees", reducer.build(reducer.within(depth, trees), trees)))
    for most in dict.fromkeys(max(depth * part // 8, 1) for part in (6, 4, 3, 2)):
        made.append((f"depth {most}", reducer.build(reducer.within(most))))
    for bits in (8, 4, 1):
        made.append((f"leaves of {bits} bit{'s' * (bits > 1)}", reducer.build(everything, bits=bits)))
    return [(what, each.nodes, *compared.of(each)) for what, each in made]


class Room(NamedTuple):
    """The block RAMs that a forest may have on a board, with that many engines and banks."""

    title: str
    board: str
    device: str
    mhz: float
    cells: str
    rams: int
    engines: int
    banks: int

    @classmethod
    def of(cls, name, engines=1, banks=1):
        """``name``: a board, or board:device; ValueError lists them."""
        known = {}
        for title, board, device, count, mhz in devices():
            found = title, board.name, device, mhz, board.cells, count - RESERVE
            known[board.name] = known[f"{board.name}:{device}"] = found
        if name not in known:
            names = dict.fromkeys(each.rstrip(":") for each in known)
            raise ValueError(f"fit = {name} must be one of {', '.join(names)}")
        return cls(*known[name], engines, banks)

    def fits(self, model):
        return in_words(model) and needs(model, self.cells, self.engines, self.banks) <= self.rams

    def nodes(self, size: Size, leaves=0.0):
        """The most nodes of a forest of else that ``size`` that fit, with so many ``leaves`` for each."""
        low, high = 0, 1 << 24
        while high - low > 1:
            middle = (low + high) // 2
            own = replace(size, nodes=middle, leaves=max(int(leaves * middle * self.engines), 1))
            need = block_rams(own, self.cells, self.engines, self.banks)
            low, high = (middle, high) if need <= self.rams else (low, middle)
        return low * self.engines

    def toml(self, forest, folder):
        """The configuration of a core on this board, in a file in ``folder``, for the file ``forest``."""
        path = Path(os.path.relpath(forest, folder)).as_posix()
        found = {"about": f"the forest {Path(forest).name} on the {self.title}", "clock": {"mhz": self.mhz}}
        found |= {"sensor": {"kind": "none"}}
        found |= {"forest": {"source": "host", "file": path, "engines": self.engines, "banks": self.banks}}
        found |= {"link": {"baud": 1_000_000, "statistics": False}} if self.cells == "ice40" else {}  # small
        return f"# Written by `meissner forest-budget`; docs/config.md explains every key.\n{toml(found)}"


def fit(reducer, compared, room):
    """(model, accuracy, same class) of the best forest that fits ``room``, None if there is none.

    For each number of trees the nodes that matter most are kept, as many as fit; the number whose forest
    gives most rows of ``compared`` the whole forest's class is taken, of equal ones the larger. As each cut
    adds a leaf to the table of three classes and more, these forests also try as many whole trees as fit.
    """
    count, best = len(reducer.model.trees), None
    table = len(reducer.model.classes) != 2

    def score(model):
        nonlocal best
        scored = compared.of(model)
        if best is None or scored[1] > best[2]:
            best = (model, *scored)

    if table:
        first = lambda trees: replace(reducer.model, trees=reducer.model.trees[:trees])
        if fitting := bisect_left(range(1, count + 1), True, key=lambda trees: not room.fits(first(trees))):
            score(first(fitting))
    whole = size_of(words.without_missing(reducer.model)[0], room.engines)
    for trees in dict.fromkeys(max(count * part // 64, 1) for part in (64, 48, 32, 24, 16, 12, 8, 4, 2, 1)):
        size = replace(whole, trees=-(-trees // room.engines), features=min(whole.features, words.FEATURES))
        nodes = room.nodes(size)
        model = reducer.build(reducer.cheapest(nodes, trees), trees)
        while not room.fits(model) and nodes > trees:
            most = room.nodes(size, len(model.leaves) / max(model.nodes, 1)) if table else nodes
            step = nodes // 64 if in_words(model) else nodes // 8
            nodes = min(nodes - max(step, 1), model.nodes, most)
            model = reducer.build(reducer.cheapest(nodes, trees), trees)
        if room.fits(model):
            score(model)
    return best


def command(arguments):
    """``meissner forest-budget``."""
    forest = Forest.from_file(arguments.forest, trust=arguments.trust)
    engines, banks = arguments.engines, arguments.banks
    if not 1 <= engines <= 64 or banks not in (1, 2):
        raise ValueError(f"engines = {engines} must lie in 1 .. 64, banks = {banks} be 1 or 2")
    if arguments.training and not arguments.data:
        raise ValueError("--training says which nodes matter for the rows of --data, which is missing")
    if arguments.out and arguments.fit is None:
        raise ValueError("--out writes the forest that --fit finds")
    if arguments.out:
        file.check_out(arguments.out)
    if arguments.toml:
        if not arguments.out:
            raise ValueError("--toml writes a configuration for the forest of --out")
        if check_out(arguments.toml).suffix != ".toml":
            raise ValueError(f"{arguments.toml} must be a .toml file")
        check_kept(arguments.toml, arguments.overwrite, [])
    room = Room.of(arguments.fit, engines, banks) if arguments.fit is not None else None
    names = [feature.name for feature in forest.model.features]
    x, y = read(arguments.data, names, labelled=True)[:2] if arguments.data else (None, None)
    found = budget(forest.model, walks(forest, x), engines, banks)
    if x is not None:
        compared = Compared(forest, x, y)
        trained = read(arguments.training, names, labelled=True).x if arguments.training else x[::2]
        reducer = Reducer(forest, trained)
        found["distinct_subtrees"] = reducer.distinct()
        if not arguments.fit:
            keys = ("forest", "nodes", "accuracy", "same_class")
            found["smaller"] = [dict(zip(keys, row)) for row in smaller(reducer, compared)]
    model = forest.model
    if room is not None and not room.fits(model):
        if x is None:
            print(json.dumps(found, indent=2) if arguments.json else "\n".join(tell(found)))
            raise ValueError(
                f"{model.nodes} nodes do not fit {room.title}; give --data to find a smaller forest"
            )
        chosen = fit(reducer, compared, room)
        if chosen is None:
            raise ValueError(f"no forest of one node a tree fits {room.title}")
        model, accuracy, same = chosen
        whole = compared.of(forest.model)[0]
        found["fit"] = budget(model, walks(Forest(model), x), engines, banks)
        found["fit"] |= {
            "memory": room.title,
            "accuracy": accuracy,
            "whole_accuracy": whole,
            "same_class": same,
        }
    if arguments.out:
        file.write(Path(arguments.out), model)
    if arguments.toml:
        with written(arguments.toml) as text:
            text.write(room.toml(arguments.out, Path(arguments.toml).parent).encode())
    if arguments.json:
        print(json.dumps(found, indent=2))
        return
    print(*tell(found), sep="\n")
    if "distinct_subtrees" in found:
        if compared.unknown:
            print(
                f"\n{compared.unknown} of {len(x)} labels are none of the forest's classes: no class is right"
            )
        print(f"\nequal subtrees merged: {found['distinct_subtrees']} nodes (the engines do not merge them)")
    if "smaller" in found:
        rows = [("forest", "nodes", "accuracy", "same class")]
        rows += [
            (each["forest"], str(each["nodes"]), f"{each['accuracy']:.2%}", f"{each['same_class']:.2%}")
            for each in found["smaller"]
        ]
        print("", *columns(rows, numbers=True), sep="\n")
    if "fit" in found:
        own = found["fit"]
        print(f"\nthe best of these kinds that fits {own['memory']}:")
        print(*tell(own), sep="\n")
        print(
            f"accuracy {own['accuracy']:.2%}, of the whole forest {own['whole_accuracy']:.2%}; "
            f"{own['same_class']:.2%} of the rows have the whole forest's class"
        )
    elif room is not None:
        print(f"\nthe forest fits {room.title} as it is")
    if arguments.out:
        print(f"the forest: {plain(arguments.out)}")
    if arguments.toml:
        device = f" DEVICE={room.device}" if room.device else ""
        print(f"its bitstream: make synth BOARD={room.board} CONFIG={plain(arguments.toml)}{device}")
