"""The page of three papers: pins of the Optacon; slip from a centre of pressure; the net-structure sensor."""

import dataclasses
from functools import cache

import numpy as np

from meissner import engines, scenes
from meissner.interval import rate, words
from meissner.physics import grip, rubber
from meissner.scenes.grip import run as grip_run
from meissner.scenes.grip.scene import Pull
from meissner.scenes.shear.published import FIT, STEP_V
from published import _net, rows_of, section
from published._parts import NONE, beside, figure, label, save

TITLE = "Slip from a centre of pressure, and a net of tactile elements"
HEAD = """*Displacement of the pins of an Optacon-II in contact with a finger, and the receptors they reach*
(in Japanese); *Development of High Speed and High Sensitivity Slip Sensor* ("CoP slip"), whose sensor gives
a centre of pressure; *A Net-Structure Tactile Sensor Covering Freeform Surface with Reduced Wiring*
("net"). "None stated": the paper shows a curve without readable numbers."""
OPTACON = """This is an actuator that vibrates the skin, not a sensor; this repository has no counterpart yet.
Figures 2 to 4, 7 and 13 are drawings and photographs."""
SLIP = """`meissner run cop_slip` has pulls in seven directions, at 1, 2 and 3 N, and three kinds of grip
without slip. The electrodes of a 7×7 mesh pass a converter, `msn_cop4` and `msn_cop_slip`. Figure 4 has means
over the pulls at 2 N, up to the moment the object moves; rates are over all pulls and all runs. The picture
shows the first pull. Figures 1 to 3, 5 and 9 are drawings and photographs."""
OPTACON_ROWS = """
    fig. 1 | thresholds of vibration, four channels | curves over frequency, after other papers

    table 1 | four receptors | 11, 59, 13, 101 mm² wide; 60, 10, 140, 20 in a cm²

    fig. 6 | a pin's displacement without a finger, 30 V
    | 22.2 dB above 1 µm at 230 Hz; r = 0.996, 0.2 dB apart

    fig. 5 | a pin's actuator | 37.0 mm × 1.05 mm × 0.55 mm, nominally 50 V

    figs. 8-11 | pins under a finger, 10, 30, 50 V, beside the thresholds
    | displacement least at 150 Hz; above the thresholds of SA-I and FA-I at 20 Hz and below with 30 V or
    more, of SA-II at no frequency, of FA-II from 120 Hz on only if the pin's small tip is ignored

    fig. 12 | a pin's tip | 0.0007 cm², an order of magnitude below the 0.008 cm² of the thresholds

    fig. 14 | a pin switched on and off, period 0.4 s, 30 V
    | 33 µm (30 dB), then 0.8 µm (-2 dB) at 230 Hz; back when off
"""

SEEDS = range(1, 6)  # for each condition; docs/cop_scenes.md has the scene's own ten seeds
GRIP_N = 2.0  # III-A
FALL = 0.5, 0.65  # figure 4 (a): 1.0 and 1.3 N of 2 N, the right and the left sensor
MOVE_V, RISE_N = 0.05, 0.2  # figure 4 (b), (c)
COVERS_MM = (0.0, 0.2, 0.6)


@cache
def scene(cover_mm=0.0):
    found = scenes.load("cop_slip")
    return dataclasses.replace(found, world=found.world | {"cover_mm": cover_mm})


@cache
def ran(condition, seed, side=0, cover_mm=0.0):
    """(recording, x, y, load, verdict, quantities with published numbers or None) of one run of the scene."""
    of = scene(cover_mm)
    recording = scenes.simulate(of, of.conditions[condition], seed, side=side)
    found, decisions = engines.load("fixed").cop_slip(recording.codes, of.config, of.lag, of.registers)
    x, y = found.x / engines.COP_ONE, found.y / engines.COP_ONE
    load = found.load * of.config.load_lsb_n
    verdict = grip_run.judge(recording, decisions)
    return recording, x, y, load, verdict, grip_run.published(recording, x, y, load)


