"""Faster versions of the functions that cocotb runs at every value that a bench reads or writes.

A long bench reads and writes ports some 300,000 times. The benches of msn_cop_accumulate and msn_haar take
11.4 s of processor in place of 16.0, start of pytest included: the rest went into turning 0 and 1 into Logic
values and these into characters, and into looking up ports by name. Each function here handles the plain case
(an integer is deposited) like the cocotb function that its docstring names, and passes all other cases to
that function. tb/common/test_fast_cocotb.py checks that the sources of those functions are the known version.
MEISSNER_COCOTB=plain switches all of it off. The functions that run at every await are left alone: shorter
ones gained 2 %.
"""

import gc
from functools import lru_cache

import cocotb.debug
import cocotb.handle
from cocotb import _gpi_triggers, _profiling
from cocotb.handle import HierarchyObject, LogicObject, ValueObjectBase
from cocotb.triggers import ReadOnly
from cocotb.types import Logic, LogicArray, Range

ARRAYS = cocotb.handle._LogicArrayObjectBase
DEPOSIT = cocotb.handle._GPISetAction.DEPOSIT.value
LEVEL = {0: "0", 1: "1"}
LOGIC = {level: Logic(level) for level in "01XZ"}
BIT = {0: Logic(0), 1: Logic(1)}  # cocotb has one object for each
WORD = 32  # bits up to which cocotb writes an integer as a number
READ_ONLY = ReadOnly()  # a singleton


def child(self, name):
    """HierarchyObject.__getattr__; the found handle becomes an attribute, so this runs once per name"""
    found = _child(self, name)
    if not name.startswith("_"):
        self.__dict__[name] = found
    return found


def may_write(handle):
    return _gpi_triggers._current_gpi_trigger is not READ_ONLY and not handle.is_const


def get_level(self):
    """LogicObject.get"""
    level = self._handle.get_signal_val_binstr()
    return LOGIC[level] if level in LOGIC else Logic(level)


def equal(self, other):
    """Logic.__eq__"""
    if type(other) is int:
        return other in BIT and self is BIT[other]
    return _equal(self, other)


def set_level(self, value):
    """LogicObject._set_value"""
    if type(value) in (int, bool) and 0 <= value <= 1 and may_write(self):
        self._handle.set_signal_val_binstr(DEPOSIT, LEVEL[value])
    else:
        _set(self, value)


def set_word(self, value):
    """_LogicArrayObjectBase._set_value"""
    if type(value) is int and self._min_val <= value <= self._max_val and may_write(self):
        bits = self.__dict__.get("_bits") or self.__dict__.setdefault("_bits", len(self))
        if bits <= WORD:
            self._handle.set_signal_val_int(DEPOSIT, value)
        else:
            self._handle.set_signal_val_binstr(DEPOSIT, f"{value & (1 << bits) - 1:0{bits}b}")
    else:
        _set(self, value)


@lru_cache(None)
def down_from(left):
    return Range(left, "downto", 0)


def from_handle(cls, value, warn_indexing):
    """LogicArray._from_handle"""
    self = cls.__new__(cls)
    self._value_as_array = self._value_as_int = None
    self._value_as_str = value
    self._range = down_from(len(value) - 1)
    self._warn_indexing = warn_indexing
    return self


_child, _set = HierarchyObject.__getattr__, ValueObjectBase.value.fset
_equal = Logic.__eq__


def install():
    """Replace cocotb's functions in this process, unless a debug log or a profile is on."""
    if cocotb.debug.debug or not isinstance(_profiling.profiling_context, _profiling.nullcontext):
        return
    HierarchyObject.__getattr__ = child
    Logic.__eq__ = equal
    LogicArray._from_handle = classmethod(from_handle)
    if cocotb.handle._trust_inertial:  # otherwise a write waits for its phase
        LogicObject.value = property(get_level, set_level)
        ARRAYS.value = property(ValueObjectBase.value.fget, set_word)
    # Modules imported so far stay, and objects made in a clock form no cycles: the collector can run rarely.
    gc.freeze()
    gc.set_threshold(100_000, 20, 20)
