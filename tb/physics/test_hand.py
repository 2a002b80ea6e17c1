"""The hand's physics block by block: equal to the whole-run forms for a pull that only grows, in blocks of
any length; what restarts when the grip rises; a slide against a plain loop; balanced forces; the closed
loop's parts against the blocks that they stand for; mistakes in a scene.
"""

from dataclasses import replace

import numpy as np
import pytest
from msgspec import structs
from scipy.integrate import solve_ivp

from meissner import names, scenes
from meissner import run as runs
from meissner.physics import hand, plate, rubber
from meissner.physics.slide import Contacts, slide
from meissner.physics.stepped import Fluctuation, Level, Ring, Ripple
from meissner.scenes.hand import loop
from meissner.scenes.hand import run as hand_run
from meissner.twins.actuate import actuate
from meissner.twins.actuate.grip import Grip, GripConfig
from meissner.twins.slip.config import SlipConfig
from meissner.twins.slip.slip_path import decide

RATE_HZ = 10000
BLOCKS = [1, 7, 100, 4321]
CLOSE_S = 1e-11  # of an event's time: a sample of 1e-4 s, interpolated to seven digits


def pull(seed=3, seconds=4.0, newtons=2.0, speed=10.0):
    """A pull of the whole-run form from 0.1 s on, with its patches."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    found = plate.pull(time_s, newtons, speed, "acrylic", 0.1, rng)
    ratios = rubber.event_ratios(rng)
    return time_s, found, ratios, rubber.event_shares(len(ratios), 1.0, rng)


def in_blocks(count, block):
    return [slice(at, min(at + block, count)) for at in range(0, count, block)]


def rings(force_n, tension_n, ring, block):
    """(instants in samples, shares) of all events."""
    events = []
    for part in in_blocks(tension_n.shape[1], block):
        _, at, share = ring.next(force_n[:, part], tension_n[:, part], tension_n[:, part].shape[1] / RATE_HZ)
        events += list(zip(at + part.start, share))
    return np.array(events).reshape(-1, 2).T


@pytest.mark.parametrize("block", BLOCKS)
def test_patches_let_go_when_the_whole_run_form_says(block):
    time_s, found, ratios, shares = pull()
    stuck = time_s < found.gross_s
    mu = plate.PULL_STIFFNESS_N_MM * 10.0 * (found.gross_s - 0.1) / 2.0
    ring = Ring([ratios], [shares], [mu])
    at, share = rings(np.full((1, stuck.sum()), 2.0), found.tension_n[None, stuck], ring, block)
    wanted_s = found.time_of(ratios)
    seen = wanted_s <= time_s[stuck][-1]
    assert len(at) == seen.sum() > 100
    assert np.abs(at / RATE_HZ - wanted_s[seen]).max() < CLOSE_S
    assert share.tolist() == shares[seen].tolist()


@pytest.mark.parametrize("block", [1, 100, 250])
@pytest.mark.parametrize("recovers", [1.0, 0.4])
def test_the_shear_level_is_the_whole_run_s(block, recovers):
    """In blocks that end where the speed changes, as for a hand: only the exponentials round differently."""
    speed = np.repeat([0.0, 0.8, 0.8, 0.003, 0.0, 2.0, 0.0], 500)
    time_s = np.arange(len(speed)) / RATE_HZ
    wanted = rubber.shear_level(time_s, speed, recovers)
    level = Level(1, recovers)
    got = np.concatenate([level.next(speed[part][:1], block, RATE_HZ)[0] for part in in_blocks(3500, block)])
    # The whole-run form keeps its first sample at 0.
    assert np.abs(got - wanted).max() < 1e-12 and wanted.max() > 0.9


@pytest.mark.parametrize("block", BLOCKS)
def test_the_fluctuation_is_the_whole_run_s_bit_for_bit(block):
    rng = np.random.default_rng(5)
    instants = np.sort(rng.uniform(0, 0.5, 40))
    instants[7] = 0.0300  # exactly on a sample
    instants.sort()
    shares = rng.standard_normal(40)
    wanted = rubber.fluctuation(instants, shares, 5000, RATE_HZ)
    noise, got = Fluctuation(2, RATE_HZ), np.zeros((2, 5000))
    place = instants * RATE_HZ
    for part in in_blocks(5000, block):
        here = (np.ceil(place) >= part.start) & (np.ceil(place) < part.stop)
        rows, rung = noise.next(
            np.full(here.sum(), 1), place[here] - part.start, shares[here], part.stop - part.start
        )
        got[rows, part] = rung
    assert not got[0].any()
    assert np.abs(got[1] - wanted).max() <= 1e-15, "the pole's last ring below 1e-18 is dropped"


def test_the_ripple_is_the_plate_s_and_begins_again():
    wanted = plate._ripple(20000, RATE_HZ, np.random.default_rng(9))
    ripple = Ripple(RATE_HZ, [np.random.default_rng(9)])
    got = np.concatenate([ripple.next(700)[0] for _ in range(60)])
    assert got.tolist() == np.tile(wanted, 3)[: len(got)].tolist()


def loaded(force, tension, heal_s):
    """Number of events of three patches, at q of 0.3, 0.6 and 0.8, in each block of 10 samples."""
    ring = Ring([[0.3, 0.6, 0.8]], [[1.0, 1.0, 1.0]], [0.5], heal_s)
    counts = []
    for newtons, pulled in zip(force, tension):
        contact, _, _ = ring.next(np.full((1, 10), newtons), np.full((1, 10), pulled), 0.001)
        counts.append(len(contact))
    return counts


def test_what_has_slipped_slips_again_only_beyond_it():
    """mu 0.5. q: 0.2, 0.7, then 2.1 N in place of 2: 0.667, N - T/mu from 0.6 to 0.7 N. With 0.76 N, 0.58."""
    force = [2.0, 2.0, 2.1, 2.1, 2.1]
    tension = [0.2, 0.7, 0.7, 0.75, 0.9]
    assert loaded(force, tension, np.inf) == [0, 2, 0, 0, 1]
    # Released and pulled again at the same grip: no new event, unless it stuck for long in between.
    assert loaded([2.0] * 4, [0.7, 0.1, 0.7, 0.9], np.inf) == [2, 0, 0, 1]
    assert loaded([2.0] * 4, [0.7, 0.1, 0.7, 0.9], 1e-6) == [2, 0, 2, 1]
    # A grip that falls under the same pull slips, too: 0.7 N of 0.85 N.
    assert loaded([2.0, 1.7], [0.7, 0.7], np.inf) == [2, 1]


def test_memory_fades_with_its_time():
    """One block of a tenth of the time constant recovers 1 - exp(-0.1) of the difference."""
    ring = Ring([[0.5]], [[1.0]], [0.5], 0.01)
    ring.next(np.full((1, 10), 2.0), np.full((1, 10), 0.8), 0.001)
    assert ring.margin[0] == pytest.approx(0.4, abs=1e-15)
    ring.next(np.full((1, 10), 2.0), np.full((1, 10), 0.2), 0.001)
    assert ring.margin[0] == pytest.approx(0.4 + 1.2 * (1 - np.exp(-0.1)), abs=1e-15)
    assert ring.reach(np.array([2.0]))[0] == pytest.approx(1 - ring.margin[0] / 2)


def test_a_slide_is_friction_and_inertia():
    """Against a plain loop: 2 N on each of two contacts of 0.6 and 0.5, 2.5 N of load, 0.25 kg."""
    contacts = Contacts(np.random.default_rng(1))
    force, load = np.full(80, 2.0), np.full(80, 2.5)
    mu_s, mu_k = np.array([0.6, 0.6]), np.array([0.5, 0.5])
    found = slide(contacts, force, load, 0.25, mu_s, mu_k, np.zeros(2), RATE_HZ)
    speed = way = 0.0
    for sample in range(1, 80):
        friction = 2.0 * (0.5 + 0.1 * np.exp(-sample * 1e-4 / 0.04))
        speed += (2.5 - 2 * friction) / 0.25 * 1000 * 1e-4
        way += speed * 1e-4
        assert found.tension_n[0, sample] == pytest.approx(friction, rel=1e-12)
        assert found.slip_mm[sample] == pytest.approx(way, rel=1e-9, abs=1e-15)
    assert all(contacts.sliding) and way > 0.01
    # Gripped harder it stops, and the contacts hold half each.
    held = slide(contacts, np.full(300, 4.0), np.full(300, 2.5), 0.25, mu_s, mu_k, found.slid_mm, RATE_HZ)
    assert not any(contacts.sliding) and contacts.speed_mm_s == 0
    assert held.tension_n[:, -1].tolist() == pytest.approx([1.25, 1.25])
    assert held.slip_mm[-1] == held.slip_mm[-2] > found.slip_mm[-1]


def test_a_slide_s_friction_falls_as_the_plate_s():
    """plate.pull's tension after the slip, without the sawtooth of its string."""
    time_s, found, _, _ = pull(newtons=2.0)
    after = np.flatnonzero(time_s >= found.gross_s)[:50]
    slips = np.concatenate([[found.gross_s], found.slips_s])
    since = time_s[after] - slips[np.searchsorted(slips, time_s[after], "right") - 1]
    friction = found.tension_n[after] - plate.PULL_STIFFNESS_N_MM * 10.0 * since
    mu_s = plate.PULL_STIFFNESS_N_MM * 10.0 * (found.gross_s - 0.1) / 2.0
    mu_k = mu_s * 0.62 / 0.70
    contacts = Contacts(np.random.default_rng(1))
    contacts.sliding, contacts.since_s = [True, True], [time_s[after[0]] - found.gross_s] * 2
    contacts.left_mm = [1e9, 1e9]
    pair = np.array([mu_s, mu_s]), np.array([mu_k, mu_k])
    got = slide(contacts, np.full(50, 2.0), np.full(50, 4.0), 0.3, *pair, np.zeros(2), RATE_HZ)
    assert np.abs(got.tension_n[0] - friction).max() < 1e-12


