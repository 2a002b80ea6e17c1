"""Engine ``rtl``, slip: the Verilated msn_core behind a batch C++ driver, numpy arrays in and out."""

import ctypes
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from meissner.arrays import Bools, Ints
from meissner.engines import Watched
from meissner.engines.protocol import PinRecording, Waves, Windows
from meissner.engines.verilated import library
from meissner.twins.frontend.adc_spi import BY_NAME, Part
from meissner.twins.link.registers import ADDRESSES, members, words
from meissner.twins.slip.config import SAMPLE_BITS, TIMER_BITS, SlipConfig

# The parts of msn_core that slip does not need are left out; packets go as bytes to nobody.
_CORE = {"Uart": 0, "Statistics": 0, "SlipDepth": 2}
# The clock of a pin-level run: the slowest with the MCP3208's full 2 MHz, since simulation takes time per
# clock.
PIN_CLK_KHZ, PIN_SCLK_KHZ = 4000, 2000
CONVERSION_NS = 4000  # of a converter with BUSY, or its longest if that is shorter


def busy_clocks(part: Part, clk_khz: int) -> int:
    """Clocks for which the model of a converter is busy; 0 without BUSY."""
    return min(CONVERSION_NS, part.conversion_max_ns) * clk_khz // 1_000_000


class _PinFacts(ctypes.Structure):
    _fields_ = tuple(
        (name, ctypes.c_int64)
        for name in ("clocks", "frames", "period_min", "period_max", "decision_min", "decision_max")
    )


@cache
def _open(path: Path) -> ctypes.CDLL:
    lib = ctypes.CDLL(str(path))
    lib.core_new.restype = ctypes.c_void_p
    lib.core_delete.argtypes = [ctypes.c_void_p]
    pointer, number, long = ctypes.c_void_p, ctypes.c_int32, ctypes.c_int64
    lib.core_write.argtypes = [pointer, number, ctypes.c_uint32]
    lib.core_read.argtypes = [pointer, number]
    lib.core_slip.argtypes = [
        *(pointer, pointer, long, number, ctypes.c_uint32, pointer, pointer, pointer, long),
    ]
    lib.core_pins.argtypes = [
        *(pointer, number, number, number, pointer, long, pointer, pointer, pointer, long),
        *(long, long, ctypes.c_char_p, long, ctypes.POINTER(_PinFacts)),
    ]
    for name in ("core_write", "core_read", "core_slip", "core_pins"):
        getattr(lib, name).restype = long
    return lib


class Core:
    """One Verilated core with its settings of slip written; ``parameters``: of msn_core beside ``_CORE``."""

    def __init__(self, parameters: dict[str, int], config: SlipConfig, trace: bool = False) -> None:
        values = {name: int(getattr(config, name) or 0) for name in members("slip")}
        values["keep_threshold"] = config.keeps_above
        written = words("slip", values, {"detail": SAMPLE_BITS + config.level, "timer": TIMER_BITS})
        self._lib = _open(library("msn_core", "slip_driver.cpp", parameters | _CORE, trace))
        self._core = self._lib.core_new()
        self._write(written)

    def _write(self, written: Mapping[int, int]) -> None:
        for address, word in written.items():
            if self._lib.core_write(self._core, address, word) < 0:
                raise RuntimeError("the core did not answer on its bus")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._lib.core_delete(self._core)

    def slip(self, x: Ints, moving: Bools | None = None) -> tuple[NDArray[np.uint32], NDArray[np.uint8]]:
        """Send ``x`` [channels, samples]; returns (p2p, flags), one of each per decision, in order."""
        channels, frames = x.shape
        samples = np.ascontiguousarray(x.T, dtype=np.int32)
        p2p = np.empty(samples.size, dtype=np.uint32)
        flags = np.empty(samples.size, dtype=np.uint8)
        moving = None if moving is None else np.ascontiguousarray(moving, dtype=np.uint8)
        count = self._lib.core_slip(
            *(self._core, samples.ctypes.data, frames, channels, SAMPLE_BITS),
            *(None if moving is None else moving.ctypes.data, p2p.ctypes.data, flags.ctypes.data, p2p.size),
        )
        if count < 0:
            raise RuntimeError("the core stalled, though its output was always taken")
        return p2p[:count], flags[:count]

    def pins(
        self,
        part: str,
        codes: Ints,
        period: int,
        moving: Bools,
        trace_path: Waves = None,
        trace: tuple[int, int] = (0, 0),
    ) -> tuple[NDArray[np.uint32], NDArray[np.uint8], _PinFacts]:
        """Put ``codes`` [samples] behind the pins of ``part``; returns (p2p, flags, facts)."""
        codes = np.ascontiguousarray(codes, dtype=np.int32)
        moving = np.ascontiguousarray(moving, dtype=np.uint8)
        p2p = np.empty(codes.size, dtype=np.uint32)
        flags = np.empty(codes.size, dtype=np.uint8)
        facts, converter = _PinFacts(), BY_NAME[part]
        self._write(words("adc", {"period": period}, {}))
        count = self._lib.core_pins(
            *(self._core, converter.number, busy_clocks(converter, PIN_CLK_KHZ), ADDRESSES["adc.enable"]),
            *(codes.ctypes.data, codes.size),
            *(moving.ctypes.data, p2p.ctypes.data, flags.ctypes.data, p2p.size, *trace),
            *(None if trace_path is None else str(trace_path).encode(), PIN_CLK_KHZ, ctypes.byref(facts)),
        )
        if count < 0:
            raise RuntimeError("the core gave more decisions than it got samples")
        return p2p[:count], flags[:count], facts

    @property
    def blanked(self) -> int:
        """Number of details since reset that were over while blanked or while the actuator moved."""
        return self._lib.core_read(self._core, ADDRESSES["slip.blanked"])


