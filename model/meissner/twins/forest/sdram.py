"""Twin of rtl/forest/msn_sdram.sv: words of 64 bits by address, in an SDRAM of four banks.
msn_forest_sdram.sv joins it to a forest, whose twin is forest.py.

word address = {bank [21:20], row [19:7], column / 4 [6:0]}     four beats of 16 bits, the low one first
"""

import numpy as np

from meissner.twins.shared import within

BANKS = 4
BANK_WORDS = 1 << 20
WORDS = BANKS * BANK_WORDS


class Sdram:
    """``load`` writes a word, ``read`` gives that of each address; the order of answers is free."""

    def __init__(self, clk_khz=100_000, power_up_us=200, tag_bits=5, queue=32, read_clocks=4):
        within(
            clk_khz=(clk_khz, 20_000, 133_000),
            power_up_us=(power_up_us, 1, 1000),
            tag_bits=(tag_bits, 1, 16),
            read_clocks=(read_clocks, 3, 6),
        )
        if queue < 2 or queue & (queue - 1):
            raise ValueError(f"queue = {queue} must be a power of two, 2 or more")
        self._words = {}

    def load(self, address, word):
        within(address=(address, 0, WORDS - 1), word=(word, 0, (1 << 64) - 1))
        self._words[address] = word

    def read(self, addresses):
        return np.array([self._words[address] for address in addresses], np.uint64)


def beats(address, word):
    """(bank, row, column, 16 bits) of each of a word's beats, in order."""
    place = address % BANK_WORDS
    where = address // BANK_WORDS, place >> 7
    return [(*where, (place & 127) * 4 + beat, word >> 16 * beat & 0xFFFF) for beat in range(4)]