def test_one_finger_slides_while_the_other_holds():
    """2 N on contacts of 0.3 and 0.8: above 1.2 N in total the weak one slides, and the other takes the
    rest."""
    contacts = Contacts(np.random.default_rng(1))
    load = np.linspace(1.0, 1.8, 500)
    args = 0.2, np.array([0.3, 0.8]), np.array([0.25, 0.7]), np.zeros(2), RATE_HZ
    found = slide(contacts, np.full(500, 2.0), load, *args)
    slides = np.flatnonzero(load > 1.2)[0]
    assert next(sample for finger, sample, _ in found.events if finger == 0) == slides
    assert not [1 for finger, *_ in found.events if finger == 1]
    assert found.tension_n.sum(axis=0) == pytest.approx(load, abs=1e-12)
    assert found.tension_n[0, -1] < 0.6 and found.tension_n[1, -1] > 1.2
    assert found.slid_mm[1] == 0 < found.slid_mm[0]
    # With less pull it sticks again, and keeps its slid distance, by which the two halves differ.
    args = 0.2, np.array([0.3, 0.8]), np.array([0.25, 0.7]), found.slid_mm, RATE_HZ
    after = slide(contacts, np.full(50, 2.0), np.full(50, 1.0), *args)
    assert not any(contacts.sliding) and after.slid_mm.tolist() == found.slid_mm.tolist()
    apart = 12.0 * found.slid_mm[0] / 2
    assert after.tension_n[:, -1].tolist() == pytest.approx([0.5 - apart, 0.5 + apart], rel=1e-12)


