"""Bit-exact twin of rtl/link/msn_uart_tx.sv: the levels of a serial line, clock by clock."""


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
