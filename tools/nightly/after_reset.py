"""Second attempt at mutants that equivalence.py leaves open: a reset from any state that both copies share.

Such a state may be unreachable, so only a proof counts. Registers that the reset sets start with their reset
values, so that their equality holds from the first clock on and induction can use it.
"""

from collections import defaultdict

from meissner.builds.yowasp import ROOT, yosys
from nightly import circuit as netlist
from nightly.aig import FALSE, TRUE, Aig, write
from nightly.clauses import Clauses
from nightly.mutate import INNER
from nightly.two_copies import masked_by

RESET = "rst_i"


def bits(folder):
    """The netlist of all mutants in ``folder`` as a circuit."""
    yosys(
        f"read_rtlil {folder}/mutated.il; hierarchy -top {INNER}; flatten; opt_clean; async2sync; "
        f"techmap -map {netlist.HERE}/defined_map.v; memory -nordff; {netlist.BITS}; "
        f"write_json {folder}/bits.json",
        f"{folder}/bits.log",
    )
    return netlist.load(ROOT / folder / "bits.json", INNER)


def select(circuit, number):
    """{bit: literal} that chooses mutant ``number``."""
    wanted = {bit: index for (name, index), bit in circuit.inputs.items() if name == "mutsel"}
    return {bit: TRUE if number >> index & 1 else FALSE for bit, index in wanted.items()}


def miter(circuit, number):
    """(graph, latches, the literal that is 1 where the copies differ) of mutant ``number``."""
    graph = Aig()
    chosen = {"a": 0, "b": number}

    def inputs(reset):
        found = {bit: graph.input() for (name, _), bit in circuit.inputs.items() if name != "mutsel"}
        return found | ({circuit.inputs[RESET, 0]: TRUE} if reset else {})

    def copy(side, given):
        return circuit.build(graph, given | select(circuit, chosen[side]))

    shared = {bit: graph.input() for bit in circuit.registers}
    resets = (RESET, 0) in circuit.inputs
    given = shared | inputs(resets)
    begun = graph.input()
    now, latches, known = inputs(False), [(begun, TRUE)], {}
    for side in "ab":
        reset, states, held = copy(side, given) if resets else None, {}, {}
        for bit, after in circuit.registers.items():
            first, latch = reset[after] if resets else shared[bit], graph.input()
            held[bit] = latch, int(first == TRUE)  # latches start at 0
            constant = first in (FALSE, TRUE)
            states[bit] = latch ^ (first == TRUE) if constant else graph.choose(begun, latch, first)
        known[side] = copy(side, now | states)
        latches += [
            (held[bit][0], known[side][after] ^ held[bit][1]) for bit, after in circuit.registers.items()
        ]
    return graph, latches, outputs_apart(circuit, graph, known["a"], known["b"])


def idle(circuit, number):
    """Whether mutant ``number`` changes no register and no valid output in any state and with any inputs."""
    graph = Aig()
    given = {bit: graph.input() for (name, _), bit in circuit.inputs.items() if name != "mutsel"}
    given |= {bit: graph.input() for bit in circuit.registers}
    block, mutant = (circuit.build(graph, given | select(circuit, chosen)) for chosen in (0, number))
    bad = [graph.differ(block[after], mutant[after]) for after in circuit.registers.values()]
    bad = graph.any([*bad, outputs_apart(circuit, graph, block, mutant)])
    clauses = Clauses(graph)
    return bad == FALSE or not clauses.solve([clauses.literal(bad)])


def outputs_apart(circuit, graph, block, mutant):
    """A literal that is 1 where an output differs while it is valid."""
    names = defaultdict(list)
    for (name, _), bit in circuit.outputs.items():
        names[name].append(bit)
    bad = []
    for name, output in names.items():
        apart = graph.any(graph.differ(block[bit], mutant[bit]) for bit in output)
        counts = masked_by(name, names, {})
        when = graph.any(block[names[other][0]] for other, _ in counts) if counts else TRUE
        bad.append(graph.both(apart, when))
    return graph.any(bad)


def write_all(mutants, folder):
    """Write an AIGER file m<number>.aig for each mutant."""
    circuit = bits(folder)
    for mutant in mutants:
        graph, latches, bad = miter(circuit, mutant.number)
        write(ROOT / folder / f"m{mutant.number}.aig", graph, latches, [bad])