def runs(pulls, **settings):
    """All runs of the conditions with a pull, or of all conditions."""
    numbers = [k for k, c in enumerate(scene().conditions) if isinstance(c, Pull) or not pulls]
    return [ran(number, seed, **settings) for number in numbers for seed in SEEDS]


def mean(key, **settings):
    """The mean of a quantity with published numbers, over the pulls at the paper's grip."""
    found = [facts[key] for r, *_, facts in runs(True, **settings) if r.condition.grip_n == GRIP_N]
    return float(np.mean(found))


def slip():
    drop, move_v, rise_n = mean("load_drop"), mean("move_v"), mean("grip_rise_n")
    between = "between the two" if FALL[0] <= drop <= FALL[1] else "outside"
    between += ", with the wire's stiffness that was chosen ([cop_scenes](../cop_scenes.md))"
    published = "right: down by about 4 V, read as about 1 N; left: by about 1.3 N: 50 and 65 % of the 2 N"
    what = "load output at a grip of 2 N, right and left sensor"
    yield ("fig. 4 (a)", what, published, f"down by {100 * drop:.1f} %", between)
    off = [v["direction_error_deg"] for *_, v, _ in runs(True) if v["direction_error_deg"] is not None]
    right = sum(bool(v["octant_right"]) for *_, v, _ in runs(True))
    ours = f"{move_v:.4f} V; {np.mean(off):.1f}° off, {right} of {len(runs(True))} in the right octant"
    what, published = "position output of ±4 V", "moves by about 0.05 V, only in the direction of the slip"
    yield ("fig. 4 (b)", what, published, ours, beside(move_v, MOVE_V))
    ours = f"{rise_n:.3f} N, an input"
    what, published = "grip force before the move", "rises by about 0.2 N"
    yield ("fig. 4 (c)", what, published, ours, beside(rise_n, RISE_N))
    every = runs(False)
    missed = words(rate(sum(v["missed"] for *_, v, _ in runs(True)), len(runs(True))))
    false = words(rate(sum(v["false_alarms"] > 0 for *_, v, _ in every), len(every)))
    lead_ms = 1e3 * min(v["lead_s"] for *_, v, _ in runs(True) if v["lead_s"] is not None)
    ours = f"missed: {missed}; false alarms: {false}; shortest lead {lead_ms:.0f} ms"
    what = f"flag before displacement, seeds {SEEDS[0]} to {SEEDS[-1]}"
    yield ("III-A", what, "the start of slip can be detected", ours, NONE)


def second_sensor():
    both = list(zip(runs(True), runs(True, side=1)))
    at_grip = [pair for pair in both if pair[0][0].condition.grip_n == GRIP_N]
    falls = [[facts["load_drop"] for *_, facts in pair] for pair in at_grip]
    apart = np.abs(np.diff(falls)).max()
    flagged = sum(not any(v["missed"] for *_, v, _ in pair) for pair in both)
    gap_ms = 1e3 * max(
        abs(a[4]["flag_s"] - b[4]["flag_s"]) for a, b in both if a[4]["flag_s"] and b[4]["flag_s"]
    )
    ours = f"down by {100 * np.mean(falls):.1f} % on both, {100 * apart:.1f} points apart at most"
    why = "both have the same rubber and half the pull: the published 15 points are not reproduced"
    what = "load outputs of the two sensors of the grip"
    published = "both fall from the moment the tangential force rises, by about 1 and 1.3 N"
    yield ("III-A", what, published, ours, why)
    moves = np.array([[facts["move_v"] for *_, facts in pair] for pair in at_grip])
    ours = f"{moves[:, 0].mean():.4f} and {moves[:, 1].mean():.4f} V, the second in its own coordinates"
    what = "their position outputs"
    yield ("fig. 4 (b)", what, "the same on both", ours, "none")
    ours = (
        f"both flag before the object moves in {flagged} of {len(both)} pulls, at most {gap_ms:.0f} ms apart"
    )
    yield ("III-A", "flags of the two sensors", "not stated", ours, NONE)


