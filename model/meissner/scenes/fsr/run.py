"""Running a scene of a resistive matrix: codes calibrated on an engine, compared with the true forces."""

from functools import partial

import numpy as np

from meissner import calibration, interval, scenes
from meissner.builds.units import Units
from meissner.engines import COP_ONE
from meissner.physics import mesh_loads
from meissner.scenes.drawing import draw_even
from meissner.scenes.errors import errors, percent, summarise, unevenness
from meissner.scenes.fsr import pictures
from meissner.scenes.fsr.scene import broken_cells
from meissner.scenes.results import Result, head, numbered, table
from meissner.scenes.timed import TimedEngine
from meissner.scenes.verdict import count, position_and_load

TABLES = {"Ways to read it": "conditions"}
WAVES = False
FAINT = 0.02  # share of the largest force: a cell with less counts as unpressed
SHOWN = (
    "the frame with the largest load as pressed, as converted and as calibrated; position and load over time",
    "an even press on all cells before and after calibration, each cell's distance from the mean",
    "the same press read by four circuits, each as a share of its largest reading",
)


def ghosts(recording):
    """A row for each way of reading the frame with the largest load: crosstalk through the network.

    ``ghost``: the largest part of an unpressed cell's reading that comes from other cells, as a share of the
    largest reading; ``pressed_spread``: over the pressed cells, deviation over mean of the ratio of a cell's
    reading to the reading it would give alone.
    """
    force_n = recording.force_n[recording.shown]
    pressed, unpressed = force_n > 0.5 * force_n.max(), force_n < FAINT * force_n.max()
    rows = []
    for (circuit, unselected), volts in recording.readings.items():
        share = (volts / recording.alone)[pressed]
        own = np.median(share) * recording.alone
        rows.append(
            {
                "circuit": circuit,
                "unselected": unselected,
                "ghost": round(float((volts - own)[unpressed].max() / volts.max()), 4),
                "pressed_spread": round(float(share.std() / share.mean()), 4),
            }
        )
    return rows


def run(scene, engine, seed, waves=None, spread=None):
    """The Result of the scene, which runs once."""
    recording, core = scenes.simulate(scene, seed), TimedEngine(engine, scene.features)
    presses, force_n = recording.parts["calibration"]
    lines, residual_n = calibration.fit(presses, force_n)
    broken = broken_cells(scene)
    min_load = Units(newtons_per_code=lines.force_lsb_n).load_code(scene.min_load_n)
    forces = core.calibrate(recording.codes, lines)
    found = core.cop(forces, min_load)
    x, y, valid = found["x"] / COP_ONE, found["y"] / COP_ONE, found["valid"]
    load_n = found["sum"] * lines.force_lsb_n
    truth = mesh_loads.true_centre(recording.force_n)
    position, of_load = errors(x, y, load_n, valid, *truth)
    # Errors against the forces on working cells only: without the effect of broken cells.
    working = mesh_loads.true_centre(np.where(broken, 0.0, recording.force_n))
    position_rest, of_load_rest = errors(x, y, load_n, valid, *working)

    pressed, _ = recording.parts["even"]
    rest = presses[force_n[:, 0, 0] == 0].mean(axis=0)
    before = pressed.mean(axis=0) - rest
    after = core.calibrate(pressed, lines).mean(axis=0) * lines.force_lsb_n
    rows = ghosts(recording)
    summary = head(scene, core, seed, len(recording.codes) / scene.rate_hz, recording.modelled) | {
        "over_range": recording.over_range,
        "runs": 1,
        "seeds": [seed, seed],
        "frames": len(recording.codes),
        "position_error": summarise(position),
        "load_error": summarise(of_load[valid]),
        "position_error_of_working_cells": summarise(position_rest),
        "load_error_of_working_cells": summarise(of_load_rest[valid]),
        "below_min_load": int(((truth[0] > 0) & ~valid).sum()),
        "rows": scene.rows,
        "columns": scene.columns,
        "dead": int(lines.dead.sum()),
        "dead_found": interval.rate(int((lines.dead & broken).sum()), int(broken.sum()))
        if broken.any()
        else None,
        "dead_falsely": interval.rate(int((lines.dead & ~broken).sum()), int((~broken).sum())),
        "dead_as_injected": bool((lines.dead == broken).all()),
        "unevenness_before": unevenness(before, lines.dead),
        "unevenness_after": unevenness(after, lines.dead),
        "conditions": rows,
    }
    arrays = {
        "time_s": recording.time_s,
        "codes": recording.codes,
        "forces": forces,
        "load_n": load_n,
        "x": x,
        "y": y,
        "valid": valid,
        "true_load_n": truth[0],
        "true_x": truth[1],
        "true_y": truth[2],
        "dead": lines.dead,
        "offset": lines.offset,
        "gain": lines.gain,
        "force_lsb_n": np.float64(lines.force_lsb_n),
        "residual_n": residual_n,
        "even_before": before,
        "even_after": after,
    }
    drawn = recording, forces * lines.force_lsb_n, (x, y, load_n, valid), truth
    even = {"before: codes above rest": before, "after calibration (N)": after}
    masked = {name: np.where(lines.dead, np.nan, image) for name, image in even.items()}
    draws = (
        lambda path: pictures.draw_matrix(scene, path, *drawn),
        partial(draw_even, scene, images=masked),
        partial(pictures.draw_ghosts, scene, recording=recording),
    )
    return Result(
        summary, arrays, numbered([(draw, scene.title, shown) for draw, shown in zip(draws, SHOWN)])
    )


def tell(summary):
    found = "as injected" if summary["dead_as_injected"] else "not all as injected"
    rates = [
        f"{word}: {interval.words(summary[key], 'cells')}"
        for key, word in (("dead_found", "broken cells found"), ("dead_falsely", "working cells found dead"))
        if summary[key]
    ]
    return [
        f"1 run, seed {summary['seed']}: {summary['frames']} frames of "
        f"{summary['rows']}×{summary['columns']}; {summary['dead']} cells found dead, {found}",
        *rates,
        f"position error, of the range -1 to 1: {percent(summary['position_error'])}",
        f"load error: {percent(summary['load_error'])}",
        f"even press: no cell off the mean by more than {100 * summary['unevenness_before']:.3g} % "
        f"before and {100 * summary['unevenness_after']:.2g} % after calibration",
        "",
        *table(summary["conditions"]),
    ]


def answer(summary):
    """The sentence about a run: position, load, and the cells found dead."""
    text = position_and_load(summary)[:-1]
    as_injected = "those injected" if summary["dead_as_injected"] else "not all as injected"
    if summary["dead"] or not summary["dead_as_injected"]:
        text += f"; {count(summary['dead'], 'cell was', 'cells were')} found dead, {as_injected}"
    return text + "."
