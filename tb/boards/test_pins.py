"""Every input of every board: its pull in the constraints, and its destination in the netlist.

An input that changes at any time (the serial line, BUSY, moving, a PLL's lock) feeds one flip-flop, through
inverters at most, and that flip-flop feeds only one other: msn_sync. A converter's DOUT changes at a known
time after SCLK and feeds one flip-flop. Any other input except the clock is unknown here and fails the test.
"""

import json
import re

import pytest

from meissner.builds import boards
from meissner.builds.yowasp import ROOT, read_rtl, yosys

CLOCK, TIMED = r"clk_\w+_i", r"(onboard_)?adc_miso_i"
ASYNCHRONOUS = r"rx_i|moving(_n)?_i|adc_busy_i"
REST = {"rx_i": "up", "moving_i": "down", "moving_n_i": "up", "adc_busy_i": "down"}  # and DOUT: "up"
PATTERNS = {  # how a constraints file sets the pull of a port
    (".lpf", "up"): 'IOBUF PORT "{}" PULLMODE=UP ',
    (".lpf", "down"): 'IOBUF PORT "{}" PULLMODE=DOWN ',
    (".pcf", "up"): "set_io -pullup yes {} ",
    (".cst", "up"): 'IO_PORT "{}" IO_TYPE=LVCMOS33 PULL_MODE=UP;',
    (".cst", "down"): 'IO_PORT "{}" IO_TYPE=LVCMOS33 PULL_MODE=DOWN;',
    (".xdc", "up"): "PULLUP TRUE}} [get_ports {{{}}}]",
    (".xdc", "down"): "PULLDOWN TRUE}} [get_ports {{{}}}]",
}
ALL = [*boards.BOARDS.values(), boards.ARTY]
LOCKS = ("LOCK", "LOCKED")
# Board, configuration, and inputs that the configuration may leave unused.
CASES = [(board, "slip1", {"rx_i"}) for board in ALL]
CASES += [(boards.BOARDS["ulx3s"], "cop4", {"moving_i"})]


def written(board, name):
    """Write a board's top and constraints for that configuration; returns the folder."""
    folder = f"build/tb/pins/{board.name}-{name}"
    boards.write_board(folder, board, name)
    return folder


def inputs(board, name):
    """Yields (port, bit of the port) for every input."""
    text = (ROOT / written(board, name) / f"{board.top}.sv").read_text()
    for width, name in re.findall(r"^  input +logic +(\[\d+:0\])? *(\w+)", text, re.M):
        for bit in range(int(width[1:-3]) + 1) if width else [None]:
            yield name, name if bit is None else f"{name}[{bit}]"


@pytest.mark.parametrize(
    "board, name", [case[:2] for case in CASES], ids=[f"{case[0].name}-{case[1]}" for case in CASES]
)
def test_every_input_has_its_pull(board, name):
    path = ROOT / written(board, name) / f"{board.top}{board.constraints}"
    found = [line for line in path.read_text().splitlines() if not line.startswith(("#", "//"))]
    checked = 0
    for signal, port in inputs(board, name):
        if re.fullmatch(CLOCK, signal):
            continue
        pull = "up" if re.fullmatch(TIMED, signal) else REST[signal]
        assert (path.suffix, pull) in PATTERNS, f"{path.name}: no pull {pull} on this part, for {port}"
        wanted = PATTERNS[path.suffix, pull].format(port)
        assert any(wanted in line for line in found), f"{path.name}: {port} is not pulled {pull}"
        checked += 1
    assert checked >= 3


def netlists(cases):
    """The top of each case in Yosys's JSON, flattened, registers not mapped. Yosys reads the sources
    once: that takes as long as the rest for a board."""
    script, folders = [f"read_verilog -lib tb/lint/cells.v; {read_rtl()}; design -save sources"], []
    for board, name, _ in cases:
        folders.append(folder := written(board, name))
        # The package again, whose types Yosys's reader forgets.
        files = ["rtl/msn_pkg.sv", "rtl/frontend/msn_adc_pkg.sv", *board.sources, f"{folder}/{board.top}.sv"]
        script += [
            "design -load sources",
            f"read_verilog -sv -nooverwrite -I{folder} {' '.join(files)}",
            f"hierarchy -top {board.top}; proc; flatten; opt -full; clean; write_json {folder}/netlist.json",
        ]
    yosys("; ".join(script), "build/tb/pins/log")
    texts = [(ROOT / folder / "netlist.json").read_text() for folder in folders]
    return [json.loads(text)["modules"][board.top] for (board, _, _), text in zip(cases, texts)]


