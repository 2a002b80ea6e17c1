"""Extremes of the physics that pulls and holds an object: plate, grip, their stepped forms, slides, the
hand."""

from fractions import Fraction

import mpmath
import numpy as np

from extremes.rows import row
from meissner.physics import grip, hand, plate, slide, stepped

G = Fraction("9.81")


def relative(see, got, wanted, where, part=""):
    """Compares relative to 1, for a result of any size."""
    see.near(float(got) / wanted if wanted else 1 + float(got), 1, where, part)


@row("plate", {"": "1e-12 of the value"})
def plate_(see):
    stiffness = Fraction("0.7") * 2 / 30
    for one in see.covering(
        newtons=[1e-300, 1e-3, 2.0, 1e6, 1e12],
        speed=[1e-3, 10.0, 1e3],
        follow=[0.0, 0.5, 1.4],
        spread=[0.5, 1.0],
    ):
        mu = Fraction("0.7") * Fraction(one["spread"])
        wanted = mu * Fraction(one["newtons"]) / (1 - mu * Fraction(one["follow"]))
        got = plate.rise_s(one["newtons"], one["speed"], "acrylic", one["follow"], one["spread"])
        relative(see, got, float(wanted / (stiffness * Fraction(one["speed"]))), one)
    for newtons, speed in ((1e-3, 1.0), (2.0, 10.0), (1e6, 1e6)):
        spread = 1 + Fraction("0.03") * Fraction(np.random.default_rng(3).standard_normal())
        rise_s = Fraction("0.7") * spread * Fraction(newtons) / (stiffness * Fraction(speed))
        time_s = np.arange(200) / 200 * float(rise_s) * 1.5
        found = plate.pull(time_s, newtons, speed, "acrylic", 0.0, np.random.default_rng(3))
        relative(see, found.gross_s, float(rise_s), (newtons, speed))
        for at, tension_n in zip(time_s[time_s < found.gross_s].tolist(), found.tension_n.tolist()):
            relative(see, tension_n, float(stiffness * Fraction(speed) * Fraction(at)), (newtons, speed, at))
        for q in (0.0, 5e-324, 0.875, 1.0):
            see.near(found.time_of(q) / found.gross_s, Fraction(q), q)
        see.same(bool(np.isfinite(found.tension_n).all() and np.isfinite(found.slip_mm).all()), True, newtons)
        see.same(bool((found.slip_mm[time_s < found.gross_s] == 0).all()), True, newtons)
    still, moving = plate.press(
        np.arange(500) / 1000, 1e6, [(0.1, 0.1), (0.3, 0.1)], np.random.default_rng(1)
    )
    see.near(still[250] / 1e6, 1, "held at 1e6 N")
    see.same((still[0], still[-1], int(moving.sum())), (0.0, 0.0, 200), "pressed and let go")


@row("gripped object", {"": "1e-12"})
def grip_(see):
    time_s = np.arange(9) / 8
    for top in (5e-324, 1e-12, 2.0, 1e12):
        found = grip.ramps(time_s, [(0.25, 0.5, top)])
        for at, force_n in zip(time_s.tolist(), found.tolist()):
            place = min(max((mpmath.mpf(at) - mpmath.mpf("0.25")) / mpmath.mpf("0.5"), 0), 1)
            wanted = mpmath.mpf(top) * (1 - mpmath.cos(mpmath.pi * place)) / 2
            room = max(mpmath.mpf(top), mpmath.mpf("1e-300"))
            see.near(mpmath.mpf(force_n) / room, wanted / room, (top, at))
    for force_n, rest in ((0.5, 4), (1.0, 3), (1.7, 2)):
        k = min(Fraction("1.55") - Fraction("0.27") * rest, Fraction("0.47") * (5 - rest))
        for level in (0.0, 5e-324, 1e-9, 0.5, 1.13):
            volts = rest + k * Fraction(level)
            wanted = (5 - volts) / volts * rest / (5 - rest)
            see.near(float(grip.share(np.array([force_n]), level)[0]), wanted, (force_n, level))
    see.same(grip.share(np.array([0.0, 0.0]), 1.0).tolist(), [1.0, 1.0], "0 N")
    for force_n in (1e-300, 1e-6, 1e6, 1e12):
        left = grip.share(np.array([force_n]), 1.0)[0]
        see.same(bool(0 <= left <= 1), True, force_n)
    for degrees in (0.0, 90.0, 180.0, 360.0, -1e12):
        see.near(grip.mirrored(degrees) / 1e12, (180 - Fraction(degrees)) / Fraction(1e12), degrees)


