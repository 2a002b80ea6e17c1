"""Judging a run of the capacitive pad: each kind's summary, arrays and drawings from its codes."""

from typing import NamedTuple

import numpy as np

from meissner import calibration, second_order
from meissner.engines import COP_ONE
from meissner.physics import capacitive, mesh_loads
from meissner.physics.capacitive import GRAM_N, PITCH_MM
from meissner.report.words import fact
from meissner.scenes.capacitive import pictures as report_arrays
from meissner.scenes.capacitive.scene import CALIBRATION_FRAMES, PROBED_CELL, SETTLED_FRAMES, cell_mm
from meissner.scenes.drawing import draw_even
from meissner.scenes.errors import errors, summarise, unevenness
from meissner.scenes.verdict import position_and_load

SHARES = (0.1, 0.05, 0.01)  # shares of the output that the unselected cells may take
HERTZ = np.logspace(4, 6.5, 251)


def _rounded(row):
    return {key: float(f"{value:.4g}") if isinstance(value, float) else value for key, value in row.items()}


class Fit(NamedTuple):
    """The Calibration from a press recording, its residual (newtons), and the forces it was fitted to."""

    lines: calibration.Calibration
    residual_n: np.ndarray
    force_n: np.ndarray


def calibrated(part, codes):
    """The Fit of a Part's codes of presses."""
    known = part.probe_n if part.probed is not None else part.force_n
    force_n = calibration.cell_forces(known, codes.shape, part.probed)
    return Fit(*calibration.fit(codes, force_n), force_n)


def calibrations(recording, codes):
    """{way of calibration in the recording: Fit}."""
    ways = [way for way in ("probe", "even") if way in recording.parts]
    return {way: calibrated(recording.parts[way], codes[way]) for way in ways}


def _terms(core, codes, fit):
    """The second-order term of every cell, from the recording that its line was fitted to."""
    return second_order.fit(core.calibrate(codes, fit.lines), fit.force_n)


def _crosstalk(scene, codes, *_):
    """Eq. 18 against the demodulated output; the gain that each accuracy needs."""
    readout, world = scene.readout, scene.world
    gains, others_pf = np.array(world["gains"]), np.array(world["unselected_pf"])
    measured_v = codes["sweep"][0] * scene.volts_per_code
    ideal_v = readout["drive_v"] * capacitive.CELL_F / capacitive.REF_F
    formula_v = capacitive.output_v(capacitive.CELL_F, others_pf * 1e-12, gains[:, None], readout["drive_v"])
    chosen = readout["gain"]
    rows = []
    for pf, at in zip(others_pf, codes["chosen"].mean(axis=(0, 1)) * scene.volts_per_code):
        # Eq. 18 solved for the gain at which the output is low by ``share``.
        total = 1 + (capacitive.CELL_F + pf * 1e-12) / capacitive.REF_F
        lagging = float(capacitive.output_v(capacitive.CELL_F, pf * 1e-12, -1j * chosen, readout["drive_v"]))
        row = {
            "unselected_pf": float(pf),
            "output_v": float(at),
            "low_by": 1 - at / ideal_v,
            "low_by_with_lagging_gain": 1 - lagging / ideal_v,
        } | {f"gain_for_{100 * share:g}_percent": total * (1 - share) / share for share in SHARES}
        rows.append(_rounded(row))
    # Leakage calls for a high carrier frequency, the amplifier's gain-bandwidth product for a low one.
    leaking_v = np.array(
        [
            capacitive.output_v(
                capacitive.CELL_F,
                others_pf.max() * 1e-12,
                world["gain_bandwidth_hz"] / HERTZ,
                readout["drive_v"],
                hertz=HERTZ,
                cell_ohm=mohm * 1e6,
            )
            for mohm in world["leak_mohm"]
        ]
    )
    summary = {
        "ideal_v": ideal_v,
        "difference_from_eq18_v": float(np.abs(measured_v - formula_v).max()),
        "conditions": rows,
    }
    arrays = {
        "gain": gains,
        "unselected_pf": others_pf,
        "measured_v": measured_v,
        "eq18_v": formula_v,
        "hertz": HERTZ,
        "leaking_v": leaking_v,
    }
    draw = {**arrays, "ideal_v": ideal_v, "leak_mohm": world["leak_mohm"], "chosen": chosen}
    return summary, arrays, [(report_arrays.draw_crosstalk, draw)]


