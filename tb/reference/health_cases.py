"""Frames for the health of taxels and the faults that must be found in them, worked out by hand from
docs/array.md.

A case names only the taxels whose code is not always 0. ``found``: {frame: {place: faults}}, from frame 0.
"""

from dataclasses import dataclass, field

DEAD, RAILED, BLINKING = 1, 2, 4
REST = {"band": 2, "jump": 7, "low": -40, "high": 50, "over_range_enable": False, "edges": False}
REST |= {"still": 0, "rail": 0, "blink": 0}


@dataclass
class Case:
    name: str
    codes: dict  # place: its codes, one per frame
    found: dict
    settings: dict
    over: dict = field(default_factory=dict)  # place: its over-range flags
    clear: int = 0  # the frame before which a clear is requested
    broken: dict = field(default_factory=dict)  # frame: how many of its beats are intact
    shape: tuple = (3, 5)
    later: tuple = ()  # a frame and the settings that change before it

    def frames(self):
        return max(len(codes) for codes in self.codes.values())

    def frame(self, number, of=None):
        rows, columns = self.shape
        of = self.codes if of is None else of
        place = lambda row, column: of.get((row, column), [0] * (number + 1))[number]
        return [[place(row, column) for column in range(columns)] for row in range(rows)]


def path(frames, **steps):
    """Codes that start at 0 and step in given frames: f3=8 adds 8 in frame 3."""
    codes = [0]
    for frame in range(1, frames):
        codes.append(codes[-1] + steps.get(f"f{frame}", 0))
    return codes


def always(frames, step):
    """A step in every frame; if ``step`` is a pair, its two values alternate."""
    steps = step if isinstance(step, tuple) else (step, step)
    return path(frames, **{f"f{frame}": steps[frame % 2] for frame in range(1, frames)})


def at(frame, kind, *places):
    return {frame: dict.fromkeys(places, kind)}


def broken(whole, beats):
    """(place, last) of the beats of a frame that breaks after ``whole`` good beats: too short, or one too
    long."""
    good = [(place, False) for place in range(whole)]
    return [*good, (whole, True)] if whole < beats - 1 else [*good, (whole, False), (whole, True)]


A, B, C = (1, 0), (1, 1), (1, 2)  # side by side: B has all four neighbours
UP, DOWN = (0, 1), (2, 1)  # neighbours of B


