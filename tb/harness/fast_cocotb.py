"""Faster versions of the functions that cocotb runs at every await and every value, for what benches use.

A bench awaits an edge and the settled values in every clock, and reads and writes ports there: some 300,000
times each in a long one. Half of that time went into checks for cocotb's debug log and profile, into the
objects made for them, and into turning 0 and 1 into Logic values and these into characters. Each function
here handles the plain case (an integer is deposited, a coroutine awaits; no log, no profile) like the cocotb
function that its docstring names, and passes all other cases to that function. tb/common/test_quick.py checks
that the sources of those functions are the known version. MEISSNER_COCOTB=plain switches all of it off.
"""

import gc
from functools import lru_cache

import cocotb.debug
import cocotb.handle
from cocotb import _base_triggers, _bridge, _event_loop, _gpi_triggers, _profiling, task
from cocotb.handle import HierarchyObject, LogicObject, ValueObjectBase
from cocotb.triggers import ReadOnly, Trigger
from cocotb.types import Logic, LogicArray, Range

ARRAYS = cocotb.handle._LogicArrayObjectBase
DEPOSIT = cocotb.handle._GPISetAction.DEPOSIT.value
LEVEL = {0: "0", 1: "1"}
LOGIC = {level: Logic(level) for level in "01XZ"}
BIT = {0: Logic(0), 1: Logic(1)}  # cocotb has one object for each
WORD = 32  # bits up to which cocotb writes an integer as a number
RUNNING, PENDING, SCHEDULED = (getattr(task._TaskState, name) for name in ("RUNNING", "PENDING", "SCHEDULED"))
READ_ONLY = ReadOnly()  # a singleton

_waiting = _event_loop._inst._callbacks
_threads = _bridge.pending_threads


def run(self):
    """EventLoop.run"""
    while _waiting:
        while _waiting:
            callback = _waiting.popleft()
            if not callback._cancelled:
                callback._func()
        if _threads:
            _bridge.run_bridge_threads()


def react(self):
    """GPITrigger._react"""
    _gpi_triggers._current_gpi_trigger = self
    self._do_callbacks()
    run(None)


def do_callbacks(self):
    """Trigger._do_callbacks"""
    callbacks, self._callbacks = self._callbacks, {}
    for callback in callbacks:
        callback._func()


def register(self, function):
    """Trigger._register"""
    callback = _base_triggers.TriggerCallback(self, function)
    first = not self._callbacks
    self._callbacks[callback] = None
    if first:
        self._prime()
    return callback


def settled(self):
    """ReadOnly.__await__"""
    if _gpi_triggers._current_gpi_trigger is self:
        raise RuntimeError("Attempted illegal transition: awaiting ReadOnly in ReadOnly phase")
    yield self
    return self


def schedule_resume(self, exc=None):
    """Task._schedule_resume"""
    self._state = SCHEDULED
    self._exc = exc
    self._schedule_callback = callback = _event_loop.ScheduledCallback(self._resume)
    _waiting.append(callback)


class Replay:
    """Stands in for a coroutine: returns or raises again the result of its last step."""

    def __init__(self, given, raised):
        self.given, self.raised = given, raised

    def send(self, _):
        if self.raised is not None:
            raise self.raised
        return self.given


def resume(self):
    """Task._resume"""
    if self._exc is not None or self._must_cancel:
        return _resume(self)
    self._state = RUNNING
    task._current_task = self
    given = raised = None
    try:
        given = self._coro.send(None)
    except BaseException as error:
        raised = error
    if raised is not None or not isinstance(given, Trigger):
        coroutine, self._coro = self._coro, Replay(given, raised)
        try:
            return _resume(self)
        finally:
            self._coro = coroutine
    self._state = PENDING
    self._trigger = given
    try:
        self._trigger_callback = given._register(self._schedule_resume)
    except Exception as error:
        self._schedule_resume(error)
    finally:
        task._current_task = None


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


_resume, _child, _set = task.Task._resume, HierarchyObject.__getattr__, ValueObjectBase.value.fset
_equal = Logic.__eq__


def install():
    """Replace cocotb's functions in this process, unless a debug log or a profile is on."""
    if cocotb.debug.debug or not isinstance(_profiling.profiling_context, _profiling.nullcontext):
        return
    _event_loop.EventLoop.run = run
    _gpi_triggers.GPITrigger._react = react
    Trigger._do_callbacks = do_callbacks
    Trigger._register = register
    ReadOnly.__await__ = settled
    task.Task._schedule_resume = schedule_resume
    task.Task._resume = resume
    HierarchyObject.__getattr__ = child
    Logic.__eq__ = equal
    LogicArray._from_handle = classmethod(from_handle)
    if cocotb.handle._trust_inertial:  # otherwise a write waits for its phase
        LogicObject.value = property(get_level, set_level)
        ARRAYS.value = property(ValueObjectBase.value.fget, set_word)
    # Modules imported so far stay, and objects made in a clock form no cycles: the collector can run rarely.
    gc.freeze()
    gc.set_threshold(100_000, 20, 20)
