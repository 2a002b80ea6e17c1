"""The rules of docs/shear_speed.md, window by window in integers, and the formula with 50 digits."""

from fractions import Fraction

import mpmath

UNSETTLED, RANGE, SMALL, DENOMINATOR, CLIPPED, RISING, FAST, SATURATED = (1 << bit for bit in range(8))


class ShearReference:
    """``window`` takes a window's samples and returns (flags that do not depend on the speed, exact v or
    None).

    ``settings``: a dict of the registers; ``window_log2``, ``settle_log2`` as in docs/shear_speed.md.
    """

    def __init__(self, settings, window_log2, settle_log2, speed_fraction):
        self.given, self.more = settings, 2**settle_log2
        self.point = speed_fraction
        self.reference = self.vi = None
        self.resting = []  # window sums counted so far

    def window(self, samples, held=False):
        given, total = self.given, sum(samples)
        level = total * self.more
        clipped = max(samples) >= given["full"]
        rises = self.reference is not None and level > self.reference + given["still"]
        falls = self.reference is not None and level < self.reference - given["still"]
        known = self.vi is not None and not held and (clipped or not falls)
        flags, exact = CLIPPED if clipped else 0, None
        small = True
        if known:
            rise, k = level - self.vi, self.denominator()
            small = rise < given["noise"] or rise <= 0
            if not clipped:
                flags |= RANGE if not given["vi_min"] <= self.vi <= given["vi_max"] else 0
                flags |= SMALL if small else 0
                flags |= DENOMINATOR if k < 1 else 0
                if not flags:
                    exact = self.speed(rise, k)
        else:
            flags |= UNSETTLED
        self.follow(total, level, held, clipped, rises or falls, known, small)
        return flags, exact

    def denominator(self):
        return self.given["k0"] + (self.given["k1"] * self.vi) // 2**16

    def speed(self, rise, k):
        """v in units of 2^-SpeedFraction."""
        power = mpmath.mpf(self.given["exponent"]) / 2**11
        return mpmath.power(mpmath.mpf(rise) / k, power) * mpmath.mpf(2) ** self.point

    def follow(self, total, level, held, clipped, moved, known, small):
        if held:  # rule 5
            self.reference = self.vi = None
            self.resting = []
            return
        if clipped:  # rule 6
            self.resting = []
            return
        if not known:
            self.vi = None
        if self.reference is None or moved:  # rule 1; counting starts with the reference
            self.reference, self.resting = level, []
        if known and not small:  # rule 3: Vi is kept and counting restarts
            self.resting = []
            return
        self.resting.append(total)
        if len(self.resting) == self.more:  # rule 2
            self.vi, self.reference, self.resting = sum(self.resting), level, []


def within(exponent, level_bits, table_bits, fraction_bits):
    """The relative error of v that docs/shear_speed.md, Error, allows before the rounding to an LSB."""
    lsb, two = mpmath.mpf(2) ** -fraction_bits, mpmath.mpf(2)
    log_above = lsb * 5 / 8 + two**-29
    log_below = log_above + lsb / 4 + mpmath.mpf("0.1804") / 4**table_bits
    if level_bits - table_bits > 17:
        log_below += mpmath.mpf("1.4427") * two ** -(table_bits + 17)
    power = (
        (log_below + log_above) * Fraction(exponent, 2**11).numerator / Fraction(exponent, 2**11).denominator
    )
    own = max(lsb * 3 / 8 + two**-29, lsb / 8 + two**-29 + mpmath.mpf("0.0601") / 4**table_bits)
    return two ** (power + lsb / 2) * (1 + own) - 1