def grasps(count=2, **changes):
    settings = {
        "mu_s": (0.7, 0.72),
        "mu_k": (0.62, 0.64),
        "closing_mm": 3.0,
        "mass_kg": np.full(101, 0.28542),
    }
    settings |= changes
    return [hand.Grasp(**settings, rng=np.random.default_rng(n)) for n in range(count)]


def test_a_held_glass_sags_by_the_published_stiffness():
    """2.8 N on two fingers of 12 N/mm: 0.117 mm, and nothing slides."""
    held = hand.Hand(grasps(), RATE_HZ, 100)
    for _ in range(5):
        found = held.next([3.0, 3.0])
    assert found.load_n[0, -1] == pytest.approx(2.8, abs=1e-4)
    assert found.sag_mm[0, -1] == pytest.approx(0.117, abs=0.0005)
    assert found.slip_mm.max() == 0 and found.tension_n.sum(axis=1) == pytest.approx(found.load_n)
    assert found.normal_n[0] == pytest.approx(np.full(100, 3.0), abs=1e-12), (
        "a hand that stands has no ripple"
    )
    q = 1.4 / (0.71 * 3.0)
    assert found.ring_mm[0] == pytest.approx(0.71 * 3.0 / 12 * (1.5 * (1 - (1 - q) ** (2 / 3)) - q), rel=0.01)