@row(
    "hand, stepped",
    {"the ring": "1e-12 of a sample", "its memory": "1e-12 of N", "the level": "1e-12", "an event": "1e-12"},
)
def stepped_(see):
    shares = (1 / 16, 0.3, 0.5, 0.875, 15 / 16)
    for power in (-20, 0, 20, 1000):
        force_n = 2.0**power
        ring = stepped.Ring([list(shares)], [[1.0] * len(shares)], [0.5])
        ratio = np.arange(1, 16) / 16
        _, at, _ = ring.next(np.full((1, 15), force_n), force_n * 0.5 * ratio[None], 1e-3)
        for q, instant in zip(shares, at.tolist()):
            see.near(instant, Fraction(q) * 16 - 1, (power, q), "the ring")
        see.same(len(at), len(shares), power, "the ring")
        for heal_s in (1e-3, 0.1, np.inf):
            ring = stepped.Ring([[0.9]], [[1.0]], [0.5], heal_s)
            ring.start(np.array([force_n]), np.array([force_n * 0.25]))  # half of the friction limit
            ring.next(np.full((1, 10), 2 * force_n), np.full((1, 10), force_n * 0.25), 0.01)
            fades = 0 if np.isinf(heal_s) else 1 - mpmath.exp(-mpmath.mpf("0.01") / mpmath.mpf(heal_s))
            wanted = mpmath.mpf("0.5") + fades  # a margin of 0.5 N first, 1.5 N now
            see.near(mpmath.mpf(float(ring.margin[0])) / force_n, wanted, (power, heal_s), "its memory")
    for speed in (0.0, 5e-324, 1e-9, 0.01, 3.0, 1e6, 1e300):
        found = stepped.Level(1).next(np.array([speed]), 4, 1e3)[0]
        rate = 3 * (mpmath.mpf(speed) / mpmath.mpf("0.01") + mpmath.mpf("0.2"))
        target = mpmath.power(mpmath.mpf(speed), mpmath.mpf("0.11"))
        for sample, level in enumerate(found.tolist()):
            wanted = target * (1 - mpmath.exp(-rate * (sample + 1) / 1000))
            room = max(target, 1)
            see.near(mpmath.mpf(level) / room, wanted / room, (speed, sample), "the level")
    for share in (1e-300, 0.0135, -1.0, 1e300):
        noise = stepped.Fluctuation(2, 1e4)
        rows, rung = noise.next(np.array([1]), np.array([0.25]), np.array([share]), 6)
        see.same(rows.tolist(), [1], share, "an event")
        see.same(rung[0, 0], 0.0, share, "an event")
        pole = mpmath.mpc(noise.pole.real, noise.pole.imag)
        for sample in range(1, 6):
            wanted = mpmath.re(mpmath.exp(pole * (sample - mpmath.mpf("0.25"))))
            see.near(
                mpmath.mpf(float(rung[0, sample])) / mpmath.mpf(share), wanted, (share, sample), "an event"
            )


