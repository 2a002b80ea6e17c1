"""Prove that a netlist equals its sources: both run side by side, and no output ever differs.

Registers of the same name start with the same unknown contents; inputs, including reset, are free from the
first clock on. ABC, which is part of Yosys, merges what it proves equal by induction (scorr); an output is
proven if its difference then is the constant 0.
"""

import random

from meissner.builds import toolchain, yowasp
from nightly.aig import FALSE, LANES, TRUE, Aig, lane_bits, outputs_of, simulate, write

RESET = "rst_i"
CLOCKS = 30  # of simulation
DUMMY = "module dummy(input a, b, output y); assign y = a & b; endmodule"  # ABC needs a design to work on


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
    """The initial contents of the registers on each side, {Q: literal} twice: equal where they share a name.

    Registers that synthesis merged, or replaced by a constant, start equal in the source, too; a register
    that it removed starts like one with the same behaviour.
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
    """{Q: its values in a random simulation from zeros}: synthesis merges registers that behave the same."""
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
    """{Q: 0 or 1} for the registers that one clock of reset sets."""
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

    ``from_reset``: registers that a reset sets start with their reset values. This is for a state machine
    that synthesis re-encoded, so that the registers of the two sides do not correspond.
    """
    graph, latches, differs = miter(source, netlist, from_reset)
    stem = f"{folder}/{name}"
    write(toolchain.ROOT / f"{stem}.aig", graph, latches, list(differs.values()))
    done = toolchain.ROOT / f"{stem}.proven.aig"
    done.unlink(missing_ok=True)
    abc(folder, [f"read_aiger {stem}.aig", "strash", "scorr", f"write_aiger {stem}.proven.aig"])
    return [output for output, literal in zip(differs, outputs_of(done)) if literal != FALSE]
