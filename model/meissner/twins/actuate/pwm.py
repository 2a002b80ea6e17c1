"""Bit-exact twin of rtl/actuate/msn_pwm.sv: a word as a pulse width."""


def pwm(words, bits=16, divide=0):
    """The level of the pin in every clock, over one period for each of ``words``.

    A period is 2**bits - 1 steps of ``divide`` + 1 clocks; the pin is high in the first ``word`` steps, so
    0 is always low and 2**bits - 1 always high.
    """
    if not 2 <= bits <= 16:
        raise ValueError(f"bits = {bits} must lie in 2 .. 16")
    if not 0 <= divide < 1 << 16:
        raise ValueError(f"divide = {divide} must lie in 0 .. {(1 << 16) - 1}")
    steps, levels = (1 << bits) - 1, []
    for word in words:
        if not 0 <= word <= steps:
            raise ValueError(f"word = {word} must lie in 0 .. {steps}")
        levels += [1] * (word * (divide + 1)) + [0] * ((steps - word) * (divide + 1))
    return levels
