"""The pin display by docs/pin_display.md: the phase clock by clock, the limits pin by pin from lists of all
that was driven, the image's averages from areas as fractions."""

from fractions import Fraction

WRAP = 1 << 40


class Phase:
    """``clock`` takes a clock's inputs; it returns (begins, off, slot that begins or None) of that clock."""

    def __init__(self, least, largest, slots, tick_clocks, ticks):
        self.least, self.largest, self.slots = least, largest, slots
        self.tick_clocks, self.ticks = tick_clocks, ticks
        self.now, self.running, self.place, self.increment = 0, False, 0, 0
        self.since_frame, self.was = 65535, 0
        self.starting = self.wrapped = self.turned = False
        self.slot = None
        self.ticks_of_period = self.length = self.burst = 0
        self.silent = self.burst_on = False

    def clock(self, asked, burst_period, burst_on, stop, enable=1, fault=0, frame=1, idle=1):
        begins, slot = False, None
        tick = (self.now + 1) % self.tick_clocks == 0
        self.turned = (self.now + 1) % (self.tick_clocks * self.ticks) == 0
        self.now += 1
        dead = not enable or fault or (not frame and self.since_frame >= stop)
        off = self.running and (dead or (self.wrapped and self.was < self.least))
        if self.running and not off:
            slot, begins = self.slot, self.wrapped
            if begins:
                wanted = min(self.was, self.largest)
                self.silent = wanted != self.increment
                self.burst_on = burst_period == 0 or self.burst < burst_on
                self.burst = 0 if self.silent or self.burst + 1 >= burst_period else self.burst + 1
                self.length, self.ticks_of_period = self.ticks_of_period + tick, 0
            else:
                wanted = self.increment
                self.ticks_of_period += tick
            place = self.place + self.increment  # the new one counts from the next clock on
            self.wrapped, before = place >= WRAP, self.place * self.slots // WRAP
            self.place, self.increment = place % WRAP, wanted
            now = self.place * self.slots // WRAP
            self.slot = now if now != before else None
        elif off:
            self.length = self.ticks_of_period + tick
            self.running = self.wrapped = False
        elif not dead and self.was >= self.least and idle and not self.turned:
            self.running = self.wrapped = True
            self.place = self.increment = self.slot = self.burst = self.ticks_of_period = 0
        if begins and frame:
            self.since_frame = 0
        elif tick:
            self.since_frame = min(self.since_frame + 1, 65535)
        self.was = asked
        return begins, bool(off), slot


class Limits:
    """``period`` takes a frame and what is known of the period that ends; it returns the levels that are
    driven."""

    def __init__(self, pins, bits):
        self.pins, self.highest = range(pins), (1 << bits) - 1
        self.charged = [[] for _ in self.pins]  # of each pin: (seventh in which it was charged, ticks)
        self.held = [0] * pins  # sevenths that ended while the frames had it on
        self.on = set()
        self.seventh = 0

    def charge(self, length):
        for pin in self.on:
            self.charged[pin].append((self.seventh, length + 1))
        self.on = set()

    def total(self, pin):
        return sum(ticks for seventh, ticks in self.charged[pin] if seventh >= self.seventh - 7)

    def period(self, frame, length, turned, top, most, duty, watchdog, burst=True, silent=False):
        """(levels, whether a limit keeps a pin off)"""
        self.seventh += turned
        self.charge(length)
        top, levels, used, kept_off = min(top, self.highest), [], 0, False
        for pin, wish in zip(self.pins, frame):
            wish = min(wish, self.highest)
            self.held[pin] = min(self.held[pin] + turned, 15) if wish else 0
            may = wish > 0 and top > 0 and used < most and self.held[pin] <= watchdog
            may = may and self.total(pin) + length + 2 <= duty
            used += may
            kept_off |= wish > 0 and not may
            if may and burst and not silent:
                self.on.add(pin)
            levels.append(min(wish, top) if pin in self.on else 0)
        return levels, kept_off

    def off(self, length, turned=0):
        self.seventh += turned
        self.charge(length)


def averages(image, rows, columns):
    """Of each pin of a grid that an image is divided into: the mean of the taxels by their areas, as
    fractions."""
    high, wide = len(image), len(image[0])

    def shared(first, last, start, end):
        return max(Fraction(0), min(last, end) - max(first, start))

    def mean(i, j):
        top, bottom = Fraction(i * high, rows), Fraction((i + 1) * high, rows)
        left, right = Fraction(j * wide, columns), Fraction((j + 1) * wide, columns)
        total = sum(
            x * shared(top, bottom, r, r + 1) * shared(left, right, c, c + 1)
            for r, row in enumerate(image)
            for c, x in enumerate(row)
        )
        return total / ((bottom - top) * (right - left))

    return [[mean(i, j) for j in range(columns)] for i in range(rows)]


def level_of(mean, floor, step, highest):
    """Of a pin with that mean: 0 below ``floor``, then a level for each ``step``, all of them at once for
    0."""
    if mean < floor:
        return 0
    level = 1
    while level < highest and mean >= floor + step * level:
        level += 1
    return level


def stripes(octant, phase, rows, columns):
    """{(row, column)} of the cue: rows count downwards, octants from the right counter-clockwise."""
    right = {0: 1, 1: 1, 2: 0, 3: -1, 4: -1, 5: -1, 6: 0, 7: 1}[octant]
    down = {0: 0, 1: -1, 2: -1, 3: -1, 4: 0, 5: 1, 6: 1, 7: 1}[octant]
    return {(i, j) for i in range(rows) for j in range(columns) if (right * j + down * i - phase) % 4 == 0}
