"""Draw how each named configuration is wired on each of its boards: docs/wiring/ and docs/wiring.md."""

from meissner.builds import boards, config
from meissner.builds.toolchain import ROOT
from meissner.builds.wiring.drawing import svg

FOLDER = ROOT / "docs/wiring"
PAGE = ROOT / "docs/wiring.md"
HEAD = """# Wiring

`make wiring` draws these, `make synth` each beside its bitstream, and this any configuration on any board:

    .venv/bin/meissner wiring mine.toml --board icebreaker --out wiring.svg

The rows of the table on the right are the ports of the bitstream with header, pin of the FPGA and signal, as
place and route gets them (`tb/boards/test_wiring.py` compares them with the constraints). The numbers of the
converters' pins are those of KiCad's symbols; where a note says so they are from memory. A converter with
one supply is drawn at 3.3 V, that of the boards' pins: a code is a share of it, so the bitstream is the same.
`--volts 5` draws the level shifters that it needs at 5 V, where an MCP3208 takes 3.5 V and more for high,
and sends 5 V. What a column of a resistive matrix ends in: [fsr.md](fsr.md#which-circuit).
"""


def pictures():
    """{file name: the drawing}."""
    return {f"{board.name}-{name}.svg": svg(board, name) for board, name in boards.pairs()}


def page():
    lines = [HEAD]
    for name in config.names():
        on = [board for board, other in boards.pairs() if other == name]
        about = config.load(name).about
        lines.append(f"## {name}\n\n{about[0].upper()}{about[1:]}.\n")
        lines += [f"![{name} on the {board.title}](wiring/{board.name}-{name}.svg)\n" for board in on]
    return "\n".join(lines)


def main():
    FOLDER.mkdir(exist_ok=True)
    found = pictures()
    for name, drawing in found.items():
        (FOLDER / name).write_bytes(drawing)
    PAGE.write_text(page(), "utf-8")
    print(f"{len(found)} drawings in {FOLDER.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
