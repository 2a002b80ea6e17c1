"""Running a scene of an array of taxels: its frames through an engine, compared with the true forces."""

import numpy as np

from meissner import engines, scenes
from meissner.scenes.array import pictures
from meissner.scenes.errors import errors, percent, summarise
from meissner.scenes.results import Picture, Result, head
from meissner.scenes.timed import TimedEngine, mismatches
from meissner.scenes.verdict import position_and_load as answer

__all__ = ["TABLES", "WAVES", "answer", "run", "tell"]

KEPT_SAMPLES = 1 << 22  # result.npz has no codes if there are more taxel samples
TABLES: dict[str, str] = {}
WAVES = True
SHOWN = (
    "the path of the centre of pressure over the largest force on each taxel; position, load and their "
    "errors over time"
)


def run(scene, engine, seed, waves, spread):
    """The Result of the scene, which runs once."""
    recording, core = scenes.simulate(scene, seed), TimedEngine(engine, scene.features)
    codes = recording.codes
    # In pieces only to show progress: no frame depends on another.
    step = max(1, (1 << 22) // codes[0].size)
    parts = [
        core.cop(codes[start : start + step], scene.min_load)
        for start in spread.progress(range(0, len(codes), step))
    ]
    result = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    if waves:
        from meissner.engines import rtl_cop  # here: other engines need not load the builder

        part = rtl_cop.shown(result["sum"], codes.shape[1:])
        seen = rtl_cop.cop(codes[part], scene.min_load, waves)
        core.differences += mismatches(seen, engines.process_cop(codes[part], "fixed", scene.min_load))

    x, y = (result[name] / engines.COP_ONE for name in ("x", "y"))
    load, valid = result["sum"] * scene.load_lsb, result["valid"]
    position, of_load = errors(x, y, load, valid, recording.load, recording.x, recording.y)
    summary = {
        **head(scene, core, seed, len(codes) / scene.rate_hz, recording.modelled),
        "position_error": summarise(position),
        "load_error": summarise(of_load[valid]),
        "below_min_load": int(((recording.load > 0) & ~valid).sum()),
        "over_range": recording.over_range,
        "runs": 1,
        "seeds": [seed, seed],
        "frames": len(codes),
        "rows": scene.rows,
        "columns": scene.columns,
    }
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

    def draw(path):
        pictures.draw_array(path, recording, valid, x, y, load, position, of_load)

    return Result(summary, arrays, [Picture("", draw, scene.title, SHOWN)])


def tell(summary):
    return [
        f"1 run, seed {summary['seed']}: {summary['frames']} frames of "
        f"{summary['rows']}×{summary['columns']}; {summary['below_min_load']} below the least load",
        f"position error, of the range -1 to 1: {percent(summary['position_error'])}",
        f"load error: {percent(summary['load_error'])}",
    ]
