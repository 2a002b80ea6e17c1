"""Running a scene of the four-wire mesh: electrode voltages through an engine, against the true forces."""

import time

import numpy as np

from meissner import engines, scenes
from meissner.scenes.errors import errors, percent, summarise
from meissner.scenes.mesh import pictures
from meissner.scenes.mesh.scene import CONVERTER
from meissner.scenes.results import Picture, Result, head, table
from meissner.scenes.timed import TimedEngine, mismatches
from meissner.scenes.verdict import position_and_load as answer

__all__ = ["TABLES", "WAVES", "answer", "circle", "run", "tell"]

TABLES = {"Errors": "conditions", "Bounds of the solver": "solver", "Locus": "locus"}
WAVES = True
# What the picture of a scene's kind shows (pictures.draw_mesh).
SHOWN = {
    "points": "reported place and load against the true ones, and their errors",
    "surface": "voltage of layer A, the whole layer for the first r and the loaded row for each r",
    "random": "errors of position and load over the total load, mean and deviation of all draws",
    "pulse": "applied load, load felt by the taxels and reported load over time",
    "stroke": "the locus of the reported centre over the taxels, and its radius around the circle",
}


def circle(x, y):
    """The least-squares circle of points [n] and their deviation from it.

    ``centre_x``, ``centre_y``, ``radius``; ``deviation``: standard deviation of the points' radii;
    ``roundness``: the largest radius less the smallest, over the mean radius. Kasa's linear fit; ValueError
    unless at least three points are not on a line.
    """
    x, y = np.asarray(x, float), np.asarray(y, float)
    terms = np.stack([x, y, np.ones_like(x)], axis=1)
    (a, b, _), _, rank, _ = np.linalg.lstsq(terms, x * x + y * y, rcond=1e-9)
    if rank < 3:
        raise ValueError("a circle needs three points that are not on a line")
    radii = np.hypot(x - a / 2, y - b / 2)
    return {
        "centre_x": float(a / 2),
        "centre_y": float(b / 2),
        "radius": float(radii.mean()),
        "deviation": float(radii.std()),
        "roundness": float(np.ptp(radii) / radii.mean()),
    }


def _response_s(recording, load):
    """Time from the start of a pulse to the sample at which the reported load has made 95 % of its rise."""
    start_s = recording.scene.world["start_s"]
    before = load[recording.time_s < start_s].max(initial=0.0)
    return float(recording.time_s[np.argmax(load >= before + 0.95 * (load.max() - before))] - start_s)


def _position_response_s(recording, x, y):
    """Time from the start of a pulse to the first sample from which on the position stays within 5 % of its
    way to its place at the pulse's end. The way begins at the position before the pulse, or at 0."""
    world, rate_hz = recording.scene.world, recording.scene.rate_hz
    start, stop = (
        int(np.ceil(s * rate_hz - 1e-6)) for s in (world["start_s"], world["start_s"] + world["pulse_s"])
    )
    left = np.hypot(x - x[stop - 1], y - y[stop - 1])[max(start - 1, 0) : stop]
    away = np.flatnonzero(left > 0.05 * left[0])
    return float((start + away[-1] if len(away) else start) / rate_hz - world["start_s"])


def reported(recording, core):
    """x, y, load (N), valid [samples] by a TimedEngine; float takes the voltages."""
    if core.engine == "float":
        started = time.perf_counter()
        found = engines.load("float").cop4_of_volts(recording.solution)
        core.taken_s += time.perf_counter() - started
        core.samples += len(recording.codes)
        return found
    found = core.cop4(recording.codes, recording.config)
    x, y = found.x / engines.COP_ONE, found.y / engines.COP_ONE
    return x, y, found.load * recording.config.load_lsb_n, found.pressed


def certified(recordings):
    """The solver's own bounds, worst over all samples: position (of the range), load (of it), condition."""
    solutions = [recording.solution for recording in recordings]
    place = max(float(max(s.bound.x.max(), s.bound.y.max())) / 2 for s in solutions)
    load = max(float((s.bound.load[s.valid] / s.load[s.valid]).max(initial=0)) for s in solutions)
    return {"position": place, "load": load, "condition": float(max(s.condition.max() for s in solutions))}


