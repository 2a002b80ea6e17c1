"""Is a netlist what its sources say? Both side by side, and a proof that no output ever differs.

Registers of the same name begin with the same, unknown contents; inputs may do what they like from the first
clock on, reset or not. ABC, which is part of Yosys, merges what it proves equal by induction (scorr); an
output is proven if its difference is then the constant 0.
"""

import random

from meissner.builds import toolchain, yowasp
from verify.aig import FALSE, LANES, TRUE, Aig, lane_bits, outputs_of, simulate, write

RESET = "rst_i"
CLOCKS = 30  # of simulation
DUMMY = "module dummy(input a, b, output y); assign y = a & b; endmodule"  # ABC wants something to work on


def abc(folder, commands):
    """Run ABC's ``commands`` with files relative to ROOT."""
    (toolchain.ROOT / folder / "dummy.v").write_text(DUMMY)
    script = "\n".join(["backup", *commands, "restore", "strash"]) + "\n"
    (toolchain.ROOT / folder / "script.abc").write_text(script)
    yowasp.yosys(
        f"read_verilog {folder}/dummy.v; hierarchy -top dummy; techmap; abc -script {folder}/script.abc",
        f"{folder}/abc.log",
    )


def power_up(graph, source, netlist):
    """What the registers of either side begin with, {Q: literal} twice: the same where they share a name.

    Registers that synthesis made one, or a constant, begin so in the source too; one that it dropped, like
    one that behaves the same.
    """
    first, begins = {}, {}
    owner = source.holders()
    names = {}
    for name, (bit, inverted) in netlist.holders().items():
        if name in owner and owner[name][0] is not None:
            twin, turned = owner[name]
            names.setdefault(bit, {})[twin] = inverted ^ turned
    first = {twin: FALSE ^ turned for twin, turned in names.pop(None, {}).items()}
    for bit in netlist.registers:
        twins = names.get(bit, {})
        known = [first[twin] ^ turned for twin, turned in twins.items() if twin in first]
        begins[bit] = known[0] if known else graph.input()
        first.update({twin: begins[bit] ^ turned for twin, turned in twins.items()})
    like = behaviour(source)
    leaders = {like[bit]: literal for bit, literal in first.items()} | {(0,) * CLOCKS: FALSE}
    for bit in source.registers:
        if bit not in first:
            first[bit] = leaders[like[bit]] if like[bit] in leaders else graph.input()
    return first, begins


def behaviour(circuit):
    """{Q: what it held in a random simulation from zeros on}: what does the same becomes one in synthesis."""
    rng, graph = random.Random(1), Aig()
    given = {bit: graph.input() for bit in [*circuit.registers, *circuit.inputs.values()]}
    known = circuit.build(graph, given)
    held = dict.fromkeys(circuit.registers, 0)
    seen = {bit: [] for bit in held}
    for _ in range(CLOCKS):
        values = {given[bit] >> 1: rng.getrandbits(LANES) for bit in circuit.inputs.values()}
        values |= {given[bit] >> 1: value for bit, value in held.items()}
        lanes = simulate(graph, values)
        held = {bit: lane_bits(lanes, known[after]) for bit, after in circuit.registers.items()}
        for bit, value in held.items():
            seen[bit].append(value)
    return {bit: tuple(values) for bit, values in seen.items()}


def after_reset(circuit):
    """{Q: 0 or 1} of the registers that a clock of reset sets."""
    graph = Aig()
    given = {bit: graph.input() for bit in [*circuit.registers, *circuit.inputs.values()]}
    if (RESET, 0) in circuit.inputs:
        given[circuit.inputs[RESET, 0]] = TRUE
    known = circuit.build(graph, given)
    return {bit: known[after] for bit, after in circuit.registers.items() if known[after] <= TRUE}


def miter(source, netlist, from_reset):
    """(graph, latches, {name: literal that is 1 where an output of that name differs})."""
    graph = Aig()
    started = graph.input()
    given = {key: graph.input() for key in dict.fromkeys([*source.inputs, *netlist.inputs])}
    first, begins = power_up(graph, source, netlist)
    if from_reset:
        first, begins = first | after_reset(source), begins | after_reset(netlist)
    latches, sides = [(started, 1)], []
    for circuit, begin in ((source, first), (netlist, begins)):
        held = {bit: graph.input() for bit in circuit.registers}
        state = {bit: graph.choose(started, held[bit], begin[bit]) for bit in held}
        known = circuit.build(graph, {bit: given[key] for key, bit in circuit.inputs.items()} | state)
        latches += [(held[bit], known[after]) for bit, after in circuit.registers.items()]
        sides.append({key: known[bit] for key, bit in circuit.outputs.items()})
    differs = {}
    for key in dict.fromkeys([*sides[0], *sides[1]]):
        both = [side.get(key) for side in sides]
        if None in both:
            raise ValueError(f"{key} is on one side only")
        differs[key[0]] = graph.either(differs.get(key[0], FALSE), graph.differ(*both))
    return graph, latches, differs


def prove(source, netlist, folder, name, from_reset=False):
    """Names of the outputs that are not proven equal; files in ``folder`` begin with ``name``.

    ``from_reset``: registers that a reset sets begin as it leaves them: for a state machine whose states
    synthesis encoded again, so that its registers have nothing in common.
    """
    graph, latches, differs = miter(source, netlist, from_reset)
    stem = f"{folder}/{name}"
    write(toolchain.ROOT / f"{stem}.aig", graph, latches, list(differs.values()))
    done = toolchain.ROOT / f"{stem}.proven.aig"
    done.unlink(missing_ok=True)
    abc(folder, [f"read_aiger {stem}.aig", "strash", "scorr", f"write_aiger {stem}.proven.aig"])
    return [output for output, literal in zip(differs, outputs_of(done)) if literal != FALSE]
