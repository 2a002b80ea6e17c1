"""Performance Analysis of a Tactile Sensor (8×8 capacitive cells), compared with the capacitive scenes."""

from functools import cache

import numpy as np

from meissner import calibration, engines, scenes
from meissner.physics import capacitive, dielectric
from meissner.physics.capacitive import GRAM_N, PITCH_MM
from meissner.scenes.capacitive import run
from meissner.scenes.capacitive import scene as of_pad
from published import _capacitive_pictures, rows_of, section

TITLE = "Performance Analysis of a Tactile Sensor (8×8 capacitive array)"
HEAD = """
Siegel, Drucker, Garabieta, 1987. Only the text and axes of the paper's figures are known here; where it
prints no number, none is compared. The text is uncertain in three places: equations 2 to 7 call the direction
of the force x in one sentence and z in the next (x here), the signs and subscripts of equation 15 are
illegible (Kirchhoff's law at the amplifier gives the equation), and the section on the design has an
amplifier for each row and drives the columns, those on fabrication and calibration the reverse (as here). The
rows of objects give the applied load, the reported load, and the load with the second-order term of
[capacitive.md](../capacitive.md).
"""
SEEDS = range(1, 9)
PER_MM2 = np.pi / 4 * capacitive.TAB_DIAMETER_MM**2


@cache
def measured(kind, seed=1):
    """The Result of a scene."""
    return run.run(scenes.load(f"capacitive_{kind}"), "fixed", seed)


def over_seeds(kind, key, scale=1.0):
    """``4.19 (3.81 to 4.69)``: seed 1 and the range of all seeds. ``key``: in the summary or its last row."""

    def value(seed):
        summary = measured(kind, seed).summary
        return scale * (summary[key] if key in summary else summary["conditions"][-1][key])

    values = [value(seed) for seed in SEEDS]
    return f"{values[0]:.3g} ({min(values):.3g} to {max(values):.3g})"


def mean_over_seeds(kind, key):
    values = [100 * measured(kind, seed).summary[key]["mean"] for seed in SEEDS]
    return f"{values[0]:.2g} % ({min(values):.2g} to {max(values):.2g})"


@cache
def even_lines(seed):
    """(lines, codes, newtons) of a calibration with even presses."""
    scene = scenes.load("capacitive_shapes")
    part = of_pad._World(scene, seed).even(of_pad.CALIBRATION_G, of_pad.EVEN_FRAMES)
    codes = engines.demodulate(part.samples, scene.carrier, "fixed")
    return calibration.fit(codes, np.array(part.force_n))[0], codes, np.array(part.force_n)


def columns_share():
    """The share of the columns' means in the variance of the cells' gains, in percent, for each seed."""
    gains = [even_lines(seed)[0].gain.astype(float) for seed in SEEDS]
    return [100 * gain.mean(axis=0).var() / gain.var() for gain in gains]


def integers_off_g():
    """Largest difference in grams of the core's integer line from the least-squares line, 25 to 150 g."""
    lines, codes, force_n = even_lines(1)
    slope, intercept, _ = calibration.line(codes, force_n)
    exact = (codes - intercept) / slope / GRAM_N
    core = engines.calibrate(codes, lines, "fixed") * lines.force_lsb_n / GRAM_N
    return np.abs(core - exact)[force_n[:, 0, 0] > 20 * GRAM_N].max()


