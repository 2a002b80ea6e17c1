"""``meissner ports``: the serial ports of this computer, and which core answers on them.

A port is opened and listened to; then the core's own description is read, a read of docs/link.md at a time,
and nothing is written. A port is asked if its USB chip is that of a board of docs/boards.md, except the
interface that loads the board; any other only if it is named, since bytes may mean something to it.
"""

import errno
import os
from argparse import Namespace
from contextlib import closing, suppress
from typing import Any

from meissner.builds.flash import EVERY
from meissner.builds.pins import description
from meissner.host import line, names
from meissner.host.core import Core, NoAnswer, Refused
from meissner.terminal import plain

BAUDS = (3_000_000, 1_000_000)  # of the named configurations
LISTEN_S, ANSWER_S = 0.3, 0.15


def _boards(port: Any) -> list[str]:
    """The boards whose USB chip this port has."""
    own = f"{port.vid or 0:04x}:{port.pid or 0:04x}"
    return [name for name in EVERY if description(name).usb["id"] == own]


def _loads(port: Any, boards: list[str]) -> bool:
    """Whether it is the interface that loads the board, not its serial line."""
    interface = (port.location or "").rpartition(".")[2]
    return bool(boards) and interface.isdecimal() and int(interface) < description(boards[0]).usb["interface"]


def _core(core: Core) -> str:
    rows, columns = core.units.rows or 1, core.units.columns or 1
    shape = f"{columns} channel{'s' * (columns > 1)}" if rows == 1 else f"{rows}×{columns} taxels"
    version = ".".join(str(names.CONSTANTS[f"core.version.{part}"]) for part in ("major", "minor"))
    features = ", ".join(name for name in core.features if name != "core")
    return f"core {names.CONSTANTS['core.id.value']:08x}, register map {version}: {shape}; {features}"


def _heard(opened: line.Line) -> str | None:
    """What is at the other end of an open line, in words; None if nothing understandable came."""
    core = Core(opened, registers=False, timeout_s=ANSWER_S, retries=1, give_up_s=0.0, say=lambda _: None)
    for _ in core.packets(LISTEN_S):
        pass
    try:
        core.identify()
        return _core(core)
    except Refused as refused:
        return str(refused)
    except NoAnswer:
        packets = core.counts.packets
        return f"a core without registers: {packets} packets came, no answer" if packets else None


def asked(url: str, bauds: tuple[int, ...]) -> str:
    """What answers on a port or another line of meissner.host.line, in words."""
    device = url.startswith("/dev/")
    for baud in bauds if device else bauds[:1]:
        try:
            opened = line.Device(url, baud) if device else line.open_line(url)
        except OSError as problem:
            if problem.errno in (errno.EAGAIN, errno.EBUSY):
                return "in use by another program"
            if problem.errno == errno.EACCES:
                return "you may not open it: host/60-meissner.rules, or the group dialout"
            return f"cannot be opened: {os.strerror(problem.errno) if problem.errno else problem}"
        with closing(opened):
            found = _heard(opened)
        if found is not None:
            return f"{found}; {baud} baud" if device else found
    tried = " and ".join(f"{baud}" for baud in bauds)
    return f"nothing answers at {tried} baud" if device else "nothing answers"


def command(arguments: Namespace) -> None:
    """``meissner ports``."""
    from serial.tools import list_ports

    bauds = (arguments.baud,) if arguments.baud else BAUDS
    if not all(300 <= baud <= 100_000_000 for baud in bauds):
        raise ValueError(f"baud = {arguments.baud} must lie in 300 .. 100000000")
    if arguments.ports:
        found = [(url, "", True) for url in arguments.ports]
    else:
        found = []
        for port in sorted(list_ports.comports()):
            boards = _boards(port)
            if _loads(port, boards):
                boards, what = [], f"loads the board ({', '.join(boards)})"
            else:
                what = port.description if port.description not in (None, "n/a") else "unknown"
            found.append((port.device, what, bool(boards)))
    if not found:
        print("no serial ports: is the board plugged in, by a cable with data lines?")
    for url, what, ask in found:
        with suppress(BrokenPipeError):
            said = asked(url, bauds) if ask else "not asked"
            print("  ".join(filter(None, (plain(url), plain(what), said))), flush=True)
