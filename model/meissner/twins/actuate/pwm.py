"""Bit-exact twin of rtl/actuate/msn_pwm.sv: a word as a pulse width."""

from meissner.twins.shared import within


def pwm(words, bits=16, divide=0):
    """The level of the pin in every clock, over one period for each of ``words``.

    A period is 2**bits - 1 steps of ``divide`` + 1 clocks; the pin is high in the first ``word`` steps, so
    0 is always low and 2**bits - 1 always high.
    """
    within(bits=(bits, 2, 16), divide=(divide, 0, (1 << 16) - 1))
    steps, levels = (1 << bits) - 1, []
    for word in words:
        within(word=(word, 0, steps))
        levels += [1] * (word * (divide + 1)) + [0] * ((steps - word) * (divide + 1))
    return levels