def _cell(scene, codes, recording, fits, core):
    """Hysteresis, sag, linearity and repeatability of a cell, all in grams.

    ``low_at_full_g``: how much the calibrated cell reads low at the top of the cycles; ``low_settled_g``:
    the same after the force has settled, so only by the curve of the cell.
    """
    row, column = PROBED_CELL[0]
    fit = fits["probe"]
    lines, terms = fit.lines, _terms(core, codes["probe"], fit)
    names = ("cycles", "hold", "presses", "settled")
    forces = {name: core.calibrate(codes[name], lines) for name in names}
    grams = {name: f[:, row, column] * lines.force_lsb_n / GRAM_N for name, f in forces.items()}
    bent = {name: second_order.newtons(f, terms)[:, row, column] / GRAM_N for name, f in forces.items()}
    applied = {name: recording.parts[name].probe_n / GRAM_N for name in names}

    period = scene.world["rate_hz"]
    cycles, bent_cycles = (values["cycles"].reshape(-1, period) for values in (grams, bent))
    rise, top = applied["cycles"][:period], period // 2
    # Loading and unloading at the same forces, without the two turning points.
    up, down = cycles[:, 1:top], cycles[:, :top:-1]
    still = codes["probe"][:, row, column].reshape(-1, CALIBRATION_FRAMES)
    gram = lines.gain[row, column] / 2**lines.gain_shift * lines.force_lsb_n / GRAM_N  # grams per code
    noise_g = float(np.sqrt(still.var(axis=1, ddof=1).mean()) * gram)
    steps = np.array(scene.world["steps_g"])
    presses, bent_presses = (values["presses"].reshape(-1, len(steps)) for values in (grams, bent))
    hold, held = grams["hold"], np.flatnonzero(applied["hold"])
    first, last = hold[held[:4]].mean(), hold[held[-20:]].mean()
    # From codes above those at rest: the core reads 0 below the start of its line, which would hide the rest.
    at_rest = codes["settled"][:SETTLED_FRAMES, row, column].mean()
    left = (codes["hold"][:, row, column] - at_rest) * gram
    # The complete mean cycle, with its turning points, against the straight line that fits it best.
    cycle = cycles.mean(axis=0)
    departure = cycle - np.polyval(np.polyfit(rise, cycle, 1), rise)
    # Settled presses have no lag, so only the curve of the cell remains.
    at = applied["settled"][::SETTLED_FRAMES]
    settled, bent_settled = (values["settled"].reshape(len(at), -1).mean(1) for values in (grams, bent))
    low_g, low_settled_g = float(rise[top] - cycle[top]), float(at[-1] - settled[-1])
    summary = {
        "noise_g": noise_g,
        "unloading_above_loading_g": float((down - up).mean()),
        "off_the_line_g": float(np.abs(departure).max()),
        "low_at_full_g": low_g,
        "low_settled_g": low_settled_g,
        "settled_off_g": float(np.abs(settled - at).max()),
        "settled_off_second_order_g": float(np.abs(bent_settled - at).max()),
        "low_at_full_second_order_g": float((rise[top] - bent_cycles[:, top]).mean()),
        "reads_0_below_g": float(terms[row, column, 0] / GRAM_N),
        "sag_of_hold": float(last / first - 1),
        "left_after_release_g": float(left[held[-1] + 1]),
        "left_after_rest_g": float(left[-20:].mean()),
        "calibration_residual_g": float(fit.residual_n[row, column] / GRAM_N),
        "conditions": [
            _rounded(
                {
                    "press_g": float(step),
                    "mean_g": float(column_g.mean()),
                    "off_share": float(column_g.mean() / step - 1),
                    "off_share_second_order": float(bent_g.mean() / step - 1),
                    "deviation_g": float(column_g.std(ddof=1)),
                    "of_the_mean": float(column_g.std(ddof=1) / column_g.mean()),
                }
            )
            for step, column_g, bent_g in zip(steps, presses.T, bent_presses.T)
        ],
    }
    arrays = {f"{name}_g": values for name, values in grams.items()}
    arrays |= {f"{name}_applied_g": values for name, values in applied.items()}
    draw = {
        "rise": rise,
        "cycles": cycles,
        "noise_g": noise_g,
        "hold_s": np.arange(len(hold)) / recording.parts["hold"].rate_hz,
        "held_s": scene.world["hold_s"],
        "hold": hold,
        "hold_g": scene.world["hold_g"],
        "steps": steps,
        "presses": presses,
    }
    return summary, arrays, [(report_arrays.draw_cell, draw)]


def peak(x, values, reach):
    """(place, height) of the vertex of a parabola fitted within ``reach`` of the largest value."""
    near = np.abs(x - x[np.argmax(values)]) <= reach + 1e-9
    middle = x[near].mean()
    a, b, c = np.polyfit(x[near] - middle, values[near], 2)
    return float(middle - b / (2 * a)), float(c - b * b / (4 * a))


