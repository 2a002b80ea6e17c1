"""[scan] of a scene: converters that read its array row by row, each through its analogue front."""

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from msgspec import Meta

from meissner.arrays import Floats
from meissner.builds.read_by import Scanning
from meissner.physics import front
from meissner.tables import naming


class ScanKeys(Scanning, frozen=True, kw_only=True):
    """[scan]: keys as in [adc] of a build (docs/config.md); ``mhz``: the core's clock."""

    mhz: Annotated[float, Meta(ge=1, le=200)] = 100.0


@dataclass(frozen=True)
class Scan:
    """``twin``: ScanAdc; ``settling``: Settling; ``settle``: clocks; ``idle_s``: between two frames."""

    twin: Any
    settling: Any
    settle: int
    idle_s: float

    def through(self) -> "Through":
        return Through(self)


def build(where: str, keys: ScanKeys, rows: int, columns: int, rate_hz: float) -> Scan:
    """The Scan of an array with that many frames a second; ``where`` begins the sentence of a ValueError."""
    with naming(f"{where}, [scan]"):
        clk_khz = round(1000 * keys.mhz)
        twin = keys.scan(rows, columns, clk_khz)
        settling = keys.settling(twin)
        settle = settling.clocks(keys.settle_us)
        settling.check(settle)
        frame_s = twin.scan.frame_clocks(settle) / (1000 * clk_khz)
        if frame_s * rate_hz > 1:
            raise ValueError(f"rate_hz = {rate_hz:g} is too fast: a scan takes {1e6 * frame_s:.4g} us")
        return Scan(twin, settling, settle, 1 / rate_hz - frame_s)


class Through:
    """What is sampled of the taxels' values [frames, rows, columns], which are 0 while no row is driven.

    A multiplexed converter samples its inputs one after the other; that the later ones have more time to
    settle is left out, as is the clock between two rows in which none is driven.
    """

    def __init__(self, scan: Scan) -> None:
        self.twin = scan.twin
        (path,) = scan.settling.paths
        clock_s = 1 / (1000 * scan.twin.clk_khz)
        slot_s = clock_s * scan.twin.scan.slot(scan.settle)
        self.pins = front.held(path.pin, clock_s * scan.settle, slot_s, scan.idle_s)
        self.capacitors = front.Held(1.0, path.keep, path.keep, 1.0) if path.keep else None

    def next(self, values: Floats) -> Floats:
        twin, plan = self.twin, self.twin.scan
        wide = plan.groups * twin.channels * twin.lanes
        spare = ((0, 0), (0, 0), (0, wide - twin.columns))
        pins = np.pad(values, spare).reshape(len(values), twin.rows * plan.groups, -1)
        pins = self.pins.next(pins)
        if self.capacitors:
            pins = self.capacitors.next(pins.reshape(len(values), -1, twin.lanes))
        return pins.reshape(len(values), twin.rows, wide)[..., : twin.columns]
