"""``meissner ports``: which ports are asked, what is sent to them, and what is said about each."""

import fcntl
import os
import re

import pytest
from serial.tools import list_ports
from serial.tools.list_ports_common import ListPortInfo

import synth
from meissner import cli
from meissner.builds import boards
from meissner.builds.toolchain import ROOT
from meissner.host.pty import Pty
from meissner.host.simulated import SimulatedCore, of_scenes
from meissner.twins.link import bridge
from meissner.twins.link import packet as p


class Noted:
    """A pipe that keeps what a host sends to the core behind it."""

    def __init__(self, core):
        self.core, self.sent = core, b""

    def read(self, n):
        return self.core.read(n)

    def write(self, data):
        self.sent += data
        self.core.write(data)


class Deaf(SimulatedCore):
    """A core without registers: it takes no commands."""

    def write(self, data):
        pass


class Noise:
    """Bytes that are no packets."""

    def read(self, n):
        return b"\x55\xaa\x00\x13"[:n]

    def write(self, data):
        pass


def info(path, identity="0000:0000", location=None, description="n/a"):
    port = ListPortInfo(path)
    port.vid, port.pid = (int(part, 16) for part in identity.split(":"))
    port.location, port.description = location, description
    return port


def lines(capsys, *arguments):
    cli.main(["ports", *arguments])
    said = capsys.readouterr()
    assert said.err == ""
    return said.out.splitlines()


class Silent:
    """An empty board."""

    def read(self, n):
        return b""

    def write(self, data):
        pass


CHIPS = {  # of the ports of a board that was plugged in: chip, place, what it calls itself; the last is asked
    "icebreaker": [
        ("0403:6010", "1-2:1.0", "iCEBreaker V1.0e"),
        ("0403:6010", "1-2:1.1", "iCEBreaker V1.0e"),
    ],
    "ulx3s": [("0403:6015", "1-2", "ULX3S FPGA 25K v3.0.8")],
    "tangnano20k": [("0403:6010", "1-2:1.0", "USB Debugger"), ("0403:6010", "1-2:1.1", "USB Debugger")],
    "orangecrab": [("0403:6001", "1-2", "FT232R USB UART")],
}


@pytest.mark.parametrize("board", CHIPS)
def test_a_start_page_shows_what_is_printed(board, capsys, monkeypatch):
    """By `ports` for an empty board, and by `make synth` at its end."""
    page = (ROOT / f"docs/start/{board}.md").read_text("utf-8")
    with Pty(Silent()) as pty:
        ports = [f"/dev/ttyUSB{k}" for k in range(len(CHIPS[board]))]
        found = [info(port, *about) for port, about in zip([*ports[:-1], pty.path], CHIPS[board])]
        monkeypatch.setattr(list_ports, "comports", lambda: found)
        said = "\n".join(sorted(line.replace(pty.path, ports[-1]) for line in lines(capsys)))
    assert f"```\n{said}\n```" in page, said
    steps = "\n".join(synth.after(boards.BOARDS[board], "slip1", f"{board}-slip1"))
    assert f"```\nwhat next:\n{steps}\n```" in page, steps


def test_a_core_is_described_and_only_read(capsys):
    noted = Noted(SimulatedCore(features=["slip", "cop"], size=(3, 5)))
    with Pty(noted) as pty:
        [said] = lines(capsys, pty.url)
    told = r"core 4d534e52, register map 0\.\d+: 3×5 taxels; slip, cop"  # the ID is "MSNR"
    assert re.fullmatch(rf"{pty.url}  {told}", said)
    found, rejected = bridge.accesses(noted.sent)
    assert rejected == 0 and len(found) > 5
    assert {operation for operation, *_ in found} == {bridge.READ}


def test_the_boards_serial_lines_are_asked_and_nothing_else(capsys, monkeypatch):
    """An iCEBreaker's second interface, a ULX3S, and beside them what must not get a byte: an iCEBreaker's
    first interface, which loads it, and a modem."""
    cores = {name: Noted(of_scenes("acrylic_slip")) for name in ("second", "first", "ulx3s", "modem")}
    ptys = {name: Pty(core) for name, core in cores.items()}
    found = [
        info(ptys["second"].path, "0403:6010", "1-2:1.1", "iCEBreaker V1.0e"),
        info(ptys["first"].path, "0403:6010", "1-2:1.0", "iCEBreaker V1.0e"),
        info(ptys["ulx3s"].path, "0403:6015", "1-3", "ULX3S"),
        info(ptys["modem"].path, "1234:5678", "1-4", "a modem"),
    ]
    monkeypatch.setattr(list_ports, "comports", lambda: found)
    try:
        said = {line.split()[0]: line for line in lines(capsys)}
    finally:
        for pty in ptys.values():
            pty.unplug()
    assert set(said) == {pty.path for pty in ptys.values()}
    for name in ("second", "ulx3s"):
        assert re.search(r"core \w{8}, register map .*; 3000000 baud$", said[ptys[name].path])
    assert said[ptys["modem"].path].endswith("a modem  not asked")
    assert "loads the board (icebreaker" in said[ptys["first"].path]
    assert {name for name, core in cores.items() if core.sent} == {"second", "ulx3s"}


@pytest.mark.parametrize(
    "pipe, says",
    [
        (
            lambda: Deaf([(k, p.COP, p.cop_frame(k, 0, 9, 1)) for k in range(50)]),
            "a core without registers: ",
        ),
        (Noise, "nothing answers"),
        (SimulatedCore, "core "),
    ],
)
def test_what_else_is_at_the_other_end(capsys, pipe, says):
    with Pty(pipe()) as pty:
        [said] = lines(capsys, pty.url)
    assert says in said


def test_a_port_in_use_and_a_port_that_is_gone(capsys):
    with Pty(SimulatedCore()) as pty:
        held = os.open(pty.path, os.O_RDWR | os.O_NOCTTY)
        fcntl.flock(held, fcntl.LOCK_EX)
        try:
            [said] = lines(capsys, pty.path)
        finally:
            os.close(held)
    assert said == f"{pty.path}  in use by another program"
    [said] = lines(capsys, "/dev/ttyNoSuch")
    assert said == "/dev/ttyNoSuch  cannot be opened: No such file or directory"


def test_without_a_port_it_says_so(capsys, monkeypatch):
    monkeypatch.setattr(list_ports, "comports", lambda: [])
    [said] = lines(capsys)
    assert said.startswith("no serial ports: ")


def test_the_rules_name_the_boards_chips():
    """Of each board that is loaded or read over USB, by the identities in the makers' files."""
    text = (ROOT / "host/60-meissner.rules").read_text()
    found = set(re.findall(r'ATTR\{idVendor\}=="(\w+)", ATTR\{idProduct\}=="(\w+)"', text))
    assert found == {("0403", "6010"), ("0403", "6015"), ("1209", "5af0"), ("1209", "5bf0")}
