"""Jitter of convert start and of the decision in the acrylic slip scene on engine rtl, in clocks.

python tools/jitter.py
"""

import tempfile
from pathlib import Path

from meissner import run, scenes


def figures():
    """Clocks between the shortest and longest interval, over all frames and all decisions of the scene."""
    with tempfile.TemporaryDirectory() as out:
        pins = run.run(scenes.load("acrylic_slip"), "rtl", Path(out))["pins"]
    return {key: pins[key] for key in ("convert_jitter_clocks", "decision_jitter_clocks")}


if __name__ == "__main__":
    for key, clocks in figures().items():
        print(f"{key}: {clocks}")
