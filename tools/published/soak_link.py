"""Send slip events through the Verilated link at full image load and count the lost ones.

    python tools/published/soak_link.py [EVENTS] [SEED]

Images are offered back to back, CoP frames every thousand clocks, and events in bursts that fill their queue;
a bit lasts four clocks. The portable C decoder reads the line.
"""

import ctypes
import sys
import time

from meissner.builds.toolchain import ROOT
from meissner.engines import verilated
from meissner.twins.link.uart import sixteenths

DRIVER = ROOT / "tools/published/soak_driver.cpp"
TAXELS, DEPTH, CLK_HZ, BAUD_HZ = 1024, 64, 24_000_000, 6_000_000
NAMES = ("events", "lost", "wrong", "images", "cops", "clocks", "held")


class Soak(ctypes.Structure):
    """``images``, ``cops``: numbers of packets; ``held``: clocks in which an event waited for room."""

    _fields_ = tuple((name, ctypes.c_int64) for name in NAMES)


def soak(events, mean=1000, burst=100, seed=1):
    """A soak with so many events, on average ``mean`` clocks apart, in bursts of up to ``burst``."""
    parameters = {
        "ClkKhz": CLK_HZ // 1000,
        "BaudHz": BAUD_HZ,
        "Taxels": TAXELS,
        "SlipDepth": DEPTH,
        "Health": 0,
    }
    lib = ctypes.CDLL(str(verilated.library("msn_link", DRIVER, parameters)))
    number = ctypes.c_int32
    pointer = ctypes.POINTER(Soak)
    lib.soak_run.argtypes = [
        ctypes.c_int64,
        ctypes.c_int64,
        number,
        number,
        number,
        ctypes.c_uint32,
        pointer,
    ]
    found = Soak()
    lib.soak_run(events, sixteenths(CLK_HZ, BAUD_HZ), mean, burst, TAXELS, seed, found)
    return found


def main():
    given = [int(argument) for argument in sys.argv[1:3]]
    events, seed = [*given, *(1_000_000, 1)[len(given) :]]
    began = time.perf_counter()
    found = soak(events, seed=seed)
    print(
        f"{found.events} slip events, {found.lost} lost, {found.wrong} wrong; beside them {found.images} "
        f"packets of images and {found.cops} CoP frames; {found.held} clocks that an event waited for room; "
        f"{found.clocks} clocks in {time.perf_counter() - began:.0f} s, seed {seed}"
    )
    sys.exit(bool(found.lost or found.wrong or found.events != events))


if __name__ == "__main__":
    main()
