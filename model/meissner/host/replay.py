"""Run a log's images through an engine, beside the core's own results for the same frames."""

import numpy as np

from meissner import engines
from meissner.arrays import Arrays
from meissner.host.log import boots


def replay(log: Arrays, engine: str, min_load: int | None = None) -> Arrays:
    """Arrays of ``process_cop`` for each logged image, with the logged results beside them.

    ``log``: from meissner.host.log.read. ``min_load``: in place of the log's, or of 1 if not known.
    ``boot``: resets before the image; ``time``: clocks since then; ``logged``: whether the log has the core's
    CoP of that frame; ``logged_x``, ``logged_y``, ``logged_load``, ``logged_pressed``: its values,
    0 without it.
    """
    images, boot = log["image"], boots(log, "image")
    if not images.size:
        raise ValueError("the log has no image to replay")
    least = np.array([log.get("min_load", -1), *log["reset_min_load"]])[boot]
    least = np.where(least < 0, 1, least) if min_load is None else np.full(len(images), min_load)
    found: Arrays = {}
    for one in np.unique(least):
        which = least == one
        for name, values in engines.process_cop(images[which], engine, int(one)).items():
            found.setdefault(name, np.zeros((len(images), *values.shape[1:]), values.dtype))[which] = values
    row_of = {at: row for row, at in enumerate(zip(boots(log, "cop"), log["cop_time"]))}
    rows = np.array([row_of.get(at, -1) for at in zip(boot, log["image_time"])])
    beside = {
        f"logged_{name}": np.where(rows >= 0, log[f"cop_{name}"][rows] if len(row_of) else 0, 0)
        for name in ("x", "y", "load", "pressed")
    }
    return {"boot": boot, "time": log["image_time"], **found, "logged": rows >= 0, **beside}


def changes(log: Arrays) -> tuple[int, int]:
    """(changes of channels' states in the log, how many of them do not begin with the state that the change
    before of that channel led to): those between were lost."""
    last: dict[tuple[int, int], int] = {}
    broken = 0
    columns = [boots(log, "change"), *(log[f"change_{name}"] for name in ("channel", "before", "state"))]
    for boot, channel, before, state in zip(*(column.tolist() for column in columns)):
        broken += last.get((boot, channel), before) != before
        last[boot, channel] = state
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
