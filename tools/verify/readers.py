"""The readers of lines and files that `make fuzz` tests: the files that each consists of, and its digest.

A reader's files are those that read the bytes. What they call with values that they have checked (twins,
engines, the rest of a configuration) does not count.
"""

from meissner.builds import toolchain
from verify import revision

LINE = ("twins/link/cobs.py", "twins/link/decoder.py", "twins/link/packet.py")
CORE = (*LINE, "host/__init__.py", "host/core.py", "host/line.py", "host/names.py", "host/packets.py")
ARRAYS = ("calibration.py", "files.py")
FILES = {  # {reader: patterns of its files in model/meissner}
    "decoder_python": LINE,
    "host": CORE,
    "host_pty": CORE,
    "config": (
        *("builds/build.py", "builds/config.py", "builds/four_wires.py", "builds/stages/*.py"),
        *("builds/units.py", "builds/configs/*.toml", "check.py", "plain.py"),
    ),
    "recordings": ARRAYS,
    "calibration": ARRAYS,
    "log": (
        "files.py",
        "host/log.py",
        "host/replay.py",
        "host/ros.py",
        "host/unfinished_log.py",
        "host/table.py",
    ),
}
IN_C = {"decoder_c": ("host/msn_packet.c", "host/msn_packet.h", "tb/host/packet_fuzz.c")}
CORPUS = {name: "packets" for name in ("decoder_python", "host", "host_pty", "decoder_c")}
TOOL = "tools/verify/fuzz.py"


def files_of(reader):
    """Paths of the reader's files, the tool and the files from which its inputs are made."""
    patterns = [f"model/meissner/{pattern}" for pattern in FILES.get(reader, ())] + [*IN_C.get(reader, ())]
    patterns += [TOOL, f"tb/corpus/{CORPUS.get(reader, reader)}/*"]
    return [path for pattern in patterns for path in sorted(toolchain.ROOT.glob(pattern))]


def digest(reader):
    """Eight digits that change with what the reader's record rests on."""
    return revision.of_reader(files_of(reader))
