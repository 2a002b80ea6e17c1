"""And-inverter graphs, on which proofs about netlists are computed.

A literal is an integer, 2·node + 1 if inverted; node 0 is the constant, so 0 is false and 1 is true.
"""

FALSE, TRUE = 0, 1
LANES = 512  # parallel simulation runs, one bit each of an integer
ALL = (1 << LANES) - 1


class Aig:
    """A growing graph of inputs and two-input ANDs; equal ANDs share one node."""

    def __init__(self):
        self.fan = [None]  # per node: its two literals; None for the constant and for inputs
        self.inputs = []  # nodes of the inputs
        self._known = {}

    def input(self):
        self.fan.append(None)
        self.inputs.append(len(self.fan) - 1)
        return 2 * self.inputs[-1]

    def both(self, a, b):
        """a AND b."""
        if a > b:
            a, b = b, a
        if a == FALSE or a == b ^ 1:
            return FALSE
        if a in (TRUE, b):
            return b
        if (a, b) not in self._known:
            self._known[a, b] = 2 * len(self.fan)
            self.fan.append((a, b))
        return self._known[a, b]

    def either(self, a, b):
        return self.both(a ^ 1, b ^ 1) ^ 1

    def differ(self, a, b):
        return self.either(self.both(a, b ^ 1), self.both(a ^ 1, b))

    def choose(self, condition, a, b):
        """a if condition, otherwise b."""
        return b if a == b else self.either(self.both(condition, a), self.both(condition ^ 1, b))

    def any(self, literals):
        result = FALSE
        for literal in literals:
            result = self.either(result, literal)
        return result

    def minus(self, a, b):
        """(a - b without the borrow, the borrow): lists of literals, lowest bit first."""
        borrow, result = FALSE, []
        for x, y in zip(a, b):
            apart = self.differ(x, y)
            result.append(self.differ(apart, borrow))
            borrow = self.choose(apart, y, borrow)
        return result, borrow


def simulate(graph, values):
    """The value of every node, one bit per lane; ``values``: {input node: integer}."""
    known = [0] * len(graph.fan)
    for node, fan in enumerate(graph.fan):
        if fan:
            a, b = fan
            known[node] = (known[a >> 1] ^ -(a & 1)) & (known[b >> 1] ^ -(b & 1)) & ALL
        else:
            known[node] = values.get(node, 0)
    return known


def lane_bits(known, literal):
    return (known[literal >> 1] ^ -(literal & 1)) & ALL


def write(path, graph, latches, outputs):
    """Write binary AIGER. ``latches``: [(literal of the latch's input node, next)]; they start at 0."""
    held = {literal >> 1 for literal, _ in latches}
    inputs = [node for node in graph.inputs if node not in held]
    gates = [node for node, fan in enumerate(graph.fan) if fan]
    order = [0, *inputs, *(literal >> 1 for literal, _ in latches), *gates]
    number = {node: index for index, node in enumerate(order)}

    def renamed(literal):
        return 2 * number[literal >> 1] | literal & 1

    lines = [f"aig {len(order) - 1} {len(inputs)} {len(latches)} {len(outputs)} {len(gates)}"]
    lines += [str(renamed(after)) for _, after in latches]
    lines += [str(renamed(literal)) for literal in outputs]
    body = bytearray("\n".join(lines).encode() + b"\n")
    for node in gates:
        high, low = sorted(map(renamed, graph.fan[node]), reverse=True)
        for delta in (2 * number[node] - high, high - low):
            while delta > 127:
                body.append(delta & 127 | 128)
                delta >>= 7
            body.append(delta)
    path.write_bytes(body)


def outputs_of(path):
    """Literals of the outputs of a binary AIGER file; 0 means that the output is always false."""
    lines = path.read_bytes().split(b"\n")
    _, _, _, latches, outputs, _ = lines[0].split()[:6]
    first = 1 + int(latches)
    return [int(line) for line in lines[first : first + int(outputs)]]
