"""The Optacon-II measurement (piezo pins under a finger, and what its receptors feel), beside our simulated
pins."""

import dataclasses
from functools import cache

import numpy as np

from meissner import scenes
from meissner.physics import pins, receptors
from meissner.physics.receptors import CHANNELS, PLOTTED_CM2, SMALLEST_CM2, TIP_CM2
from meissner.scenes.optacon import pictures, published, run
from meissner.scenes.optacon.judge import conclusions
from meissner.tradeoff.changes import Change, changed
from published import rows_of, section
from published._parts import figure, save

TITLE = "Optacon-II: displacement of tactile pins under a finger, and its receptors"
HEAD = """
In Japanese; a subject's left index finger on piezo pins, measured from below by a laser. The paper
publishes curves and, in its text, about five numbers. Everything under "ours" is of a simulated pin under a
simulated finger ([pins.py](../../model/meissner/physics/pins.py)) and of thresholds
([receptors.py](../../model/meissner/physics/receptors.py)). Six constants are fitted to the five numbers,
and the thresholds are from memory within about 3 dB. So the page shows that the paper's four conclusions
follow from such pins and such receptors, and what they hang on. It is no second measurement, and no display
was built here.

Figures: `meissner run optacon_free` (6), `optacon_contact` (1, 8 to 11), `optacon_burst` (14),
`optacon_letter` (13 and the letter as an animation); `touch_to_touch` closes the loop from two sensors to
pins.
"""
FREE, CONTACT, BURST, LETTER = (f"optacon_{kind}" for kind in ("free", "contact", "burst", "letter"))


@cache
def measured(name):
    found = run.run(scenes.load(name), "fixed", 1)
    return found.summary, found.arrays


def held():
    """The four conclusions of the model as it is now, without the laser's scatter: "1234", "-" where one
    fails."""
    hz, volts = published.FREQUENCIES, published.VOLTS
    db = [[pins.peak_db(f, v, True) for f in hz] for v in volts]
    found = conclusions(hz, volts, db)
    smallest = receptors.reached(
        "FA-II", published.FREE_HZ, pins.peak_db(published.FREE_HZ, 30.0, True), SMALLEST_CM2
    )
    lowest = {hz[int(np.argmin(one))] for one in db}
    return found, bool(smallest), lowest


def _channel(name, db):
    """CHANNELS with one threshold moved by so many dB."""
    channel = CHANNELS[name]
    return CHANNELS | {name: channel._replace(knots=tuple((f, t + db) for f, t in channel.knots))}


def _skin(key, factor):
    return pins.SKIN._replace(**{key: getattr(pins.SKIN, key) * factor})


def changes():
    """(words, Change) of what was not tuned, and of what was."""
    yield "as it is", Change("DAMPING", pins.DAMPING, pins)
    for name, values in {
        "DAMPING": (0.2, 1.0),
        "D31": (171e-12, 330e-12),
        "PRELOAD_V": (0.0, 2.0, 6.0),
    }.items():
        for value in values:
            yield f"{name} = {value:g}", Change(name, value, pins)
    for key in pins.SKIN._fields:
        for factor in (0.7, 1.4):
            yield f"SKIN.{key} × {factor}", Change("SKIN", _skin(key, factor), pins)
    for name in CHANNELS:
        for db in (-3, 3):
            yield f"threshold of {name} {db:+d} dB", Change("CHANNELS", _channel(name, db), receptors)
    yield (
        "summation as on the thenar, 3 dB a doubling to 2.9 cm²",
        Change("SLOPES", receptors.SLOPES | {"fingertip": receptors.SLOPES["thenar"]}, receptors),
    )


def slowest_s():
    """The longest time constant of a pin under a finger, of the two masses' equations of motion."""
    k, m, skin, grams = pins.stiffness(), pins.mass(), pins.SKIN, pins.SKIN.grams * 1e-3
    c = 2 * pins.DAMPING * np.sqrt(k * m)
    matrix = [
        [0, 1, 0, 0],
        [-(k + skin.kc) / m, -(c + skin.cc) / m, skin.kc / m, skin.cc / m],
        [0, 0, 0, 1],
        [skin.kc / grams, skin.cc / grams, -(skin.kc + skin.kg) / grams, -(skin.cc + skin.cg) / grams],
    ]
    return 1 / min(-np.linalg.eigvals(np.array(matrix)).real)


def sensitivity():
    rows = []
    for words, change in changes():
        with changed(change):
            found, smallest, lowest = held()
        marks = [("holds" if found[k] else "**fails**") for k in (1, 2, 3, 4)]
        at = ", ".join(f"{f:g}" for f in sorted(lowest))
        rows.append((words, *marks, "yes" if smallest else "no", at))
    return rows