def dead_cases():
    def case(name, codes, found, later=(), **settings):
        return Case(f"dead: {name}", codes, found, REST | settings, later=later)

    for sign in (1, -1):
        both = {A: path(8, f1=3 * sign), C: path(8, f1=3 * sign)}
        # One move in frame 1 is recent in frames 2, 3 and 4: 12 in all.
        yield case(f"recent for three frames {sign}", both, at(4, DEAD, B), still=12)
        yield case(f"not for a fourth {sign}", both, {}, still=13)
        yield case(f"after two frames 8 {sign}", both, at(3, DEAD, B), still=8)
        yield case(f"9 takes three {sign}", both, at(4, DEAD, B), still=9)
        yield case(f"off {sign}", both, {}, still=0)
        column = {UP: path(8, f1=3 * sign), DOWN: path(8, f1=3 * sign)}
        yield case(f"column {sign}", column, at(4, DEAD, B), still=12)
        band = {A: path(8, f1=2 * sign), C: path(8, f1=2 * sign)}
        yield case(f"as much as the band is no move {sign}", band, {}, still=1)
        creep = {A: path(9, f1=sign, f2=sign, f3=sign), C: path(9, f1=sign, f2=sign, f3=sign)}
        yield case(f"what creeps moves at frame 3 {sign}", creep, at(6, DEAD, B), still=12)
        contrary = {A: path(8, f1=3 * sign), C: path(8, f1=-3 * sign)}
        yield case(f"contrary ways {sign}", contrary, {}, still=1)
        turned = {A: path(8, f1=3 * sign, f2=-3 * sign), C: path(8, f2=-3 * sign)}
        yield case(f"the latest way counts {sign}", turned, at(5, DEAD, B), still=12)
        turned = {A: path(8, f1=3 * sign, f2=-3 * sign), C: path(8, f1=3 * sign)}
        yield case(f"until one turns {sign}", turned, at(2, DEAD, B), still=4)
        yield case(f"no more once it has {sign}", turned, {}, still=5)
        one = {B: path(8, f1=3 * sign)}  # the taxels above, below and left of it are at a border
        yield case(f"border {sign}", one, at(4, DEAD, UP, DOWN, A), still=3, edges=True)
        yield case(f"border not 4 {sign}", one, {}, still=4, edges=True)
        yield case(f"border off {sign}", one, {}, still=1)

        # Its own move in frame 3 keeps the count at 0 in frames 3 to 6; then 4, 8, 12 in frames 7, 8, 9.
        steady = {A: always(12, 3 * sign), C: always(12, 3 * sign)}
        yield case(f"own move {sign}", steady | {B: path(12, f3=3)}, at(9, DEAD, B), still=12)
        yield case(f"own move down {sign}", steady | {B: path(12, f3=-3)}, at(9, DEAD, B), still=12)
        yield case(
            f"as much as the band acquits not {sign}", steady | {B: path(12, f3=2)}, at(4, DEAD, B), still=12
        )

    corner = {(0, 1): path(8, f1=3), (1, 0): path(8, f1=3)}
    yield case("two that are no pair", corner, {}, still=1)
    yield case("corner", corner, at(4, DEAD, (0, 0), (2, 0)), still=3, edges=True)
    yield case("corner once a frame", corner, {}, still=4, edges=True)
    three = {(0, 0): path(8, f1=3), (0, 2): path(8, f1=3), (1, 1): path(8, f1=3)}
    yield case("a pair at a border", three, at(2, DEAD, (0, 1)), still=4, edges=True)
    yield case("a pair at a border adds 4, not 5", three, at(3, DEAD, (0, 1)), still=5, edges=True)
    cross = {place: path(8, f1=3) for place in (A, C, UP, DOWN)}
    yield case("two pairs add 4", cross, at(3, DEAD, B), still=5)
    # The n-th 4 comes in frame n + 1; 63 of them are 252.
    long = {A: always(80, (3, -3)), C: always(80, (3, -3))}
    yield case("252", long, at(64, DEAD, B), still=252)
    yield case("253", long, at(65, DEAD, B), still=253)
    yield case("to its end", long, at(65, DEAD, B), still=255)
    yield case("off for ever", long, {}, still=0)
    alone = {B: always(270, (3, -3))}
    yield case("border to its end", alone, at(256, DEAD, UP, DOWN, A), still=255, edges=True)
    # It also counts while off and saturates: a threshold set later is met immediately.
    yield case("stays at its end", long, at(75, DEAD, B), later=(75, {"still": 255}))
    on = {"edges": True}
    yield case(
        "border stays at its end", alone, at(265, DEAD, UP, DOWN, A), later=(265, {"still": 255}), **on
    )
    yield case("what the first frame brings is no move", {A: [300] * 8, C: [300] * 8}, {}, still=1)


def rail_cases():
    def case(name, codes, found, over=None, clear=0, **settings):
        return Case(f"rail: {name}", {(2, 3): codes}, found, REST | settings, over or {}, clear)

    T = (2, 3)
    yield case("at the upper", [50] * 20, at(16, RAILED, T), rail=1)
    yield case("one below", [49] * 40, {}, rail=1)
    yield case("one above", [51] * 20, at(16, RAILED, T), rail=1)
    yield case("at the lower", [-40] * 20, at(16, RAILED, T), rail=1)
    yield case("one above the lower", [-39] * 40, {}, rail=1)
    yield case("one below the lower", [-41] * 20, at(16, RAILED, T), rail=1)
    yield case("looked at in frame 16", [0] * 16 + [50] + [0] * 3, at(16, RAILED, T), rail=1)
    yield case("not in 15 and 17", [50] * 16 + [0] + [50] * 15 + [0] * 2, {}, rail=1)
    yield case("twice", [50] * 40, at(32, RAILED, T), rail=2)
    yield case("a break", [50] * 20 + [0] + [50] * 30, at(48, RAILED, T), rail=2)
    yield case("off", [50] * 40, {}, rail=0)
    yield case("over-range", [0] * 20, at(16, RAILED, T), {T: [1] * 20}, rail=1, over_range_enable=True)
    yield case("over-range is not asked", [0] * 20, {}, {T: [1] * 20}, rail=1)
    yield case("over-range once", [0] * 20, {}, {T: [1] * 16 + [0] * 4}, rail=1, over_range_enable=True)
    again = at(16, RAILED, T) | at(32, RAILED, T)
    yield case("a clear leaves the sixteen frames", [50] * 40, again, clear=20, rail=1)
    yield case("a clear counts from 0", [50] * 50, at(48, RAILED, T), clear=20, rail=2)