def covers():
    bare = mean("move_v")
    parts = []
    for cover_mm in COVERS_MM[1:]:
        moved = mean("move_v", cover_mm=cover_mm) / bare
        parts.append(f"{cover_mm:g} mm of silicone: {moved:.2f} times")
    why = (
        f"none, but the paper states no thickness: on a lever of {grip.LEVER_MM:g} mm, covers of 0.2 and "
        "0.6 mm make it two and four times as long"
    )
    what, published = "a layer of silicone on the sensor", "the position moves two or four times as far"
    yield ("III-A", what, published, "; ".join(parts), why)


def cover_table():
    rows = []
    for cover_mm in COVERS_MM:
        verdicts = [v for *_, v, _ in runs(True, cover_mm=cover_mm)]
        delays = [1e3 * v["delay_s"] for v in verdicts if v["delay_s"] is not None]
        leads = [1e3 * v["lead_s"] for v in verdicts if v["lead_s"] is not None]
        off = [v["direction_error_deg"] for v in verdicts if v["direction_error_deg"] is not None]
        missed = sum(v["missed"] for v in verdicts)
        alarms = sum(v["false_alarms"] > 0 for *_, v, _ in runs(False, cover_mm=cover_mm))
        rows.append(
            (
                f"{cover_mm:g} mm",
                f"{mean('move_v', cover_mm=cover_mm):.3f} V",
                f"{missed} of {len(verdicts)}",
                f"{alarms} of {len(runs(False))}",
                f"{np.median(delays):.1f} / {max(delays):.0f} ms",
                f"{min(leads):.0f} ms",
                f"{max(off):.1f}°",
            )
        )
    text = (
        "The pull acts at the top of the cover, so the cover's thickness adds to the lever; the stress in "
        "the rubber, and so the load's fall, does not change. The detector's settings are those of the bare "
        "sensor."
    )
    header = (
        "silicone",
        "position moves",
        "missed",
        "false",
        "delay, median / largest",
        "worst lead",
        "direction off",
    )
    yield section("CoP slip with a cover", text, header, rows)


def sheared():
    """The rubber's response during and after the shear of figures 6 to 8, at 2 V."""
    k, speed = float(rubber.shear_gain(2.0)), 0.05
    time_s = np.arange(0, 7, 1e-3)
    level = rubber.shear_level(time_s, np.where((time_s > 0) & (time_s <= 1), speed, 0.0))
    ours = f"{k * level[999]:.2f} V at 0.05 mm/s; {100 * level[200] / level[999]:.0f} % of it after 0.01 mm"
    what = "rise of the voltage with 0.05 mm of shear, from 2 V"
    yield ("IV-C", what, "more than 1 V", ours, "see table I below")
    time_s = np.arange(0, 5.3, 1e-3)
    speeds = np.where((time_s > 0) & (time_s <= 0.3), 1.0, 0.0)
    ends = [
        2 + k * float(rubber.shear_level(time_s, speeds, recovers)[-1]) for recovers in (rubber.RESTORED, 0.4)
    ]
    ours = f"{ends[0]:.2f} V: restored, as the high-sensitivity sensor's paper states; "
    ours += f"{ends[1]:.2f} V with recovers = 0.4"
    what = "voltage 5 s after the shear at 1 mm/s, from 2 V"
    why = "the papers disagree; both are modelled"
    yield ("figs. 6-8", what, "about 3 V", ours, why)
    thick = f"{rubber.THICKNESS_MM:g} mm"
    yield ("V", "thickness of the rubber", "about 0.5 mm", thick, "another sensor's")
    what, ours = "response of the circuit", "clock counts: docs/results.md"
    yield ("II-B", what, "below 1 ms", ours, "none")