def design():
    ohm = 1 / (2 * np.pi * 1e5 * capacitive.CELL_F)
    low, high = (1e12 * float(capacitive.plate_f(capacitive.BACKING_MM + h)) for h in (0.75, 0.25))
    soft = [100 * float(dielectric.rise_without_tabs(100.0, v)) for v in (0.5, 0.499, 0.49)]
    tabs = 100 * float(dielectric.rise(100.0))
    leak = [100 * (float(dielectric.leaking_v(1.0, f, 10e6)) - 1) for f in (1e5, 200e3)]
    share = dielectric.rise(100.0)
    grams = dielectric.force_for(share, np.array(dielectric.HEIGHTS_MM))
    at_200 = 200 * PER_MM2
    rises = [100 * float(dielectric.rise(at_200, h)) for h in (0.75, 0.25)]
    heights = [100 * float(capacitive.tab_height(at_200 * GRAM_N, tab_mm=h)) for h in (0.75, 0.25)]
    return rows_of(f"""
        eq. 2–6 | flat sheet, glued down, even press: strain along the force | 0: no change of position at
        all
        | stress/E·(1 + ν)(1 − 2ν)/(1 − ν): 0 at ν = ½; 100 g on a cell add {soft[0]:.2g} % of capacitance,
        {soft[1]:.2g} % at ν = 0.499, {soft[2]:.2g} % at 0.49 | none at ν = ½

        eq. 7 | the same with tabs | stress/E
        | the same; with the glued ends a tab is 1 + 2S² = {1 + 2 * (1.4 / 3) ** 2:.2f} times as stiff, and
        100 g add {tabs:.3g} % | the ends, which the paper leaves out

        fabrication | tab of 0.25 to 0.75 mm “depending on the desired force range” | no number
        | what 100 g do to 0.75 mm takes {grams[0]:.0f} g at 0.25 mm: the range is {grams[0] / grams[1]:.1f}
        times as wide | –

        fabrication | range 0 to 200 g/mm² | “suitable performance”
        | 200 g/mm² on a tab are {at_200:.0f} g: capacitance +{rises[0]:.0f} % at 0.75 mm, +{rises[1]:.0f} %
        at 0.25 mm, a tab compressed to {heights[0]:.0f} and {heights[1]:.0f} % | –

        design | Ccell | on the order of 1 pF
        | 1 pF is used; the printed sizes give {low:.3f} pF (tab 0.75 mm) to {high:.3f} pF (0.25 mm) |
        {1 / high:.0f} to {1 / low:.0f} times

        eq. 11 | reactance of 1 pF at 100 kHz | 10 MΩ
        | {ohm / 1e6:.2f} MΩ; 10 MΩ is 1/(fC), without 2π | {10e6 / ohm:.1f} times

        eq. 16, 17 | leakage of the cell, large gain | a high carrier makes it small
        | 10 MΩ: {leak[0]:.2g} % too much at 100 kHz, {leak[1]:.2g} % at 200 kHz | –
    """)


def crosstalk():
    summary = measured("crosstalk").summary
    rows = {row["unselected_pf"]: row for row in summary["conditions"]}
    volts = ", ".join(f"{rows[pf]['output_v']:.2f} ({pf:g} pF)" for pf in (0, 10, 40, 80))
    lagging = ", ".join(f"{100 * rows[pf]['low_by_with_lagging_gain']:.2g}" for pf in (0, 10, 40, 80))
    hertz = scenes.load("capacitive_crosstalk").world["gain_bandwidth_hz"]
    return rows_of(f"""
        eq. 18 | output at any gain, 0 to 80 pF unselected | formula
        | demodulated carrier at most {1e3 * summary["difference_from_eq18_v"]:.2g} mV of 10 V off |
        {10 * summary["difference_from_eq18_v"]:.2g} %

        2 | output over the gain: “for gain over approximately 200, adequate performance is obtained” | 10 V
        ideally
        | at G = 200 {volts} V; with a phase lag of 90°, as of a compensated amplifier, {lagging} % low |
        {100 * rows[0]["low_by"]:.1f} to {100 * rows[80]["low_by"]:.0f} % low

        design | carrier from the gain-bandwidth product over 200 | 200 kHz
        | needs a product of {hertz / 1e6:g} MHz | –

        1, 3 | schematic, cross section | drawings | as described | –
    """)


def cell():
    summary = measured("cell").summary
    rows = summary["conditions"]
    spread = [100 * row["of_the_mean"] for row in rows]
    return rows_of(f"""
        4, 5 | up and down at about 1 Hz, no grams printed (4); 0 to 150 g and back, no rate printed (5)
        | linear (4)
        | 150 g in a cycle of a second: within {over_seeds("cell", "off_the_line_g")} g of the straight line
        that fits it best |
        {100 * summary["off_the_line_g"] / 150:.2g} % of 150 g

        5 | loading and unloading | differ within the noise
        | {summary["unloading_above_loading_g"]:.2g} g apart, noise {summary["noise_g"]:.2g} g rms |
        {summary["unloading_above_loading_g"] / summary["noise_g"]:.2g} times the noise

        calibration | straight line by least squares, per cell | “adequate”: the response is linear
        | top of a cycle {over_seeds("cell", "low_at_full_g")} g low, of which nonlinearity
        {over_seeds("cell", "low_settled_g")} g, the rest creep; settled presses at most
        {over_seeds("cell", "settled_off_g")} g off, with a second-order term
        {over_seeds("cell", "settled_off_second_order_g")} g | {over_seeds("cell", "off_share", -100)} % low
        in presses of 150 g, with the second-order term {over_seeds("cell", "off_share_second_order", -100)}
        %

        calibration | fout = (cout − b)/m | formula
        | the same in integers, deviation at most {integers_off_g():.2g} g from real numbers | –

        6 | constant force, 240 s | sags; comes back (no hysteresis)
        | reading rises by {100 * summary["sag_of_hold"]:.2g} %; 0.5 s after release
        {over_seeds("cell", "left_after_release_g")} g of 100 g remain, after 60 s
        {over_seeds("cell", "left_after_rest_g")} g | no number printed

        7 | press to press | much worse than within a press
        | {min(spread):.2g} to {max(spread):.2g} % (standard deviation of twelve) | no number printed
    """)


