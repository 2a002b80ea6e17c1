"""A block as bits: Yosys makes them from the sources or by synthesis; this module turns them into a graph.

Products are leaves: black boxes on both sides, whose results are free like inputs and whose operands are
compared like outputs. The blocks inside a block can be leaves as well.
"""

import json
import re
from dataclasses import dataclass, field

from meissner.builds import toolchain, yowasp
from nightly import proofs
from nightly.aig import FALSE, TRUE, Aig

HERE = "tools/nightly"
FAMILIES = {
    "ecp5": ("synth_ecp5 -run begin:check -nobram -nolutram -nodsp", "+/ecp5/cells_sim.v"),
    "ice40": ("synth_ice40 -run begin:check -nobram", "+/ice40/cells_sim.v"),
}
# Undefined values, such as a word beyond a memory's end, are 0 on both sides.
ZERO = "setundef -undriven -zero; setundef -zero"
BITS = (
    f"techmap -map {HERE}/carry_map.v -map +/techmap.v; dffunmap; simplemap; opt_clean; {ZERO}; "
    "aigmap; opt_clean; check -assert; setattr -unset src */t:* */w:*"
)
DEFINED = f"techmap -map {HERE}/defined_map.v; memory -nordff; {ZERO}; opt_clean; "


@dataclass
class Circuit:
    """Bits as Yosys numbers them; "0" and "1" are constants.

    ``inputs``, ``outputs``: {(name, index): bit}, including those of boxes as ("box.port", index);
    ``registers``: {Q: D}; ``gates``: {Y: its operands, two for an AND, one for an inverter};
    ``names``: {bit: every (name, index) it has in the source}; ``boxes``: {instance: block without msn_}.
    """

    inputs: dict = field(default_factory=dict)
    outputs: dict = field(default_factory=dict)
    registers: dict = field(default_factory=dict)
    gates: dict = field(default_factory=dict)
    names: dict = field(default_factory=dict)
    boxes: dict = field(default_factory=dict)

    def build(self, graph, given):
        """Literals in ``graph`` of every bit; ``given``: those of inputs and registers."""
        known = {"0": FALSE, "1": TRUE, **given}
        for root in self.gates:
            waiting = [root]
            while waiting:
                bit = waiting[-1]
                if bit in known:
                    waiting.pop()
                    continue
                if bit not in self.gates:
                    raise ValueError(f"bit {bit} {self.names.get(bit, '')} has no driver")
                operands = self.gates[bit]
                if open_ones := [one for one in operands if one not in known]:
                    waiting += open_ones
                    continue
                first = known[operands[0]]
                known[bit] = graph.both(first, known[operands[1]]) if len(operands) == 2 else first ^ 1
                waiting.pop()
        return known

    def widths(self):
        """{name: bits}."""
        found = {}
        for known in self.names.values():
            for name, index in known:
                found[name] = max(found.get(name, 0), index + 1)
        return found

    def holders(self):
        """{(name, index): (Q, inverted)} for signals that equal a register or its inverse.

        Q is None for a constant.
        """
        graph = Aig()
        given = {bit: graph.input() for bit in [*self.registers, *self.inputs.values()]}
        of = {given[bit]: bit for bit in self.registers} | {FALSE: None}
        known = self.build(graph, given)
        found = {}
        for bit, names in self.names.items():
            literal = known.get(bit)
            if literal is not None and literal & ~1 in of:
                found.update(dict.fromkeys(names, (of[literal & ~1], literal & 1)))
        return found


def load(path, top):
    """The circuit of a netlist in Yosys's JSON; it must have one clock."""
    module = json.loads(path.read_text())["modules"][top]
    circuit = Circuit()
    clock = module["ports"].get("clk_i", {"bits": [None]})["bits"][0]
    for name, port in module["ports"].items():
        if name != "clk_i":
            side = circuit.inputs if port["direction"] == "input" else circuit.outputs
            side.update({(name, index): bit for index, bit in enumerate(port["bits"])})
    for name, cell in module["cells"].items():
        pins = cell["connections"]
        if cell["type"] == "$_DFF_P_":
            if pins["C"][0] != clock:
                raise ValueError(f"{top}: {name} has another clock")
            circuit.registers[pins["Q"][0]] = pins["D"][0]
        elif cell["type"] == "$_AND_":
            circuit.gates[pins["Y"][0]] = (pins["A"][0], pins["B"][0])
        elif cell["type"] == "$_NOT_":
            circuit.gates[pins["Y"][0]] = (pins["A"][0],)
        elif cell["type"] == "$scopeinfo":
            pass
        elif re.search(r"product|\bmsn_", cell["type"]):
            if found := re.search(r"\bmsn_(\w+)", cell["type"]):
                circuit.boxes[name] = found[1]
            for pin, bits in pins.items():
                if pin == "clk_i":
                    if bits != [clock]:
                        raise ValueError(f"{top}: {name} has another clock")
                    continue
                inward = cell["port_directions"][pin] == "output"
                side = circuit.inputs if inward else circuit.outputs
                side.update({(f"{name}.{pin}", index): bit for index, bit in enumerate(bits)})
        else:
            raise ValueError(f"{top}: {name} is a {cell['type']}")
    for name, net in module["netnames"].items():
        if not net["hide_name"]:
            for index, bit in enumerate(net["bits"]):
                circuit.names.setdefault(bit, []).append((name, index))
    return circuit


