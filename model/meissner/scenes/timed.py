"""An engine with a scene's features: its calls are timed and, for rtl and gate, compared with the twins."""

import dataclasses
import time
from functools import partial

import numpy as np

from meissner import engines
from meissner.engines.features import function


def _arrays(result):
    """Every array and number in an engine's result."""
    if isinstance(result, dict):
        result = result.values()
    elif dataclasses.is_dataclass(result):
        result = vars(result).values()
    elif not isinstance(result, tuple):
        return [np.asarray(result)]
    return [array for part in result for array in _arrays(part)]


def mismatches(ours, twin):
    """Number of details, windows, samples or frames that differ from the twin's in any array."""
    by_shape = {}
    for one, other in zip(_arrays(ours), _arrays(twin), strict=True):
        by_shape.setdefault(one.shape, []).append(one != other)
    return sum(int(np.any(wrong, axis=0).sum()) for wrong in by_shape.values())


def each(scene, engine, work, tasks, spread):
    """(a TimedEngine with the sums of all tasks, [``work(scene, its own TimedEngine, *task)`` of each task]).

    ``work``: a module's function; ``spread``: pool.Spread. A process builds and warms each feature up once.
    """
    _WARM.clear()
    cores, found = zip(*spread.map(partial(_alone, work, scene, engine), tasks))
    total = TimedEngine(engine, scene.features)
    for core in cores:
        total.taken_s += core.taken_s
        total.samples += core.samples
        total.differences += core.differences
    return total, found


_WARM = set()  # features that are warm in this process, for the tasks of a run


def _alone(work, scene, engine, task):
    core = TimedEngine(engine, scene.features, _WARM)
    return core, work(scene, core, *task)


class TimedEngine:
    """An engine of meissner.engines. A call that needs a feature beyond ``features`` raises ValueError.

    ``samples`` went through the engine in ``taken_s`` seconds; ``differences``: results that are not the
    integer twins'.
    """

    def __init__(self, engine, features, warm=None):
        self.engine, self.features = engine, features
        self.taken_s, self.samples, self.differences = 0.0, 0, 0
        self._warm = set() if warm is None else warm

    def _call(self, feature, run, x, first=None):
        """``run(x, engine)``; ``first``: a short input, by default the first of ``x``."""
        if feature not in self.features:
            raise ValueError(f"the core is built without {feature}: it has {', '.join(self.features)}")
        if feature not in self._warm:  # built and warm before it is timed
            self._warm.add(feature)
            run(x[:1] if first is None else first, self.engine)
        started = time.perf_counter()
        result = run(x, self.engine)
        self.taken_s += time.perf_counter() - started
        self.samples += len(x) if feature in ("cop4", "cop_slip") else x.size  # four electrodes are one
        if self.engine in engines.VERILATED:
            self.differences += mismatches(result, run(x, "fixed"))
        return result

    def watch(self, codes, config, moving=None):
        """Watched of codes [channels, samples]; ``moving`` [samples]."""

        def run(x, engine):
            return function(engine, "watch")(x, config, None if moving is None else moving[: x.shape[1]])

        return self._call("slip", run, codes, np.zeros((1, config.window), dtype=np.int64))

    def shear_speed(self, codes, config, moving):
        """Speed and flags of each window of codes [channels, samples]."""

        def run(x, engine):
            return function(engine, "shear_speed")(x, config, moving[: x.shape[1]])

        return self._call("shear_speed", run, codes, codes[:, :64])

    def forest_features(self, codes, window):
        """Features [frames - window, window * channels] of codes [channels, frames]."""

        def run(x, engine):
            return function(engine, "forest_features")(x, window)

        return self._call("forest_features", run, codes, codes[:, : window + 1])

    def pin_display(self, frames, size, settings):
        """Shown of frames [periods, pins] of levels."""

        def run(x, engine):
            return function(engine, "pin_display")(x, size, settings)

        return self._call("pin_display", run, frames, frames[:2])

    def render(self, felt, *settings):
        """Levels [frames, rows, columns] of what a sensor felt; ``settings``: grid, amplitude bits,
        registers."""
        return self._call("render", lambda x, engine: function(engine, "render")(x, *settings), felt)

    def demodulate(self, samples, carrier):
        """Codes [...] of carriers [..., samples]."""
        return self._call("demod", lambda x, engine: engines.demodulate(x, carrier, engine), samples)

    def calibrate(self, codes, calibration):
        """Forces [frames, rows, columns] of codes."""
        return self._call("calibrate", lambda x, engine: engines.calibrate(x, calibration, engine), codes)

    def cop(self, forces, min_load=1):
        """The arrays of engines.process_cop of forces [frames, rows, columns]."""
        return self._call("cop", lambda x, engine: engines.process_cop(x, engine, min_load), forces)

    def cop4(self, codes, config):
        """Cop4 of codes [samples, 4]."""
        return self._call("cop4", lambda x, engine: function(engine, "cop4")(x, config), codes)

    def cop_slip(self, codes, *settings):
        """Cop4 and CopSlipResult of codes [samples, 4]; ``settings``: config, lag, registers."""
        return self._call("cop_slip", lambda x, engine: function(engine, "cop_slip")(x, *settings), codes)
