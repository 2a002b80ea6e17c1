"""Each board's netlist against its sources: the same codes at the converters' pins, the same bytes sent.

    python tools/gate.py                     every pair of a board and a configuration
    python tools/gate.py icebreaker slip1    one

After a while something presses, and is shaken now and then. Exit code 1 if a byte differs, or if none came.
"""

import argparse
import sys
import time

import numpy as np

from meissner import boards
from meissner.engines.rtl_core import line


def codes(board, name, seed=1):
    """Raw codes [frames, channels] or [frames, rows, columns] that make a contact and slips."""
    config = board.config(name)
    rng = np.random.default_rng(seed)
    top = (1 << config.part.data_bits - config.part.signed) - 1
    array = config.kind == "array"
    shape = (config.sensor["rows"], config.sensor["columns"]) if array else (config.channels,)
    steps = 400 if array else 1500
    t = np.arange(steps).reshape(steps, *(1 for _ in shape))
    free, held = (
        (0.1, 0.6) if array else (0.95, 0.63)
    )  # of the range; a rubber's voltage falls, a taxel's rises
    level = np.where(t < steps // 6, free, held) * top
    shaken = t // 40 % 4 == 3
    noise = rng.integers(-6, 7, (steps, *shape)) + shaken * rng.integers(-top // 10, top // 10, level.shape)
    return np.clip(np.rint(level + noise), 0, top).astype(np.int32)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("board", nargs="?")
    parser.add_argument("config", nargs="?")
    options = parser.parse_args()
    try:
        pairs = boards.pairs(options.board, options.config)
    except ValueError as error:
        parser.exit(2, f"gate: {error}\n")
    wrong = False
    for board, name in pairs:
        began = time.monotonic()
        shown = codes(board, name)
        rtl, gate = (line(board, name, shown, gates) for gates in (False, True))
        wrong |= rtl != gate or not rtl
        verdict = "the same" if rtl == gate else "DIFFERENT"
        print(
            f"{board.name}-{name}: {len(rtl)} bytes, {verdict}; {time.monotonic() - began:.0f} s", flush=True
        )
    sys.exit(wrong)


if __name__ == "__main__":
    main()
