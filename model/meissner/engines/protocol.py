"""The functions of every engine module: the same work by float, twins, the Verilated RTL and its netlist."""

from typing import Any, Protocol

import numpy as np


class Engine(Protocol):
    """A module of meissner.engines; those of names.VERILATED also take ``waves``, the path of a VCD file."""

    def watch(self, x, config, moving=None) -> Any:
        """``Watched`` of samples ``x`` [channels, samples] with ``moving`` [samples]."""

    def windows(self, x, config, count) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """p2p, slip and first detail over [channels, windows] of ``count`` windows: see ``process_slip``."""

    def cop(self, forces, min_load=1) -> dict[str, np.ndarray]:
        """sum, mx, my, x, y, valid of each frame of ``forces`` [frames, rows, columns]."""

    def cop4(self, codes, config) -> Any:
        """twins.cop.cop4.Cop4 of codes [samples, 4]; ``config``: Cop4Config."""

    def cop_slip(self, codes, config, lag, registers) -> tuple[Any, Any]:
        """Cop4 and twins.cop.cop_slip.CopSlipResult; ``registers``: CopSlipRegisters."""

    def demodulate(self, samples, carrier) -> np.ndarray:
        """Amplitudes [...] of carriers [..., samples]; ``carrier``: meissner.engines.Carrier."""

    def calibrate(self, codes, calibration) -> np.ndarray:
        """Forces of codes [frames, rows, columns]; ``calibration``: meissner.calibration.Calibration."""
