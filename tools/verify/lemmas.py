"""Another attempt at a mutant of a block with one channel: prove inner signals equal first, then the outputs.

A counter that takes its values in another order marks the same clocks, but its bits do not help induction. So
each named one-bit signal is checked alone: is it equal in both copies while `in_valid_i` is 1? Such a
question involves little logic. Signals proven equal then replace the mutant's own. Frames are complete and
consist of one detail, the first after a reset with restart, as in equivalence.py.
"""

from verify import after_reset
from verify.aig import FALSE, TRUE

WANTED = (("in_valid_i", 0), ("in_restart_i", 0), ("in_last_i", 0), ("in_id_i", 0), ("rst_i", 0))


class Frames:
    """``frames`` of after_reset.miter: the inputs, and the signals that the mutant takes from the block."""

    def __init__(self, circuit, alike=()):
        self.circuit, self.alike = circuit, alike
        self.valid, self.restart, self.last, self.id, self.reset = (circuit.inputs[key] for key in WANTED)
        [self.ready] = [bit for (name, _), bit in circuit.outputs.items() if name == "in_ready_o"]

    def inputs(self, graph, now, ready):
        """(inputs, latches) that turn ``now`` into frames; ``ready`` must not depend on what they replace."""
        begun, valid = graph.input(), now[self.valid]
        restart = now[self.restart]
        framed = {
            self.restart: graph.choose(valid, graph.either(begun ^ 1, restart), restart),
            self.last: graph.choose(valid, TRUE, now[self.last]),
            self.id: graph.choose(valid, FALSE, now[self.id]),
        }
        later = graph.both(now[self.reset] ^ 1, graph.either(begun, graph.both(valid, ready)))
        return now | framed, [(begun, later)]

    def taken_over(self, graph, now, block, mutant):
        """{bit: literal} for the signals in ``alike``: the block's values while the input is valid."""
        return {bit: graph.choose(now[self.valid], block[bit], mutant[bit]) for bit in self.alike}


def signals(circuit):
    """Bits of named one-bit signals that are not inputs, outputs or registers."""
    ports = {*circuit.inputs.values(), *circuit.outputs.values()}
    widths = circuit.widths()
    return [
        bit
        for bit, names in circuit.names.items()
        if bit in circuit.gates and bit not in ports and any(widths[name] == 1 for name, _ in names)
    ]


def fits(circuit, parameters):
    """Whether it is a block with one channel that takes frames."""
    return parameters.get("Channels") == "1" and all(key in circuit.inputs for key in WANTED)


def signal_apart(circuit, number, bit):
    """The result of after_reset.miter for one signal instead of the outputs."""
    frames = Frames(circuit)

    def bad(graph, now, block, mutant):
        return graph.both(now[frames.valid], graph.differ(block[bit], mutant[bit]))

    return after_reset.miter(circuit, number, frames, bad)
