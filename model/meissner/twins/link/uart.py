"""Bit-exact twins of rtl/link/msn_uart_tx.sv, the levels of a serial line, clock by clock, and
msn_uart_rx.sv, bytes and damaged bytes of a line."""

from meissner.twins.shared import Stream


def sixteenths(clk_hz=12_000_000, baud_hz=1_000_000):
    """Average length of a bit in sixteenths of a clock."""
    if baud_hz < 300 or baud_hz > clk_hz // 4 or clk_hz > 400_000_000:
        raise ValueError(f"baud_hz = {baud_hz} must lie in 300 .. clk_hz / 4")
    return (16 * clk_hz + baud_hz // 2) // baud_hz


def levels(data, clk_hz=12_000_000, baud_hz=1_000_000, part=0):
    """The line for back-to-back bytes, one level per clock, from the first start bit to the last stop bit.

    ``part``: sixteenths of a clock carried over from the previous byte.
    """
    whole, fraction = divmod(sixteenths(clk_hz, baud_hz), 16)
    line = []
    for byte in data:
        for bit in (0, *(byte >> place & 1 for place in range(8)), 1):
            part += fraction
            line += [bit] * (whole + part // 16)
            part %= 16
    return line


class UartRx(Stream):
    """``next`` takes levels, one per clock, and returns a list of (clock, byte); byte None: no stop bit.

    ``clock`` counts from reset; the synchroniser delays a level by 2 clocks.
    """

    def __init__(self, clk_hz=12_000_000, baud_hz=1_000_000):
        self.whole, self.fraction = divmod(sixteenths(clk_hz, baud_hz), 16)
        self.reset()

    def reset(self):
        self._clock, self._state, self._left, self._part = 0, "broken", 0, 0
        self._bits, self._line = [], [1, 1]

    def next(self, levels):
        found = []
        for level in levels:
            self._line.append(level)
            rx, tick, state = self._line.pop(0), self._left == 0, self._state
            self._left -= not tick
            if state == "rest" and not rx:
                self._state, self._left, self._part = "start", (self.whole - 2) // 2, 8
            elif state == "broken" and rx:
                self._state = "rest"
            elif tick and state in ("start", "data"):
                self._part += self.fraction
                self._left = self.whole - 1 + self._part // 16
                self._part %= 16
                if state == "start":
                    self._state, self._bits = "rest" if rx else "data", []
                elif len(self._bits) == 8:
                    byte = sum(bit << place for place, bit in enumerate(self._bits))
                    found.append((self._clock, byte if rx else None))
                    self._state = "rest" if rx else "broken"
                else:
                    self._bits.append(rx)
            self._clock += 1
        return found