def images():
    select, shapes = measured("select").summary, measured("shapes").summary
    share = columns_share()
    arrays = measured("shapes").arrays
    edges = arrays["image_two_edges"][:, 2:6].mean(axis=1)
    names = {row["shape"]: row for row in shapes["conditions"]}

    def one(name):
        row = names[name]
        return f"{row['load_g']:.0f}, {row['reported_g']:.0f}, {row['second_order_g']:.0f} g"

    return rows_of(f"""
        8 | peaks of three cells, probe of 100 g in steps of 0.1 mm (the caption has “OSmm”, perhaps 0.5)
        | about 2 mm apart
        | {select["peaks_apart_mm"]:.2f} mm ({select["peaks_apart_from_mm"]:.3f} to
        {select["peaks_apart_to_mm"]:.3f}) | pitch {PITCH_MM} mm

        8 | overlap | some
        | a neighbour reads {100 * select["neighbour_at_a_centre"]:.1f} % over a cell's centre | no number
        printed

        calibration | differences of cells | the columns' amplifiers contribute heavily
        | columns are {min(share):.0f} to {max(share):.0f} % of the gains' variance (seeds 1 to 8) | no
        number printed

        calibration | even press, cell with the largest deviation from the mean | every cell should read the
        same
        | {100 * shapes["unevenness_before"]:.1f} % before; calibrated by a probe, as published,
        {100 * shapes["unevenness_calibrated_by_probe"]:.1f} %, by even presses
        {100 * shapes["unevenness_after"]:.2f} % | no number printed

        9 | straight edges: slightly off horizontal; vertical | bars
        | edge: {one("edge")}; upright: {one("upright edge")} | –

        10 | socket on the diagonal; on the opposite one | bars
        | {one("IC socket")}; opposite: {one("opposite socket")} | –

        11 | two edges, one thicker, 3 mm apart | a gap of one pixel
        | one row at {100 * edges[3] / edges.max():.0f} % of the thicker edge | none

        12 | bolt; washer | bars | bolt: {one("bolt")}; washer: {one("washer")} | –

        13 | connector of 6 pins | bars | {one("connector")} | –

        9–13 | total load of the objects | none printed
        | {mean_over_seeds("shapes", "load_error")} off in the mean, with a second-order term
        {mean_over_seeds("shapes", "load_error_second_order")}; position
        {mean_over_seeds("shapes", "position_error")} of the range | –
    """)


def tabs():
    heights = (0.25, 0.375, 0.5, 0.625, 0.75)
    share = dielectric.rise(100.0)
    rows = []
    for height in heights:
        grams = float(dielectric.force_for(share, height))
        rise = 100 * dielectric.rise(np.array([50.0, 100.0, 150.0]), height)
        rows.append(
            (f"{height:g}", f"{grams:.0f}", f"{grams / PER_MM2:.0f}", *(f"{one:.1f}" for one in rise))
        )
    return section(
        "Height of the tab against the range of forces",
        f"Grams, and grams per mm² of the tab, that raise the capacitance by {100 * share:.3g} %, as 100 g "
        "do at 0.75 mm; and the rise with 50, 100 and 150 g. With an incompressible sheet without tabs there "
        "is no rise at any thickness.",
        ("tab, mm", "g for the same rise", "g/mm²", "50 g: %", "100 g: %", "150 g: %"),
        tuple(rows),
    )


def compute():
    return [
        *design(),
        *crosstalk(),
        *cell(),
        *images(),
        tabs(),
    ]


def draw(folder):
    return _capacitive_pictures.draw(folder, measured)
