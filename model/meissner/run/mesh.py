"""Running a scene of the four-wire mesh: electrode voltages through an engine, held against what presses."""

import time

import numpy as np

from meissner import engines, report_cop, scenes
from meissner.run import finish, table
from meissner.run.truth import errors, percent, summarise


def check(scene, engine, waves):
    """ValueError with one sentence if this engine cannot run the scene."""
    if not hasattr(engines.load(engine), "cop4"):
        raise ValueError(
            f"the engine {engine} has no four-electrode centre of pressure yet; run {scene.name} "
            "with --engine float"
        )
    if waves:
        raise ValueError(f"--waves is for slip scenes; {scene.name} has no converter's pins to show")


def _response_s(recording, load):
    """From the start of a pulse to the sample at which the reported load is at 95 % of its greatest."""
    start = recording.scene.world["start_s"]
    return float(recording.time_s[np.argmax(load >= 0.95 * load.max())] - start)


def run(scene, engine, out, seed, waves, progress):
    """Run every r of the scene; write results to ``out``; return the summary."""
    began = time.perf_counter()
    module, twin_module = engines.load(engine), engines.load("fixed")
    recordings = scenes.simulate(scene, seed)
    engine_s, mismatches, runs, rows = 0.0, 0, [], []
    for recording in progress(recordings):
        started = time.perf_counter()
        x, y, load, valid = module.cop4(recording.solution)
        engine_s += time.perf_counter() - started
        if engine == "rtl":
            twin = twin_module.cop4(recording.solution)
            mismatches += int(np.any([a != b for a, b in zip((x, y, load, valid), twin)], axis=0).sum())
        truth = recording.load, recording.x, recording.y
        position, of_load = errors(x, y, load, valid, *truth)
        runs.append({"x": x, "y": y, "load": load, "valid": valid, "position": position, "of_load": of_load})
        parts = {"": slice(None)}
        if scene.kind == "random":
            parts = {total: recording.load.round(6) == total for total in scene.world["totals_n"]}
        for total, part in parts.items():
            rows.append({"r_ohm": recording.r_ohm} | ({"total_n": total} if total else {}))
            for name, error in (("position", position[part]), ("load", of_load[part])):
                error = summarise(error)
                rows[-1] |= {f"{name}_error_{key}": round(value, 6) for key, value in error.items()}
    everything = {name: np.concatenate([one[name] for one in runs]) for name in runs[0]}
    samples = len(everything["x"])
    first = recordings[0]
    summary = {
        "scene": scene.name,
        "engine": engine,
        "seed": seed,
        "seconds_simulated": round(samples / scene.rate_hz, 3),
        "seconds_taken": None,
        "samples_per_second": round(samples / engine_s),
        "twin_mismatches": mismatches if engine == "rtl" else None,
        "modelled": list(first.modelled),
        "left_out": list(first.left_out),
        "position_error": summarise(everything["position"]),
        "load_error": summarise(everything["of_load"]),
        "runs": len(runs),
        "conditions": rows,
    }
    if scene.kind == "pulse":
        # Against what the taxels feel: without the lag of the rubber.
        felt = [
            errors(o["x"], o["y"], o["load"], o["valid"], r.felt_n, r.x, r.y)[1]
            for r, o in zip(recordings, runs)
        ]
        summary["load_error_without_lag"] = summarise(np.concatenate(felt))
        summary["response_s"] = round(_response_s(first, runs[0]["load"]), 9)
    pictures = [(report_cop.draw_mesh(out / f"{scene.name}.png", recordings, runs), f"seed {seed}")]
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
        arrays |= {prefix + name: values for name, values in kept.items()}
    arrays |= {
        "time_s": first.time_s,
        "true_load": first.load,
        "true_x": first.x,
        "true_y": first.y,
        "felt_load": first.felt_n,
    }
    return finish(scene, summary, out, arrays, pictures, {"Errors": rows}, began, ("conditions",))


def tell(summary):
    """The lines to print of a summary."""
    lines = [
        f"position error, of the range -1 to 1: {percent(summary['position_error'])}",
        f"load error: {percent(summary['load_error'])}",
    ]
    if "response_s" in summary:
        lines += [
            f"without the rubber's lag: {percent(summary['load_error_without_lag'])}",
            f"95 % of the load is reported {summary['response_s'] * 1e3:.2f} ms after it begins",
        ]
    return [*lines, "", *table(summary["conditions"])]
