"""Health of taxels by docs/array.md, one sample at a time: written from that page, not from the twin."""

DEAD, RAILED, BLINKING = 1, 2, 4  # docs/link.md, packets of type 4


class Taxel:
    """The state of one taxel."""

    def __init__(self):
        self.held = None  # the code that the next one is compared with; None before the first frame
        self.since = None  # frames from its latest move to the end of the last frame, both included
        self.rose = False  # direction of its latest move
        self.jumped = False  # in the last frame
        self.still = self.looks = self.blinks = 0
        self.faults = 0

    def recent(self):
        """Whether it moved in one of the last three frames."""
        return self.since is not None and self.since <= 3


class HealthReference:
    """``frame`` takes a frame of codes [row][column] and returns the new faults: {place: faults}."""

    def __init__(self, rows, columns, **settings):
        self.rows, self.columns, self.settings = rows, columns, settings
        self.frames = 0  # complete ones since reset
        self.clear()

    def clear(self):
        places = [(row, column) for row in range(self.rows) for column in range(self.columns)]
        self.taxels = {place: Taxel() for place in places}
        self.first = True
        self.last_whole = {place: (False, False) for place in places}

    def faults(self, row, column):
        """The sum of DEAD, RAILED and BLINKING; if it is not 0, the next frame's sample is masked."""
        return self.taxels[row, column].faults

    def frame(self, codes, over=None, beats=None):
        """``over``: over-range flags like ``codes``; ``beats``: the places received before a frame broke
        off."""
        new = {}
        for (row, column), taxel in self.taxels.items():
            if beats is not None and (row, column) not in beats:
                continue
            before = taxel.faults
            if self.first:
                fresh = Taxel()
                fresh.held = codes[row][column]
                self.taxels[row, column] = fresh
            else:
                self._sample(taxel, row, column, codes[row][column], bool(over and over[row][column]))
                if taxel.faults != before:
                    new[row, column] = taxel.faults & ~before
        if beats is None:
            for place, taxel in self.taxels.items():
                self.last_whole[place] = (taxel.recent(), taxel.rose)
            self.frames += 1
            self.first = False
        return new

    def _sample(self, taxel, row, column, code, over):
        given = self.settings
        left, right = self.last_whole.get((row, column - 1)), self.last_whole.get((row, column + 1))
        above, below = self.last_whole.get((row - 1, column)), self.last_whole.get((row + 1, column))
        difference = code - taxel.held
        moved = difference > given["band"] or -difference > given["band"]

        # Dead: still between two neighbours that move.
        if moved or taxel.recent():
            taxel.still = 0
        else:
            taxel.still = min(taxel.still + self._proof(left, right, above, below), 255)
        if given["still"] != 0 and taxel.still >= given["still"]:
            taxel.faults |= DEAD

        # Railed: checked in every sixteenth frame.
        if code <= given["low"] or code >= given["high"] or (given["over_range_enable"] and over):
            if self.frames % 16 == 0 and taxel.looks < 255:
                taxel.looks += 1
            if given["rail"] != 0 and taxel.looks >= given["rail"]:
                taxel.faults |= RAILED
        else:
            taxel.looks = 0

        # Blinking: the jump of the previous frame, as only now it is known which neighbours moved in that
        # frame.
        alone = True
        for neighbour in (left, right, above, below):
            if neighbour is not None and neighbour[0]:
                alone = False
        if taxel.jumped and alone:
            taxel.blinks = min(taxel.blinks + 16, 255)
        elif taxel.blinks > 0:
            taxel.blinks -= 1
        if given["blink"] != 0 and taxel.blinks >= given["blink"]:
            taxel.faults |= BLINKING
        taxel.jumped = difference > given["jump"] or -difference > given["jump"]

        if moved:
            taxel.held, taxel.since, taxel.rose = code, 1, difference > 0
        elif taxel.since is not None:
            taxel.since += 1

    def _proof(self, left, right, above, below):
        """The count that the neighbours, each (recent, rose) or None if absent, add against a taxel that is
        still."""
        border = 0
        for one, other in ((left, right), (above, below)):
            if one is None and other is None:
                continue
            if one is None or other is None:
                single = one or other
                if single[0] and self.settings["edges"]:
                    border = 1
            elif one[0] and other[0] and one[1] == other[1]:
                return 4
        return border