def compute():
    free, _ = measured(FREE)
    contact, _ = measured(CONTACT)
    burst, _ = measured(BURST)
    letter, _ = measured(LETTER)
    by_volts = {row["volts"]: row for row in contact["conditions"]}
    table_1 = ", ".join(
        f"{name} {one.receptor} {one.field_mm2:g} mm², {one.density_cm2:g} per cm², {one.depth}"
        for name, one in CHANNELS.items()
    )
    units = ", ".join(f"{name} {one.units:.1f}" for name, one in CHANNELS.items())
    holds = {k: "holds" if contact[f"conclusion_{k}"] else "does not hold" for k in (1, 2, 3, 4)}
    over = receptors.summation_db(SMALLEST_CM2), receptors.summation_db(TIP_CM2)
    thenar = receptors.summation_db(SMALLEST_CM2, "thenar")
    at_230 = {v: by_volts[v]["at_230_hz_db"] for v in published.VOLTS}
    resonance = np.sqrt(pins.stiffness() / pins.mass()) / 2 / np.pi
    first = rows_of(f"""
        table 1 | fields, densities, depths | SA-I Merkel 11 mm², 60 per cm², shallow; SA-II Ruffini 59, 10,
        deep;
        FA-I Meissner 13, 140, shallow; FA-II Pacini 101, 20, deep | {
        table_1
    }; so a point lies in the field of
        so many units: {units} | taken as published

        1 | thresholds of four channels, and FA-II's by area | curves after Bolanowski et al. and Gescheider
        et al. |
        the curves below; FA-II for {SMALLEST_CM2} cm² {over[0]:.1f} dB, for {TIP_CM2} cm² {
        over[1]:.1f} dB above
        that for {PLOTTED_CM2} cm² | from memory, about 3 dB, unverified

        2, 3, 7 | measured from below, through the bimorph; drive set by a microcontroller | stated | the
        display's
        core sets the drive: frequency within {
        free["frequency_error_hz"]:.1g} Hz; pulses, half of a period high |
        that the drive is square is our reading

        4, 5 | pin array on bimorphs of 37.0 × 1.05 × 0.55 mm, 50 V | stated | the same; tip's stiffness {
        pins.stiffness():.1f} N/m, mass with the pin {1e6 * pins.mass():.0f} mg, so {
        resonance:.0f} Hz free | the
        published 22.2 dB at 230 Hz is below the displacement at rest: a free pin above its resonance

        4.1 | 5 s to settle, then 50 periods, 5 repetitions | stated | the steady state; under a finger the
        slowest motion dies away with a time constant of {1e3 * slowest_s():.0f} ms | 5 s are more than enough

        6 | free pin at 30 V and 230 Hz, from above | 22.2 dB | {free["above_db"]:.1f} dB | {
        free["fit_error_db"]:+.2f}
        dB: fitted

        6 | from below | about 0.2 dB apart | {free["apart_db"]:.2f} dB less, in the mean | taken as published

        6 | correlation of both | 0.996 | {free["correlation"]:.4f} | a scatter of {pins.SCATTER_DB} dB a
        reading is chosen for it

        3.1.2 | a single peak of 230 Hz at 2 kHz | none stated | reads up to {
        free["single_low_db"]:.2f} dB low: the
        nearest sample is up to a quarter of a millisecond away | computed; the mean of 50 peaks {
        20 * np.log10(np.sinc(230 / 2000)):.2f} dB

        8 to 11 | displacement falls with frequency and is lowest at 150 Hz, at every voltage | stated |
        lowest at {contact["lowest_hz"]:g} Hz at every voltage; at 30 V {
        by_volts[30.0]["at_1_hz_db"]:.1f} dB at 1 Hz, {by_volts[30.0]["at_20_hz_db"]:.1f} at 20, {
        by_volts[30.0]["at_150_hz_db"]:.1f} at 150, {at_230[30.0]:.1f} at
        230 | fitted: dip; the curve between is qualitative

        8 to 11 | not proportional to the voltage, at no frequency | stated, no number | from 10 to 50 V {
        contact["gained_slow_db"]:+.1f} dB beside proportion up to 20 Hz, {
        contact["gained_fast_db"]:+.1f} dB from 100
        Hz on | qualitative

        6, 8 to 11 | under a finger less than free everywhere, most at high frequency | stated, no number | {
        contact["less_than_free_db"]:.1f} dB or more; at most {
        contact["less_slow_db"]:.1f} dB up to 20 Hz, at least {
        contact["less_fast_db"]:.1f} dB from 100 Hz on | qualitative

        8, 10 | (1) SA-I and FA-I are reached at 30 V and more at 20 Hz and below | stated | {
        holds[1]
    }. At 10, 30,
        50 V: SA-I at {by_volts[10.0]["SA-I"]}; {by_volts[30.0]["SA-I"]}; {
        by_volts[50.0]["SA-I"]
    } Hz. FA-I at {by_volts[10.0]["FA-I"]}; {by_volts[30.0]["FA-I"]}; {
        by_volts[50.0]["FA-I"]
    } Hz | ours reaches FA-I above 20
        Hz too, which the text neither states nor excludes

        9 | (2) SA-II never | stated | {holds[2]}: {by_volts[10.0]["SA-II"]}; {by_volts[30.0]["SA-II"]}; {
        by_volts[50.0]["SA-II"]
    } | as stated

        11 | (3) FA-II is above its curve from 120 Hz at every voltage | stated | {
        holds[3]
    } with the curve for {PLOTTED_CM2} cm²: at 10, 30, 50 V at {by_volts[10.0]["FA-II"]}; {
        by_volts[30.0]["FA-II"]
    }; {by_volts[50.0]["FA-II"]} Hz | the curve's area is our reading, below

        11, 12 | (4) with the tip's 0.0007 cm² FA-II takes practically no part | stated | {holds[4]}: {
        by_volts[10.0]["FA-II tip"]
    }; {by_volts[30.0]["FA-II tip"]}; {by_volts[50.0]["FA-II tip"]} | as stated

        11 | with 0.008 cm² in place of the tip's area | nothing exceeds the curve of 0.008 cm² | FA-II
        responds at
        {by_volts[10.0]["FA-II smallest"]}; {by_volts[30.0]["FA-II smallest"]}; {
        by_volts[50.0]["FA-II smallest"]
    } Hz | differs: by the summation of the fingertip, below

        13 | the pin of row 3, column 5 is on in steps 2 and 4 | stated | {
        " and ".join(map(str, letter["pin_on_in_steps"]))
    } | the letter's shape is chosen for it

        14 | bursts of 0.4 s: out by 33 µm (30 dB) and back | stated | {burst["out_um"]:.1f} µm ({
        burst["out_db"]:.1f} dB), {burst["back_um"]:.1f} µm left | {burst["out_um"] - 33:+.2f} µm: fitted

        14 | 230 Hz on top, 0.8 µm (−2 dB) | stated | {burst["ripple_um"]:.2f} µm ({
        burst["ripple_db"]:.1f} dB) | {burst["ripple_um"] - 0.8:+.2f} µm: fitted

        14 | a finger feels 2.5 Hz, by SA-I and FA-I alone | stated | {burst["felt_hz"]:g} Hz, felt by {
        " and ".join(burst["felt_by"])
    } | as stated

        appendix | 0.4 s a character: 150 characters, 30 words a minute | stated | {
        letter["characters_min"]:.0f}
        characters at {letter["words_min"]:g} words a minute; {
        letter["step_ms"]:.1f} ms a step, with a column between
        letters | as stated
    """)
    heads = ("changed", "(1)", "(2)", "(3)", "(4)", "0.008 cm² at 230 Hz, 30 V", "lowest at (Hz)")
    large = lambda hz: float(receptors.threshold_db("FA-II", hz, PLOTTED_CM2))
    return [
        *first,
        READING.format(
            smallest=over[0],
            thenar=thenar,
            ten=at_230[10.0],
            thirty=at_230[30.0],
            fifty=at_230[50.0],
            depth=-np.diff(receptors.threshold_db("FA-II", np.array([120.0, 230.0]), PLOTTED_CM2))[0],
            span=receptors.summation_db(TIP_CM2) - over[0],
            summed=letter["summed_pins"],
        ).strip(),
        section("What the conclusions hang on", HANG, heads, sensitivity()),
        ORIGINS.format(
            slope=(large(40.0) - large(250.0)) / np.log2(250 / 40),
            small=large(250.0) + receptors.summation_db(0.02, "thenar"),
            sa2=float(receptors.threshold_db("SA-II", 250.0)),
        ).strip(),
    ]


