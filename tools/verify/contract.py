"""Third attempt at mutants of msn_divide, whose result is defined only if |num| <= den and den > 0.

Two copies, one of them mutated, get legal inputs. Induction over the clocks shows that their registers agree
where they matter, and that the registers of a running division stay within their bounds. A SAT solver does
each step; only a proof counts.
"""

from collections import defaultdict

from verify import after_reset
from verify.aig import FALSE, TRUE, Aig
from verify.clauses import Clauses

CONTROL = ("turn", "gen_turn.count", "gen_pipe.valid", "out_valid_o")  # the same in both copies
RANK = ("rest", "den", "low", "high", "step", "negative", "side")


class Copies:
    """The block and mutant ``number`` in one clock; ``apart``: ranks without a division may differ."""

    def __init__(self, circuit, number, apart, reset=None):
        self.circuit, self.graph = circuit, Aig()
        graph = self.graph
        self.bits = defaultdict(dict)
        for bit, names in circuit.names.items():
            for name, index in names:
                self.bits[name][index] = bit
        ports = {bit: graph.input() for (name, _), bit in circuit.inputs.items() if name != "mutsel"}
        if reset is not None:
            ports[circuit.inputs["rst_i", 0]] = reset
        state = {bit: graph.input() for bit in circuit.registers}
        block = circuit.build(graph, ports | state | after_reset.select(circuit, 0))
        holds = {one: bit for bit, one in state.items()}
        pipe = self.bits["gen_pipe.valid"]
        ranks = len(pipe) or 1
        self.control = {holds[one] for name in CONTROL for one in self.word(block, name) if one in holds}
        self.rank_of = dict.fromkeys(state, 0)  # {register: its rank}
        wide = sum(len(self.bits[f"gen_unit[0].{field}"]) for field in RANK)
        self.rank_of |= {
            holds[one]: index // wide for index, one in enumerate(self.word(block, "rank")) if one in holds
        }
        for unit in range(ranks):
            triple = self.word(block, f"gen_unit[{unit}].gen_two.triple")
            self.rank_of |= {holds[one]: unit for one in triple if one in holds}
        live = self.live(block)
        other = {
            bit: one
            if bit in self.control or not apart
            else graph.choose(live[self.rank_of[bit]], one, graph.input())
            for bit, one in state.items()
        }
        self.known = block, circuit.build(graph, ports | other | after_reset.select(circuit, number))

    def live(self, known):
        """For each rank, a literal that is 1 if it holds a division."""
        pipe = self.word(known, "gen_pipe.valid")
        return pipe or [self.graph.any(self.word(known, "turn") + self.word(known, "out_valid_o"))]

    def word(self, known, name):
        bits = self.bits[name]
        return [known[bits[index]] for index in sorted(bits)]

    def legal(self):
        """A literal that is 1 if the input is legal."""
        graph, known = self.graph, self.known[0]
        num, den = self.word(known, "in_num_i"), self.word(known, "in_den_i")
        negative, _ = graph.minus([FALSE] * len(num), num)
        magnitude = [graph.choose(num[-1], below, above) for below, above in zip(negative, num)]
        _, above = graph.minus([*den, FALSE], magnitude)
        [valid] = self.word(known, "in_valid_i")
        return graph.either(valid ^ 1, graph.both(graph.any(den), above ^ 1))

    def bounded(self, known):
        """Whether rest <= 2 den in a division's first clock, then <= den << BitsPerClock; triple = 3 den."""
        graph = self.graph
        if live := self.word(known, "gen_pipe.valid")[:-1]:
            first = [TRUE, *[FALSE] * (len(live) - 1)]
        else:
            live = self.word(known, "turn")
            first = [graph.any(self.word(known, "gen_turn.count")) ^ 1]
        return graph.any(map(self._wrong, [known] * len(live), range(len(live)), live, first)) ^ 1

    def _wrong(self, known, unit, live, first):
        graph = self.graph
        rest, den = self.word(known, f"gen_unit[{unit}].rest"), self.word(known, f"gen_unit[{unit}].den")
        zeros = [FALSE] * (len(rest) - len(den))
        bounds = zip([FALSE, *den, *zeros], [*zeros, *den, FALSE])
        bound = [graph.choose(first, *pair) for pair in bounds]
        wrong = graph.minus(bound, [*rest, FALSE])[1]
        if triple := self.word(known, f"gen_unit[{unit}].gen_two.triple"):
            three, _ = graph.minus([FALSE, FALSE, *den], [*den, FALSE, FALSE])
            should = [graph.choose(first, TRUE, one) for one in three]
            wrong = graph.either(wrong, graph.any(map(graph.differ, triple, should)))
        return graph.both(live, wrong)

    def after(self, known):
        """Literals with the registers one clock later, for ``bounded``."""
        later = {bit: known[after] for bit, after in self.circuit.registers.items()}
        return self.circuit.build(self.graph, {**dict.fromkeys(self.circuit.inputs.values(), FALSE), **later})

    def outputs_differ(self):
        """A literal that is 1 if the copies differ in an output that is valid."""
        graph, (one, other) = self.graph, self.known
        [valid] = self.word(one, "out_valid_o")
        apart = {port: graph.differ(one[bit], other[bit]) for port, bit in self.circuit.outputs.items()}
        always = [one for (name, _), one in apart.items() if name.endswith(("valid_o", "ready_o"))]
        return graph.either(graph.any(always), graph.both(valid, graph.any(apart.values())))

    def leaves(self):
        """A literal that is 1 if a clock later the copies differ where it matters or bounds are violated."""
        graph, (one, other) = self.graph, self.known
        later = self.after(one)
        apart = {bit: graph.differ(one[after], other[after]) for bit, after in self.circuit.registers.items()}
        control = graph.any(one for bit, one in apart.items() if bit in self.control)
        live = self.live(later)
        rest = graph.any(graph.both(live[self.rank_of[bit]], one) for bit, one in apart.items())
        return graph.any([control, rest, self.bounded(later) ^ 1])


def same(circuit, number):
    """Whether mutant ``number`` of the circuit is proven equal to the block."""
    begin, on = Copies(circuit, number, False, TRUE), Copies(circuit, number, True)
    legal = [begin.legal()], [on.legal(), on.bounded(on.known[0])]
    wrong = begin.leaves(), on.graph.either(on.outputs_differ(), on.leaves())
    for copies, given, bad in zip((begin, on), legal, wrong):
        clauses = Clauses(copies.graph)
        for literal in given:
            clauses.add([clauses.literal(literal)])
        if clauses.solve([clauses.literal(bad)]):
            return False
    return True
