"""The rubber papers of the page: shear against resistance (journal), and the high-sensitivity slip sensor."""

from functools import cache

import numpy as np

from meissner import scenes
from meissner.physics import rubber
from meissner.scenes.shear import pictures, published
from meissner.scenes.shear.judge import slope
from meissner.scenes.shear.published import FIT, SHEARED_MM, STEP_V, step
from meissner.scenes.shear.scene import Case
from meissner.scenes.shear.scene import pulled as plate_pulled
from published import rows_of, section
from published._parts import save
from published._wavelets import SEEDS, first_flag

RATE = 10_000
SPEEDS = np.geomspace(0.01, 3.0, 61)  # figs. 12 and 14
FIRST = (0.875, rubber.PUBLISHED_ONSET)
PULL = "plate on the rubber, 2 N, 0.5 mm/s, 4 mm"

sheared = cache(published.sheared)


@cache
def pulled(first):
    """The slip experiment of both papers: time, pull, Vc and event times, from the beginning of the pull."""
    rng, time_s = np.random.default_rng(1), np.arange(8 * RATE) / RATE
    case = Case("", 2.0, 0.5, 4.0, material="acrylic", first_event=first)
    pull, slip = plate_pulled(time_s, case, 0.0, RATE, rng)
    return time_s, pull, rubber.volts(np.full(len(time_s), 2.0), slip.level, slip.share), slip.events_s


@cache
def leads(first):
    """Seconds from the flag to the slip of the whole contact for each seed that has a flag."""
    scene = scenes.load("slip_first_event")
    found = []
    for seed in SEEDS:
        run = scenes.simulate(scene, f"first event at {first:g}", seed)
        flag_s = first_flag(run)
        if flag_s is not None:
            found.append(run.gross_s - flag_s)
    return np.array(found)


def of_pull():
    time_s, pull, vc, _ = pulled(rubber.PUBLISHED_ONSET)
    gross = pull.gross_s
    yield from rows_of(f"""
        Fig. 5, 6 | {PULL}: tangential force rises | until about 0.4 s, then constant
        | until {gross:.2f} s | {100 * (gross / 0.4 - 1):+.0f} %

        Fig. 6 | the plate moves while the force rises | about 0.1 mm (at 0.5 mm/s, 0.4 s would be 0.2 mm)
        | {0.5 * gross:.2f} mm | {0.5 * gross - 0.1:+.2f} mm
    """)
    reached = np.argmax(vc >= vc[0] + 0.9 * (vc[round(0.5 * gross * RATE)] - vc[0]))
    yield from rows_of(f"""
        Fig. 6 | Vc rises with the force, to its maximum | immediately, by 0.01 mm or less
        | immediately; nine tenths by {0.5 * time_s[reached]:.3f} mm | none
    """)
    last = vc[round(gross * RATE) - 2]
    drop = float(rubber.event_steps(last, rubber.GROSS_SHARE * rubber.EVENT_SHARE))
    yield from rows_of(f"""
        Fig. 5 | Vc when sliding begins | drops
        | {drop:+.2f} V, rings out in about {1e3 * 3 * rubber.RING_S:.1f} ms; then falls within
        {rubber.RECOVERY_S:g} s | size not stated
    """)
    sliding = pull.tension_n[time_s > gross + 0.2]
    yield from rows_of(f"""
        Fig. 5 | tangential force while it slides | constant
        | a sawtooth from {sliding.min():.2f} to {sliding.max():.2f} N | not as published, and above the
        static {pull.tension_n[round(gross * RATE)]:.2f} N: with a drive this stiff, sticks of random length
        go too far (the scenes' string is 250 times as soft)

        Fig. 5 | while it slides | small changes at random, also in the force (circled places)
        | {len(pull.slips_s)} stick-slips in {8 - gross:.1f} s | the published record shows a few; ours are
        many and small
    """)


