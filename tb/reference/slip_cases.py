"""Details and the states they must lead to, worked out by hand from docs/slip.md; one letter per detail.

levels   Q above the contact level, P at it, p one below, R at the release level, L one below, m between,
         l far below
         (all mirrored if the level falls with the force)
p2p      0: none; . at the threshold, o one above; G at the gross threshold, g one above
states   n none, c contact, i incipient, g gross, r release
"""

from dataclasses import dataclass

RISES = {"Q": 1001, "P": 1000, "p": 999, "m": 950, "R": 900, "L": 899, "l": 100}
FALLS = {"Q": 1299, "P": 1300, "p": 1301, "m": 1350, "R": 1400, "L": 1401, "l": 2300}
SIZES = {"0": 0, ".": 40, "o": 41, "G": 80, "g": 81}


@dataclass
class Case:
    name: str
    levels: str
    p2p: str
    states: str
    blanked: int = 0  # details counted as over while blanked or moving
    moving: str = ""  # m where the actuator moves
    masked: str = ""  # x where the detail is masked
    hold: int = 0
    refractory: int = 0
    blank: int = 0
    gross: int = 80
    swapped: bool = False  # the contact level is R, the release level P

    def __post_init__(self):
        for name in ("levels", "p2p", "states", "moving", "masked"):
            setattr(self, name, getattr(self, name).replace(" ", ""))
        count = len(self.states)
        assert len(self.levels) == len(self.p2p) == count, self.name
        self.moving, self.masked = self.moving.ljust(count, "-"), self.masked.ljust(count, "-")

    def settings(self, rises):
        levels = RISES if rises else FALLS
        contact, release = "RP" if self.swapped else "PR"
        given = {"threshold": 40, "gross_threshold": self.gross, "contact_rises": rises}
        given |= {"contact_level": levels[contact], "release_level": levels[release]}
        return given | {name: getattr(self, name) for name in ("hold", "refractory", "blank")}

    def details(self, rises):
        """(p2p, level, moving, masked) of each detail."""
        levels = RISES if rises else FALLS
        return [
            (SIZES[size], levels[level], moving == "m", masked == "x")
            for size, level, moving, masked in zip(self.p2p, self.levels, self.moving, self.masked)
        ]


LONGEST = 15  # of a timer of four bits

