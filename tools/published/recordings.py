"""Print the tables of docs/recordings.md as Markdown: false alarms on real recordings of a hold without slip.

    python tools/published/recordings.py

The recordings (docs/recordings.md names their source) are read from $MEISSNER_DATA or ../shared/data;
without them the command prints one sentence and exits with code 2. Every figure of the core comes from the
rtl engine; the fixed engine runs too, and any difference stops the run.
"""

import math
import os
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from meissner import engines
from meissner.builds.toolchain import ROOT
from meissner.twins.slip.config import SlipConfig

NAME = "biotac_hold/pac_all.npz"
RATE = 2200  # samples per second
WINDOW = 64
LEVELS = (1, 2, 3)
THRESHOLDS = (2, 3, 4, 6, 8, 12, 16, 23, 32, 40, 64)
# The hold: it begins HOLD seconds after the start and ends AFTER seconds before the end of a recording. The
# gripper closes before it, and every recording has settled when it begins (settled_at; a test checks it). In
# their last 5 ms, four recordings of two grasps rise sharply in both fingers, perhaps the robot's next step.
HOLD, AFTER = 0.6, 0.05


@dataclass(frozen=True)
class Watch:
    """One measure on one recording: each window's start and p2p, and {threshold: whether it is exceeded}."""

    samples: int
    start: np.ndarray
    p2p: np.ndarray
    over: dict

    def holding(self):
        """Only the windows that lie entirely in the hold."""
        last = self.samples - AFTER * RATE - WINDOW
        keep = (self.start >= HOLD * RATE) & (self.start <= last)
        over = {t: over[keep] for t, over in self.over.items()}
        return Watch(self.samples, self.start[keep], self.p2p[keep], over)


def find(name):
    """Path of recorded data in $MEISSNER_DATA or ../shared/data; the project does not contain them."""
    folder = os.environ.get("MEISSNER_DATA")
    path = (Path(folder) if folder else ROOT.parent / "shared/data") / name
    if not path.is_file():
        looked = "$MEISSNER_DATA" if folder else "../shared/data"
        raise ValueError(f"the recordings {name} are not in {looked}: nothing was measured on them")
    return path


def read():
    """{name: codes [samples]}, in the order of the file."""
    with np.load(find(NAME)) as recordings:
        return {name: recordings[name].astype(np.int64) for name in recordings.files}


def settled_at(x):
    """Time in seconds when the mean of 20 ms first reaches the hold's level, the median from 1 s on."""
    span = RATE // 50
    sums = np.cumsum(np.concatenate([[0], x]))
    means = (sums[span:] - sums[:-span]) / span
    return (np.argmax(means >= np.median(x[RATE:])) + span) / RATE


def scaled(threshold, level):
    """The threshold for a level: white noise makes the detail sqrt(2) larger with each level."""
    return math.isqrt(threshold**2 << (level - 1))


def stack(recordings):
    """All as the channels of one core, so that a level is built once; short ones repeat their last code."""
    longest = max(map(len, recordings.values()))
    return np.stack([np.pad(x, (0, longest - len(x)), mode="edge") for x in recordings.values()])


def watch_haar(recordings, level):
    """{name: Watch}, by the rtl engine."""
    x = stack(recordings)
    over = {}
    for threshold in THRESHOLDS:
        config = SlipConfig(WINDOW, hop=1 << level, level=level, threshold=scaled(threshold, level))
        result, twin = (engines.process_slip(x, config, engine) for engine in ("rtl", "fixed"))
        for field in result:
            if not np.array_equal(result[field], twin[field]):
                raise RuntimeError(f"{field} at {config} differs between rtl and fixed")
        over[threshold] = result["slip"]
    start = result["window_end"] - (WINDOW - 1)
    watched = {}
    for i, (name, codes) in enumerate(recordings.items()):
        count = np.searchsorted(result["window_end"], len(codes))  # windows within the recording
        cut = {t: slip[i, :count] for t, slip in over.items()}
        watched[name] = Watch(len(codes), start[:count], result["p2p"][i, :count], cut)
    return watched


def watch_raw(recordings):
    """{name: Watch}, by the plain peak-to-peak of the codes over the same windows as level 1."""
    watched = {}
    for name, x in recordings.items():
        windows = np.lib.stride_tricks.sliding_window_view(x, WINDOW)[::2]
        p2p = windows.max(axis=1) - windows.min(axis=1)
        watched[name] = Watch(len(x), np.arange(len(p2p)) * 2, p2p, {t: p2p > t for t in THRESHOLDS})
    return watched


