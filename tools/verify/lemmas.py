"""A further look at a mutant of a block of one channel: first signals that are alike, then the outputs.

A counter that goes through its values in another order gives the same marks at the same time, but its bits
are no help to induction. So each named signal of one bit is asked for alone: is it the same in both copies
while `in_valid_i` is 1? That hangs on little. Those that are proven to be stand for the mutant's own then.
Frames are whole, of one detail, the first after a reset with restart, as in equivalence.py.
"""

from verify import after_reset
from verify.aig import FALSE, TRUE

WANTED = (("in_valid_i", 0), ("in_restart_i", 0), ("in_last_i", 0), ("in_id_i", 0), ("rst_i", 0))


class Frames:
    """``shape`` of after_reset.miter: what comes in, and signals that the mutant has of the block."""

    def __init__(self, circuit, alike=()):
        self.circuit, self.alike = circuit, alike
        self.valid, self.restart, self.last, self.id, self.reset = (circuit.inputs[key] for key in WANTED)
        [self.ready] = [bit for (name, _), bit in circuit.outputs.items() if name == "in_ready_o"]

    def inputs(self, graph, now, ready):
        """(inputs, latches) that make frames of ``now``; ``ready`` does not hang on what is changed."""
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
        """{bit: literal} of the signals in ``alike``: the block's while the input is valid."""
        return {bit: graph.choose(now[self.valid], block[bit], mutant[bit]) for bit in self.alike}


def signals(circuit):
    """Bits of named signals of one bit that are no inputs, outputs or registers."""
    ports = {*circuit.inputs.values(), *circuit.outputs.values()}
    widths = circuit.widths()
    return [
        bit
        for bit, names in circuit.names.items()
        if bit in circuit.gates and bit not in ports and any(widths[name] == 1 for name, _ in names)
    ]


def fits(circuit, parameters):
    """Is it a block of one channel that takes frames?"""
    return parameters.get("Channels") == "1" and all(key in circuit.inputs for key in WANTED)


def signal_apart(circuit, number, bit):
    """after_reset.miter's answer, of one signal in place of the outputs."""
    frames = Frames(circuit)

    def bad(graph, now, block, mutant):
        return graph.both(now[frames.valid], graph.differ(block[bit], mutant[bit]))

    return after_reset.miter(circuit, number, frames, bad)
