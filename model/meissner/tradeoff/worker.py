"""A process that measures points: one line of JSON in and one out per point, until the input is closed."""

import json
import os
import queue
import sys
import threading
from importlib import import_module


def rounded(value):
    """Figures rounded to nine digits: further digits depend on the order in which a library adds."""
    if isinstance(value, dict):
        return {key: rounded(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [rounded(each) for each in value]
    if hasattr(value, "item"):
        value = value.item()
    return float(f"{value:.9g}") if isinstance(value, float) else value


def measured(axis, point):
    """{"cost", "error"} of a point of ``axis``."""
    return rounded({"cost": axis.cost(point), "error": axis.error(point)})


def answer(where, name, point):
    """{"found": ``measured`` for the axis ``name`` in AXES of module ``where``}, or {"problem": why}."""
    try:
        axis = next(axis for axis in import_module(where).AXES if axis.name == name)
        return {"found": json.loads(json.dumps(measured(axis, point), allow_nan=False))}
    except Exception as problem:
        return {"problem": f"{type(problem).__name__}: {problem}"}


def _asked(lines):
    for line in sys.stdin:
        lines.put(line)
    os._exit(0)  # the parent is gone, so nobody will read the running result


def main():
    out = os.fdopen(os.dup(sys.stdout.fileno()), "w", encoding="utf-8")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # output of a library must not mix with answers
    lines = queue.SimpleQueue()
    threading.Thread(target=_asked, args=(lines,), daemon=True).start()
    while True:
        print(json.dumps(answer(*json.loads(lines.get()))), file=out, flush=True)


if __name__ == "__main__":
    main()
