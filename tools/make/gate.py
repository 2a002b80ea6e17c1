"""Compare each board's netlist with its sources: both get the same ADC codes and must send the same bytes.

    python tools/make/gate.py                     every pair of a board and a configuration
    python tools/make/gate.py icebreaker slip1    one pair
    python tools/make/gate.py --scenes            every scene on twins, RTL and netlist (gate_scenes.py)
    python tools/make/gate.py --scenes cop_slip   one scene

Each pair runs twice: with noise, in which an object later presses and is shaken now and then, and with the
scene that the configuration is meant for. Exit code 1 if a byte differs, or if no byte is sent.
"""

import argparse
import sys
import time

import numpy as np

import gate_scenes
from meissner import scenes
from meissner.builds import boards
from meissner.engines.rtl_core import line
from meissner.scenes.core_stimulus import codes_of
from meissner.twins.link.decoder import Decoder

# The part of a configuration's scene: first frame, number of frames, stride (so that a few show a press).
SCENES = {
    "slip1": (30_000, 9000, 1),
    "fingertip": (0, 400, 1),
    "cop4": (0, 450, 1),
    "array64": (0, 25, 12),
    "full": (0, 25, 12),
    "grip": (30_000, 9000, 1),
    "display": (0, 25, 12),
}


def codes(board, name, seed=1):
    """Raw codes [frames, channels] or [frames, rows, columns] of a contact with slips."""
    config = board.config(name)
    rng = np.random.default_rng(seed)
    top = (1 << config.part.data_bits - config.part.signed) - 1
    array = config.kind == "array"
    shape = config.shape if array else (config.channels,)
    steps = (40 if shape[0] > 8 else 400) if array else 1500
    t = np.arange(steps).reshape(steps, *(1 for _ in shape))
    free, held = (
        (0.1, 0.6) if array else (0.95, 0.63)
    )  # as a share of the range; under load a rubber's voltage falls, a taxel's rises
    level = np.where(t < steps // 6, free, held) * top
    shaken = t // 40 % 4 == 3
    noise = rng.integers(-6, 7, (steps, *shape)) + shaken * rng.integers(-top // 10, top // 10, level.shape)
    return np.clip(np.rint(level + noise), 0, top).astype(np.int32)


def scene(board, name):
    """Raw codes of the scene that a configuration is meant for, cut to the part in SCENES."""
    start, frames, every = SCENES[name]
    return codes_of(board.config(name))[start::every][:frames]


def compare(board, name, shown):
    """(bytes that a pair's sources send with these codes at the pins, whether its netlist sends the same)."""
    rtl, gate = (line(board, name, shown, gates) for gates in (False, True))
    return rtl, rtl == gate


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("board", nargs="?")
    parser.add_argument("config", nargs="?")
    parser.add_argument(
        "--scenes", nargs="*", metavar="SCENE", help="in place of boards; all of them if none"
    )
    options = parser.parse_args()
    try:
        if options.scenes is not None:
            chosen = [scenes.load(name).name for name in options.scenes or scenes.names()]
            sys.exit(gate_scenes.table(chosen))
        pairs = boards.pairs(options.board, options.config)
    except ValueError as error:
        parser.exit(2, f"gate: {error}\n")
    wrong = False
    for board, name in pairs:
        for what, shown in (("noise", codes(board, name)), ("scene", scene(board, name))):
            began = time.monotonic()
            said, same = compare(board, name, shown)
            packets = Decoder().next(said)
            wrong |= not same or not packets
            verdict = "the same" if same else "DIFFERENT"
            told = f"{len(shown)} frames, {len(packets)} packets, {verdict}; {time.monotonic() - began:.0f} s"
            print(f"{board.name}-{name}, {what}: {told}", flush=True)
    sys.exit(wrong)


if __name__ == "__main__":
    main()