def run(scene, engine, seed, waves, spread):
    """The Result of every r of the scene."""
    recordings, core = scenes.simulate(scene, seed), TimedEngine(engine, scene.features)
    runs, rows = [], []
    for recording in spread.progress(recordings):
        x, y, load, valid = reported(recording, core)
        truth = recording.load, recording.x, recording.y
        position, of_load = errors(x, y, load, valid, *truth)
        runs.append({"x": x, "y": y, "load": load, "valid": valid, "position": position, "of_load": of_load})
        parts = {"": slice(None)}
        if scene.kind == "random":
            parts = {total: recording.load.round(6) == total for total in scene.world["totals_n"]}
        for total, part in parts.items():
            rows.append({"r_ohm": recording.r_ohm} | ({"total_n": total} if total else {}))
            for name, error in (("position", position[part]), ("load", of_load[part])):
                error = summarise(error) or {"maximum": None, "mean": None}
                rows[-1] |= {
                    f"{name}_error_{key}": None if value is None else round(value, 6)
                    for key, value in error.items()
                }
    everything = {name: np.concatenate([one[name] for one in runs]) for name in runs[0]}
    samples = len(everything["x"])
    first = recordings[0]
    unused = [CONVERTER] if engine == "float" else []
    if waves:  # samples of the first r, up to the greatest load
        part = slice(0, int(np.argmax(runs[0]["load"])) + 1)
        seen = engines.load(engine).cop4(first.codes[part], first.config, waves)
        core.differences += mismatches(seen, engines.load("fixed").cop4(first.codes[part], first.config))
    summary = {
        **head(scene, core, seed, samples / scene.rate_hz, first.modelled),
        "modelled": [part for part in first.modelled if part not in unused],
        "left_out": [*unused, *first.left_out],
        "position_error": summarise(everything["position"]),
        "load_error": summarise(everything["of_load"]),
        "solver": certified(recordings),
        "runs": len(runs),
        "seeds": [seed, seed],
        "conditions": rows,
    }
    if scene.kind == "pulse":
        # Errors against the felt load, so without the rubber's lag, where the sensor gives a load.
        felt = [
            errors(o["x"], o["y"], o["load"], o["valid"], r.felt_n, r.x, r.y)[1][o["valid"]]
            for r, o in zip(recordings, runs)
        ]
        summary["load_error_without_lag"] = summarise(np.concatenate(felt))
        summary["response_s"] = round(_response_s(first, runs[0]["load"]), 9)
        summary["position_response_s"] = round(_position_response_s(first, runs[0]["x"], runs[0]["y"]), 9)
    if scene.kind == "stroke":
        summary["locus"] = circle(runs[0]["x"], runs[0]["y"])
    kind = "surface" if scene.kind == "points" and len(first.load) == 1 else scene.kind
    condition = f"{scene.title}, r = {' and '.join(f'{r.r_ohm:g}' for r in recordings)} Ω"
    arrays = {}
    for recording, one in zip(recordings, runs):
        prefix = f"r{recording.r_ohm:g}_" if len(runs) > 1 else ""
        solution = recording.solution
        kept = {
            **{f"E{k}": getattr(solution, f"E{k}") for k in (1, 2, 3, 4)},
            **{name: one[name] for name in ("x", "y", "load", "valid")},
            "position_error": one["position"],
            "load_error": one["of_load"],
        }
        if engine != "float":
            kept["codes"] = recording.codes
        arrays |= {prefix + name: values for name, values in kept.items()}
    arrays |= {
        "time_s": first.time_s,
        "true_load": first.load,
        "true_x": first.x,
        "true_y": first.y,
        "felt_load": first.felt_n,
    }

    def draw(path):
        pictures.draw_mesh(path, recordings, runs)

    return Result(summary, arrays, [Picture("", draw, condition, SHOWN[kind])])


def tell(summary):
    count = f"{summary['runs']} run{'s' if summary['runs'] > 1 else ''}, one for each r"
    lines = [
        f"{count}, seed {summary['seed']}",
        f"position error, of the range -1 to 1: {percent(summary['position_error'])}",
        f"load error: {percent(summary['load_error'])}",
    ]
    solver = summary["solver"]
    lines.append(
        f"bounds of the mesh's solver: {solver['position']:.1g} of the range, {solver['load']:.1g} of "
        f"the load; condition number at most {solver['condition']:.3g}"
    )
    if "response_s" in summary:
        lines += [
            f"without the rubber's lag: {percent(summary['load_error_without_lag'])}",
            f"95 % of the load is reported {summary['response_s'] * 1e3:.2f} ms after it starts, and the "
            f"position settles after {summary['position_response_s'] * 1e3:.2f} ms (published: about 0.6 ms)",
        ]
    if "locus" in summary:
        locus = summary["locus"]
        lines.append(
            f"locus: a circle of radius {locus['radius']:.4f} ± {locus['deviation']:.4f}, "
            f"out of round by {100 * locus['roundness']:.3g} % (published: a neat locus, without a number)"
        )
    return [*lines, "", *table(summary["conditions"])]
