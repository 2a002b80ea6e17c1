"""The complete core on Verilator, alone or in a board: codes at its converters' pins, bytes on its line."""

import ctypes
from contextlib import nullcontext
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from meissner.arrays import Ints
from meissner.builds import boards
from meissner.builds.build import Config, verilog
from meissner.builds.keys import ArrayAdc
from meissner.engines import verilated
from meissner.engines.rtl_slip import busy_clocks
from meissner.twins.link.uart import sixteenths

PIECE = 2000  # clocks simulated per read of the line


class _Size(ctypes.Structure):
    _fields_ = tuple(
        (name, ctypes.c_int32) for name in ("part", "converters", "adc_lanes", "rows", "columns", "channels")
    )


@verilated.cached
def _open(parameters: tuple[tuple[str, object], ...], folder: str | None) -> ctypes.CDLL:
    top, given = ("msn_core", dict(parameters)) if folder is None else ("msn_board", {})
    lib = ctypes.CDLL(str(verilated.library(top, "core_driver.cpp", given, include=folder)))
    pointer, long = ctypes.c_void_p, ctypes.c_int64
    lib.sensor_new.restype = pointer
    lib.sensor_new.argtypes = [
        *(ctypes.POINTER(_Size), ctypes.c_int32, long, long, pointer, long, long),
    ]
    lib.sensor_delete.argtypes = [pointer]
    lib.sensor_write.argtypes = [pointer, ctypes.c_char_p, long]
    lib.sensor_run.argtypes = [pointer, long, pointer, long]
    for count in ("sensor_run", "sensor_now", "sensor_frames"):
        getattr(lib, count).restype = long
    for count in ("sensor_now", "sensor_frames"):
        getattr(lib, count).argtypes = [pointer]
    return lib


class CoreOnPins:
    """A build of ``config`` (meissner.builds.build.Config) with a sensor that repeats ``codes``.

    ``codes``: integers [frames, rows, columns] of an array, else [frames, channels]. ``read`` and ``write``
    are the bytes of the line, as meissner.host.pty and meissner.host.line take them; reading runs the core.
    ``board``: (boards.Board, name) that ``config`` belongs to; then only its pins are used, and each frame
    of codes stays at the inputs for one frame period.
    """

    def __init__(
        self, config: Config, codes: ArrayLike, board: tuple[boards.Board, str] | None = None
    ) -> None:
        self.config = config
        self.units = config.units
        self.registers = bool(config.link.registers)  # whether a host can access registers
        self.codes = codes = np.ascontiguousarray(codes, dtype=np.int32)
        array = config.kind == "array"
        shape = config.shape if array else (config.channels,)
        if codes.shape[1:] != shape or not len(codes):
            raise ValueError(f"the codes must have the shape [frames, {', '.join(map(str, shape))}]")
        folder, parameters = None, config.parameters
        if board is not None:
            folder = f"build/board/{board[0].name}-{boards.label(board[1])}"
            parameters = board[0].parameters(board[1])
            boards.write_build(folder, parameters)
        self._lib = _open(tuple(verilog(parameters).items()), folder)
        size = _Size(
            *(config.part.number, getattr(config.adc, "converters", 1), config.adc.lanes),
            *(shape if array else (1, *shape)),
            config.adc.channels if isinstance(config.adc, ArrayAdc) else config.channels,
        )
        places = len(config.scan.scan.places()) if array else 1
        shown = 0 if board is None else config.period_clocks
        bit = sixteenths(1000 * config.clk_khz, config.link.baud)
        busy = busy_clocks(config.part, config.clk_khz)
        self._core = self._lib.sensor_new(size, busy, places, shown, codes.ctypes.data, len(codes), bit)
        self._waiting = bytearray()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        if self._core is not None:
            self._lib.sensor_delete(self._core)
            self._core = None

    @property
    def now(self) -> int:
        """Clocks since reset."""
        return self._lib.sensor_now(self._core)

    @property
    def simulated_s(self) -> float:
        """Seconds since reset, by the core's clock."""
        return self.now / (1000 * self.config.clk_khz)

    @property
    def frames(self) -> int:
        """Frames whose conversion has begun."""
        return self._lib.sensor_frames(self._core)

    def run(self, clocks: int) -> bytes:
        """The bytes that the core sends in ``clocks`` clocks."""
        room = int(clocks // 40 + 64)
        out = (ctypes.c_uint8 * room)()
        end, found = self.now + clocks, bytearray()
        while self.now < end:
            count = self._lib.sensor_run(self._core, end - self.now, ctypes.addressof(out), room)
            found += bytes(out[:count])
        return bytes(found)

    def read(self, n: int) -> bytes:
        """At most ``n`` bytes of the line; b"" if none arrived within PIECE clocks."""
        if not self._waiting:
            self._waiting += self.run(PIECE)
        data = bytes(self._waiting[:n])
        del self._waiting[: len(data)]
        return data

    def write(self, data: bytes) -> None:
        self._lib.sensor_write(self._core, data, len(data))


def line(board: boards.Board, name: str, codes: Ints, gates: bool = False) -> bytes:
    """The bytes on the serial line of a board with that configuration, from power-up on.

    ``codes``: as in CoreOnPins, each frame once; ``gates``: run the netlist after synthesis for this board.
    """
    with verilated.gates(board.cells) if gates else nullcontext():
        built = CoreOnPins(board.config(name), codes, (board, name))
    with built:
        return built.run(len(codes) * built.config.period_clocks)
