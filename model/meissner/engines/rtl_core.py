"""The whole core on Verilator, on its own or in a board: codes at its converters' pins, bytes on its line."""

import ctypes
from contextlib import nullcontext

import numpy as np

from meissner import boards
from meissner.build import verilog
from meissner.engines import verilated
from meissner.link.uart_tx import sixteenths

CONVERSION_NS = 4000  # of a converter with BUSY
PIECE = 2000  # clocks between two looks at the line


class _Size(ctypes.Structure):
    _fields_ = tuple(
        (name, ctypes.c_int32) for name in ("part", "converters", "adc_lanes", "rows", "columns", "channels")
    )


@verilated.cached
def _open(parameters, folder):
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
    """A build of ``config`` (meissner.build.Config) with a sensor that gives ``codes``, over and over.

    ``codes``: integers [frames, rows, columns] of an array, [frames, channels] else. ``read`` and ``write``
    are the bytes of the line, as meissner.host.pty and meissner.host.line take them; reading runs the core.
    ``board``: (boards.Board, name), of which ``config`` is; nothing but its pins is seen, and each frame of
    codes stands there for its period.
    """

    def __init__(self, config, codes, board=None):
        self.config = config
        self.units = config.units
        self.registers = bool(config.link["registers"])  # whether a host may ask
        codes = np.ascontiguousarray(codes, dtype=np.int32)
        array = config.kind == "array"
        shape = (config.sensor["rows"], config.sensor["columns"]) if array else (config.channels,)
        if codes.shape[1:] != shape or not len(codes):
            raise ValueError(f"the codes must have the shape [frames, {', '.join(map(str, shape))}]")
        folder, parameters = None, config.parameters
        if board is not None:
            folder = f"build/board/{board[0].name}-{boards.label(board[1])}"
            parameters = board[0].parameters(board[1])
            boards.write_build(folder, parameters)
        self._lib = _open(tuple(verilog(parameters).items()), folder)
        size = _Size(
            *(config.part.number, config.adc.get("converters", 1), config.adc["lanes"]),
            *(shape if array else (1, *shape)),
            config.adc["channels"] if array else config.channels,
        )
        places = len(config.scan.scan.places()) if array else 1
        shown = 0 if board is None else config.period_clocks
        bit = sixteenths(1000 * config.clk_khz, config.link["baud"])
        busy = CONVERSION_NS * config.clk_khz // 1_000_000
        self._core = self._lib.sensor_new(size, busy, places, shown, codes.ctypes.data, len(codes), bit)
        self._waiting = bytearray()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        if self._core is not None:
            self._lib.sensor_delete(self._core)
            self._core = None

    @property
    def now(self):
        """Clocks since reset."""
        return self._lib.sensor_now(self._core)

    @property
    def simulated_s(self):
        """Seconds since reset, by its own clock."""
        return self.now / (1000 * self.config.clk_khz)

    @property
    def frames(self):
        """Frames of which the conversion began."""
        return self._lib.sensor_frames(self._core)

    def run(self, clocks):
        """The bytes that the core says in so many clocks."""
        room = int(clocks // 40 + 64)
        out = (ctypes.c_uint8 * room)()
        end, found = self.now + clocks, bytearray()
        while self.now < end:
            count = self._lib.sensor_run(self._core, end - self.now, ctypes.addressof(out), room)
            found += bytes(out[:count])
        return bytes(found)

    def read(self, n):
        """At most ``n`` bytes of the line; b"" if none came in a piece of time."""
        if not self._waiting:
            self._waiting += self.run(PIECE)
        data = bytes(self._waiting[:n])
        del self._waiting[: len(data)]
        return data

    def write(self, data):
        self._lib.sensor_write(self._core, data, len(data))


def line(board, name, codes, gates=False):
    """What the serial line of a board with that configuration says, as bytes, from power-up on.

    ``codes``: as of CoreOnPins, each frame once; ``gates``: the netlist after synthesis for this board.
    """
    with verilated.gates(board.cells) if gates else nullcontext():
        built = CoreOnPins(board.config(name), codes, (board, name))
    with built:
        return built.run(len(codes) * built.config.period_clocks)


SCENES = {(3, 3): "fsr_3x3", (64, 64): "fsr_64x64"}
PRESS_FRAMES = 256
BEFORE_S = 0.1  # of a scene of slip, before what it is about


def codes_of(config, seed=1):
    """Codes of the scene that shows what ``config`` is for: what its converter makes of a recording.

    An array that no scene has sees a press: see ``press``.
    """
    from meissner import scenes
    from meissner.host.units import of_scene
    from meissner.scenes.cop_slip import electrodes

    top = (1 << config.part.data_bits - config.part.signed) - 1
    if config.kind == "channels":
        scene = scenes.load("acrylic_slip")
        codes = scenes.simulate(scene, 0, seed).codes
        scale = of_scene(scene).volts_per_code / config.volts_per_code
        if scale != 1:
            codes = np.clip(np.rint(codes * scale), 0, top).astype(codes.dtype)
        return np.repeat(codes[:, None], config.channels, axis=1)
    if config.kind == "electrodes":
        scene = scenes.load("cop_slip")
        recording = scenes.simulate(scene, scene.conditions[0], seed)
        return config.cop4.convert(electrodes(recording.solution))
    shape = config.sensor["rows"], config.sensor["columns"]
    if shape in SCENES:
        codes = scenes.simulate(scenes.load(SCENES[shape]), seed).codes
        if codes.max() <= top:
            return codes
    return press(*shape, top, seed)


def press(rows, columns, top, seed=1):
    """Codes of something round that comes down, goes around and is shaken now and then: no physics."""
    rng = np.random.default_rng(seed)
    turn = 2 * np.pi * np.arange(PRESS_FRAMES)[:, None, None] / PRESS_FRAMES
    y = (np.arange(rows)[:, None] + 0.5) / rows - 0.5 - 0.25 * np.sin(turn)
    x = (np.arange(columns) + 0.5) / columns - 0.5 - 0.25 * np.cos(turn)
    held = np.minimum(1, np.arange(PRESS_FRAMES) / (PRESS_FRAMES / 4))[:, None, None]
    level = (0.02 + 0.6 * held * np.exp(-12 * (x * x + y * y))) * top
    shaken = np.arange(PRESS_FRAMES)[:, None, None] // 32 % 4 == 3
    level = level * (1 + np.where(shaken, rng.uniform(-0.2, 0.2, level.shape), 0))
    return np.clip(np.rint(level), 0, top).astype(np.int32)


def shown(config):
    """``codes_of`` for somebody who watches: where single channels slip, from shortly before that on."""
    from meissner import core

    codes = codes_of(config)
    if config.kind != "channels":
        return codes
    events = core.of_channels(codes, config.slip).slip
    before = round(BEFORE_S * config.rate_hz)
    return np.roll(codes, -max(0, int(events[0][0]) - before), axis=0) if events else codes