CASES = [
    Case("contact from its level on", "lLRmp PpmRR", "00000 00000", "nnnnn ccccc"),
    Case("contact above its level", "pQ", "00", "nc"),
    Case("released below the release level", "PRLLp P", "00000 0", "ccrnn c"),
    Case("released, and none after hold details", "PLpplp", "000000", "crrrrn", hold=3),
    Case("released with hold 1", "PLpp", "0000", "crrn", hold=1),
    Case("touched again in release", "PLPRLpmpp", "000000000", "crccrrrnn", hold=2),
    Case("the longest release", "PL" + "p" * 16, "0" * 18, "cr" + "r" * 15 + "n", hold=LONGEST),
    # At each threshold and one above.
    Case("thresholds", "PPPPPPPPPPPP", "0.o.G.g.ogG.", "ccicicgciggc"),
    Case("gross at once, then only over", "PPPPP", "0goo0", "cgggc"),
    Case("over when touched", "PPP", "g.o", "cci"),
    Case("gross threshold below the other", "PPPP", "0.o.", "ccgc", gross=20),
    Case("over without contact", "pmRPL", "ggg0g", "nnncr"),
    Case("lifted while over", "PPLpP", "0ogg0", "cirnc"),
    Case("lifted from gross", "PPL", "0gg", "cgr"),
    # Hold.
    Case("hold 0", "PPPP", "0o.o", "cici"),
    Case("hold 1", "PPPPP", "0o..o", "ciici", hold=1),
    Case("hold 2", "PPPPPP", "0o...o", "ciiici", hold=2),
    Case("hold begins again", "PPPPPPPP", "0o..o...", "ciiiiiic", hold=2),
    Case("gross holds too", "PPPPPP", "0g.G..", "cggggg", hold=2),
    Case("the longest hold", "PP" + "P" * 16, "0o" + "." * 16, "ci" + "i" * 15 + "c", hold=LONGEST),
    Case("hold one short of the longest", "PP" + "P" * 15, "0o" + "." * 15, "ci" + "i" * 14 + "c", hold=14),
    # Refractory.
    Case("refractory 1", "PPPPP", "0o.oo", "cicci", refractory=1),
    Case("refractory 2", "PPPPPP", "0o.ooo", "ciccci", refractory=2),
    Case("refractory after gross", "PPPPPP", "0g.ggg", "cgcccg", refractory=2),
    Case("refractory runs while quiet", "PPPPPP", "0o...o", "ciccci", refractory=2),
    Case(
        "the longest refractory",
        "PP" + "P" * 17,
        "0o." + "o" * 16,
        "cic" + "c" * 15 + "i",
        refractory=LONGEST,
    ),
    Case("a release ends it", "PPPLPPP", "0o.00oo", "cicrcii", refractory=9),
    Case("not counted", "PPPP", "0o.g", "cicc", refractory=5),
    # Blank.
    Case("blank 0", "PP", "oo", "ci"),
    Case("blank 1", "PPP", "ooo", "cci", 1, blank=1),
    Case("blank 2", "PPPP", "oogo", "ccci", 2, blank=2),
    Case("what is not over is not counted", "PPPPP", "0..oo", "cccci", 1, blank=3),
    Case("the longest blank", "P" * 17, "o" * 17, "c" * 16 + "i", 15, blank=LONGEST),
    Case("each contact is blanked", "PPPLPPP", "0oo00oo", "ccircci", 2, blank=1),
    Case("blank once a contact", "PPPPP", "0oo.o", "ccici", 1, blank=1),
    # Two events in one detail: a hold's end and a new contact, a hold's end and a lift, a blank's end and a
    # slip.
    Case("touched one before a release ends", "PLp PPPP", "000 oooo", "crr ccii", 1, hold=2, blank=1),
    Case("touched in a release's last detail", "PLpp PPP", "0000 ooo", "crrr cci", 1, hold=2, blank=1),
    Case("touched as a release is over", "PLppp PPP", "00000 ooo", "crrrn cci", 1, hold=2, blank=1),
    Case("over as a hold ends", "PPPP PPPPPPP", "0..o ..o...o", "ccci iiiiici", 0, hold=2, blank=2),
    Case("lifted as a hold ends", "PPPL ppp", "0o.g 000", "ciir rnn", 0, hold=1),
    Case("lifted one after a hold ends", "PPPPL pp", "0o..g 00", "ciicr rn", 0, hold=1, refractory=2),
    Case("lifted as a blank ends", "PPL pP", "0og 0o", "ccr nc", 1, blank=1),
    Case("lifted as a refractory time ends", "PPPPL pPP", "0o.oo 0oo", "ciccr nci", 0, refractory=2),
    Case("a hold as long as the blank", "PPPP PPPPP", "oooo ...oo", "ccci iicii", 2, hold=2, blank=2),
    # Moving.
    Case("moving", "PPPP", "0oo.", "ccic", 1, "-m"),
    Case("moving and gross", "PPP", "0gg", "ccg", 1, "-m"),
    Case("moving, at the threshold", "PPP", "0.o", "cci", 0, "-m"),
    Case("moving while slipping", "PPPPP", "0ooo.", "ciicc", 2, "--mm", hold=1),
    Case("moving makes nothing gross", "PPPP", "0ogg", "ciig", 1, "--m", hold=2),
    Case("moving without contact", "pPLm", "gggg", "ncrn", 0, "mmmm"),
    Case("moving while refractory", "PPPPPP", "0o.ooo", "ciccci", 2, "---mm", refractory=2),
    Case("moving while blanked", "PPPP", "0ooo", "ccci", 2, "-mm", blank=1),
    # Masked.
    Case("masked in contact", "PPPPP", "0oooo", "cinci", 0, masked="--x"),
    Case("masked is never over", "PPPP", "0oo.", "cncc", 0, "-m", "-x"),
    Case("masked from release", "PLpp", "0000", "crnn", masked="--x", hold=5),
    Case("masked is not pressed", "PP", "00", "nc", masked="x"),
    Case("masked, then blanked", "PPPPPP", "0gg0gg", "ccnccg", 2, masked="--x", blank=1),
    Case("masked from gross", "PPP", "0gg", "cgn", masked="--x"),
    Case("pressed and lifted at once", "mmmmp", "ggggg", "crcrc", swapped=True),
]
