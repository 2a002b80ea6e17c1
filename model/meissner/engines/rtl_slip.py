"""Engine ``rtl``, slip: the Verilated msn_channels behind a batch C++ driver, numpy arrays in and out."""

import ctypes
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from meissner.engines import Watched, verilated
from meissner.engines.verilated import library
from meissner.twins.link.registers import members, struct_bytes
from meissner.twins.slip.config import SAMPLE_BITS, TIMER_BITS

ADC_PARTS = {"MCP3208": 1, "AD7606": 2}  # msn_pkg::adc_part_e
# The clock of a pin-level run: the slowest with the MCP3208's full 2 MHz, since simulation takes time per
# clock. BUSY then lasts 4 us, as the AD7606's does.
PIN_CLK_KHZ, PIN_SCLK_KHZ, PIN_BUSY_CLOCKS = 4000, 2000, 16


class _PinFacts(ctypes.Structure):
    _fields_ = tuple(
        (name, ctypes.c_int64)
        for name in ("clocks", "frames", "period_min", "period_max", "decision_min", "decision_max")
    )


@cache
def _open(path):
    lib = ctypes.CDLL(str(path))
    lib.core_new.restype = ctypes.c_void_p
    lib.core_delete.argtypes = [ctypes.c_void_p]
    lib.core_start.restype = ctypes.c_int64
    lib.core_start.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int64]
    lib.core_slip.restype = ctypes.c_int64
    pointer = ctypes.c_void_p
    lib.core_slip.argtypes = [
        *(pointer, pointer, ctypes.c_int64, ctypes.c_int32, ctypes.c_uint32),
        *(pointer, pointer, pointer, ctypes.c_int64),
    ]
    lib.core_pins.restype = ctypes.c_int64
    lib.core_pins.argtypes = [
        *(pointer, ctypes.c_int32, ctypes.c_int32, pointer, ctypes.c_int64, ctypes.c_int64),
        *(pointer, pointer, pointer, ctypes.c_int64, ctypes.c_int64, ctypes.c_int64, ctypes.c_char_p),
        *(ctypes.c_int64, ctypes.POINTER(_PinFacts)),
    ]
    for count in ("core_blanked", "core_damaged"):
        getattr(lib, count).argtypes = [pointer]
        getattr(lib, count).restype = ctypes.c_uint32
    return lib


def _settings(config):
    """The bytes of cfg_i of msn_channels, lowest first, in full words: every setting of the group slip."""
    values = {member: int(getattr(config, member) or 0) for member in members("slip")}
    values["keep_threshold"] = config.keeps_above
    return struct_bytes("slip", values, {"detail": SAMPLE_BITS + config.level, "timer": TIMER_BITS})


class Core:
    """One Verilated core with its registers set; ``parameters`` are those of rtl/slip/msn_channels.sv."""

    def __init__(self, parameters, config, trace=False):
        self._lib = _open(library("msn_channels", "channels_driver.cpp", parameters, trace))
        self._core = self._lib.core_new()
        settings = _settings(config)
        verilated.check_room(self._lib.core_start(self._core, settings, len(settings)))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._lib.core_delete(self._core)

    def slip(self, x, moving=None):
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

    def pins(self, part, codes, period, moving, trace_path=None, trace=(0, 0)):
        """Put ``codes`` [samples] behind the pins of ``part``; returns (p2p, flags, facts)."""
        codes = np.ascontiguousarray(codes, dtype=np.int32)
        moving = np.ascontiguousarray(moving, dtype=np.uint8)
        p2p = np.empty(codes.size, dtype=np.uint32)
        flags = np.empty(codes.size, dtype=np.uint8)
        facts = _PinFacts()
        count = self._lib.core_pins(
            *(self._core, ADC_PARTS[part], PIN_BUSY_CLOCKS, codes.ctypes.data, codes.size, period),
            *(moving.ctypes.data, p2p.ctypes.data, flags.ctypes.data, p2p.size, *trace),
            *(None if trace_path is None else str(trace_path).encode(), PIN_CLK_KHZ, ctypes.byref(facts)),
        )
        verilated.check_room(count)
        if count < 0:
            raise RuntimeError("the core gave more decisions than it got samples")
        return p2p[:count], flags[:count], facts

    @property
    def blanked(self):
        """Number of details since reset that were over while blanked or while the actuator moved."""
        return self._lib.core_blanked(self._core)


def _parameters(channels, config):
    return {
        "Channels": channels,
        "SampleBits": SAMPLE_BITS,
        "Level": config.level,
        "Window": config.window,
        "Hop": config.hop,
        "TimerBits": TIMER_BITS,
    }


def _run(x, config, moving=None):
    """p2p and flags as [details, channels], and the count of blanked details."""
    with Core(_parameters(len(x), config), config) as core:
        p2p, flags = core.slip(x, moving)
        return p2p.reshape(-1, len(x)), flags.reshape(-1, len(x)), core.blanked


@dataclass(frozen=True)
class Pins:
    """A run at the converter's pins: its output and the number of clocks."""

    watched: Watched
    facts: dict


def watch_pins(recording, config, waves=None):
    """Run a scene's recording through the pins of its converter; ``waves``: path of a VCD file.

    The VCD covers 20 ms around the first rise of the flag (or the start, if it never rises).
    """
    part = recording.scene.adc_part
    period = round(PIN_CLK_KHZ * 1000 / recording.scene.rate_hz)
    parameters = _parameters(1, config) | {
        "Adc": ADC_PARTS[part],
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


def watch(x, config, moving=None):
    """Run the slip path over ``x`` [channels, samples] with ``moving`` [samples]; returns Watched."""
    return _watched(*_run(x, config, moving))


def _watched(p2p, flags, blanked):
    return Watched(
        p2p=p2p.T.astype(np.int64),
        over=(flags.T >> 3 & 1).astype(bool),
        state=(flags.T & 7).astype(np.int8),
        end=(flags[:, 0] >> 4 & 1).astype(bool),
        blanked=blanked,
    )


def windows(x, config, count):
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
