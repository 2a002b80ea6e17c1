"""Twin of rtl/frontend/msn_condition.sv: an array's samples, faulty taxels masked and zeros subtracted."""

import numpy as np

from meissner.twins.frontend.health import Health
from meissner.twins.frontend.tare import Tare


class Condition:
    """``limits``: of msn_health; ``tare``: a dict of Tare's arguments (contact, step, tare_log2); or None.

    ``health`` and ``tare`` are the stages, None if absent.
    """

    def __init__(self, rows, columns, lanes=1, sample_bits=17, limits=None, tare=None):
        size = rows, columns, lanes, sample_bits
        self.health = None if limits is None else Health(*size, limits)
        self.tare = None if tare is None else Tare(*size, **tare)
        self.steps = {"health": int(limits is not None), "tare": int(tare is not None)}  # clocks

    def next(self, samples, over=None):
        """Samples and masks of complete frames of samples, all [frames, rows, columns]."""
        samples = np.asarray(samples, dtype=np.int64)
        mask = np.zeros(samples.shape, dtype=bool)
        if self.health is not None:
            mask, _ = self.health.next(samples, over)
        if self.tare is not None:
            samples = self.tare.next(samples, mask)
        return samples, mask

    def beat(self, raw, over, id_, last, fits=True):
        """One beat as FrameMarker passes it: samples (None while zeros are loaded), mask, events."""
        mask, events = np.zeros(len(raw), dtype=bool), []
        if self.health is not None:
            mask, events = self.health.beat(raw, over, id_, last, fits)
        if self.tare is not None:
            raw = self.tare.beat(raw, id_, last, mask, fits)
        return raw, mask, events
