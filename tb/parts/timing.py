"""Common to the part models: time in ns, and the handling of a broken limit."""

import random
from dataclasses import fields
from math import inf

import cocotb
from cocotb import simulator
from cocotb.triggers import Timer, ValueChange

from harness.streams import read


class TimingViolation(Exception):
    """The master broke a limit of the part. If raised in the model's task, it fails the test."""


def now():
    """Simulated time in ns, exact to the picosecond, which is the simulator's step (runner.py)."""
    high, low = simulator.get_sim_time()  # cocotb's own get_sim_time takes five times as long
    return (high << 32 | low) / 1000


class Line:
    """``width`` bits of a vector of pins, for one of several parts on the same ports.

    ``driven``: the same dict for all parts; it keeps the levels driven on each input port.
    """

    def __init__(self, port, index, driven, width=1):
        self.port, self.driven, self.width = port, driven, width
        self.low, self.mask = index * width, (1 << width) - 1

    def __len__(self):
        return self.width

    @property
    def value(self):
        return read(self.port) >> self.low & self.mask

    @value.setter
    def value(self, level):
        levels = self.driven.get(self.port._path, 0) & ~(self.mask << self.low) | int(level) << self.low
        self.driven[self.port._path] = levels
        self.port.value = levels


def level(pin):
    """The level of ``pin``: a handle, a Line, or a stand-in for a handle."""
    return read(pin) if hasattr(pin, "_handle") else int(pin.value)


async def changed(pin):
    """Wait until the level of ``pin``, a handle or a Line, changes."""
    if not isinstance(pin, Line):
        await ValueChange(pin)
        return
    before = pin.value
    while pin.value == before:
        await ValueChange(pin.port)


def tightened(limits, name):
    """``limits`` with one figure so tight that no master can meet it."""
    known = {field.name for field in fields(limits)}
    assert name in known, f"{name} is not a limit"
    values = {field: getattr(limits, field) for field in known}
    return type(limits)(**{**values, name: 0 if name.endswith("_max") else 10**9})


class PartModel:
    """A part on some pins. ``report`` gets each violation; by default it raises and so fails the test."""

    front = None  # parts.front.Front, if its samples come through one

    def __init__(self, limits, report=None):
        self.limits = limits
        self.report = report or self.fail
        self.noise = random.Random(7)
        self.drives = {}

    def fail(self, violation):
        raise violation

    def take(self, channel, acquired_ns=None):
        """The code of a channel, sampled now; its capacitor was connected for ``acquired_ns``, None: long."""
        if self.front is not None:
            self.front.acquired_ns = inf if acquired_ns is None else acquired_ns
        return self.code(channel, now())

    def least(self, name, measured):
        """Check a minimum; ``measured`` None: there is no earlier edge to measure from."""
        limit = getattr(self.limits, name)
        if measured is not None and measured < limit - 1e-6:
            self.report(TimingViolation(f"{name}: {measured:.1f} ns, at least {limit} needed"))

    def most(self, name, measured):
        limit = getattr(self.limits, name)
        if measured is not None and measured > limit + 1e-6:
            self.report(TimingViolation(f"{name}: {measured:.1f} ns, at most {limit} allowed"))

    def since(self, moment):
        return None if moment is None else now() - moment

    def drive(self, lane, bit, delay, hold=0.0):
        """Put ``bit`` on a lane in ``delay`` ns; from ``hold`` until then the lane shows the wrong level."""
        self.drives[lane] = token = object()

        async def later():
            if hold:
                await Timer(round(hold * 1000), "ps")
            if self.drives[lane] is token:
                self.set_miso(lane, 1 - bit)
                await Timer(round((delay - hold) * 1000), "ps")
            if self.drives[lane] is token:
                self.set_miso(lane, bit)

        cocotb.start_soon(later())

    def release(self, lane, delay):
        """High impedance after ``delay`` ns: the master may read either level."""
        self.drives[lane] = token = object()

        async def later():
            await Timer(round(delay * 1000), "ps")
            if self.drives[lane] is token:
                self.set_miso(lane, self.noise.getrandbits(1))

        cocotb.start_soon(later())

    def set_miso(self, lane, bit):
        self.levels = self.levels & ~(1 << lane) | bit << lane
        self.miso.value = self.levels
