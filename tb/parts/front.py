"""What stands between a converter's pins and its samples: its filter, or its sampling capacitor.

From the differential equations in real numbers, not from meissner.physics.front:

    filter of order 2 with corner f:    y'' + 2a y' + 2a^2 (y - u) = 0,   a = sqrt(2) pi f
    z = y - u, v = y'/a:                z(t) = e^-at (z cos at + (z + v) sin at)
                                        v(t) = e^-at (v cos at - (2z + v) sin at)
    source R at a pin of C:             z(t) = e^(-t/RC) z
    capacitor C behind R, once each:    c += (pin - c) (1 - e^(-acquired/RC))
"""

from dataclasses import dataclass
from math import exp, inf, pi, sqrt

import cocotb
import numpy as np

from parts.timing import changed, now


@dataclass(frozen=True)
class Values:
    """Of one part, by docs/adc.md: ``corner_hz``, or ohms and farads of source, pin, switch, capacitor."""

    corner_hz: float = 0.0
    source_ohm: float = 100.0
    pin_f: float = 50e-12
    switch_ohm: float = 0.0
    hold_f: float = 0.0


AD7606_5V, AD7606_10V = Values(15e3), Values(23e3)
AD7606C = Values(220e3)
MAX1112X = Values(switch_ohm=300.0, hold_f=15e-12)
MCP3208 = Values(switch_ohm=1000.0, hold_f=20e-12)


class Front:
    """``levels()``: of all pins now, which change only with one of ``lines``; levels and samples in any unit.

    A part model sets ``acquired_ns`` before each sample of a capacitor.
    """

    def __init__(self, values, levels, lines):
        self.values, self.levels = values, levels
        self.at_ns = now()
        self.to = np.array(levels(), float)
        self.z, self.v = 0 * self.to, 0 * self.to
        self.held, self.acquired_ns = 0.0, inf
        for line in lines:
            cocotb.start_soon(self.watch(line))

    async def watch(self, line):
        while True:
            await changed(line)
            self.move()

    def move(self):
        """The pins have changed."""
        self.advance()
        to = np.array(self.levels(), float)
        self.z += self.to - to
        self.to = to

    def advance(self):
        seconds, self.at_ns = (now() - self.at_ns) * 1e-9, now()
        if self.values.corner_hz:
            at = sqrt(2) * pi * self.values.corner_hz * seconds
            z, v, fade = self.z, self.v, exp(-at)
            self.z = fade * (z * np.cos(at) + (z + v) * np.sin(at))
            self.v = fade * (v * np.cos(at) - (2 * z + v) * np.sin(at))
        else:
            self.z = self.z * exp(-seconds / (self.values.source_ohm * self.values.pin_f))

    def sample(self, channel):
        self.advance()
        values, found = self.values, self.to[channel] + self.z[channel]
        if values.hold_f:
            tau_ns = (values.source_ohm + values.switch_ohm) * values.hold_f * 1e9
            found += (self.held - found) * exp(-self.acquired_ns / tau_ns)
            self.held = found
        return found
