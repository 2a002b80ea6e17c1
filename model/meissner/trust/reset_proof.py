"""Does a clock of reset make a block forget what it began with? Two copies that begin apart are shown to answer alike.

Both copies get the same inputs, with reset in the first clock. An output must then be the same for ever, what a
`*_valid_o` qualifies while that is 1. The invariant is found, not written: for every register, under which
condition (a state bit, a value of a small register, a signal that hangs on the state alone) do the copies hold
the same in it? Random simulation leaves the conditions that never failed, and a SAT solver takes away those that
do not follow from the rest a clock later (Houdini). What is left holds from reset on, whatever comes in.
"""

import random
import re
from collections import defaultdict
from dataclasses import replace
from itertools import permutations, starmap

from pysat.solvers import Solver

from meissner.trust.aig import ALL, FALSE, LANES, TRUE, Aig, lane_bits, simulate

RESET = "rst_i"
SMALL = 5  # bits of a register whose every value is a condition
MOST = 24  # conditions a register is tried with, those that hold most often
PLACE = re.compile(r"\[(\d+)\]$")  # behind the name of a memory: one of its words


def draw(rng, name):
    """Random lanes: reset seldom, single bits now rare, now usual."""
    value = rng.getrandbits(LANES)
    if name == RESET:
        for _ in range(6):
            value &= rng.getrandbits(LANES)
        return value
    kind = rng.randrange(4)
    if kind == 0:
        return value & rng.getrandbits(LANES)
    return value | rng.getrandbits(LANES) if kind == 1 else value


def masked_by(output, outputs):
    """The valid that qualifies ``output``, or None."""
    if re.search(r"(valid|ready)_o$", output):
        return None
    return next((v for v in outputs if v.endswith("_valid_o") and output.startswith(v[: -len("valid_o")])), None)


class Pair:
    """Two copies side by side in one graph, ``a`` and ``b``, for a clock and what they hold after it.

    ``same``: registers (Q) that both hold alike; ``reset``: whether this is the clock of reset; ``boxes``: False
    lets a product hand its operands through, for simulation.
    """

    def __init__(self, circuit, same=(), reset=False, boxes=True):
        self.graph = graph = Aig()
        self.circuit = circuit
        # A product is a box: whatever it gives, it gives the same to the same operands.
        self.inputs = {bit: graph.input() for key, bit in circuit.inputs.items() if "." not in key[0]}
        if reset:
            self.inputs[circuit.inputs[RESET, 0]] = TRUE
        self.a = {bit: graph.input() for bit in circuit.registers}
        self.b = {bit: self.a[bit] if bit in same else graph.input() for bit in circuit.registers}
        self.with_boxes = boxes
        self.boxes = {}
        self.known = {"a": self.copy(self.a, "a"), "b": self.copy(self.b, "b")}
        self.after = {
            side: {bit: known[next_bit] for bit, next_bit in circuit.registers.items()}
            for side, known in self.known.items()
        }

    def operands(self, box):
        return [bit for (name, _), bit in self.circuit.outputs.items() if name.rpartition(".")[0] == box]

    def copy(self, state, side=None):
        """Literals of a copy that holds ``state``."""
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
        """[(operands differ, results differ)] of every box: not the second without the first."""
        found = []
        for box, results in self.boxes["a"].items():
            operands = [(self.known["a"][bit], self.known["b"][bit]) for bit in self.operands(box)]
            pairs = zip(results, self.boxes["b"][box])
            found.append(tuple(self.graph.any(starmap(self.graph.differ, ones)) for ones in (operands, pairs)))
        return found

    def outputs(self):
        """{name: literal that is 1 where the output differs and counts}."""
        names = defaultdict(list)
        for (name, _), bit in self.circuit.outputs.items():
            if "." not in name:
                names[name].append(bit)
        found = {}
        for name, bits in names.items():
            literal = self.graph.any(self.graph.differ(self.known["a"][bit], self.known["b"][bit]) for bit in bits)
            if valid := masked_by(name, names):
                literal = self.graph.both(literal, self.known["a"][names[valid][0]])
            found[name] = literal
        return found