def of_shear():
    moved = np.arange(1, 11) / 100
    rises = np.array([step(1.0, 0.05, distance) for distance in moved])
    yield from rows_of(f"""
        Fig. 8 | ΔV for 0.01 to 0.1 mm at 0.05 mm/s, 1.0 N | almost the same (deviation up to 0.04 V)
        | {rises.min():.2f} to {rises.max():.2f} V | as published, by construction
    """)
    for number, (speed, volts) in zip((9, 10, 11), STEP_V.items()):
        own, ours = FIT[2][0] * speed ** FIT[2][1], step(1.7, speed, SHEARED_MM)
        yield from rows_of(f"""
            Fig. {number}, table 1 | ΔV at {speed:g} mm/s, from 2 V, 0.3 mm | {volts} V (its own table 2:
            {own:.2f} V)
            | {ours:.2f} V | {100 * (ours / volts - 1):+.0f} %; of table 2 {100 * (ours / own - 1):+.0f} %
        """)
    time_s, restored, until = sheared(0.05, rubber.RESTORED)
    converged = sheared(0.05, rubber.CONVERGED)[1]
    five = np.searchsorted(time_s, until + 5.0)
    yield from rows_of(f"""
        Fig. 9 to 11, III | Vc after the shear stops, from 2 V at 0.05 mm/s | not stated (CoP slip: gradually
        to about 3 V in about 5 s; slip sensor, below: gradually to the initial state)
        | after 5 s {restored[five]:.2f} V restored, {converged[five]:.2f} V converged | the papers
        disagree; `recovers` in a scene's condition selects one (default 1)
    """)
    left = [2.0 + (1.0 - rubber.CONVERGED) * volts for volts in STEP_V.values()]
    yield from rows_of(f"""
        CoP slip, figs. 6 to 8 | voltage to which table 1's own steps would converge | about 3 V, slightly
        different for each
        | {", ".join(f"{volts:.2f}" for volts in left)} V | mean {np.mean(left) - 3:+.2f} V
    """)
    ours = np.polyfit(np.log(SPEEDS), np.log(rubber.shear_step(2.0, SPEEDS)), 1)
    yield from rows_of(f"""
        Fig. 12, eq. 1 | ΔV = k·v^n, 0.01 to 3.0 mm/s, from 2 V | k {FIT[2][0]}, n {FIT[2][1]}
        | k {np.exp(ours[1]):.2f}, n {ours[0]:.2f} | k {np.exp(ours[1]) - FIT[2][0]:+.2f}, n
        {ours[0] - FIT[2][1]:+.2f}
    """)
    ours = ", ".join(f"{volts:.2f}" for volts in rubber.rest_volts(np.array([0.5, 1.0, 1.7]))) + " V"
    yield from rows_of(f"""
        Fig. 13 | Vc under 0.5, 1.0 and 1.7 N | 4, 3, 2 V | {ours} | none: the curve goes through them
    """)
    for rest, (k, n) in FIT.items():
        found = float(rubber.shear_gain(rest))
        off = rubber.shear_step(float(rest), SPEEDS) / (k * SPEEDS**n) - 1
        ends = [f"{100 * end:+.0f}" for end in (off.min(), off.max())]
        yield from rows_of(f"""
            Fig. 14, 15, table 2 | k and n from {rest} V | {k}, {n}
            | {found:.2f}, {rubber.SHEAR_EXPONENT} | k {found - k:+.2f}; ΔV
            {" to ".join(dict.fromkeys(ends))} % over 0.01 to 3 mm/s
        """)
    ratio = float(rubber.shear_step(2.0, 0.05) / rubber.shear_gain(2.0))
    solved, printed = ratio ** (1 / rubber.SHEAR_EXPONENT), ratio**-rubber.SHEAR_EXPONENT
    yield from rows_of(f"""
        Eq. 3, 5 | speed from ΔV and k: the exponent | -0.11
        | 1/0.11: 0.05 mm/s is recovered as {solved:.2f} mm/s; as printed, as {printed:.2f} mm/s | misprint:
        eq. 1 solved for v has 1/n
    """)


def of_sensor():
    yield from rows_of(f"""
        Fig. 3 | ΔV at 0.05 mm/s, 0.3 mm, from 2 V | 1.5 V
        | {step(1.7, 0.05, SHEARED_MM):.2f} V | {100 * (step(1.7, 0.05, SHEARED_MM) / 1.5 - 1):+.0f} %
    """)
    stays = sheared(0.05, rubber.RESTORED)
    during = stays[1][(stays[0] > 4.3) & (stays[0] < stays[2])]
    yield from rows_of(f"""
        Fig. 3 | Vc during the shear and after it | constant; restored to the initial state gradually
        | constant to {1e3 * np.ptp(during):.0f} mV; 10 s later {stays[1][-1]:.2f} V | none; the CoP slip
        paper states otherwise (above)
    """)
    thin_hz = rubber.RING_HZ * np.sqrt(rubber.THICKNESS_MM / 0.5)
    yield from rows_of(f"""
        Fig. 4, 5 | ΔV by distance, by speed | as figures 8 and 12 above | as above |

        Fig. 6 | sensor | 0.5 mm thick; at least 3 mm × 3 mm × 0.5 mm
        | rubber {rubber.THICKNESS_MM:g} mm (of the initial-slip sensor's 2.0 mm) | at 0.5 mm it would ring
        at {thin_hz / 1e3:.1f} kHz, not {rubber.RING_HZ / 1e3:.1f}: beyond 5
    """)
    _, pull, _, _ = pulled(rubber.PUBLISHED_ONSET)
    yield from rows_of(f"""
        Fig. 8, 9 | {PULL}: static friction lasts; Vc changes sharply before the slip | until 0.4 s; about
        0.3 s before it
        | until {pull.gross_s:.2f} s; {pull.gross_s:.2f} s before it | {pull.gross_s - 0.4:+.2f} s

        Fig. 9 | the plate moves from 0.05 to 0.4 s | 0.2 mm
        | {0.5 * pull.gross_s:.2f} mm up to the slip | {0.5 * pull.gross_s - 0.2:+.2f} mm; the journal
        version has 0.1 mm
    """)
    for first in FIRST:
        share = np.median([rubber.event_ratios(np.random.default_rng(seed), first)[0] for seed in SEEDS])
        yield from rows_of(f"""
            Fig. 9 | first fluctuation, as a share of the static phase; first event at {first:g} | about
            0.05 s of 0.4 s: 12 %
            | {100 * share:.0f} %, median of {len(SEEDS)} pulls | {100 * share - 12.5:+.0f} points
        """)
        found = leads(first)
        yield from rows_of(f"""
            III-D | lead of the flag before the slip, pull of 3 s (`slip_first_event`), first event at
            {first:g} | before the slip, so that a grip can react
            | median {1e3 * np.median(found):.0f} ms, least {1e3 * found.min():.0f} ms,
            {np.count_nonzero(found > 0)} of {len(SEEDS)} runs | none stated
        """)
    _, pull, vc, events_s = pulled(rubber.PUBLISHED_ONSET)
    change = np.abs(slope(vc, RATE))
    rough = change[round(events_s[0] * RATE) : round(pull.gross_s * RATE) - 10]
    slides = change[round((pull.gross_s + 0.1) * RATE) : -10]
    rms = [np.sqrt(np.mean(part**2)) for part in (rough, slides)]
    yield from rows_of(f"""
        Fig. 8, 9, middle | derivative of Vc over 1 ms: from the first event to the slip, and sliding |
        shows the fluctuation clearly; small where it slides
        | up to {rough.max():.0f} V/s before, {slides.max():.0f} sliding (rms {rms[0]:.1f} and {rms[1]:.1f})
        | no scale stated; the paper's rate is not stated, ours is 10 kHz
    """)


