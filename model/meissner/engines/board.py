"""A board from its converters' pins to its serial line: its sources, or the netlist of its bitstream."""

import ctypes
from contextlib import nullcontext

import numpy as np

from meissner import boards
from meissner.engines import verilated


def _open(board, name):
    folder = f"build/board/{board.name}-{name}"
    boards.write_build(folder, board.parameters(name))
    lib = ctypes.CDLL(str(verilated.library("msn_board", "board_driver.cpp", {}, include=folder)))
    lib.board_new.restype = ctypes.c_void_p
    lib.board_delete.argtypes = [ctypes.c_void_p]
    wide, small, pointer = ctypes.c_int64, ctypes.c_int32, ctypes.c_void_p
    lib.board_run.restype = wide
    lib.board_run.argtypes = [pointer, *[small] * 3, pointer, *[wide] * 3, pointer, wide]
    return lib


def line(board, name, codes, clocks, gates=False):
    """What the serial line says, as bytes, from power-up on.

    ``board``: boards.Board; ``codes``: raw codes int [steps, converters, 8], each shown for ``clocks`` clocks
    (to a matrix with something added for each row); ``gates``: the netlist after synthesis for this board.
    """
    parameters = board.parameters(name)
    sixteenths = (16_000 * parameters["ClkKhz"] + parameters["BaudHz"] // 2) // parameters["BaudHz"]
    with verilated.gates(board.cells) if gates else nullcontext():
        lib = _open(board, name)
    codes = np.ascontiguousarray(codes, dtype=np.int32)
    steps, converters, _ = codes.shape
    room = np.zeros(steps * clocks * 16 // sixteenths // 10 + 16, dtype=np.uint8)
    core = lib.board_new()
    try:
        count = lib.board_run(
            *(core, parameters["Adc"], converters, parameters["AdcLanes"], codes.ctypes.data, steps, clocks),
            *(sixteenths, room.ctypes.data, room.size),
        )
    finally:
        lib.board_delete(core)
    return room[:count].tobytes()