class Clauses:
    """A solver that takes in what of a graph it is asked about."""

    def __init__(self, graph):
        self.graph = graph
        self.solver = Solver(name="cadical153")
        self.variables = {0: 1}  # of nodes
        self.top = 1
        self.add([-1])

    def fresh(self):
        self.top += 1
        return self.top

    def literal(self, literal):
        """The solver's literal for one of the graph, with the clauses of all below it."""
        waiting = [literal >> 1]
        while waiting:
            node = waiting.pop()
            if node in self.variables:
                continue
            fan = self.graph.fan[node] or ()
            if below := [one >> 1 for one in fan if one >> 1 not in self.variables]:
                waiting += [node, *below]
                continue
            self.variables[node] = self.fresh()
            if fan:
                y, a, b = self.variables[node], *map(self._of, fan)
                self.add([-y, a])
                self.add([-y, b])
                self.add([y, -a, -b])
        return self._of(literal)

    def _of(self, literal):
        variable = self.variables[literal >> 1]
        return -variable if literal & 1 else variable

    def add(self, literals):
        self.solver.add_clause(literals)

    def solve(self, assumptions):
        return self.solver.solve(assumptions=assumptions)

    def true_of(self, literals):
        """Those keys of ``literals`` that the model makes true, as far as it knows."""
        true = set(self.solver.get_model())
        return [key for key, one in literals.items() if one >> 1 in self.variables and self._of(one) in true]


def conditions(pair):
    """{name: function of a copy's literals} of what hangs on the state alone, so that a register may count under it."""
    circuit, graph, known = pair.circuit, pair.graph, pair.known["a"]
    state = {literal >> 1 for literal in pair.a.values()}
    pure = [True]
    for node, fan in enumerate(graph.fan[1:], 1):
        pure.append(pure[fan[0] >> 1] and pure[fan[1] >> 1] if fan else node in state)
    found, there = {}, {TRUE, FALSE}

    def offer(name, recipe):
        literal = recipe(known)
        if literal not in there:
            there.add(literal)
            found[name] = recipe

    words, sizes = defaultdict(dict), defaultdict(int)
    for bit, [(name, index), *_] in circuit.names.items():
        if place := PLACE.search(name):
            sizes[name[: place.start()]] = max(sizes[name[: place.start()]], int(place[1]) + 1)
        elif bit in known and pure[known[bit] >> 1]:
            offer(f"{name}.{index}", lambda of, bit=bit: of[bit])
            offer(f"not {name}.{index}", lambda of, bit=bit: of[bit] ^ 1)
            if bit in circuit.registers:
                words[name][index] = bit
    words = {name: [bits[index] for index in sorted(bits)] for name, bits in words.items()}
    for name, bits in words.items():
        offer(f"{name} != 0", lambda of, bits=bits: graph.any(of[bit] for bit in bits))
        if 1 < len(bits) <= SMALL:
            for value in range(1 << len(bits)):
                offer(f"{name} == {value}", lambda of, bits=bits, value=value: _equals(graph, of, bits, value))
    for size in sorted({size for size in sizes.values() if size & (size - 1) == 0}):
        ends = [name for name, bits in words.items() if 1 << len(bits) == 2 * size]
        for begin, end in permutations(ends, 2):
            for place in range(size):
                offer(
                    f"{place} in {begin} .. {end}",
                    lambda of, place=place, begin=words[begin], end=words[end]: _within(graph, of, place, begin, end),
                )
    return found


def _equals(graph, of, bits, value):
    return graph.any(of[bit] ^ (value >> i & 1) for i, bit in enumerate(bits)) ^ 1


