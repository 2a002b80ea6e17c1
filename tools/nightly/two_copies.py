"""Two copies of a block with different states, and conditions on the state under which they must agree."""

import re
from collections import defaultdict
from dataclasses import replace
from functools import partial
from itertools import permutations

from nightly.aig import FALSE, TRUE, Aig

WIDEST = 16  # up to so many bits, a word's single bits are conditions
SMALL = 5  # up to so many bits, each value of a register is a condition
PLACE = re.compile(r"\[(\d+)\]$")  # ends the name of a memory's word


def masked_by(output, outputs, qualifiers):
    """``output`` counts if one of the returned [(output, wanted value)] holds, or if the list is empty."""
    if output in qualifiers:
        return [(name.lstrip("!"), name[0] != "!") for name in qualifiers[output].split()]
    if re.search(r"(valid|ready)_o$", output):
        return []
    valids = [v for v in outputs if v.endswith("_valid_o") and output.startswith(v[: -len("valid_o")])]
    return [(valid, True) for valid in valids[:1]]


class Pair:
    """Two copies, ``a`` and ``b``, side by side in one graph for one clock, and their states after it.

    ``same``: registers (Q) that are equal in both; ``ties``: {input: constant, or "!other": 0 while that
    input is 1}; ``boxes``: False makes a product pass its operands through, for simulation; ``before``: the
    pair of the previous clock. ``free``: the inputs without ties.
    """

    def __init__(self, circuit, same=(), ties=None, boxes=True, before=None):
        self.circuit, self.with_boxes = circuit, boxes
        self.graph = graph = before.graph if before else Aig()
        self.free = {bit: graph.input() for key, bit in circuit.inputs.items() if "." not in key[0]}
        self.inputs = self.free | {
            bit: self.tied(bit, index, ties[port])
            for (port, index), bit in circuit.inputs.items()
            if port in (ties or {})
        }
        if before:
            self.a, self.b = before.after["a"], before.after["b"]
        else:
            self.a = {bit: graph.input() for bit in circuit.registers}
            self.b = {bit: self.a[bit] if bit in same else graph.input() for bit in circuit.registers}
        self.boxes = {}  # free results of products, but equal for equal operands
        self.known = {"a": self.copy(self.a, "a"), "b": self.copy(self.b, "b")}
        self.after = {
            side: {bit: known[next_bit] for bit, next_bit in circuit.registers.items()}
            for side, known in self.known.items()
        }

    def tied(self, bit, index, value):
        """Literal of an input bit, the ``index``-th of its port, tied to ``value``."""
        if isinstance(value, int):
            return TRUE if value >> index & 1 else FALSE
        other = self.circuit.inputs[value.removeprefix("!"), 0]
        return self.graph.both(self.free[bit], self.free[other] ^ 1)

    def operands(self, box):
        return [bit for (name, _), bit in self.circuit.outputs.items() if name.rpartition(".")[0] == box]

    def copy(self, state, side=None):
        """Literals of a copy with this ``state``."""
        results = defaultdict(list)
        for (name, _), bit in self.circuit.inputs.items():
            if "." in name:
                results[name.rpartition(".")[0]].append(bit)
        if self.with_boxes:
            free = {bit: self.graph.input() for bits in results.values() for bit in bits}
            self.boxes[side] = {box: [free[bit] for bit in bits] for box, bits in results.items()}
            return self.circuit.build(self.graph, {**self.inputs, **state, **free})
        through = {}
        for box, bits in results.items():
            operands = [bit for bit in self.operands(box) if not isinstance(bit, str)] or ["0"]
            through |= {bit: (operands[i % len(operands)],) * 2 for i, bit in enumerate(bits)}
        handed = replace(self.circuit, gates=self.circuit.gates | through)
        return handed.build(self.graph, {**self.inputs, **state})

    def boxes_differ(self):
        """[(operands differ, results differ)] of every box; the second must imply the first."""
        found = []
        for box, results in self.boxes["a"].items():
            given = self.differ(self.operands(box))
            gives = self.graph.any(map(self.graph.differ, results, self.boxes["b"][box]))
            found.append((given, gives))
        return found

    def differ(self, bits):
        """A literal that is 1 where the copies differ in one of ``bits``."""
        return self.graph.any(self.graph.differ(self.known["a"][bit], self.known["b"][bit]) for bit in bits)

    def outputs(self, qualifiers):
        """{name: literal that is 1 where the output differs and counts}."""
        names = defaultdict(list)
        for (name, _), bit in self.circuit.outputs.items():
            if "." not in name:
                names[name].append(bit)
        found = {}
        for name, bits in names.items():
            literal = self.differ(bits)
            if counts := masked_by(name, names, qualifiers):
                when = (self.known["a"][names[other][0]] ^ (not wanted) for other, wanted in counts)
                literal = self.graph.both(literal, self.graph.any(when))
            found[name] = literal
        return found