def shear_tables():
    n = rubber.SHEAR_EXPONENT
    k = {volts: float(rubber.shear_gain(volts)) for volts in FIT}  # eq. 2 within its range
    rows = []
    for speed, step in STEP_V.items():
        own, ours = FIT[2][0] * speed ** FIT[2][1], k[2] * speed**n
        rows.append((f"{speed:g} mm/s", f"{step} V", f"{own:.2f} V", f"{ours:.2f} V", beside(ours, step)))
    text = (
        "The steps of table I are about twice those that table II of the same paper gives. Ours follows "
        "table II, so it is about half of table I at every speed: the exponent agrees. Figures 6 to 8 show "
        "the same steps."
    )
    header = ("shear speed", "table I", "by its own table II", "ours", "ours beside table I")
    yield section("Voltage step of sheared rubber at 2 V (CoP slip, tables I, II)", text, header, rows)
    rows = [
        (f"{volts} V", f"{own:g}", f"{k[volts]:.2f}", f"{k[volts] - own:+.2f}", f"{power:g}", f"{n:g}")
        for volts, (own, power) in FIT.items()
    ]
    text = "Equation 3 prints the exponent -0.11 where the inverse of equation 1 has 1/0.11."
    header = (
        "initial voltage",
        "k, table II",
        "k, eq. 2, ours",
        "difference",
        "n, table II",
        "n, eq. 1, ours",
    )
    yield section("Constants of the step (CoP slip, table II, figs. 10, 11)", text, header, rows)


def compute():
    return [
        section("Pins of the Optacon-II", OPTACON),
        *((*cells, "no counterpart", "all of it") for cells in rows_of(OPTACON_ROWS)),
        section("Development of High Speed and High Sensitivity Slip Sensor", SLIP),
        *(*slip(), *second_sensor(), *covers(), *sheared()),
        *(*cover_table(), *shear_tables()),
        *_net.compute(),
    ]


def draw(folder):
    drawn, axes = figure(1, 3, height=8.6, sharex=True)
    for side, name in ((0, "right"), (1, "left")):
        recording, x, _, load, verdict, _ = ran(0, 1, side)
        part = slice(*np.searchsorted(recording.time_s, (0.2, recording.held.gross_s + 0.08)))
        time_s = recording.time_s[part]
        axes[0].plot(time_s, load[part], ("-", "--")[side], lw=2, label=f"load output, {name}")
        volts = grip.FULL_SCALE_V * x[part]
        axes[1].plot(time_s, volts - volts[:50].mean(), lw=2, label=f"position output, {name}")
    held = recording.held
    axes[2].plot(time_s, held.grip_n[part], lw=2, label="grip force (N)")
    axes[2].plot(time_s, held.tension_n[part], lw=2, label="pulling force (N)")
    axes[2].plot(time_s, held.slip_mm[part], lw=2, label="displacement (mm)")
    for axis in axes:
        axis.axvline(held.gross_s, color="black", lw=1, ls=":")
        axis.axvline(verdict["flag_s"], color="red", lw=1, ls="--")
    label(axes[0], "", "load (N)", "(a)")
    label(axes[1], "", "from rest (V)", "(b)")
    label(axes[2], "time (s)", "force, way", "(c)")
    caption = "Figure 4: a grip of 2 N, pulled at 100 mm/s; dashed: the flag, dotted: the object moves"
    pictures = [(save(drawn, folder, "cop_slip_fig4.png"), caption)]

    drawn, axes = figure(2)
    speed = np.geomspace(0.01, 4, 50)
    for volts, (own, power) in FIT.items():
        (line,) = axes[0].loglog(speed, rubber.shear_step(volts, speed), lw=2, label=f"Vi = {volts} V")
        axes[0].loglog(speed, own * speed**power, ":", lw=2, color=line.get_color())
    axes[0].set_yticks([0.3, 0.5, 1.0], ["0.3", "0.5", "1"])
    axes[0].minorticks_off()
    label(axes[0], "shear speed (mm/s)", "ΔV (V)", "fig. 10 (dotted: table II)")
    volts = np.linspace(1.5, 4.5, 40)
    axes[1].plot(volts, rubber.shear_gain(volts), lw=2, label="ours")
    axes[1].plot(list(FIT), [own for own, _ in FIT.values()], "o", ms=8, label="table II")
    label(axes[1], "initial voltage (V)", "k", "fig. 11")
    caption = (
        "The step of sheared rubber over speed and its constant over the initial voltage (figures 10, 11)"
    )
    pictures.append((save(drawn, folder, "cop_slip_shear.png"), caption))
    return pictures + _net.draw(folder)