class Netlist:
    """Which cells read a bit of the flat netlist."""

    def __init__(self, module):
        self.module, self.readers = module, {}
        for name, cell in module["cells"].items():
            for port, bits in cell["connections"].items():
                if cell["port_directions"][port] == "input":
                    for place, bit in enumerate(bits):
                        self.readers.setdefault(bit, []).append((name, port, place))

    def cell(self, name):
        return self.module["cells"][name]

    def after_inverters(self, bit):
        """(cell, port, place) of each reader of the bit, seen through inverters."""
        for name, port, place in self.readers.get(bit, ()):
            cell = self.cell(name)
            if cell["type"] in ("$not", "$_NOT_", "$logic_not") and len(cell["connections"]["Y"]) > place:
                yield from self.after_inverters(cell["connections"]["Y"][place])
            else:
                yield name, port, place

    def registers(self, bit, seen):
        """Flip-flops that the bit reaches through any logic."""
        for name, port, place in self.readers.get(bit, ()):
            cell = self.cell(name)
            if "ff" in cell["type"]:
                yield name, port, place
            elif name not in seen:
                assert not cell["type"].startswith("$mem"), f"a memory, {name}, reads an input"
                for out, way in cell["port_directions"].items():
                    if way == "output":
                        # Bitwise cells are followed bit by bit: a wide multiplexer does not mix its bits.
                        of = cell["connections"][out]
                        same = cell["type"] in ("$mux", "$pmux", "$not") and port != "S"
                        for bit_out in [of[place % len(of)]] if same else of:
                            yield from self.registers(bit_out, seen | {name})

    def synchronised(self, bit, what):
        """Check that the bit feeds only the first flip-flop of an msn_sync; False if nothing reads it."""
        readers = list(self.after_inverters(bit))
        if not readers:
            return False
        assert len(readers) == 1, f"{what} goes into {readers}"
        (name, port, place) = readers[0]
        cell = self.cell(name)
        assert cell["type"] == "$dff" and port == "D", f"{what} goes into {name}, {cell['type']}.{port}"
        second = list(self.readers.get(cell["connections"]["Q"][place], ()))
        assert len(second) == 1, f"the first flip-flop of {what} steers {second}"
        (name, port, _) = second[0]
        assert self.cell(name)["type"] == "$dff" and port == "D", f"{what}: {name} is no second flip-flop"
        return True


@pytest.mark.long
def test_inputs_go_into_one_register_each(subtests):
    for (board, name, unused), module in zip(CASES, netlists(CASES)):
        with subtests.test(board=board.name, configuration=name):
            check_inputs(board, name, unused, module)


def check_inputs(board, name, unused, module):
    """The destination of every input, as the head of this file says."""
    found, read = Netlist(module), set()
    for port, of in module["ports"].items():
        if of["direction"] != "input" or re.fullmatch(CLOCK, port):
            continue
        for place, bit in enumerate(of["bits"]):
            what = f"{board.name} {name}: {port}[{place}]"
            if re.fullmatch(ASYNCHRONOUS, port):
                if found.synchronised(bit, what):
                    read.add(port)
            else:
                assert re.fullmatch(TIMED, port), f"{what} is no input that is known"
                registers = set(found.registers(bit, frozenset()))
                assert len(registers) <= 1, f"{what} goes into {registers}"
                if registers:
                    read.add(port)
    for cell in module["cells"].values():
        for port in set(LOCKS) & set(cell["connections"]):
            (bit,) = cell["connections"][port]
            assert found.synchronised(bit, f"{board.name}: {port}")
            read.add("lock")
    known = {signal for signal, _ in inputs(board, name) if not re.fullmatch(CLOCK, signal)}
    assert read - unused == known - unused | {"lock"} & read
    assert ("lock" in read) == (board.name in ("ulx3s", "arty_a7"))  # boards whose clock needs a PLL
