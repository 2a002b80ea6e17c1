"""Does a clock of reset make a block forget what it began with? Two copies that begin apart then do the same.

Both copies get the same inputs, with reset in the first clock. An output must then be the same for ever, what
a `*_valid_o` qualifies while that is 1. The invariant is found, not written: for every register, under which
condition (a state bit, a value of a small register, a signal that hangs on the state alone) do the copies
hold the same in it, and which conditions exclude each other? Random simulation leaves what never failed; a
SAT solver takes away what does not follow from the rest a clock later (Houdini). What is left holds from
reset on, whatever comes in.
"""

import random
import re
from collections import defaultdict
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from itertools import count

from verify.aig import ALL, FALSE, LANES, TRUE, lane_bits, simulate
from verify.clauses import Clauses
from verify.two_copies import PLACE, SMALL, Pair, conditions

RESET = "rst_i"
MOST = 48  # conditions a register is tried with, those that hold most often; and so many that were never seen
PART = 16  # bits of a word that are alike under a condition, or not, together
NODES = 3_000_000  # of clocks one after the other
EVALUATIONS = 12_000_000  # of nodes in simulation: seconds


@dataclass(frozen=True)
class Task:
    """``ties``: of Pair; ``qualifiers``: {output: outputs one of which has to be 1, or with ! 0};
    ``clocks``: before outputs count; ``alike``: memories begin alike; ``reset``: the input that resets,
    ``held`` for so many of these clocks; ``framed``: it gets frames, as msn_frame_filter hands them on.

    ``since``: {output, with * for any: the port that has to have been 1 before it counts}, in ``bounded``;
    ``joined``: of ``conditions``.
    """

    ties: dict = field(default_factory=dict)
    qualifiers: dict = field(default_factory=dict)
    clocks: int = 1
    alike: bool = False
    reset: str = RESET
    held: int = 1
    framed: bool = False
    since: dict = field(default_factory=dict)
    joined: tuple = ()

    def since_when(self, output):
        """The port that has to have been 1, or None."""
        wanted = (port for name, port in self.since.items() if fnmatchcase(output, name))
        return next(wanted, None)

    def same_from_the_start(self, circuit):
        if not self.alike:
            return set()
        return {
            bit
            for bit in circuit.registers
            if any(PLACE.search(name) for name, _ in circuit.names.get(bit, []))
        }


def draw(rng, seldom):
    """Random lanes: a reset seldom, single bits now rare, now usual."""
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
    """Random simulation of two copies: (pair, nodes' values, what the copies hold) of clocks that count."""
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
    """What random simulation from reset on leaves.

    (registers always the same, {register: names of conditions}, {(condition, another that it implies)})
    """
    asked, open_to = None, dict.fromkeys(circuit.registers)  # None: always the same so far
    support = dict.fromkeys(recipes, 0)
    for pair, known, state in steps(circuit, task, rng):
        if asked is None:
            asked = {
                name: [recipe(pair.graph, pair.known[side]) for side in "ab"]
                for name, recipe in recipes.items()
            }
            known = simulate(pair.graph, dict(enumerate(known)))  # with what the conditions add to the graph
            small = handy(circuit, asked)
            implied = {name: [other for other in small if other != name] for name in small}
        holds = {}
        for name, (one, other) in list(asked.items()):
            holds[name] = lane_bits(known, one)
            if holds[name] != lane_bits(known, other):  # what the copies see differently tells nothing
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
    """Those of the conditions' names that may say what states there are: bits and small registers.

    A bit that a register points at is one too.
    """
    width = circuit.widths()

    def says(name):
        word = re.sub(r"^not |\.\d+$| .=.*$", "", name)
        return name.endswith("]") or (word in width and width[word] <= SMALL)

    return [name for name in names if says(name)]


class Induction:
    """The invariant, smaller with every candidate that fails.

    ``same``: registers that both copies hold alike; ``under``: {(condition, registers alike under it)};
    ``facts``: {(condition, another that it implies, or None: it never holds)}.
    """

    def __init__(self, circuit, task, seed=1):
        self.circuit, self.task, self.recipes = circuit, task, conditions(circuit, task.joined)
        # `names`: {register: names of conditions}, for those that fall out of `same`
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
        """{candidate: literal that is 1 where it fails} of copies that hold ``state``; ``known``: a's."""
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
        """Leave what holds when outputs begin to count, from any two states."""
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
        """Leave what follows from itself a clock later; then names of outputs that differ all the same."""
        while True:
            pair = Pair(self.circuit, self.same, self.task.ties)
            graph, clauses = pair.graph, Clauses(pair.graph)
            for given, gives in pair.boxes_differ():
                clauses.add([clauses.literal(given), -clauses.literal(gives)])
            switches = {}  # each lets its candidate hold
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
        """The candidates that may fail although all others held the clock before."""
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


def bounded(circuit, task=Task()):
    """From any two states, clock by clock after the reset: ({outputs that may differ}, clocks without one).

    Ends with the first that may, or as the graph has grown to ``NODES``.
    """
    pair, clauses, same = None, None, task.same_from_the_start(circuit)
    been = dict.fromkeys(task.since.values(), FALSE)
    for clock in count():
        reset = {task.reset: int(clock < task.held)} if clock < task.clocks else {}
        pair = Pair(circuit, same, task.ties | reset, before=pair)
        clauses = clauses or Clauses(pair.graph)
        for given, gives in pair.boxes_differ():
            clauses.add([clauses.literal(given), -clauses.literal(gives)])
        if clock < task.clocks:
            continue
        outputs = pair.outputs(task.qualifiers)
        for name in outputs:
            if port := task.since_when(name):
                outputs[name] = pair.graph.both(outputs[name], been[port])
        for port in been:
            bit = (circuit.inputs | circuit.outputs)[port, 0]
            been[port] = pair.graph.either(been[port], (pair.inputs | pair.known["a"])[bit])
        outputs = {name: one for name, one in outputs.items() if one != FALSE}
        differ = {name for name, one in outputs.items() if clauses.solve([clauses.literal(one)])}
        yield differ, clock - task.clocks + (not differ)
        if differ or len(pair.graph.fan) > NODES:
            return


def prove(circuit, task=Task()):
    """Names of the outputs that are not proven."""
    induction = Induction(circuit, task)
    induction.begin()
    return induction.close()
