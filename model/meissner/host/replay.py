"""Run a log's images through an engine, beside the core's own results for the same frames."""

import numpy as np

from meissner import engines
from meissner.arrays import Arrays


def replay(log: Arrays, engine: str, min_load: int = 1) -> Arrays:
    """Arrays of ``process_cop`` for each logged image, with the logged results beside them.

    ``log``: from meissner.host.log.read. ``time``: clocks; ``logged``: whether the log has the core's CoP of
    that frame; ``logged_x``, ``logged_y``, ``logged_load``, ``logged_pressed``: its values, 0 without it.
    """
    images = log["image"]
    if not images.size:
        raise ValueError("the log has no image to replay")
    found = engines.process_cop(images, engine, min_load)
    row_of = {int(at): row for row, at in enumerate(log["cop_time"])}
    rows = np.array([row_of.get(int(at), -1) for at in log["image_time"]])
    beside = {
        f"logged_{name}": np.where(rows >= 0, log[f"cop_{name}"][rows] if len(row_of) else 0, 0)
        for name in ("x", "y", "load", "pressed")
    }
    return {"time": log["image_time"], **found, "logged": rows >= 0, **beside}


def changes(log: Arrays) -> tuple[int, int]:
    """(changes of channels' states in the log, how many of them do not begin with the state that the change
    before of that channel led to): those between were lost."""
    last: dict[int, int] = {}
    broken = 0
    for channel, before, state in zip(
        *(log[f"change_{name}"].tolist() for name in ("channel", "before", "state"))
    ):
        broken += last.get(channel, before) != before
        last[channel] = state
    return len(log["change_state"]), broken


def differences(result: Arrays) -> tuple[int, int, dict[str, int]]:
    """(frames logged with image and CoP, how many of them differ, {number: largest difference})."""
    both = result["logged"]
    pairs = {"x": "x", "y": "y", "load": "sum", "pressed": "valid"}
    apart = {
        name: np.abs(result[f"logged_{name}"][both].astype(np.int64) - result[own][both].astype(np.int64))
        for name, own in pairs.items()
    }
    wrong = np.any([values > 0 for values in apart.values()], axis=0)
    largest = {name: int(values.max(initial=0)) for name, values in apart.items()}
    return int(both.sum()), int(wrong.sum()), largest