def test_the_servo_is_critically_damped():
    held = hand.Hand(grasps(1), RATE_HZ, 20)
    held.ripple.tape[:] = 0
    got = np.concatenate([held.next([3.1]).normal_n[0] for _ in range(10)])
    assert got[19] == pytest.approx(3.0 + 0.1 * (1 - 2 / np.e), abs=1e-9)  # after SERVO_S, 2 ms
    tau = hand.SERVO_S
    solved = solve_ivp(
        lambda _, y: (y[1], (3.1 - y[0]) / tau**2 - 2 * y[1] / tau),
        *((0, 0.02), (3.0, 0.0)),
        t_eval=np.arange(1, 201) / RATE_HZ,
        rtol=1e-10,
        atol=1e-12,
    )
    assert np.abs(got - solved.y[0]).max() < 1e-8


def test_a_hand_that_moves_ripples_and_only_then():
    held = hand.Hand(grasps(1), RATE_HZ, 100)
    moving, after = held.next([3.05]).normal_n[0], [held.next([3.05]) for _ in range(5)][-1].normal_n[0]
    quiet = hand.Hand(grasps(1), RATE_HZ, 100)
    quiet.ripple.tape[:] = 0
    ripple = moving - quiet.next([3.05]).normal_n[0]
    assert 0.0005 < np.std(ripple) < plate.RIPPLE_N and np.ptp(after) < 1e-6


def test_slip_and_sag_and_a_drop_are_told_apart():
    """At 1.9 N the glass of 2.8 N needs 1.97 N: it slides and is dropped; nothing slides at 2.1 N."""
    held = hand.Hand(grasps(2, mu_s=(0.71, 0.71), mu_k=(0.63, 0.63)), RATE_HZ, 100)
    held.place[:] = 1.9, 2.1
    for _ in range(40):
        found = held.next([1.9, 2.1])
    assert held.dropped.tolist() == [True, False]
    assert found.slip_mm[0, -1] > hand.DROP_MM and found.slip_mm[1, -1] == 0
    assert found.sag_mm[0, -1] == found.sag_mm[1, -1]


@pytest.mark.parametrize("block", [10, 13, 100])
@pytest.mark.parametrize("level", [1, 2])
def test_both_slip_paths_in_blocks_are_the_whole_path(block, level):
    rng = np.random.default_rng(7)
    codes = 1500 + rng.integers(-9, 10, (4, 1300)) * (rng.random((4, 1300)) < 0.2)
    config = SlipConfig(window=64, hop=64, level=level, threshold=20)
    wanted = decide(codes, config)
    for path in (loop.FixedSlip, loop.FloatSlip):
        if path is loop.FloatSlip and block == 13:
            continue
        slip = path(4, config)
        parts = [slip.next(codes[:, part]) for part in in_blocks(1300, block)]
        detail, p2p, over = (np.concatenate(column, axis=1) for column in zip(*parts))
        assert np.rint(p2p).tolist() == wanted.p2p.tolist()
        assert over.tolist() == (wanted.p2p > 20).tolist() and over.any() and not over.all()
        assert detail.shape == wanted.p2p.shape