def _select(scene, codes, recording, fits, core):
    """The place where each cell responds most, and its neighbours' readings there."""
    lines = fits["probe"].lines
    cells = scene.world["cells"]
    first = (codes["steps"].shape[2] - cells) // 2
    columns = range(first, first + cells)
    grams = core.calibrate(codes["steps"], lines)[:, 3, list(columns)] * lines.force_lsb_n / GRAM_N
    left = cell_mm(3, first)[0] - PITCH_MM
    x_mm = np.arange(len(grams)) * scene.world["step_mm"]
    centres = [float(cell_mm(3, column)[0] - left) for column in columns]
    peaks = [peak(x_mm, values, 0.6) for values in grams.T]
    spacing = np.diff([place for place, _ in peaks])
    at_centre = [grams[np.argmin(np.abs(x_mm - centre))] for centre in centres]
    beside = [values[k + 1] / values[k] for k, values in enumerate(at_centre[:-1])]
    width = [
        float((values > height / 2).sum() * scene.world["step_mm"])
        for values, (_, height) in zip(grams.T, peaks)
    ]
    rows = [
        _rounded(
            {
                "column": column,
                "centre_mm": centre,
                "peak_mm": place,
                "height_g": height,
                "width_at_half_mm": wide,
            }
        )
        for column, centre, (place, height), wide in zip(columns, centres, peaks, width)
    ]
    summary = {
        "peaks_apart_mm": float(spacing.mean()),
        "peaks_apart_from_mm": float(spacing.min()),
        "peaks_apart_to_mm": float(spacing.max()),
        "neighbour_at_a_centre": float(np.mean(beside)),
        "conditions": rows,
    }
    arrays = {"x_mm": x_mm, "grams": grams}
    draw = {**arrays, "codes": codes["steps"][:, 3, list(columns)], "peaks": peaks, "centres": centres}
    return summary, arrays, [(report_arrays.draw_select, draw)]


def _shapes(scene, codes, recording, fits, core):
    """Images, their centre of pressure and load, and an even press before and after calibration."""
    images, rows, position, of_load, of_load_bent = {}, [], [], [], []
    lines, terms = fits["even"].lines, _terms(core, codes["even"], fits["even"])
    for name in scene.world["shapes"]:
        forces = core.calibrate(codes[name], lines)
        found = core.cop(forces)
        total, x, y, valid = found["sum"], found["x"] / COP_ONE, found["y"] / COP_ONE, found["valid"]
        truth = mesh_loads.true_centre(recording.parts[name].force_n)
        off, share = errors(x, y, total * lines.force_lsb_n, valid, *truth)
        position.append(off)
        of_load.append(share)
        bent_n = second_order.newtons(forces, terms).sum((1, 2))
        of_load_bent.append(np.abs(bent_n / truth[0] - 1))
        images[name] = forces.mean(axis=0) * lines.force_lsb_n / GRAM_N
        rows.append(
            _rounded(
                {
                    "shape": name,
                    "load_g": float(truth[0][0] / GRAM_N),
                    "reported_g": float(total.mean() * lines.force_lsb_n / GRAM_N),
                    "second_order_g": float(bent_n.mean() / GRAM_N),
                    "largest_cell_g": float(images[name].max()),
                    "position_error": float(off.mean()),
                }
            )
        )
    rest = codes["even"][recording.parts["even"].probe_n == 0].mean(axis=0)
    pressed = codes["even press"]
    even = {"before: codes above rest": pressed.mean(axis=0) - rest}
    for way, title in (("probe", "after, calibrated by a probe (g)"), ("even", "after, by even presses (g)")):
        one = fits[way].lines
        even[title] = core.calibrate(pressed, one).mean(axis=0) * one.force_lsb_n / GRAM_N
    before, by_probe, after = (unevenness(image) for image in even.values())
    summary = {
        "position_error": summarise(np.concatenate(position)),
        "load_error": summarise(np.concatenate(of_load)),
        "load_error_second_order": summarise(np.concatenate(of_load_bent)),
        "unevenness_before": before,
        "unevenness_codes_as_they_are": unevenness(pressed.mean(axis=0)),
        "unevenness_calibrated_by_probe": by_probe,
        "unevenness_after": after,
        "conditions": rows,
    }
    arrays = {f"image_{name.replace(' ', '_')}": image for name, image in images.items()}
    arrays |= {f"even_{k}": image for k, image in enumerate(even.values())}
    return (summary, arrays, [(report_arrays.draw_shapes, {"images": images}), (draw_even, {"images": even})])


ANSWERS = {"crosstalk": _crosstalk, "cell": _cell, "select": _select, "shapes": _shapes}


def answer(summary):
    """The sentence about a run."""

    def of(key):
        return fact(key, summary[key])

    if "difference_from_eq18_v" in summary:
        return f"The demodulated output is at most {of('difference_from_eq18_v')} off eq. 18."
    if "sag_of_hold" in summary:
        worst = max(row["of_the_mean"] for row in summary["conditions"])
        return (
            f"The reading of a held force rises by {of('sag_of_hold')} and leaves "
            f"{of('left_after_release_g')} at its release; the same press repeats within "
            f"{fact('of_the_mean', worst)} (standard deviation)."
        )
    if "peaks_apart_mm" in summary:
        return (
            f"Neighbouring cells peak {of('peaks_apart_mm')} apart; over a cell's centre its neighbour reads "
            f"{of('neighbour_at_a_centre')} of it."
        )
    text = position_and_load(summary)
    return (
        f"Calibration brings the cells of an even press from {of('unevenness_before')} to "
        f"{of('unevenness_after')} of their mean; {text[0].lower()}{text[1:]}"
    )
