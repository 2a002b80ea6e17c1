"""The functions of every engine module: the same work by float, twins, the Verilated RTL and its netlist."""

from collections.abc import Callable
from importlib import import_module
from os import PathLike
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from meissner.arrays import Arrays, Bools, Floats, Ints
from meissner.twins.slip.config import SlipConfig

if TYPE_CHECKING:
    from meissner.calibration import Calibration
    from meissner.engines import Carrier, Watched
    from meissner.physics.cop4_config import Cop4Config
    from meissner.twins.cop.cop4 import Cop4
    from meissner.twins.cop.cop_slip import CopSlipRegisters, CopSlipResult

ElectrodesSlip = tuple["Cop4", "CopSlipResult"]
Waves = str | PathLike[str] | None  # path of a VCD file
Windows = tuple[Ints | Floats, Bools, Ints]  # p2p, slip, first detail over


def found_in(places: dict[str, str]) -> Callable[[str], Any]:
    """``__getattr__`` of an engine: {function: module of this package}, loaded on use.

    So a scene imports only what it runs.
    """

    def get(name: str) -> Any:
        if name not in places:
            raise AttributeError(f"this engine has no {name}")
        return getattr(import_module(f"meissner.engines.{places[name]}"), name)

    return get


class PinScene(Protocol):
    """What a run at the converter's pins needs of a scene; ``adc_part``: a part of physics.adc."""

    @property
    def adc_part(self) -> str: ...

    @property
    def rate_hz(self) -> int: ...


class PinRecording(Protocol):
    """What it needs of a recording: ``codes``, ``moving`` [samples]."""

    @property
    def scene(self) -> PinScene: ...

    @property
    def codes(self) -> Ints: ...

    @property
    def moving(self) -> Bools: ...


class Engine(Protocol):
    """A module of meissner.engines; those of names.VERILATED also take ``waves``, the path of a VCD file."""

    def watch(self, x: Ints, config: SlipConfig, moving: Bools | None = None) -> "Watched":
        """``Watched`` of samples ``x`` [channels, samples] with ``moving`` [samples]."""

    def windows(self, x: Ints, config: SlipConfig, count: int) -> Windows:
        """p2p, slip and first detail over [channels, windows] of ``count`` windows: see ``process_slip``."""

    def cop(self, forces: NDArray[np.uint16], min_load: int = 1) -> Arrays:
        """sum, mx, my, x, y, valid of each frame of ``forces`` [frames, rows, columns]."""

    def cop4(self, codes: Ints, config: "Cop4Config") -> "Cop4":
        """Position, load and faults of codes [samples, 4]."""

    def cop_slip(
        self, codes: Ints, config: "Cop4Config", lag: int, registers: "CopSlipRegisters"
    ) -> "ElectrodesSlip":
        """The same, and slip of each sample."""

    def demodulate(self, samples: Ints, carrier: "Carrier") -> Ints:
        """Amplitudes [...] of carriers [..., samples]."""

    def calibrate(self, codes: NDArray[np.int32], calibration: "Calibration") -> NDArray[np.uint16] | Floats:
        """Forces of codes [frames, rows, columns]."""