FRAMED = """
module {top}_framed ({ports});
  reg [15:0] place; reg begun, again, waits;
  (* keep *) reg moved;  // a sample has left the block's first register
  wire took = in_valid_i && in_ready_o, ends = place == {last};
  wire fresh = place == 0 ? in_restart_i || !begun : again;
  always @(posedge clk_i) begin
    if (took) begin place <= ends ? 0 : place + 1; begun <= 1; again <= fresh; end
    if (in_ready_o) begin waits <= in_valid_i; moved <= moved || waits; end
    if (rst_i) begin place <= 0; begun <= 0; waits <= 0; moved <= 0; end
  end
  {top} block ({pins});
endmodule
"""
SAYS = {
    "in_id_i": "in_valid_i ? place : in_id_i",
    "in_last_i": "in_valid_i ? ends : in_last_i",
    "in_restart_i": "in_valid_i ? fresh : in_restart_i",
}


def framed(block, circuit, channels):
    """Verilog around a block of the slip path that gives it frames as msn_frame_filter sends them.

    Samples are numbered 0 .. channels - 1 and the last is marked; ``restart`` is constant over a frame and 1
    in the first frame.
    """
    sides = {"input": circuit.inputs, "output": circuit.outputs}
    found = [(side, name, index) for side, bits in sides.items() for name, index in bits if "." not in name]
    widths = {(side, name): max(i for s, n, i in found if n == name) + 1 for side, name, _ in found}
    ports = ["input clk_i"] + [f"{side} [{width - 1}:0] {name}" for (side, name), width in widths.items()]
    pins = [".clk_i(clk_i)"] + [f".{name}({SAYS.get(name, name)})" for _, name in widths]
    text = {"ports": ", ".join(ports), "pins": ", ".join(pins), "last": channels - 1}
    return FRAMED.format(top=f"msn_{block}", **text)


def boxed(top):
    """Yosys commands that make every block in ``top`` a black box and keep it even with unused outputs."""
    return f"select -set boxes =*msn_* ={top} %d; blackbox @boxes; setattr -mod -set keep 1 @boxes; "


def boxes(circuit):
    """Names, without msn_, of the blocks that are boxes in ``circuit``."""
    return sorted(set(circuit.boxes.values()))


def synthesise(block, parameters, folder, families=FAMILIES, defined=False, around="", cut=False, slang=True):
    """Netlists of ``msn_<block>`` in ``folder``, relative to ROOT: {"source": circuit, family: circuit}.

    ``slang``: slang reads the source that is compared with a netlist, so that a misreading by Yosys' own
    reader shows as a difference. ``defined``: memories become registers and undefined values 0 before
    synthesis; ``around``: the Verilog from ``framed``, which becomes the top; ``cut``: the blocks inside are
    boxes.
    """
    top = f"msn_{block}"
    (toolchain.ROOT / folder).mkdir(parents=True, exist_ok=True)
    files = [str(path.relative_to(toolchain.ROOT)) for path in toolchain.sources_of(top)]
    given = yowasp.chparam(top, parameters)
    if around:
        (toolchain.ROOT / folder / "around.v").write_text(around)
        given += f"read_verilog -sv {folder}/around.v; "
        top = f"{top}_framed"
    flat = (
        f"rename -top {top}; {boxed(top) if cut else ''}proc; flatten; setattr -unset src */t:* */w:* */m:*; "
    )
    if block != "multiply":
        flat += f"wreduce t:$mul; techmap -map {HERE}/leaves_map.v; "
        flat += "rename -enumerate -pattern product_% t:product; "
    flat += f"opt_clean; {DEFINED if defined else ''}"
    source = f"techmap -map {HERE}/defined_map.v; memory -nordff; {BITS}; write_json {folder}/source.json"
    leaves = f"read_verilog -sv {HERE}/leaves.v"
    by_yosys = f"read_verilog -sv {' '.join(files)}; {leaves}; {given}hierarchy -check -top {top}; {flat}"
    if families and slang:
        by_slang = proofs.by_slang(files, top, parameters, "--keep-hierarchy" if cut else "")
        script = [f"{by_slang}; {leaves}; {flat}{source}"]
        script += [f"design -reset; {by_yosys}design -save read"]
    else:
        script = [f"{by_yosys}design -save read; {source}"]
    for family in families:
        synth, cells = FAMILIES[family]
        script += [
            f"design -load read; {synth} -top {top}",
            f"techmap -wb -D EQUIV -autoproc -map {cells}",
            f"setattr -unset init; flatten; hierarchy -top {top} -purge_lib; {BITS}",
            f"write_json {folder}/{family}.json",
        ]
    yowasp.yosys("; ".join(script), f"{folder}/yosys.log")
    return {name: load(toolchain.ROOT / folder / f"{name}.json", top) for name in ("source", *families)}
