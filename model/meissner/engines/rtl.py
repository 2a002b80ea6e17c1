"""Engine ``rtl``: the Verilated core behind a batch C++ driver, whole numpy arrays in and out."""

import ctypes
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from meissner import toolchain
from meissner.engines import Watched
from meissner.slip.config import SAMPLE_BITS, TIMER_BITS

HERE = Path(__file__).parent
DRIVER = HERE / "rtl_driver.cpp"


class _SlipRegisters(ctypes.Structure):
    _fields_ = (
        ("threshold", ctypes.c_uint32),
        ("gross_threshold", ctypes.c_uint32),
        ("contact_level", ctypes.c_int32),
        ("release_level", ctypes.c_int32),
        ("contact_rises", ctypes.c_uint32),
        ("hold", ctypes.c_uint32),
        ("refractory", ctypes.c_uint32),
        ("blank", ctypes.c_uint32),
    )


def _library(parameters):
    """Path of the core built with these parameters; built now if this source was not built before."""
    environment = toolchain.environment()
    flags = [
        *("--cc", "--quiet", "-O3", "--x-assign", "fast", "--x-initial", "fast", "--top-module", "msn_core"),
        *toolchain.VERILATOR_FLAGS,
        *("-CFLAGS", "-fPIC -O3", "-LDFLAGS", "-shared", "--exe", "-o", "core.so"),
        *(f"-G{name}={value}" for name, value in parameters.items()),
    ]
    files = [*toolchain.sources(), *sorted(HERE.glob("*.[ch]pp"))]
    digest = hashlib.sha256(repr(flags).encode())
    for file in files:
        digest.update(file.read_bytes())
    folder = toolchain.BUILD / "rtl" / digest.hexdigest()[:16]
    library = folder / "core.so"
    if not library.exists():
        if sys.stderr.isatty():
            print("building the core for the rtl engine, once for this configuration ...", file=sys.stderr)
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder.parent) as scratch:
            command = ["verilator", *flags, "--build", "-j", "2", "-Mdir", scratch]
            command += [str(DRIVER), *map(str, toolchain.sources())]
            done = subprocess.run(command, env=environment, capture_output=True, text=True)
            if done.returncode:
                raise RuntimeError(f"the core did not build:\n{done.stdout}{done.stderr}")
            folder.mkdir(exist_ok=True)
            shutil.copy(Path(scratch) / "core.so", folder / f"core.{os.getpid()}")
            (folder / f"core.{os.getpid()}").replace(library)  # atomic: several may build at once
    return library


@cache
def _open(library):
    lib = ctypes.CDLL(str(library))
    lib.core_new.restype = ctypes.c_void_p
    lib.core_delete.argtypes = [ctypes.c_void_p]
    lib.core_start.argtypes = [ctypes.c_void_p, ctypes.POINTER(_SlipRegisters), ctypes.c_uint32]
    lib.core_slip.restype = ctypes.c_int64
    pointer = ctypes.c_void_p
    lib.core_slip.argtypes = [
        *(pointer, pointer, ctypes.c_int64, ctypes.c_int32, ctypes.c_uint32),
        *(pointer, pointer, pointer, ctypes.c_int64),
    ]
    for count in ("core_blanked", "core_damaged"):
        getattr(lib, count).argtypes = [pointer]
        getattr(lib, count).restype = ctypes.c_uint32
    return lib


class Core:
    """One Verilated core with its registers set; ``parameters`` are those of rtl/msn_core.sv."""

    def __init__(self, parameters, config):
        self._lib = _open(_library(parameters))
        self._core = self._lib.core_new()
        values = {name: int(getattr(config, name)) for name, _ in _SlipRegisters._fields_}
        self._lib.core_start(self._core, _SlipRegisters(**values), SAMPLE_BITS + config.level)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._lib.core_delete(self._core)

    def slip(self, x, moving=None):
        """Send ``x`` [channels, samples]; returns (p2p, flags), one of each per decision in their order."""
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

    @property
    def blanked(self):
        """Details that were over while blanked or while the actuator moved, since reset."""
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


def watch(x, config, moving=None):
    """Run the slip path over ``x`` [channels, samples] with ``moving`` [samples]; returns Watched."""
    p2p, flags, blanked = _run(x, config, moving)
    return Watched(
        p2p=p2p.T.astype(np.int64),
        over=(flags.T >> 3 & 1).astype(bool),
        state=(flags.T & 7).astype(np.int8),
        end=(flags[:, 0] >> 4 & 1).astype(bool),
        blanked=blanked,
    )


def windows(x, config, count):
    """(p2p, slip, first) [channels, windows]: ``first`` is the detail of a tumbling window that crosses."""
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