def _within(graph, of, place, begin, end):
    """Is ``place`` of a queue between its two pointers, which have one bit more than a place?"""
    begin, end = [of[bit] for bit in begin], [of[bit] for bit in end]
    filled, _ = graph.minus(end, begin)
    ahead, _ = graph.minus([TRUE if place >> i & 1 else FALSE for i in range(len(begin) - 1)], begin)
    return graph.minus([*ahead, FALSE], filled)[1]


def survivors(circuit, clocks, rng, alike=()):
    """What random simulation from reset on leaves.

    (registers always the same, {register: names of conditions}, {(condition, another that it implies)})
    """
    pair = Pair(circuit, boxes=False)
    graph = pair.graph
    asked = {name: recipe(pair.known["a"]) for name, recipe in conditions(pair).items()}
    asked_b = {name: recipe(pair.known["b"]) for name, recipe in conditions(pair).items()}
    names = {bit: key for key, bit in circuit.inputs.items()}
    state = {side: {bit: rng.getrandbits(LANES) for bit in circuit.registers} for side in "ab"}
    for bit in alike:
        state["b"][bit] = state["a"][bit]
    open_to = dict.fromkeys(circuit.registers)  # None: always the same so far
    support = dict.fromkeys(asked, 0)
    small = handy(circuit, asked)
    implied = {name: [other for other in small if other != name] for name in small}
    for clock in range(clocks):
        values = {literal >> 1: draw(rng, names[bit][0]) for bit, literal in pair.inputs.items()}
        if clock == 0:
            values[pair.inputs[circuit.inputs[RESET, 0]] >> 1] = ALL
        for side, held in (("a", pair.a), ("b", pair.b)):
            values |= {held[bit] >> 1: state[side][bit] for bit in held}
        known = simulate(graph, values)
        if clock:
            holds = {name: lane_bits(known, literal) for name, literal in asked.items()}
            for name in [name for name, literal in asked_b.items() if lane_bits(known, literal) != holds[name]]:
                del asked[name], asked_b[name]  # a condition that the copies see differently tells nothing
                implied.pop(name, None)
            for name, others in implied.items():
                if holds[name]:
                    implied[name] = [other for other in others if other in asked and not holds[name] & ~holds[other]]
            for name in asked:
                support[name] += holds[name].bit_count()
            for bit in circuit.registers:
                if apart := state["a"][bit] ^ state["b"][bit]:
                    before = asked if open_to[bit] is None else open_to[bit]
                    open_to[bit] = [name for name in before if name in asked and not apart & holds[name]]
        for side in "ab":
            state[side] = {bit: lane_bits(known, literal) for bit, literal in pair.after[side].items()}
    there = conditions(Pair(circuit))  # fewer than here, where a product is no box
    kept = {name: count for name, count in support.items() if count and name in asked and name in there}
    under = {
        bit: sorted((n for n in names if n in kept), key=lambda n: (" in " not in n, -kept[n]))[:MOST]
        for bit, names in open_to.items()
        if names is not None
    }
    facts = {(name, None) for name in implied if name in there and not support[name]}
    facts |= {(name, other) for name in implied if name in kept for other in implied[name] if other in kept}
    return {bit for bit, names in open_to.items() if names is None}, under, facts


def handy(circuit, names):
    """Those of the conditions' names that may say what states there are: of single bits and small registers."""
    width = defaultdict(int)
    for known in circuit.names.values():
        for name, index in known:
            width[name] = max(width[name], index + 1)
    return [
        name for name in names if " in " not in name and width[re.sub(r"^not |\.\d+$| .=.*$", "", name)] <= SMALL
    ]


