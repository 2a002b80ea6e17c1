"""Engine ``rtl`` for a hand in closed loop: a Verilated core for each run, stepped with the physics."""

import ctypes
from functools import cache
from pathlib import Path

import numpy as np

from meissner.arrays import Bools, Ints
from meissner.engines.verilated import library
from meissner.twins.actuate.actuate import ActuateConfig
from meissner.twins.link.registers import ADDRESSES
from meissner.twins.slip.config import SAMPLE_BITS, TIMER_BITS, SlipConfig

EVERY = 8  # clocks from frame to frame: enough for two samples and their decisions
_ANSWERS = (ctypes.c_int32 * 4)(
    *(ADDRESSES[f"grip.{n}"] for n in ("increment", "command", "fault", "faulty"))
)
REST = 32  # further clocks of a cycle, for register reads and the last decision


@cache
def _open(path: Path) -> ctypes.CDLL:
    lib = ctypes.CDLL(str(path))
    pointer, number, long = ctypes.c_void_p, ctypes.c_int32, ctypes.c_int64
    lib.hand_new.restype = pointer
    lib.hand_delete.argtypes = [pointer]
    lib.hand_write.argtypes = [pointer, number, ctypes.c_uint32]
    lib.hand_read.argtypes = [pointer, number]
    lib.hand_wait.argtypes = [pointer, long]
    lib.hand_next.argtypes = [
        *(pointer, pointer, long, long, number, long, long, pointer, pointer, pointer, long),
        *(ctypes.POINTER(long), pointer),
    ]
    for name in ("hand_write", "hand_read", "hand_wait", "hand_next"):
        getattr(lib, name).restype = long
    return lib


class Core:
    """One core of a hand with ``fingers``; ``slip``: SlipConfig, ``actuate``: ActuateConfig.

    Its control cycle has ``frames`` frames, regardless of the settings, and as many clocks as these need.
    ``start``: its first command; None: its minimum.
    """

    def __init__(
        self, fingers: int, slip: SlipConfig, actuate: ActuateConfig, frames: int, start: int | None = None
    ) -> None:
        parameters = {"Grip": 1, "Channels": fingers, "Uart": 0, "Statistics": 0, "SlipDepth": 2}
        parameters |= {"SampleBits": SAMPLE_BITS, "TimerBits": TIMER_BITS}
        parameters |= {"Level": slip.level, "Window": slip.window, "Hop": slip.hop}
        self._lib = _open(library("msn_core", "hand_driver.cpp", parameters))
        self.fingers, self.frames = fingers, frames
        self.period = frames * EVERY + REST
        self._core = self._lib.hand_new()
        for name, value in slip.settings.items():
            self[f"slip.{name}"] = value
        settings = actuate.settings | {"period": self.period, "enable": 0}
        for name, value in settings.items():
            self[f"grip.{name}"] = value
        # The reflex's first command is always the minimum, so the minimum is set to the start until then.
        self["grip.minimum"] = settings["minimum"] if start is None else start
        self["grip.enable"] = 1
        self._done(self._lib.hand_wait(self._core, 2 * self.period))
        self["grip.minimum"] = settings["minimum"]

    def __del__(self) -> None:
        if getattr(self, "_core", None):
            self._lib.hand_delete(self._core)
            self._core = None

    @staticmethod
    def _done(found: int) -> int:
        if found < 0:
            raise RuntimeError("the core did not answer in time")
        return found

    def __setitem__(self, name: str, value: int) -> None:
        self._done(self._lib.hand_write(self._core, ADDRESSES[name], int(value) & 0xFFFF_FFFF))

    def __getitem__(self, name: str) -> int:
        return self._done(self._lib.hand_read(self._core, ADDRESSES[name]))

    def next(self, codes: Ints, expected: Ints) -> tuple[Bools, Bools, Ints]:
        """The first cycles of ``codes`` [fingers, samples]: until an increment is not that of ``expected``
        [cycles].

        (over [fingers, details], ends [details], word, increment, command, fault and faulty fingers, one bit
        each [5, cycles]).
        """
        samples = np.ascontiguousarray(codes.T, dtype=np.int32)
        flags = np.empty(samples.size, dtype=np.uint8)
        wanted = np.ascontiguousarray(expected, dtype=np.int64)
        answers, count = np.empty((len(wanted), 5), dtype=np.int64), ctypes.c_int64()
        done = self._done(
            self._lib.hand_next(
                *(self._core, samples.ctypes.data, len(wanted), len(samples) // len(wanted), self.fingers),
                *(EVERY, self.period, _ANSWERS, wanted.ctypes.data, flags.ctypes.data, flags.size),
                *(ctypes.byref(count), answers.ctypes.data),
            )
        )
        found = flags[: count.value].reshape(-1, self.fingers)
        if (found >> 2 != np.arange(self.fingers)).any():
            raise RuntimeError("the core's decisions came out of order")
        answers = answers[:done].T
        answers[1] -= (answers[1] >> 16) << 17
        return (found & 1).T.astype(bool), (found[:, 0] & 2).astype(bool), answers