def compute():
    return [
        section(
            "Pressure-conductive rubber and shear (journal)",
            "Figures 3, 4 and 7 are drawings; the text before figure 3 is missing in the copy that was used. "
            "Tables 1 and 2 disagree by a factor of two, and the model follows table 2.",
        ),
        *of_pull(),
        *of_shear(),
        section(
            "Development of High-Sensitivity Slip Sensor",
            "Figures 1, 2, 6 and 7 are drawings. Its slip-prevention experiments are missing in the copy "
            "that was used.",
        ),
        *of_sensor(),
    ]


def draw_pull(until_s, derivative):
    """Figures 5 and 6 of the journal version, 8 and 9 of the sensor paper, for both first events."""
    pulls = []
    for first in FIRST:
        time_s, pull, vc, _ = pulled(first)
        title, normal_n = f"first event at {first:g} of the limit", np.full(len(time_s), 2.0)
        change = slope(vc, RATE)
        slipped = (title, time_s, vc, change, normal_n, pull.tension_n, pull.gross_s, 0.5)
        pulls.append(pictures.Slipped(*slipped))
    return pictures.slip_figure(pulls, until_s, derivative)


def draw_steps():
    """Figures 9 to 11: both recoveries, and the published steps."""
    panels = []
    for number, (speed, volts) in zip((9, 10, 11), STEP_V.items()):
        time_s, restored, until = sheared(speed, rubber.RESTORED)
        curves = [
            ("ours, restored", time_s, restored),
            ("ours, converges", time_s, sheared(speed, rubber.CONVERGED)[1]),
        ]
        panels.append(pictures.Sheared(f"Fig. {number}: {speed:g} mm/s", curves, 4.0, until, 2.0 + volts))
    return pictures.step_figure(panels)


def draw_laws():
    """Figures 8, 12, 14 and 15."""
    picture, axes = pictures.figure(2, 10, 2)
    by_distance, by_speed, by_load, by_rest = axes.flat
    moved = np.arange(1, 11) / 100
    pictures.draw_distance(by_distance, moved, [step(1.0, 0.05, distance) for distance in moved])
    pictures.draw_speed(by_speed, SPEEDS, rubber.shear_step(2.0, SPEEDS))
    pictures.draw_loads(by_load, {rest: (SPEEDS, rubber.shear_step(float(rest), SPEEDS)) for rest in FIT})
    rest = np.linspace(2.0, 4.0, 21)
    pictures.draw_k(by_rest, rest, rubber.shear_gain(rest))
    return picture


def draw(folder):
    drawn = {
        "5": (draw_pull(8.0, False), "Shear, figure 5: the slip experiment, 0 to 8 s"),
        "6": (draw_pull(1.0, False), "Shear, figure 6: its first second"),
        "9": (draw_steps(), "Shear, figures 9 to 11: ΔV at three speeds of shear, and what is left after it"),
        "12": (
            draw_laws(),
            "Shear, figures 8, 12, 14 and 15 (the sensor's 4 and 5): ΔV by distance, speed and load",
        ),
        "s8": (draw_pull(8.0, True), "High-sensitivity slip sensor, figure 8"),
        "s9": (draw_pull(1.0, True), "High-sensitivity slip sensor, figure 9"),
    }
    return [(save(one, folder, f"shear_{name}.png"), caption) for name, (one, caption) in drawn.items()]