def _parameters(channels: int, config: SlipConfig) -> dict[str, int]:
    return {
        "Channels": channels,
        "SampleBits": SAMPLE_BITS,
        "Level": config.level,
        "Window": config.window,
        "Hop": config.hop,
        "TimerBits": TIMER_BITS,
    }


def _run(
    x: Ints, config: SlipConfig, moving: Bools | None = None
) -> tuple[NDArray[np.uint32], NDArray[np.uint8], int]:
    """p2p and flags as [details, channels], and the count of blanked details."""
    with Core(_parameters(len(x), config), config) as core:
        p2p, flags = core.slip(x, moving)
        return p2p.reshape(-1, len(x)), flags.reshape(-1, len(x)), core.blanked


@dataclass(frozen=True)
class Pins:
    """A run at the converter's pins: its output and the number of clocks."""

    watched: Watched
    facts: dict[str, str | float]


def watch_pins(recording: PinRecording, config: SlipConfig, waves: Waves = None) -> Pins:
    """Run a scene's recording through the pins of its converter; ``waves``: path of a VCD file.

    The VCD covers 20 ms around the first rise of the flag (or the start, if it never rises).
    """
    part = recording.scene.adc_part
    period = round(PIN_CLK_KHZ * 1000 / recording.scene.rate_hz)
    parameters = _parameters(1, config) | {
        "Adc": BY_NAME[part].number,
        "ClkKhz": PIN_CLK_KHZ,
        "SclkKhz": PIN_SCLK_KHZ,
    }
    around = (0, 0)
    if waves is not None:
        raised = np.flatnonzero(_run(recording.codes[None], config, recording.moving)[1][:, 0] & 32)
        middle = int(raised[0]) << config.level if len(raised) else 0
        half = round(0.01 * recording.scene.rate_hz)
        around = (max(0, middle - half), middle + half)
        Path(waves).parent.mkdir(parents=True, exist_ok=True)
    with Core(parameters, config, trace=waves is not None) as core:
        p2p, flags, facts = core.pins(part, recording.codes, period, recording.moving, waves, around)
        watched = _watched(p2p[:, None], flags[:, None], core.blanked)
    return Pins(
        watched,
        {
            "adc": part,
            "clk_khz": PIN_CLK_KHZ,
            "frames": facts.frames,
            "clocks": facts.clocks,
            "convert_jitter_clocks": facts.period_max - facts.period_min,
            "decision_clocks": facts.decision_max,
            "decision_us": facts.decision_max / PIN_CLK_KHZ * 1000,
            "decision_jitter_clocks": facts.decision_max - facts.decision_min,
        },
    )


def watch(x: Ints, config: SlipConfig, moving: Bools | None = None) -> Watched:
    """Run the slip path over ``x`` [channels, samples] with ``moving`` [samples]; returns Watched."""
    return _watched(*_run(x, config, moving))


def _watched(p2p: NDArray[np.uint32], flags: NDArray[np.uint8], blanked: int) -> Watched:
    return Watched(
        p2p=p2p.T.astype(np.int64),
        over=(flags.T >> 3 & 1).astype(bool),
        state=(flags.T & 7).astype(np.int8),
        end=(flags[:, 0] >> 4 & 1).astype(bool),
        blanked=blanked,
    )


def windows(x: Ints, config: SlipConfig, count: int) -> Windows:
    """(p2p, slip, first) [channels, windows]; ``first``: a tumbling window's first detail over, else 0."""
    p2p, flags, _ = _run(x, config)
    ends = np.flatnonzero(flags[:, 0] & 16)
    if len(ends) != count:
        raise RuntimeError(f"the core closed {len(ends)} windows instead of {count}")
    slip = (flags[ends].T & 8).astype(bool)
    first = np.zeros(slip.shape, dtype=np.int64)
    span = config.window >> config.level
    if config.hop == config.window:
        channels, hits = np.nonzero(slip)
        inside = flags[: count * span].reshape(count, span, len(x))[hits, :, channels]
        first[channels, hits] = np.argmax(inside & 8, axis=1)
    return p2p[ends].T.astype(np.int64), slip, first
