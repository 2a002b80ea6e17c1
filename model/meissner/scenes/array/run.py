"""Running a scene of an array of taxels: its frames through an engine, compared with the true forces."""

import time

import numpy as np

from meissner import engines, scenes
from meissner.engines.stages import need
from meissner.scenes.array import pictures as report_cop
from meissner.scenes.results import check_waves, finish, head
from meissner.scenes.truth import errors, percent, summarise

KEPT_SAMPLES = 1 << 22  # result.npz has no codes if there are more taxel samples

SHOWN = (
    "the path of the centre of pressure over the largest force on each taxel; position, load and their "
    "errors over time"
)


def check(scene, engine, waves):
    """ValueError with one sentence if this engine cannot run the scene."""
    check_waves(engine, waves)


def mismatches(result, twin):
    """How many frames differ from the twin's in any array."""
    return int(np.any([result[name] != twin[name] for name in twin], axis=0).sum())


def run(scene, engine, out, seed, waves, progress):
    """Run the scene once; write results to ``out``; return the summary."""
    began = time.perf_counter()
    need(scene.features, "cop")
    recording = scenes.simulate(scene, seed)
    codes = recording.codes
    engines.process_cop(codes[:1], engine, scene.min_load)  # built and warm before it is timed
    # In pieces only to show progress: no frame depends on another.
    step = max(1, (1 << 22) // codes[0].size)
    started, parts = time.perf_counter(), []
    for start in progress(range(0, len(codes), step)):
        parts.append(engines.process_cop(codes[start : start + step], engine, scene.min_load))
    engine_s = time.perf_counter() - started
    result = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    twin = engines.process_cop(codes, "fixed", scene.min_load) if engine in engines.VERILATED else None
    wrong = None if twin is None else mismatches(result, twin)
    if waves:
        from meissner.engines import rtl_cop  # here: other engines need not load the builder

        part = rtl_cop.shown(result["sum"], codes.shape[1:])
        seen = rtl_cop.cop(codes[part], scene.min_load, out / "waves.vcd")
        wrong += mismatches(seen, {name: values[part] for name, values in twin.items()})

    x, y = (result[name] / engines.COP_ONE for name in ("x", "y"))
    load = result["sum"] * scene.load_lsb
    position, of_load = errors(x, y, load, result["valid"], recording.load, recording.x, recording.y)
    summary = {
        **head(scene, engine, seed, len(codes) / scene.rate_hz, codes.size, engine_s, wrong, recording),
        "position_error": summarise(position),
        "load_error": summarise(of_load[result["valid"]]),
        "below_min_load": int(((recording.load > 0) & ~result["valid"]).sum()),
        "over_range": recording.over_range,
        "runs": 1,
        "seeds": [seed, seed],
        "frames": len(codes),
        "rows": scene.rows,
        "columns": scene.columns,
    }
    picture = report_cop.draw_array(
        out / f"{scene.name}.png", recording, result["valid"], x, y, load, position, of_load
    )
    arrays = {
        **result,
        "time_s": recording.time_s,
        "true_load": recording.load,
        "true_x": recording.x,
        "true_y": recording.y,
        "position_error": position,
        "load_error": of_load,
        **({"codes": codes} if codes.size <= KEPT_SAMPLES else {}),
    }
    return finish(scene, summary, out, arrays, [(picture, scene.title, SHOWN)], {}, began)


def tell(summary):
    """The lines to print of a summary."""
    return [
        f"1 run, seed {summary['seed']}: {summary['frames']} frames of "
        f"{summary['rows']}×{summary['columns']}; {summary['below_min_load']} below the least load",
        f"position error, of the range -1 to 1: {percent(summary['position_error'])}",
        f"load error: {percent(summary['load_error'])}",
    ]
