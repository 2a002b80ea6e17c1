"""Twin of rtl/frontend/msn_spi_shift.sv: the bits of a word, and the timing in clocks."""

import numpy as np

from meissner.twins.shared import within


def check(bits, data_bits, half):
    within(half=(half, 1, None), data_bits=(data_bits, 2, bits))


def word(line, data_bits):
    """The code in one word, its last ``data_bits`` bits; ``line``: the DOUT level of each SCLK period."""
    code = 0
    for level in np.asarray(line)[-data_bits:]:
        code = code << 1 | int(level)
    return code


def command_line(command, bits, data_bits):
    """The DIN levels of the first ``data_bits`` SCLK periods of a word."""
    return [command >> (data_bits - 1 - bit) & 1 for bit in range(min(bits, data_bits))]


def word_clock(bits, half, words=1, lead=False):
    """Clocks from start_i to word_o of the ``words``-th word of a CS frame."""
    return 2 * half * bits * words + half * lead


def done_clock(bits, half, words=1, lead=False):
    """Clocks from start_i to done_o, the first clock in which the next start_i is allowed."""
    return 2 * half * (bits * words + 1) + half * lead