def measure(recordings):
    """Everything the report needs: {measure: {name: Watch}}."""
    return {f"Haar {level}": watch_haar(recordings, level) for level in LEVELS} | {
        "plain": watch_raw(recordings)
    }


def alarming(watched, threshold):
    """How many recordings raise at least one alarm."""
    return sum(bool(w.over[threshold].any()) for w in watched.values())


def alarms(watched, threshold):
    """How often p2p rises above the threshold, in all recordings together."""
    return sum(int((np.diff(w.over[threshold].astype(int), prepend=0) > 0).sum()) for w in watched.values())


def table(heads, rows):
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def percent(share):
    if share == 0:
        return "0"
    if 0.9995 <= share < 1:
        return "> 99.9 %"
    return f"{100 * share:.3g} %" if share > 0.1 else f"{100 * share:.2g} %"


def report(recordings, measured):
    """The tables, as Markdown."""
    seconds = sum(map(len, recordings.values())) / RATE
    settled = [settled_at(x) for x in recordings.values()]
    hold = {measure: {n: w.holding() for n, w in found.items()} for measure, found in measured.items()}
    held = seconds - (HOLD + AFTER) * len(recordings)
    phases, both = {"whole": measured, "hold": hold}, ("Haar 1", "plain")

    def share(measure, t):
        """Two cells: alarms per second of the hold, and the share of its windows above the threshold."""
        above = np.concatenate([w.over[t] for w in hold[measure].values()]).mean()
        return f"{alarms(hold[measure], t) / held:.3g}", percent(above)

    def spread(watched):
        p2p = np.concatenate([w.p2p for w in watched.values()])
        ends = (int(np.percentile(p2p, q, method="inverted_cdf")) for q in (0, 50, 90, 99, 99.9, 100))
        return *ends, f"{np.median([w.p2p.max() for w in watched.values()]):g}"

    def largest(watched, kind):
        return max(int(w.p2p.max()) for name, w in watched.items() if name.startswith(kind))

    kinds = sorted({name.split("_HOLD")[0].rsplit("_", 2)[0] for name in recordings})
    heads = ("lowest", "median", "90 %", "99 %", "99.9 %", "largest", "recording's largest, median")
    parts = [
        f"{len(recordings)} recordings, {seconds:.0f} s, {held:.0f} s of them hold; the signal reached its "
        f"level of the hold after {np.median(settled):.2f} s (median), {max(settled):.2f} s (latest).",
        f"Recordings of {len(recordings)} that raise at least one alarm:",
        table(
            ["threshold", *(f"{m}, {phase}" for phase in phases for m in measured)],
            [[t, *(alarming(of[m], t) for of in phases.values() for m in measured)] for t in THRESHOLDS],
        ),
        "In the hold, all recordings together:",
        table(
            ["threshold", *(f"{m}, {what}" for m in both for what in ("alarms per second", "time above"))],
            [[t, *(cell for m in both for cell in share(m, t))] for t in THRESHOLDS],
        ),
        "Peak-to-peak in codes, every window of every recording:",
        table(
            ["measure", "phase", *heads],
            [[m, phase, *spread(of[m])] for phase, of in phases.items() for m in measured],
        ),
        "Largest peak-to-peak by object, in codes:",
        table(
            ["object", *(f"{m}, {phase}" for phase in phases for m in both)],
            [
                [kind.replace("_", " "), *(largest(of[m], kind) for of in phases.values() for m in both)]
                for kind in kinds
            ],
        ),
    ]
    return "\n\n".join(parts)


def figures(threshold=23):
    """Recordings with an alarm in the hold at README's threshold, for level 1 and for the plain measure."""
    recordings = read()
    counts = {
        name: alarming({n: w.holding() for n, w in found.items()}, threshold)
        for name, found in (("haar", watch_haar(recordings, 1)), ("plain", watch_raw(recordings)))
    }
    return {"recordings": len(recordings), "threshold": threshold} | counts


def main():
    try:
        recordings = read()
    except ValueError as problem:
        print(f"recordings: {problem}", file=sys.stderr)
        sys.exit(2)
    print(report(recordings, measure(recordings)))


if __name__ == "__main__":
    main()