def conditions(circuit, joined=()):
    """{name: function of a graph and a copy's literals} for conditions that depend on the state alone.

    State bits, values of small registers, named signals, the bit that a register points at, and whether a
    queue's place is filled. ``joined``: pairs of a small register and a bit; the conditions are the
    register's values while the bit is 1 (0 with a ! before its name).
    """
    pair = Pair(circuit)
    graph, known = pair.graph, pair.known["a"]
    state = {literal >> 1 for literal in pair.a.values()}
    pure = [True]
    for node, fan in enumerate(graph.fan[1:], 1):
        pure.append(pure[fan[0] >> 1] and pure[fan[1] >> 1] if fan else node in state)
    found, there = {}, {TRUE, FALSE}

    def offer(name, recipe):
        literal = recipe(graph, known)
        if literal not in there:
            there.add(literal)
            found[name] = recipe

    widths = circuit.widths()
    words, sizes = defaultdict(dict), defaultdict(int)
    for bit, [(name, index), *_] in circuit.names.items():
        if place := PLACE.search(name):
            sizes[name[: place.start()]] = max(sizes[name[: place.start()]], int(place[1]) + 1)
        elif bit in known and pure[known[bit] >> 1]:
            if widths[name] <= WIDEST:
                offer(f"{name}.{index}", lambda graph, of, bit=bit: of[bit])
                offer(f"not {name}.{index}", lambda graph, of, bit=bit: of[bit] ^ 1)
            words[name][index] = bit
    words = {name: [bits[index] for index in sorted(bits)] for name, bits in words.items()}
    for name, bits in words.items():
        offer(f"{name} != 0", lambda graph, of, bits=bits: graph.any(of[bit] for bit in bits))
        if 1 < len(bits) <= SMALL:
            for value in range(1 << len(bits)):
                offer(f"{name} == {value}", partial(equals, bits=bits, value=value))
    for name, other in joined:
        bit, wanted = other.lstrip("!"), other[0] != "!"
        if missing := {name, bit} - words.keys():
            raise ValueError(f"nothing of the state is called {missing.pop()}")
        for value in range(1 << len(words[name])):
            both = value | wanted << len(words[name])
            offer(
                f"{name} == {value} and {other}", partial(equals, bits=words[name] + words[bit], value=both)
            )
    for (name, bits), (index, places) in permutations(words.items(), 2):
        if len(places) <= SMALL and 1 << len(places) >> 1 < len(bits) <= 1 << len(places):
            recipe = partial(pointed_at, bits=bits, places=places)
            offer(f"{name}[{index}]", recipe)
            offer(f"not {name}[{index}]", lambda graph, of, recipe=recipe: recipe(graph, of) ^ 1)
    for size in sorted({size for size in sizes.values() if size & (size - 1) == 0}):
        ends = [name for name, bits in words.items() if 1 << len(bits) == 2 * size]
        for begin, end in permutations(ends, 2):
            for place in range(size):
                recipe = partial(within, place=place, begin=words[begin], end=words[end])
                offer(f"{place} in {begin} .. {end}", recipe)
    return found


def equals(graph, of, bits, value):
    return graph.any(of[bit] ^ (value >> i & 1) for i, bit in enumerate(bits)) ^ 1


def pointed_at(graph, of, bits, places):
    """The bit of ``bits`` at the index in ``places``; 0 beyond them."""
    each = (graph.both(of[bit], equals(graph, of, places, place)) for place, bit in enumerate(bits))
    return graph.any(each)


def within(graph, of, place, begin, end):
    """Whether ``place`` of a queue is between its two pointers, which have one bit more than a place."""
    begin, end = [of[bit] for bit in begin], [of[bit] for bit in end]
    filled, _ = graph.minus(end, begin)
    ahead, _ = graph.minus([TRUE if place >> i & 1 else FALSE for i in range(len(begin) - 1)], begin)
    return graph.minus([*ahead, FALSE], filled)[1]
