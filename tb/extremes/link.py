"""Extremes of rtl/link: numbers, times and counters where they wrap around, packets of all lengths, bit
times.
"""

from fractions import Fraction

from extremes.rows import row
from meissner.twins.link import uart

BAUDS = [
    (1200, 300),
    (12_000_000, 300),
    (12_000_000, 3_000_000),
    (12_000_000, 921_600),
    (25_000_000, 115_200),
    (100_000_000, 25_000_000),
    (133_333_333, 921_601),
    (400_000_000, 300),
    (400_000_000, 100_000_000),
    (400_000_000, 99_999_999),
    (268_435_456, 1_000_000),
    (4001, 1000),
    (48_000_000, 11_999_999),
]


def little(value, count):
    """Little-endian, two's complement: by powers of 256."""
    return bytes(value // 256**k % 256 for k in range(count))


TIMES = [0, 1, 2**32 - 1, 2**32, 2**47, 2**48 - 1]


@row("uart_tx", {"": "1/32 clock"})
def uart_tx_(see):
    """Mean length of a bit; the carry of sixteenths loses nothing over any number of bytes."""
    for clk, baud in BAUDS:
        bit = Fraction(uart.sixteenths(clk, baud), 16)
        see.near(bit, Fraction(clk, baud), (clk, baud))
        data = [0x00, 0xFF, 0x55, 0xAA] * (4 if clk // baud < 1000 else 1)
        if clk // baud > 20_000:
            data = data[:1] if see.long else []
        line, at = uart.levels(data, clk, baud), 0
        see.near(len(line), int(10 * len(data) * bit), (clk, baud), limit=0)
        for k, level in enumerate(
            level for byte in data for level in (0, *(byte >> p & 1 for p in range(8)), 1)
        ):
            begin, at = at, int(bit * (k + 1))
            see.same(set(line[begin:at]), {level}, lambda: f"{clk} / {baud}, bit {k}")
    for bad in ((1199, 300), (12_000_000, 299), (12_000_000, 3_000_001), (400_000_001, 1_000_000)):
        see.refused(uart.sixteenths, *bad)


@row("uart_rx", {"": "0"})
def uart_rx_(see):
    """Bytes on a line with the largest tolerated baud error: half a bit less two clocks, over nine and a half
    bits.
    """
    for clk, baud in BAUDS:
        bit = Fraction(clk, baud)
        if bit > 2000 and not see.long:
            continue
        room = (bit / 2 - 2) / (Fraction(19, 2) * bit) if bit > 5 else 0
        for off in (0, room * 9 / 10, -room * 9 / 10):
            data = [0x00, 0xFF, 0x55, 0xAA, 0x80, 0x01] if bit < 2000 else [0x55]
            bits = (
                [1] * 3
                + [level for byte in data for level in (0, *(byte >> p & 1 for p in range(8)), 1)]
                + [1] * 3
            )
            edges = [round(k * bit * (1 + off)) for k in range(len(bits) + 1)]
            line = [level for k, level in enumerate(bits) for _ in range(edges[k + 1] - edges[k])]
            found = uart.UartRx(clk, baud).process(line)
            see.same(
                [byte for _, byte in found], data, lambda: f"{clk} / {baud}, {float(100 * off):.2f} % off"
            )
            see.near(len(found), len(data), (clk, baud))
