"""Prove that one clock of reset clears a block's earlier state: two copies with different states then behave
the same.

Both copies get the same inputs, with reset in the first clock. From then on each output must be the same in
both; outputs qualified by a `*_valid_o` must be so while that is 1. The invariant is found, not written: for
every register, the conditions (a state bit, a value of a small register, a signal that depends on the state
alone) under which both copies hold the same value, and the conditions that exclude each other. Random
simulation drops candidates that fail; a SAT solver drops those that do not follow from the others a clock
later (Houdini). The remaining invariant holds from reset on for any inputs.
"""

import random
import re
from collections import defaultdict
from dataclasses import dataclass, field

from nightly.aig import ALL, FALSE, LANES, TRUE, lane_bits, simulate
from nightly.clauses import Clauses
from nightly.two_copies import PLACE, SMALL, Pair, conditions

RESET = "rst_i"
MOST = 48  # conditions tried for a register: the most frequent ones, and as many that never occurred
PART = 16  # bits of a word that are compared together under a condition
EVALUATIONS = 12_000_000  # node evaluations in simulation; takes seconds


@dataclass(frozen=True)
class Task:
    """``ties``: as in Pair; ``qualifiers``: {output: outputs, one of which must be 1 (0 with a !)};
    ``clocks``: number of clocks before outputs count; ``alike``: memories start equal; ``reset``: the reset
    input, which is 1 in the first ``held`` of these clocks; ``framed``: the block gets frames as
    msn_frame_filter sends them.

    ``joined``: as in ``conditions``.
    """

    ties: dict = field(default_factory=dict)
    qualifiers: dict = field(default_factory=dict)
    clocks: int = 1
    alike: bool = False
    reset: str = RESET
    held: int = 1
    framed: bool = False
    joined: tuple = ()

    def same_from_the_start(self, circuit):
        if not self.alike:
            return set()
        return {
            bit
            for bit in circuit.registers
            if any(PLACE.search(name) for name, _ in circuit.names.get(bit, []))
        }


def draw(rng, seldom):
    """Random lanes: rare ones for a reset; for other bits the share of ones varies."""
    value = rng.getrandbits(LANES)
    if seldom:
        for _ in range(6):
            value &= rng.getrandbits(LANES)
        return value
    kind = rng.randrange(4)
    if kind == 0:
        return value & rng.getrandbits(LANES)
    return value | rng.getrandbits(LANES) if kind == 1 else value