@pytest.mark.parametrize("block", [5, 50])
def test_windows_are_counted_as_the_reflex_counts_decisions(block):
    """The reflex is fed decision by decision, and fed each block's part of every window: the same
    commands."""
    rng = np.random.default_rng(11)
    span, details = 32, 1600
    crossing = rng.integers(0, 3 * span, (2, details // span))  # the first detail of a window that is over
    over = np.arange(span)[None, None, :] >= crossing[:, :, None]
    over = over.reshape(2, details)
    config = GripConfig(step=7, decay=3, minimum=1000, rate=100)
    whole, parted = (Grip(config, 2, start=2000) for _ in range(2))
    windows, first = loop.Windows(2, span), 0
    for part in in_blocks(details, block):
        for detail in range(part.start, part.stop):
            for finger in range(2):
                whole.decision(finger, bool(over[finger, detail]), detail % span == span - 1)
        parts, ends, fresh = windows.next(over[:, part])
        assert loop.answer(parted, parts.tolist(), ends, [True, True]) == whole.cycle()
        first += fresh
    assert first.tolist() == (crossing < span).sum(axis=1).tolist()
    assert 0 < over.mean() < 0.9
    assert windows.next(over[:, :0])[1] == []


def short(name="grip_pour", seconds=3.0, **changes):
    scene = scenes.load(name)
    condition = structs.replace(scene.conditions[0], duration_s=seconds, **changes)
    world = scene.world | {"pour_start_s": 0.2, "hold_from_s": 1.0}
    return replace(scene, conditions=(condition,), world=world)


def test_a_run_is_its_seed_s_whoever_runs_beside_it():
    scene = short()
    parts = loop.FixedSlip, Grip
    together = loop.hold(scene, scene.conditions[0], [3, 4, 5], parts)
    alone = loop.hold(scene, scene.conditions[0], [4], parts)
    for name in ("slip_mm", "ring_mm", "moved_mm", "tightenings", "ratio"):
        assert getattr(together, name)[1] == getattr(alone, name)[0], name
    assert together.ring_mm[0] != together.ring_mm[1]


LOOKS = {  # scene, condition, seconds, seeds, changes: what differs in each
    "decays": ("grip_release", 2, 2.0, [1], {}),
    "three runs, each with its own slips": ("grip_release", 2, 1.3, [1, 2, 3], {}),
    "10 ms a cycle": ("grip_release", 0, 3.0, [1, 4], {}),
    "a converter whose filter remembers": ("grip_release", 2, 1.0, [1], {"adc_part": "AD7606"}),
    "tugs": ("grip_disturb", 3, 0.9, [1, 2], {}),
    "mass that changes": ("grip_pour", 3, 0.8, [1], {"first_event": 0.5}),
    "friction halves: a slide, gross slips and the floor that falls": (
        "grip_release",
        2,
        1.0,
        [1],
        {"halves_s": 0.6},
    ),
    "a fall": ("grip_release", 0, 2.0, [1, 2], {"halves_s": 1.0}),
    "fingers that fail": ("grip_release", 2, 0.6, [1], {"dead_s": 0.4}),
}


@pytest.mark.parametrize("name, number, seconds, seeds, changes", LOOKS.values(), ids=LOOKS)
def test_cycles_that_are_computed_ahead_are_those_one_by_one(name, number, seconds, seeds, changes):
    """Bit for bit, in every result and in every cycle of the trace."""
    scene = scenes.load(name)
    changes = dict(changes)
    scene = replace(scene, adc_part=changes.pop("adc_part", scene.adc_part))
    condition = structs.replace(scene.conditions[number], duration_s=seconds, **changes)
    world = scene.world | {"hold_from_s": seconds / 2, "pour_start_s": 0.1}
    world |= {"tugs": [(0.1, 0.2, 0.6), (0.5, 0.1, 0.8)]} if world["tugs"] else {}
    scene = replace(
        scene, conditions=(*scene.conditions[:number], condition, *scene.conditions[number + 1 :])
    )
    scene = replace(scene, world=world)
    one, *several = (loop.hold(scene, condition, seeds, hand_run.PARTS["fixed"], most) for most in (1, 7, 64))
    for held in several:
        for key in hand_run.KEYS:
            assert np.array_equal(getattr(held, key), getattr(one, key), equal_nan=True), key
        for key, values in vars(one.trace).items():
            assert np.array_equal(getattr(held.trace, key), values), key
    assert one.tightenings.any() or "dead_s" in changes
    assert one.faults.any() or "dead_s" not in changes
    assert one.dropped.all() == ("halves_s" in changes)


@pytest.mark.parametrize(
    "name, number, counts, values",
    [
        (
            "grip_release",
            2,
            [20, 21, 57149, 87233525],
            [1.15018751109716, 0.00232017951844846, 1.97532246719867],
        ),
        (
            "grip_disturb",
            1,
            [11, 28, 20235, 2933052],
            [1.55428203197080, 0.0572165166182500, 2.02378756370507],
        ),
    ],
)
def test_a_seed_gives_what_it_gave_cycle_by_cycle(name, number, counts, values):
    """1.5 s of seed 1, written down when each cycle was computed alone: tightenings, windows over, the last
    command and the sum of all; ratio, moved_mm and the last grip in newtons."""
    scene = scenes.load(name)
    condition = structs.replace(scene.conditions[number], duration_s=1.5)
    world = scene.world | {"hold_from_s": 1.0, "tugs": [(0.2, 0.4, 0.8)] if number == 1 else []}
    scene = replace(scene, conditions=(*scene.conditions[:number], condition), world=world)
    held = loop.hold(scene, condition, [1], hand_run.PARTS["fixed"])
    command = held.trace.command
    assert [held.tightenings[0], held.trace.over.sum(), command[-1], command.sum()] == counts
    assert [held.ratio[0], held.moved_mm[0], held.trace.normal_n[-1]] == pytest.approx(values, rel=1e-12)


def test_float_and_fixed_hold_alike():
    """The same codes give the same windows, and so the same commands, to the last event."""
    scene = short(seconds=5.0)
    fixed, exact = (
        loop.hold(scene, scene.conditions[0], [1, 2], (path, Grip))
        for path in (loop.FixedSlip, loop.FloatSlip)
    )
    assert fixed.trace.command.tolist() == exact.trace.command.tolist()
    assert fixed.tightenings.tolist() == exact.tightenings.tolist() and fixed.tightenings.min() > 5


@pytest.mark.parametrize(
    "name, number, changes",
    [
        ("grip_pour", 0, {}),
        ("grip_pour", 3, {"first_event": 0.5}),  # 1 ms a cycle
        ("grip_release", 0, {"decay_mm_s": 0.5}),
        ("grip_disturb", 0, {"first_event": 0.4}),
        ("grip_water", 0, {"dead_s": 1.2}),
    ],
)
def test_a_verilated_core_holds_as_the_twins_do(name, number, changes):
    """Word for word; each scene, shortened, with events that the reflex must answer."""
    scene = scenes.load(name)
    condition = structs.replace(scene.conditions[number], duration_s=1.6, **changes)
    world = scene.world | {"pour_start_s": 0.1, "hold_from_s": 0.1}
    world |= {"tugs": [(0.2, 0.4, 0.8)]} if world["tugs"] else {}
    grip = scene.grip | ({"guard_s": 0.3} if "guard_s" in scene.grip else {})  # calm before the end
    scene = replace(scene, conditions=(condition,), world=world, grip=grip)
    fixed, rtl = (loop.hold(scene, condition, [1, 2], hand_run.PARTS[engine]) for engine in ("fixed", "rtl"))
    assert rtl.mismatches.tolist() == [0, 0] and fixed.mismatches is None
    for key in ("command", "fault", "over", "normal_n", "detail_low", "detail_high"):
        assert np.array_equal(getattr(fixed.trace, key), getattr(rtl.trace, key), equal_nan=True), key
    for key in hand_run.KEYS:
        assert np.array_equal(getattr(fixed, key), getattr(rtl, key), equal_nan=True), key
    assert fixed.tightenings.sum() > 0 and (fixed.faults.min() > 0) == ("dead_s" in changes)


def test_a_core_that_differs_is_counted(monkeypatch):
    """The core's step is one count larger: its commands diverge, and so does the hand."""
    scene = short(seconds=1.5, step_mm=0.01)
    right = actuate.ActuateConfig
    monkeypatch.setattr(
        actuate, "ActuateConfig", lambda grip, *more: right(replace(grip, step=grip.step + 1), *more)
    )
    held = loop.hold(scene, scene.conditions[0], [1], hand_run.PARTS["rtl"])
    assert held.tightenings[0] > 0 and held.mismatches[0] > 0


def test_a_core_whose_windows_end_elsewhere_is_counted(monkeypatch):
    """Against twins whose windows end at every detail except the right one: a mismatch in each of 30 cycles
    of 10 ms."""
    scene, right = short(seconds=0.3), loop.FixedSlip.next

    def wrong(slip, codes):
        answer = right(slip, codes)
        slip.ends = ~slip.ends
        return answer

    monkeypatch.setattr(loop.FixedSlip, "next", wrong)
    assert loop.hold(scene, scene.conditions[0], [1], hand_run.PARTS["rtl"]).mismatches.tolist() == [30]


def test_the_ratio_is_the_grip_over_what_static_friction_needs():
    """A hand that neither tightens nor loosens: the drawn grip over weight divided by the sum of both
    mu_s."""
    scene = short("grip_release", step_mm=0.0, decay_mm_s=0.0)
    held = loop.hold(scene, scene.conditions[0], [2], (loop.FixedSlip, Grip))
    drawn = scenes.simulate(scene, None, 2)
    weight_n = drawn.mass_kg[0] * 9.81
    assert held.ratio[0] == pytest.approx(drawn.closing_mm * 1.0 / (weight_n / sum(drawn.mu_s)), rel=1e-9)
    assert 1.15 <= held.ratio[0] <= 1.4 and held.tightenings[0] == 0 and held.moved_mm[0] < 1e-9


def test_the_command_moves_the_hand_a_cycle_later():
    scene = short(seconds=4.0, step_mm=0.01)
    trace = loop.hold(scene, scene.conditions[0], [1], (loop.FixedSlip, Grip)).trace
    first = int(np.flatnonzero(trace.over)[0])
    step = round(scene.grip["step_mm"] / hand.COUNT_MM)
    assert trace.command[first] == trace.command[first - 1] + step * trace.over[first]
    assert trace.normal_n[first] == pytest.approx(trace.normal_n[0], abs=1e-4)
    assert trace.normal_n[first + 1] > trace.normal_n[first] + 0.003


@pytest.mark.parametrize("name", ["grip_pour", "grip_release", "grip_disturb", "grip_water"])
def test_every_scene_has_its_settings_in_counts(name):
    scene = scenes.load(name)
    for condition in scene.conditions:
        config = scene.grip_config(condition)
        own = scene.grip["decay_mm_s"] if condition.decay_mm_s is None else condition.decay_mm_s
        assert config.decay * 1000 / condition.cycle_ms * condition.count_mm == pytest.approx(own)
        assert config.rate >= config.step > 0
        # 0.02 V peak to peak, in codes of 5/4096 V of a detail, which is sqrt(2) times the coefficient.
        assert scene.slip_config(condition).threshold == int(0.02 * 2**0.5 / (5 / 4096)) == 23
        assert scene.slip_config(condition).gross_threshold == int(0.12 * 2**0.5 / (5 / 4096)) == 139
    assert {c.first_event for c in scene.conditions} >= {0.12, 0.875}
    assert {c.cycle_ms for c in scene.conditions} == {1, 10}


def test_the_threshold_is_a_share_of_what_an_event_makes_in_volts():
    """Vc (1 - Vc/5): 0.8 V at 1 V, 1.1375 at 1.75, 1.25 at 2.5; p2p in codes of 5/4096 V: 2 sqrt(2) times."""
    scene = scenes.load("grip_pour")
    scene = replace(scene, slip=scene.slip | {"threshold_p2p_share": 0.0176, "threshold_quiet": 2.5})
    vc_v, quiet_v = np.array([1.0, 1.75, 2.5, 4.99]), np.array([0.004, 0.002, 1e-5, 0.0])
    free, fixed = scene.conditions[0], structs.replace(scene.conditions[0], threshold_p2p_v=0.02)
    assert [scene.threshold_p2p_v(free, v) for v in vc_v[:3]] == pytest.approx([0.01408, 0.02002, 0.022])
    assert scene.threshold(free, vc_v, quiet_v).tolist() == [16, 23, 25, 1]
    assert scene.threshold(fixed, vc_v, quiet_v).tolist() == [23] * 4
    quiet = replace(scene, slip=scene.slip | {"threshold_p2p_share": 0.0})
    assert quiet.threshold(free, vc_v, quiet_v).tolist() == [11, 5, 1, 1]  # 0.010 V: 11.58; 0.005 V: 5.79
    assert quiet.threshold(fixed, vc_v, quiet_v).tolist() == [23] * 4
    without = replace(quiet, slip=quiet.slip | {"threshold_quiet": 0.0})
    assert without.threshold(free, vc_v, quiet_v).tolist() == [23] * 4


def test_the_threshold_follows_vc_once_a_second():
    """Read from the trace: the threshold of a second follows from the Vc just before it."""
    scene = short(seconds=4.0)
    scene = replace(scene, slip=scene.slip | {"threshold_p2p_share": 0.04})
    trace = loop.hold(scene, scene.conditions[0], [2], (loop.FixedSlip, Grip)).trace
    changes = np.flatnonzero(np.diff(trace.threshold_v)) + 1
    assert len(changes) and set(changes) <= {100, 200, 300} and trace.load_n[-1] > 1.3 * trace.load_n[0]
    lsb_v = 5 / 4096 / 2 / 2**0.5  # peak-to-peak in codes, to half of it in volts of the coefficient
    for second in range(4):
        rest_v = rubber.rest_volts(trace.normal_n[max(100 * second - 1, 0)])
        codes = trace.threshold_v[100 * second] / lsb_v
        wanted = 0.02 * rest_v * (1 - rest_v / 5) / lsb_v
        assert codes == pytest.approx(round(codes), abs=1e-9) and 0.9 * wanted - 1 < codes < 1.1 * wanted


def test_a_material_and_the_size_of_its_events_are_the_condition_s():
    """cloth: 0.75 of acrylic's events; 0.6 of those; friction 0.55 beside 0.70, by the same draw."""
    scene = scenes.load("grip_pour")
    usual = scene.conditions[0]
    changed = structs.replace(usual, material="cloth", events=0.6)
    changed_scene = replace(scene, conditions=(changed,))
    ours, theirs = scenes.simulate(scene, usual, 3), scenes.simulate(changed_scene, changed, 3)
    assert (ours.fluctuation, theirs.fluctuation) == (1.0, pytest.approx(0.45))
    assert theirs.mu_s == pytest.approx([0.55 / 0.70 * mu for mu in ours.mu_s])
    assert theirs.closing_mm == pytest.approx(0.70 / 0.55 * ours.closing_mm, abs=1e-4)
    with pytest.raises(ValueError, match="material"):
        structs.replace(usual, material="ice").__post_init__()


def test_finer_counts_let_go_as_slowly_in_a_shorter_cycle():
    """0.02 mm/s: two counts of 0.1 um in each of 100 cycles, one count of 0.02 um in each of 1000."""
    scene = scenes.load("grip_release")
    never_calm = scene.grip | {"calm_share": 0.0}
    scene = replace(scene, world=scene.world | {"hold_from_s": 0.5}, grip=never_calm)
    for number, counts, cycles in ((0, 2, 100), (2, 1, 1000)):
        condition = structs.replace(scene.conditions[number], duration_s=1.0, threshold_p2p_v=5.0)
        alone = replace(scene, conditions=(condition,))
        trace = loop.hold(alone, condition, [2], (loop.FixedSlip, Grip)).trace
        assert set(np.diff(trace.command)) == {-counts} and len(trace.command) == cycles
        assert trace.normal_n[-1] == pytest.approx(trace.normal_n[0] - 0.02, abs=1e-3)
    assert trace.command[0] == 59999  # 1.2 mm in the finer counts, less the first one
    fine, coarse = (scene.grip_config(scene.conditions[number]) for number in (2, 0))
    assert (fine.minimum, fine.maximum) == (0, 65535) and (coarse.minimum, coarse.maximum) == (1000, 60000)


def test_the_grip_after_a_tug_is_beside_its_peak():
    """For a hand that does nothing: its grip over (weight + tug)/(mu_1 + mu_2); without tugs the ratio is
    undefined."""
    scene = short("grip_disturb", step_mm=0.0, decay_mm_s=0.0)
    scene = replace(scene, world=scene.world | {"tugs": [[0.5, 0.4, 0.1]], "grip_ratio": [1.3, 1.3]})
    held = loop.hold(scene, scene.conditions[0], [2], (loop.FixedSlip, Grip))
    drawn = scenes.simulate(scene, None, 2)
    weight_n = drawn.mass_kg[0] * 9.81
    assert held.tug_ratio[0] == pytest.approx(
        drawn.closing_mm / ((weight_n + 0.1) / sum(drawn.mu_s)), rel=1e-9
    )
    assert held.tug_ratio[0] < held.ratio[0] == pytest.approx(1.3, abs=1e-3)
    none = replace(scene, world=scene.world | {"tugs": []})
    assert np.isnan(loop.hold(none, scene.conditions[0], [2], (loop.FixedSlip, Grip)).tug_ratio).all()


def test_every_engine_runs_it_and_signals_are_refused_in_a_sentence(tmp_path):
    scene = scenes.load("grip_pour")
    assert set(hand_run.PARTS) == set(names.EVERY)
    with pytest.raises(ValueError, match="spice"):
        runs.run(scene, "spice", tmp_path)
    with pytest.raises(ValueError, match="--waves"):
        runs.run(scene, "fixed", tmp_path, waves=True)


@pytest.mark.parametrize(
    "changes", [{"decay": 3}, {"decay": 70, "rate": 9}, {"minimum": 480}, {"decay": 0}, {"maximum": 600}]
)
def test_a_reflex_takes_quiet_cycles_together_as_it_takes_them_one_by_one(changes):
    """After a window over, and before another: commands, faults and, by the steps' boost, its streaks."""
    config = GripConfig(**{"step": 10, "boost": 3, "minimum": 20, "maximum": 900, "rate": 100} | changes)
    first = min(max(500, config.minimum), config.maximum)
    alone, together = Grip(config, 2, first), Grip(config, 2, first)
    for cycles, ended in ((1, False), (7, True), (40, True)):
        for reflex in (alone, together):
            reflex.next([1, 0])
        wanted = []
        for cycle in range(cycles):
            for finger in range(2):
                alone.decision(finger, False, ended and cycle == cycles - 1)
            word = alone.cycle()
            wanted.append((word.increment, word.command, word.fault, 0))
        assert together.take(together.rest(cycles), ended) == wanted
        assert vars(alone) == vars(together)
