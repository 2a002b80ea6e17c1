"""A process that measures points: a line of JSON in for each, a line out, until nobody asks any more."""

import json
import os
import queue
import sys
import threading
from importlib import import_module


def rounded(value):
    """Figures to nine digits: what is beyond them hangs on the order in which a library adds."""
    if isinstance(value, dict):
        return {key: rounded(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [rounded(each) for each in value]
    if hasattr(value, "item"):
        value = value.item()
    return float(f"{value:.9g}") if isinstance(value, float) else value


def measured(axis, point):
    """{"cost", "error"} of a point of an Axis."""
    return rounded({"cost": axis.cost(point), "error": axis.error(point)})


def answer(where, name, point):
    """The same of the axis ``name`` of the module ``where``, whose AXES has it; {"problem"} if it fails."""
    try:
        axis = next(axis for axis in import_module(where).AXES if axis.name == name)
        return {"found": json.loads(json.dumps(measured(axis, point), allow_nan=False))}
    except Exception as problem:
        return {"problem": f"{type(problem).__name__}: {problem}"}


def _asked(lines):
    for line in sys.stdin:
        lines.put(line)
    os._exit(0)  # who asked has gone: what runs now has no reader


def main():
    out = os.fdopen(os.dup(sys.stdout.fileno()), "w", encoding="utf-8")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what a library prints is no answer
    lines = queue.SimpleQueue()
    threading.Thread(target=_asked, args=(lines,), daemon=True).start()
    while True:
        print(json.dumps(answer(*json.loads(lines.get()))), file=out, flush=True)


if __name__ == "__main__":
    main()
