"""An axis that measures nothing: it logs the points that it is given, and ends its process where files tell
it to.

The environment sets: TOY_FOLDER, a folder with a file `log`; files `fails` and `die_once` hold numbers of
points; while a file `hold` exists, points from HOLD on do not end; TOY_SECONDS: the time that each takes.
"""

import os
import signal
import time
from pathlib import Path

from meissner.tradeoff.axis import Axis, Figure

COUNT = 24
HOLD = 7


def folder():
    return Path(os.environ["TOY_FOLDER"])


def _told(name, number):
    path = folder() / name
    return path.exists() and str(number) in path.read_text("utf-8").split()


def log():
    """Numbers of the points that were begun, in the order of the file."""
    path = folder() / "log"
    return [int(line) for line in path.read_text("utf-8").split()] if path.exists() else []


def error(point):
    number = point["number"]
    with (folder() / "log").open("a", encoding="utf-8") as file:
        file.write(f"{number}\n")
    if _told("fails", number):
        raise ValueError("no such thing")
    if _told("die_once", number):
        (folder() / "die_once").unlink()
        os.kill(os.getpid(), signal.SIGKILL)
    while (folder() / "hold").exists() and number >= HOLD:
        time.sleep(0.01)
    time.sleep(float(os.environ.get("TOY_SECONDS", "0")))
    return {"wrong": 1 / (1 + number), "third": number / 3}


def cost(point):
    return {"price": point["number"] % 7}


AXES = (
    Axis(
        name="toy",
        title="A toy",
        about="numbers from 0 to 99999",
        values={"number": tuple(range(COUNT))},
        quick={"number": (0, 5)},
        shipped={"number": 3},
        legal=lambda point: point["number"] < 100_000,
        cost=cost,
        error=error,
        figures=(
            Figure("price", "price", "€", judged=True),
            Figure("wrong", "wrong", "%", judged=True),
            Figure("third", "a third"),
        ),
        panels=(("price", "wrong"),),
    ),
)
