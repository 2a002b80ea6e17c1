"""Measure how far a board's LUT count depends on the order in which ABC gets the gates.

    python tools/published/orders.py ulx3s slip1                        20 orders
    python tools/published/orders.py ulx3s slip1 --synth synth_ecp5     with another synthesis command than the board's
    python tools/published/orders.py ulx3s cop4 --orders 5

Yosys makes the gates once. For each order the top's cells are shuffled with a seed and mapped by ABC. Only
the mapping changes, so two revisions differ in area only if their LUT ranges differ. For boards with an ECP5.
"""

import argparse
import json
import random
import re
import statistics
from collections import Counter

from meissner.builds import boards
from meissner.builds.yowasp import ROOT, read_rtl, yosys

CELLS = "read_verilog -lib -specify +/lattice/cells_sim_ecp5.v +/lattice/cells_bb_ecp5.v"


def parts(text):
    """(text before the cells, cells, text after them) of the RTLIL ``text`` of one module."""
    lines = text.splitlines(keepends=True)
    begin = next(n for n, line in enumerate(lines) if line.startswith("module "))
    head, cells, tail, held = lines[: begin + 1], [], [], []
    inside = False
    for line in lines[begin + 1 :]:
        held.append(line)
        inside = inside or line.startswith("  cell ")
        if line.startswith("  attribute ") or (inside and line != "  end\n"):
            continue
        if inside:
            cells.append("".join(held))
        else:
            (tail if line.startswith(("  connect ", "end")) else head).extend(held)
        held, inside = [], False
    return "".join(head), cells, "".join(tail)


def gates(board, config, synth, folder):
    """The board's top as it is passed to ABC, as RTLIL."""
    boards.write_board(folder, board, config)
    sources = f"{' '.join(board.sources)} {folder}/{board.top}.sv"
    script = f"{read_rtl(board.cells)}; read_verilog -sv -I{folder} {sources}; "
    script += f"{synth} -run :map_luts -top {board.top}; "
    script += f"select {board.top}; write_rtlil -selected {folder}/gates.il"
    yosys(script, f"{folder}/gates.log")
    return (ROOT / folder / "gates.il").read_text("utf-8")


def luts(text, board, synth, folder):
    """(LUT4 count, AND gates that ABC got) for the RTLIL ``text``."""
    (ROOT / folder / "order.il").write_text(text, "utf-8")
    script = f"{CELLS}; read_rtlil {folder}/order.il; {synth} -run map_luts:check -top {board.top}; "
    said = yosys(f"{script}blackbox =A:whitebox; write_json {folder}/order.json", f"{folder}/order.log")
    module = json.loads((ROOT / folder / "order.json").read_text("utf-8"))["modules"][board.top]
    found = Counter(cell["type"] for cell in module["cells"].values())
    return found["LUT4"], int(re.search(r"Extracted (\d+) AND gates", said)[1])


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("board", choices=[name for name, b in boards.BOARDS.items() if b.cells == "ecp5"])
    parser.add_argument("config")
    parser.add_argument("--orders", type=int, default=20, metavar="N")
    parser.add_argument("--synth", metavar="COMMAND")
    options = parser.parse_args()
    board = boards.BOARDS[options.board]
    synth, folder = options.synth or board.synth, f"build/orders/{board.name}-{boards.label(options.config)}"
    head, cells, tail = parts(gates(board, options.config, synth, folder))
    first, ands = luts(head + "".join(cells) + tail, board, synth, folder)
    found = []
    for seed in range(1, options.orders + 1):
        shuffled = random.Random(seed).sample(cells, len(cells))
        lut, there = luts(head + "".join(shuffled) + tail, board, synth, folder)
        if there != ands:
            raise RuntimeError(f"order {seed} has {there} AND gates, Yosys's own {ands}")
        found.append(lut)
    print(f"{synth}: {len(cells)} cells, {ands} AND gates; {first} LUT4 in Yosys's own order")
    spread = f"mean {statistics.mean(found):.1f}, standard deviation {statistics.pstdev(found):.1f}"
    print(f"seeds 1 to {options.orders}: {min(found)} to {max(found)} LUT4, {spread}\n{found}")


if __name__ == "__main__":
    main()