def blink_cases():
    T = (1, 3)

    def case(name, codes, found, clear=0, later=(), **settings):
        codes = codes if isinstance(codes, dict) else {T: codes}
        return Case(f"blink: {name}", codes, found, REST | settings, clear=clear, later=later)

    for sign in (1, -1):
        yield case(f"one above the jump {sign}", path(8, f1=8 * sign), at(2, BLINKING, T), blink=16)
        yield case(f"as much as the jump {sign}", path(8, f1=7 * sign), {}, blink=1)
        yield case(f"17 takes more {sign}", path(8, f1=8 * sign), {}, blink=17)
        two = path(8, f1=8 * sign, f2=-8 * sign)
        yield case(f"32 {sign}", two, at(3, BLINKING, T), blink=32)
        yield case(f"33 {sign}", two, {}, blink=33)
        gap = path(8, f1=8 * sign, f3=-8 * sign)
        yield case(f"31, less one between {sign}", gap, at(4, BLINKING, T), blink=31)
        yield case(f"32, less one between {sign}", gap, {}, blink=32)
        yield case(f"off {sign}", two, {}, blink=0)
        for frame, found in ((1, True), (2, False), (3, False), (4, False), (5, True)):
            other = {T: path(9, f4=8 * sign), (1, 4): path(9, **{f"f{frame}": 3})}
            expected = at(5, BLINKING, T) if found else {}
            yield case(f"a neighbour moves in frame {frame} {sign}", other, expected, blink=16)
        band = {T: path(9, f4=8 * sign), (1, 4): path(9, f4=2)}
        yield case(f"a neighbour's step of the band {sign}", band, at(5, BLINKING, T), blink=16)
    for place in (A, C, UP, DOWN):
        for step in (3, -3):
            codes = {B: path(6, f1=8), place: path(6, f1=step)}
            yield case(f"beside {place} {step}", codes, {}, blink=16)
    for place in ((0, 0), (0, 2), (2, 0), (2, 2)):
        codes = {B: path(6, f1=8), place: path(6, f1=3)}
        yield case(f"across {place}", codes, at(2, BLINKING, B), blink=16)
    yield case("both jump", {B: path(6, f1=8), C: path(6, f1=8)}, {}, blink=1)
    # 16 a frame from frame 2 on: 240 in frame 16; it saturates in frame 17.
    ends = always(20, (8, -8))
    yield case("240", ends, at(16, BLINKING, T), blink=240)
    yield case("241", ends, at(17, BLINKING, T), blink=241)
    end = path(26, **{f"f{frame}": 8 * (-1) ** frame for frame in range(1, 21)})
    yield case("254 after its end", end, at(22, BLINKING, T), later=(22, {"blink": 254}))
    yield case("not 255 after its end", end, {}, later=(22, {"blink": 255}))
    yield case("to its end", ends, at(17, BLINKING, T), blink=255)
    yield case("any step is a jump of 0", path(8, f1=1), at(2, BLINKING, T), blink=16, jump=0, band=0)
    yield case("no step is none", path(8), {}, blink=1, jump=0, band=0)
    yield case("what the first frame brings is no jump", [5000] * 6, {}, blink=1)
    clear = path(12, f1=8, f6=9, f8=8)
    yield case("a clear", clear, at(2, BLINKING, T) | at(9, BLINKING, T), clear=6, blink=16)


def one_row_cases():
    """1 x 3 taxels, beat by beat, with frames that break off."""

    def case(name, codes, found, broken=None, **settings):
        return Case(f"1 x 3: {name}", codes, found, REST | settings, broken=broken or {}, shape=(1, 3))

    A, B, C = (0, 0), (0, 1), (0, 2)
    outer, inner = {A: path(8, f1=3), C: path(8, f1=3)}, {B: path(8, f1=-3)}
    yield case("both sides", outer, at(4, DEAD, B), still=12)
    yield case("one side", inner, at(4, DEAD, A, C), still=3, edges=True)
    yield case("one side, no more", inner, {}, still=4, edges=True)
    yield case("one side, not asked", inner, {}, still=1)
    railed = {place: [50] * 20 for place in (A, B, C)}
    # A frame that breaks off is not counted among the sixteen, but its first beats are checked.
    found = at(16, RAILED, A) | at(17, RAILED, B, C)
    yield case("a frame breaks when looked at", railed, found, {16: 1}, rail=1)
    yield case("a frame breaks before", railed, at(17, RAILED, A, B, C), {5: 2}, rail=1)
    # A moves in frame 1, which breaks off, so C moves in frame 2; both are recent in frames 3 and 4 only.
    yield case("moves of a frame that breaks", outer, at(4, DEAD, B), {1: 2}, still=8)
    yield case("no more of them", outer, {}, {1: 2}, still=9)
    # A jump in a broken frame is also judged a frame later; moves of other taxels in it do not count.
    both = {A: path(8, f2=8), B: path(8, f2=8)}
    yield case("a jump in a frame that breaks", both, at(3, BLINKING, A, B), {2: 2}, blink=16)
    yield case("the same in a whole one", both, {}, blink=1)


def cases():
    return [*dead_cases(), *rail_cases(), *blink_cases(), *one_row_cases()]
