"""The four electrodes on the Verilated msn_cop4 and msn_cop_slip: engine ``rtl``'s ``cop4``, ``cop_slip``."""

import ctypes
from dataclasses import asdict, fields

import numpy as np
from numpy.typing import ArrayLike

from meissner.engines import verilated
from meissner.engines.protocol import ElectrodesSlip, Waves
from meissner.engines.rtl_cop import TRACE_CLK_KHZ
from meissner.physics.cop4_config import Cop4Config
from meissner.twins.cop.cop4 import Cop4, Cop4Registers
from meissner.twins.cop.cop_slip import CopSlipRegisters, CopSlipResult

TERMS = 6
TRACE_SAMPLES = 200


_TRACE = (ctypes.c_char_p, ctypes.c_int64, ctypes.c_int64)


class _Registers(ctypes.Structure):
    _fields_ = (
        *((field.name, ctypes.c_int64) for field in fields(Cop4Registers)),
        ("p", ctypes.c_int64 * TERMS),
    )


@verilated.cached
def _open(sample_bits: int, correct: bool, trace: bool = False) -> ctypes.CDLL:
    parameters = {"SampleBits": sample_bits, "Correct": int(correct)}
    lib = ctypes.CDLL(str(verilated.library("msn_cop4", "cop4_driver.cpp", parameters, trace)))
    lib.cop4_run.restype = ctypes.c_int64
    pointer = ctypes.c_void_p
    lib.cop4_run.argtypes = [pointer, ctypes.c_int64, ctypes.c_uint32, *[pointer] * 5, *_TRACE]
    return lib


def _traced(waves: Waves, count: int) -> tuple[bytes | None, int, int]:
    """The last arguments of a driver: the VCD file, its samples and its clock."""
    return None if waves is None else str(waves).encode(), min(TRACE_SAMPLES, count), TRACE_CLK_KHZ


def cop4(codes: ArrayLike, config: Cop4Config, waves: Waves = None) -> Cop4:
    """``Cop4`` of codes [samples, 4] on the core for ``config`` (Cop4Config).

    ``waves``: path of a VCD file for the last TRACE_SAMPLES samples.
    """
    lib = _open(config.sample_bits, config.terms is not None, waves is not None)
    codes = np.ascontiguousarray(codes, dtype=np.int32)
    p = (0,) * TERMS if config.terms is None else config.terms.p
    registers = _Registers(**asdict(config.registers), p=(ctypes.c_int64 * TERMS)(*p))
    x, y = np.zeros((2, len(codes)), dtype=np.int16)
    load = np.zeros(len(codes), dtype=np.uint16)
    flags = np.zeros(len(codes), dtype=np.uint8)
    count = lib.cop4_run(
        *(codes.ctypes.data, len(codes), config.sample_bits, ctypes.byref(registers)),
        *(array.ctypes.data for array in (x, y, load, flags)),
        *_traced(waves, len(codes)),
    )
    verilated.check_room(count)
    if count < 0:
        raise RuntimeError("the core did not give one result per sample")
    pressed, over, saturated, imbalance = ((flags >> bit & 1).astype(bool) for bit in range(4))
    opened = (flags >> 4).astype(np.int64)
    place = (x.astype(np.int32), y.astype(np.int32), load.astype(np.int64))
    return Cop4(*place, pressed, over, saturated, imbalance, opened)


class _SlipRegisters(ctypes.Structure):
    _fields_ = tuple((field.name, ctypes.c_int64) for field in fields(CopSlipRegisters))


@verilated.cached
def _open_slip(lag: int, trace: bool) -> ctypes.CDLL:
    lib = ctypes.CDLL(str(verilated.library("msn_cop_slip", "cop_slip_driver.cpp", {"Lag": lag}, trace)))
    lib.cop_slip_run.restype = ctypes.c_int64
    pointer = ctypes.c_void_p
    lib.cop_slip_run.argtypes = [*[pointer] * 4, ctypes.c_int64, *[pointer] * 3, *_TRACE]
    return lib


def cop_slip(
    codes: ArrayLike, config: Cop4Config, lag: int, registers: CopSlipRegisters, waves: Waves = None
) -> ElectrodesSlip:
    """``Cop4`` and ``CopSlipResult`` of codes [samples, 4]: msn_cop4, then msn_cop_slip on its results.

    ``waves``: path of a VCD file for the last TRACE_SAMPLES samples of msn_cop_slip.
    """
    found = cop4(codes, config)
    lib, count = _open_slip(lag, waves is not None), len(found.x)
    kinds = (np.int16, np.int16, np.uint16, np.uint8)
    sent = [
        np.ascontiguousarray(a, dtype=kind)
        for a, kind in zip((found.x, found.y, found.load, found.pressed), kinds)
    ]
    values = _SlipRegisters(**asdict(registers))
    moves, flags = np.zeros((count, 2), dtype=np.int32), np.zeros(count, dtype=np.uint8)
    clocks = lib.cop_slip_run(
        *(array.ctypes.data for array in sent),
        *(count, ctypes.byref(values), moves.ctypes.data, flags.ctypes.data),
        *_traced(waves, count),
    )
    verilated.check_room(clocks)
    if clocks < 0:
        raise RuntimeError("the core did not give one decision per sample")
    slip, raised, over = ((flags >> bit & 1).astype(bool) for bit in range(3))
    dx, dy = moves.T.astype(np.int64)
    return found, CopSlipResult(slip, raised, over, dx, dy, (flags >> 3).astype(np.int64))