READING = """
## Which curve is which

The text says that FA-II lies above its curve in figure 11 from 120 Hz on at every voltage, and, two
sentences later, that from 120 Hz on no displacement exceeds the curve of 0.008 cm². Both cannot be said of
one curve. Our reading: figure 11 plots the P channel of Bolanowski et al. for their large contactor of 2.9
cm², which is exceeded, and beside it Gescheider's for 0.008 cm². SA-I, SA-II and FA-I do not depend on the
area, so figures 8 to 10 have one curve each. That figure 11's exceeded curve were the one for 0.008 cm²
cannot be: P falls by {depth:.1f} dB from 120 to 230 Hz, and 0.008 and 0.0007 cm² are only {span:.1f} dB
apart. A curve below the displacement at 10 V and 120 Hz is then, moved up to the tip's area, still below
that at 50 V and 230 Hz, and FA-II would respond.

Whether 0.008 cm² would be enough depends on how FA-II sums. On the thenar, 3 dB a doubling of the area up
to 2.9 cm²: the curve for 0.008 cm² is {thenar:.1f} dB above the large one, and the pins ({ten:.1f},
{thirty:.1f} and {fifty:.1f} dB at 230 Hz and 10, 30, 50 V) do not reach it; that is what the paper says. On
a fingertip, where the paper measures, summation is less (Gescheider et al.); 3 dB a doubling up to 0.1 cm²
and 1 dB above give {smallest:.1f} dB, and FA-II responds about 230 Hz at 30 and 50 V. The slope above 0.1
cm² is chosen. With the tip's own area FA-II does not respond with either. The scenes take the fingertip's.

Neither the paper nor the scenes let FA-II sum over several pins. If it did so over all tips that move
together, {summed} pins at once would reach it, and a letter has more.
"""
HANG = """
Each row changes one constant and keeps the others; displacements without the laser's scatter. The
thresholds' rows show how far the conclusions survive an error of our reading of figure 1: each that fails
within 3 dB is one that the fit, not the paper, decides.
"""
ORIGINS = """
## Published, read off, chosen

- Published: the bimorph's size, 50 V, 230 Hz, 29 frequencies, voltages, the laser's rate and resolution, 50
  periods and 5 repetitions, the tip's area, table 1, the numbers above.
- Read off, unverified: the level of every knot of the four thresholds. We could read neither the figures
  nor the two papers behind them, only abstracts and what later papers cite. These say that FA-II falls by 12
  dB an octave from 40 Hz to its best at about 250 Hz (ours: {slope:.1f} from 40 to 250 Hz), that it sums by
  3 dB a doubling of the area, on the thenar from 0.02 to 2.9 cm² at 80 to 320 Hz and not at 25 and 40 Hz,
  on the fingertip from 0.025 to 0.1 cm² and less above, and that the four channels reach from 0.4 Hz to above
  500 Hz.
- Against ours: on the thenar none is seen from 0.02 down to 0.005 cm², where SA-II is said to take over. So
  SA-II's threshold is about FA-II's for 0.02 cm², {small:.1f} dB at 250 Hz by that rule. Ours is
  {sa2:.1f} dB, and with one 3 dB lower conclusion (2) fails, above.
- Fitted to the numbers above: the pin's mass, the skin's two springs and dampers and its tissue. Under a
  finger the curve falls by about 12 dB an octave, as a mass does, then dips where the tissue takes up the
  motion. The lumped mass of grams is no anatomy.
- Chosen: ceramic, damping of the free pin, the preload that makes displacement not proportional, the
  letter's shape, a square drive, the steady state in place of 5 s of settling.
"""


