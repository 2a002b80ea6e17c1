"""The core's own estimate of a recorded shear: feature ``shear_speed`` of kind ``speed``."""

import numpy as np

from meissner.scenes.errors import percent, summarise
from meissner.scenes.shear.published import LIMIT_MM_S
from meissner.twins.slip.shear_speed import FAST, ShearSettings
from meissner.twins.slip.shear_speeds import SIZE, ShearConfig

# Rests are 2, 3 and 4 V; noise puts half of those at the published ends, 2 and 4 V, beyond them.
VI_MIN_V, VI_MAX_V = 1.9, 4.1
AFTER = 3  # windows that a slow fall by `still` takes at the end of a shear


class Estimator:
    """The estimator of a scene on a TimedEngine."""

    def __init__(self, scene, core):
        per_v = 1.0 / scene.adc.lsb_v
        self.config = ShearConfig(ShearSettings.of(per_v, scene.rate_hz, vi_min=VI_MIN_V, vi_max=VI_MAX_V))
        self.core = core

    def of(self, recording):
        """``estimate_mm_s``: last speed in the shear, or None; ``estimate_fast``: the shear was flagged as
        above the limit; ``estimates_outside``: windows with a speed where nothing is sheared."""
        window = 1 << SIZE.window_log2
        found = self.core.shear_speed(recording.codes[None], self.config, recording.moving)
        speed, flags = (rows[0] for rows in found)
        last_s = (AFTER + 1) * window / recording.scene.rate_hz
        ends = (np.arange(len(flags)) + 1) * window / recording.scene.rate_hz
        inside = (ends > recording.start_s) & (ends <= recording.stop_s)
        around = (ends > recording.start_s) & (ends <= recording.stop_s + last_s)
        known = np.flatnonzero(inside & (flags == 0))
        return {
            "estimate_mm_s": float(speed[known[-1]]) if len(known) else None,
            "estimate_fast": bool((flags[inside] & FAST).any()),
            "estimates_outside": int((~around & (flags == 0)).sum()),
        }


def join(rows, answer, found):
    """Add the estimates to the rows of kind ``speed`` and to its answer."""
    off, missed, beyond = [], 0, []
    for row, (case, runs) in zip(rows, found.items(), strict=True):
        speeds = [run["estimate_mm_s"] for run in runs if run["estimate_mm_s"] is not None]
        row["estimate_mm_s"] = round(float(np.mean(speeds)), 5) if speeds else None
        if case.speed_mm_s <= LIMIT_MM_S:
            off += [speed / case.speed_mm_s - 1.0 for speed in speeds]
            missed += sum(run["estimate_mm_s"] is None for run in runs)
        else:
            beyond += [run["estimate_fast"] for run in runs]
    answer["estimate_error"] = summarise(np.abs(off))
    answer["estimate_missed"] = missed
    answer["estimate_beyond"] = f"{sum(beyond)} of {len(beyond)}"
    answer["estimates_outside"] = sum(run["estimates_outside"] for runs in found.values() for run in runs)


def tell(summary):
    """Lines to print."""
    return [
        f"the core's estimator: {percent(summary['estimate_error'])} off; no speed in "
        f"{summary['estimate_missed']} shears; above the limit flagged in {summary['estimate_beyond']}; "
        f"{summary['estimates_outside']} windows with a speed where nothing is sheared"
    ]