@row("hand, slide", {"": "1e-12 of the way"})
def slide_(see):
    """Both contacts slide with kinetic friction: v and the distance, by exact sums."""
    for one in see.covering(
        force=[1e-6, 1.0, 1e6], mass=[1e-3, 0.2, 1e3], pull=[0.5, 1.0, 2.0], speed=[0.0, 1.0]
    ):
        mu_s, mu_k = np.array([0.75, 0.75]), np.array([0.5, 0.5])
        friction_n = Fraction(one["force"])  # of both contacts
        load_n = float(friction_n * Fraction(one["pull"]))
        contacts = slide.Contacts(np.random.default_rng(1), speed_mm_s=one["speed"], sliding=[True, True])
        contacts.left_mm = [1e30, 1e30]  # no stick-slip
        found = slide.slide(
            *(contacts, np.full(20, one["force"]), np.full(20, load_n), one["mass"], mu_s, mu_k),
            *(np.array([0.5, 0.5]), 1024.0),
        )
        speed, way = Fraction(one["speed"]), Fraction(1, 2)
        for sample in range(20):
            speed += (Fraction(load_n) - friction_n) / Fraction(one["mass"]) * 1000 / 1024
            if speed <= 0:
                break
            way += speed / 1024
            relative(see, found.slip_mm[sample], float(way), (one, sample))
        relative(see, found.slid_mm[0], float(way), one)
        see.same(contacts.sliding == [True, True], speed > 0, one)
        see.same(bool(np.isfinite(found.tension_n).all()), True, one)


def held(closing_mm, mass_kg=0.2, mu=0.7, tugs=()):
    grasp = hand.Grasp(
        mass_kg=np.full(200, mass_kg),
        mu_s=(mu, mu),
        mu_k=(0.9 * mu, 0.9 * mu),
        closing_mm=closing_mm,
        tugs=tugs,
        rng=np.random.default_rng(1),
    )
    ours = hand.Hand([grasp], 10000, 100)
    ours.ripple.tape[:] = 0.0
    return ours


@row("hand", {"the servo": "1e-12 N", "the load": "1e-12 of it"})
def hand_(see):
    for start in (2.5, 6.5535):
        for goal in (1e-4, 0.1, 2.5, 6.5535):
            ours = held(start, 1e-9)
            for block in range(2):
                found = ours.next(np.array([goal]))
                for sample in (0, 1, 50, 99):
                    since = (block * 100 + sample + 1) / mpmath.mpf(10000) / mpmath.mpf("0.002")
                    wanted = goal + (mpmath.mpf(start) - goal) * (1 + since) * mpmath.exp(-since)
                    see.near(
                        float(found.normal_n[0, sample]), wanted, (start, goal, block, sample), "the servo"
                    )
    for mass_kg in (1e-6, 0.2, 10.0):
        ours = held(1e4 * mass_kg, mass_kg, tugs=((0.01, 0.02, mass_kg),))  # the tug peaks at 0.02 s
        weight_n = Fraction(mass_kg) * G
        for block in range(4):
            found = ours.next(np.array([1e4 * mass_kg]))
            for sample in (0, 49, 99):
                at = (mpmath.mpf(block * 100 + sample + 1) / 10000 - mpmath.mpf("0.01")) / mpmath.mpf("0.02")
                tug = (1 - mpmath.cos(2 * mpmath.pi * min(max(at, 0), 1))) / 2 * mpmath.mpf(mass_kg)
                wanted = mpmath.mpf(weight_n.numerator) / weight_n.denominator + tug
                relative(see, found.load_n[0, sample], float(wanted), (mass_kg, block, sample), "the load")
                relative(
                    see, found.sag_mm[0, sample], float(wanted / 24), (mass_kg, block, sample), "the load"
                )
                both = found.tension_n[0, :, sample].sum()
                relative(see, both, float(wanted), (mass_kg, block, sample), "the load")
    ours, found, blocks = held(2.5), None, 0  # opened until it has dropped the object
    while not ours.dropped[0] and blocks < 40:
        found, blocks = ours.next(np.array([0.0])), blocks + 1
        see.same(bool(np.isfinite(found.volts).all()), True, blocks, "the servo")
        see.same(bool(((found.volts > 0) & (found.volts < 5)).all()), True, blocks, "the servo")
        see.same(bool((np.diff(found.slip_mm[0]) >= 0).all()), True, blocks, "the servo")
    see.same(bool(ours.dropped[0]), True, "an open hand", "the servo")
    see.near(float(found.normal_n[0, -1]) / 1e-6, 1, "an open hand", "the servo")