class Induction:
    """The invariant, smaller with every candidate that fails.

    ``same``: registers that both copies hold alike; ``under``: {(condition, registers alike under it)};
    ``facts``: {(condition, another that it implies, or None: it never holds)}.
    """

    def __init__(self, circuit, same, under, facts, alike=()):
        self.circuit, self.same, self.alike, self.facts = circuit, set(same), alike, set(facts)
        self.names = under  # {register: names of conditions}, for those that fall out of `same`
        self.under = self._grouped(set(circuit.registers) - self.same)

    def _grouped(self, bits):
        groups = defaultdict(list)
        for bit in bits:
            [(word, _), *_] = self.circuit.names.get(bit, [("", 0)])
            for name in self.names.get(bit, ()):
                groups[name, word, tuple(self.names[bit])].append(bit)
        return {(name, tuple(bits)) for (name, *_), bits in groups.items()}

    def violations(self, pair):
        """{candidate: literal that is 1 where it fails after this clock}."""
        graph, after = pair.graph, pair.after
        apart = {bit: graph.differ(after["a"][bit], after["b"][bit]) for bit in self.circuit.registers}
        later = pair.copy(after["a"])
        recipes = conditions(pair)
        found = {bit: apart[bit] for bit in self.same}
        for name, bits in self.under:
            found[name, bits] = graph.both(recipes[name](later), graph.any(apart[bit] for bit in bits))
        for name, other in self.facts:
            found[name, other] = graph.both(recipes[name](later), recipes[other](later) ^ 1 if other else TRUE)
        return found

    def drop(self, candidate):
        if candidate in self.same:
            self.same.discard(candidate)
            self.under |= self._grouped([candidate])
        else:
            self.under.discard(candidate)
            self.facts.discard(candidate)

    def begin(self):
        """Leave what holds after the clock of reset, from any two states."""
        pair = Pair(self.circuit, same=self.alike, reset=True)
        failed = True
        while failed:
            clauses, failed = _clauses(pair), False
            for candidate, literal in self.violations(pair).items():
                if literal != FALSE and clauses.solve([clauses.literal(literal)]):
                    self.drop(candidate)
                    failed = True

    def close(self):
        """Leave what follows from itself a clock later; then names of outputs that differ all the same."""
        while True:
            pair = Pair(self.circuit, same=self.same)
            violations = self.violations(pair)
            clauses, chosen = _clauses(pair), {}
            recipes = conditions(pair)
            for name, bits in self.under:
                chosen[name, bits] = switch = clauses.fresh()
                when = clauses.literal(recipes[name](pair.known["a"]))
                for bit in bits:
                    a, b = clauses.literal(pair.a[bit]), clauses.literal(pair.b[bit])
                    clauses.add([-switch, -when, -a, b])
                    clauses.add([-switch, -when, a, -b])
            for name, other in self.facts:
                chosen[name, other] = switch = clauses.fresh()
                then = [clauses.literal(recipes[other](pair.known["a"]))] if other else []
                clauses.add([-switch, -clauses.literal(recipes[name](pair.known["a"])), *then])
            gone, waiting, asked = set(), [c for c, literal in violations.items() if literal != FALSE], {}
            while waiting:
                candidate = waiting.pop()
                if candidate in gone:
                    continue
                switches = {s: c for c, s in chosen.items() if c not in gone}
                if clauses.solve([*switches, clauses.literal(violations[candidate])]):
                    failed = set(clauses.true_of(violations)) - gone
                    gone |= failed
                    waiting += [c for c, needed in asked.items() if needed & failed and c not in gone]
                else:
                    asked[candidate] = {switches[s] for s in clauses.solver.get_core() or [] if s in switches}
            lost = gone & self.same
            for candidate in gone:
                self.drop(candidate)
            if not lost:
                switches = [s for c, s in chosen.items() if c not in gone]
                outputs = pair.outputs().items()
                return [
                    name for name, bad in outputs if bad != FALSE and clauses.solve([*switches, clauses.literal(bad)])
                ]


def _clauses(pair):
    clauses = Clauses(pair.graph)
    for given, gives in pair.boxes_differ():
        clauses.add([clauses.literal(given), -clauses.literal(gives)])
    return clauses


def prove(circuit, clocks=150, seed=1, alike=()):
    """Names of the outputs that are not proven."""
    induction = Induction(circuit, *survivors(circuit, clocks, random.Random(seed), alike), alike)
    induction.begin()
    return induction.close()
