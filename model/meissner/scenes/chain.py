"""The timed stages of an engine for array scenes: demodulation, calibration, centre of pressure."""

import time

import numpy as np

from meissner import engines
from meissner.engines.stages import STAGES, need
from meissner.scenes.results import head


def check(scene, engine, waves):
    """ValueError with one sentence if this engine cannot run the scene."""
    engines.load(engine)
    if waves:
        raise ValueError(f"--waves works only for scenes of slip or of taxel forces, not for {scene.name}")


ALL = tuple(STAGES.values())


class Chain:
    """An engine whose calls are timed and, for rtl and gate, compared with the integer twins.

    ``features``: of the core; a stage that they do not include is neither built nor loaded.
    """

    def __init__(self, engine, features=ALL):
        self.features = features
        self.engine, self.taken_s, self.samples, self.differences = engine, 0.0, 0, 0

    def _call(self, function, x, *settings):
        function(x[:1], *settings, self.engine)  # built and warm before it is timed
        started = time.perf_counter()
        result = function(x, *settings, self.engine)
        self.taken_s += time.perf_counter() - started
        self.samples += x.size
        if self.engine in engines.VERILATED:
            self.differences += int((result != function(x, *settings, "fixed")).sum())
        return result

    def demodulate(self, samples, carrier):
        """Codes [...] of carriers [..., samples]."""
        need(self.features, "demod")
        return self._call(engines.demodulate, samples, carrier)

    def calibrate(self, codes, calibration):
        """Forces [frames, rows, columns] of codes."""
        need(self.features, "calibrate")
        return self._call(engines.calibrate, codes, calibration)

    def cop(self, forces, min_load=1):
        """sum, x, y (-1 to 1) and valid of each frame of forces [frames, rows, columns]."""
        need(self.features, "cop")

        def packed(frames, engine):
            result = engines.process_cop(frames, engine, min_load)
            return np.stack([result[name].astype(np.int64) for name in ("sum", "x", "y", "valid")])

        total, x, y, valid = self._call(packed, forces)
        return total, x / engines.COP_ONE, y / engines.COP_ONE, valid.astype(bool)

    def summary(self, scene, recording, seconds, frames):
        """The first entries of every summary."""
        took = self.samples, self.taken_s, self.differences
        return {
            **head(scene, self.engine, recording.seed, seconds, *took, recording),
            "over_range": recording.over_range,
            "runs": 1,
            "seeds": [recording.seed, recording.seed],
            "frames": frames,
        }


def unevenness(image, dead=None):
    """Largest deviation of a cell from the mean of all, as a share of the mean; ``image`` [rows, columns]."""
    values = image if dead is None else image[~dead]
    return float(np.abs(values - values.mean()).max() / values.mean())
