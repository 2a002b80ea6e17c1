"""A log's images through an engine again, beside the core's own results for the same frames."""

import numpy as np

from meissner import engines


def replay(log, engine, min_load=1):
    """Arrays of ``process_cop`` for each logged image, and those of the log beside them.

    ``log``: of meissner.host.log.read. ``time``: clocks; ``logged``: the core's CoP of that frame is in the
    log; ``logged_x``, ``logged_y``, ``logged_load``, ``logged_pressed``: its values, 0 if it is not.
    """
    images = log["image"]
    if not images.size:
        raise ValueError("the log holds no image: there is nothing to replay")
    found = engines.process_cop(images, engine, min_load)
    row_of = {int(at): row for row, at in enumerate(log["cop_time"])}
    rows = np.array([row_of.get(int(at), -1) for at in log["image_time"]])
    beside = {
        f"logged_{name}": np.where(rows >= 0, log[f"cop_{name}"][rows] if len(row_of) else 0, 0)
        for name in ("x", "y", "load", "pressed")
    }
    return {"time": log["image_time"], **found, "logged": rows >= 0, **beside}


def differences(result):
    """Frames logged with both, frames of them that differ, and the largest difference of each number."""
    both = result["logged"]
    pairs = {"x": "x", "y": "y", "load": "sum", "pressed": "valid"}
    apart = {
        name: np.abs(result[f"logged_{name}"][both].astype(np.int64) - result[own][both].astype(np.int64))
        for name, own in pairs.items()
    }
    wrong = np.any([values > 0 for values in apart.values()], axis=0)
    largest = {name: int(values.max(initial=0)) for name, values in apart.items()}
    return int(both.sum()), int(wrong.sum()), largest