def draw(folder):
    found = []

    def kept(drawn, name, caption):
        found.append((save(drawn, folder, name), caption))

    drawn, axis = figure(1, 1, 9, 6)
    pictures.thresholds(axis)
    kept(drawn, "optacon_1.png", "Figure 1 as we read it: peak at threshold, dB re 1 µm.")
    _, arrays = measured(FREE)
    drawn, axes = figure(1, 2, 8, 8, sharex=True)
    pictures.free(axes, arrays["hz"], arrays["above_db"], arrays["below_db"])
    kept(drawn, "optacon_6.png", "Figure 6 with our pin: free, 30 V, from above and from below.")
    _, arrays = measured(CONTACT)
    drawn, axes = figure(2, 2, 12, 9)
    shown = {"hz": arrays["hz"], "volts": arrays["volts"], "db": arrays["db"], "tip_cm2": TIP_CM2}
    pictures.channels(axes.flat, **shown)
    for one in axes.flat:
        one.legend(frameon=False, fontsize=9)
    kept(drawn, "optacon_8_11.png", "Figures 8 to 11 with our pins under our finger: 10, 30 and 50 V.")
    scene = scenes.load(LETTER)
    recording = scenes.simulate(scene, 1)
    drawn, axes = figure(len(recording.steps[0]), 1, 12, 2.4)
    pictures.numbered_steps(axes, recording.steps[0], published.PIN)
    kept(drawn, "optacon_13.png", "Figure 13 with our letter: the marked pin is on in steps 2 and 4.")
    _, arrays = measured(BURST)
    drawn, axes = figure(2, 1, 12, 4)
    pictures.burst(axes, arrays["time_s"], arrays["um"])
    kept(drawn, "optacon_14.png", "Figure 14 with our pin: three bursts.")
    small = dataclasses.replace(scene, sizes=scene.sizes[:1], grids=scene.grids[:1])
    result = run.run(small, "fixed", 1)
    result.pictures[0].draw(folder / "optacon_letter.gif")
    caption = "The letter across 7 × 5 pins, slowed down: pins driven, and where each channel responds."
    return [*found, ("optacon_letter.gif", caption)]
