"""Bit-exact twin of rtl/common/msn_frame_owed.sv: whether results of a frame are still outstanding."""

from meissner.twins.shared import within


class FrameOwed:
    """Each frame owes ``results``; a lost one is given up after 2**``quiet_bits`` - 1 quiet clocks."""

    def __init__(self, results=1, quiet_bits=9):
        within(results=(results, 1, None), quiet_bits=(quiet_bits, 2, 16))
        self.results, self.quiet_bits = results, quiet_bits
        self.reset()

    def reset(self):
        self.owed, self.still = set(), 0

    def next(self, taken, first, done, drop, quiet):
        """``busy_o`` in this clock; ``done``: a flag for each result."""
        busy = bool(self.owed)
        lost = self.still == (1 << self.quiet_bits) - 1
        if taken and first:
            self.owed = set(range(self.results))
        elif drop or lost:
            self.owed = set()
        else:
            self.owed = {k for k in self.owed if not done[k]}
        self.still = self.still + 1 if busy and first and quiet and not taken and not lost else 0
        return busy

    def process(self, clocks):
        """``next`` for every clock, in order: a list of bools."""
        return [self.next(*clock) for clock in clocks]
