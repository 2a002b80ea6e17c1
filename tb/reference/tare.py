"""The zero of a taxel by docs/array.md, in exact rationals: written from that page, not from the twin."""

from fractions import Fraction
from math import floor


class TareReference:
    """``frame`` takes one complete frame of codes [taxel] and returns the codes with their zeros subtracted.

    ``sample_bits``: a subtracted zero saturates at so many bits, signed; None if no zero gets that far.
    """

    def __init__(self, taxels, fraction_bits, tare_log2, contact, step, sample_bits=None):
        self.end = None if sample_bits is None else 1 << sample_bits - 1
        self.zeros = [Fraction(0)] * taxels
        self.move, self.contact, self.length = Fraction(step, 1 << fraction_bits), contact, 1 << tare_log2
        self.asked = self.forced = False
        self.seen = None  # results of the frames being averaged; None if no tare is in progress
        self.average = None  # complete, but not yet added to the zeros
        self.tared = self.refused = 0

    def tare(self, force=False):
        if self.seen is None and self.average is None:
            self.seen, self.forced = [], force

    def taken_off(self, zero):
        nearest = floor(zero + Fraction(1, 2))
        return nearest if self.end is None else max(-self.end, min(self.end - 1, nearest))

    def frame(self, codes, masked):
        if self.average is not None:  # one frame in which nothing else changes the zeros
            self.zeros = [zero + more for zero, more in zip(self.zeros, self.average)]
        left = [code - self.taken_off(zero) for code, zero in zip(codes, self.zeros)]
        pressed = any(r > self.contact and not off for r, off in zip(left, masked))
        if self.seen is not None:
            self.seen.append(left)
            if pressed and not self.forced:
                self.seen, self.refused = None, self.refused + 1
            elif len(self.seen) == self.length:
                self.average = [Fraction(sum(each), self.length) for each in zip(*self.seen)]
                self.seen = None
        elif self.average is not None:
            self.average, self.tared = None, self.tared + 1
        else:
            for taxel, r in enumerate(left):
                if r <= self.contact and r != 0:
                    self.zeros[taxel] += self.move if r > 0 else -self.move
        return left