def steps(circuit, task, rng):
    """Random simulation of two copies; yields (pair, node values, copies' states) for clocks that count."""
    pair = Pair(circuit, ties=task.ties, boxes=False)
    seldom = circuit.inputs.get((task.reset, 0))
    state = {side: {bit: rng.getrandbits(LANES) for bit in circuit.registers} for side in "ab"}
    for bit in task.same_from_the_start(circuit):
        state["b"][bit] = state["a"][bit]
    for clock in range(max(150, min(2000, EVALUATIONS // (len(circuit.gates) + 1)))):
        values = {one >> 1: draw(rng, bit == seldom) for bit, one in pair.free.items()}
        if clock < task.clocks and seldom is not None:
            values[pair.free[seldom] >> 1] = ALL if clock < task.held else 0
        for side, held in (("a", pair.a), ("b", pair.b)):
            values |= {held[bit] >> 1: state[side][bit] for bit in held}
        known = simulate(pair.graph, values)
        if clock >= task.clocks:
            yield pair, known, state
        state = {side: {b: lane_bits(known, one) for b, one in pair.after[side].items()} for side in "ab"}


def survivors(circuit, task, recipes, rng):
    """The candidates that survive random simulation from reset on.

    (registers always equal, {register: names of conditions}, {(condition, another one that it implies)})
    """
    asked, open_to = None, dict.fromkeys(circuit.registers)  # None: always equal so far
    support = dict.fromkeys(recipes, 0)
    for pair, known, state in steps(circuit, task, rng):
        if asked is None:
            asked = {
                name: [recipe(pair.graph, pair.known[side]) for side in "ab"]
                for name, recipe in recipes.items()
            }
            known = simulate(pair.graph, dict(enumerate(known)))  # with the nodes added by the conditions
            small = handy(circuit, asked)
            implied = {name: [other for other in small if other != name] for name in small}
        holds = {}
        for name, (one, other) in list(asked.items()):
            holds[name] = lane_bits(known, one)
            if holds[name] != lane_bits(known, other):  # useless if it differs between the copies
                del asked[name], holds[name]
                implied.pop(name, None)
        for name, others in implied.items():
            if holds[name]:
                implied[name] = [
                    other for other in others if other in asked and not holds[name] & ~holds[other]
                ]
        for name in asked:
            support[name] += holds[name].bit_count()
        for bit in circuit.registers:
            if apart := state["a"][bit] ^ state["b"][bit]:
                before = asked if open_to[bit] is None else open_to[bit]
                open_to[bit] = [name for name in before if name in asked and not apart & holds[name]]
    kept = {name: count for name, count in support.items() if name in asked}

    def tried(names):
        ranked = sorted((n for n in names if n in kept), key=lambda n: (" in " not in n, -kept[n]))
        seen, unseen = ([n for n in ranked if bool(kept[n]) == some] for some in (True, False))
        return seen[:MOST] + unseen[:MOST]

    under = {bit: tried(names) for bit, names in open_to.items() if names is not None}
    facts = {(name, None) for name in implied if not support[name]}
    facts |= {(name, other) for name in implied if support[name] for other in implied[name] if other in kept}
    return {bit for bit, names in open_to.items() if names is None}, under, facts


def handy(circuit, names):
    """The names of conditions used to describe the reachable states: bits and small registers.

    Bits that a register points at are included.
    """
    width = circuit.widths()

    def says(name):
        word = re.sub(r"^not |\.\d+$| .=.*$", "", name)
        return name.endswith("]") or (word in width and width[word] <= SMALL)

    return [name for name in names if says(name)]


class Induction:
    """The invariant; every candidate that fails is dropped.

    ``same``: registers equal in both copies; ``under``: {(condition, registers that are equal under it)};
    ``facts``: {(condition, another one that it implies, or None: it never holds)}.
    """

    def __init__(self, circuit, task, seed=1):
        self.circuit, self.task, self.recipes = circuit, task, conditions(circuit, task.joined)
        # `names`: {register: names of conditions}, also for registers that drop out of `same`
        self.same, self.names, self.facts = survivors(circuit, task, self.recipes, random.Random(seed))
        self.under = self._grouped(set(circuit.registers) - self.same)

    def _grouped(self, bits):
        groups = defaultdict(list)
        for bit in bits:
            [(word, index), *_] = self.circuit.names.get(bit, [("", 0)])
            for name in self.names.get(bit, ()):
                groups[name, word, index // PART, tuple(self.names[bit])].append(bit)
        return {(name, tuple(bits)) for (name, *_), bits in groups.items()}

    def _candidates(self, graph, known, state):
        """{candidate: literal that is 1 where it fails} for copies with ``state``; ``known``: those of a."""
        apart = {bit: graph.differ(state["a"][bit], state["b"][bit]) for bit in self.circuit.registers}

        def when(name):
            return self.recipes[name](graph, known)

        found = {bit: apart[bit] for bit in self.same}
        for name, bits in self.under:
            found[name, bits] = graph.both(when(name), graph.any(apart[bit] for bit in bits))
        for name, other in self.facts:
            found[name, other] = graph.both(when(name), when(other) ^ 1 if other else TRUE)
        return found

    def _drop(self, candidate):
        if candidate in self.same:
            self.same.discard(candidate)
            self.under |= self._grouped([candidate])
        else:
            self.under.discard(candidate)
            self.facts.discard(candidate)

    def begin(self):
        """Keep the candidates that hold when outputs begin to count, from any two states."""
        pair = None
        for clock in range(self.task.clocks):
            reset = {self.task.reset: int(clock < self.task.held)}
            same = self.task.same_from_the_start(self.circuit)
            pair = Pair(self.circuit, same, self.task.ties | reset, before=pair)
        failed = True
        while failed:
            clauses, failed = Clauses(pair.graph), False
            failing = self._candidates(pair.graph, pair.copy(pair.after["a"]), pair.after)
            for candidate, literal in failing.items():
                if literal != FALSE and clauses.solve([clauses.literal(literal)]):
                    self._drop(candidate)
                    failed = True

    def close(self):
        """Keep the candidates that are inductive together; return the outputs that may still differ."""
        while True:
            pair = Pair(self.circuit, self.same, self.task.ties)
            graph, clauses = pair.graph, Clauses(pair.graph)
            for given, gives in pair.boxes_differ():
                clauses.add([clauses.literal(given), -clauses.literal(gives)])
            switches = {}  # a switch that is 1 makes its candidate hold
            held = {"a": pair.a, "b": pair.b}
            for candidate, literal in self._candidates(graph, pair.known["a"], held).items():
                if literal != FALSE:
                    switch = clauses.fresh()
                    switches[switch] = candidate
                    clauses.add([-switch, -clauses.literal(literal)])
            failing = self._candidates(graph, pair.copy(pair.after["a"]), pair.after)
            gone = self._fall(clauses, switches, failing)
            lost = gone & self.same
            for candidate in gone:
                self._drop(candidate)
            if not lost:
                chosen = [switch for switch, candidate in switches.items() if candidate not in gone]
                outputs = pair.outputs(self.task.qualifiers)
                bad = {name: clauses.literal(one) for name, one in outputs.items() if one != FALSE}
                return [name for name, one in bad.items() if clauses.solve([*chosen, one])]

    @staticmethod
    def _fall(clauses, switches, failing):
        """The candidates that may fail although all remaining ones held a clock before."""
        gone, needed = set(), {}
        waiting = [candidate for candidate, literal in failing.items() if literal != FALSE]
        while waiting:
            candidate = waiting.pop()
            if candidate in gone:
                continue
            chosen = [switch for switch, other in switches.items() if other not in gone]
            if clauses.solve([*chosen, clauses.literal(failing[candidate])]):
                failed = set(clauses.true_of(failing)) - gone
                gone |= failed
                waiting += [c for c, needs in needed.items() if needs & failed and c not in gone]
            else:
                core = clauses.solver.get_core() or []
                needed[candidate] = {switches[switch] for switch in core if switch in switches}
        return gone


def prove(circuit, task=Task()):
    """Names of the outputs that are not proven equal."""
    induction = Induction(circuit, task)
    induction.begin()
    return induction.close()
