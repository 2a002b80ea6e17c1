"""Engine ``fixed``: the integer twins, vectorised; bit-exact with the RTL.

Each function imports its twins on use, so a scene loads only those of its features.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meissner.arrays import Arrays, Bools, Ints
from meissner.engines import Carrier, Watched, moving_of_details
from meissner.engines.protocol import ElectrodesSlip, Windows
from meissner.twins.slip.config import SlipConfig

if TYPE_CHECKING:
    from meissner.calibration import Calibration
    from meissner.physics.cop4_config import Cop4Config
    from meissner.twins.cop.cop4 import Cop4
    from meissner.twins.cop.cop_slip import CopSlipRegisters


def watch(x: Ints, config: SlipConfig, moving: Bools | None = None) -> Watched:
    """Run the slip path over ``x`` [channels, samples] with ``moving`` [samples]; returns Watched."""
    from meissner.twins.slip.slip_path import decide

    detail_count = x.shape[1] >> config.level
    found = decide(x, config, moving_of_details(moving, config.level, detail_count))
    over = found.p2p > config.threshold
    return Watched(p2p=found.p2p, over=over, state=found.state, end=found.end, blanked=found.blanked)


def windows(x: Ints, config: SlipConfig, count: int) -> Windows:
    """(p2p, slip, first) [channels, windows]; ``first``: a tumbling window's first detail over, else 0."""
    from meissner.twins.slip.peak_to_peak import sliding
    from meissner.twins.slip.slip_path import details

    group = 1 << config.level
    span, hop = config.window // group, config.hop // group
    shape = (len(x), count)
    p2p = np.empty(shape, dtype=np.int64)
    first = np.zeros(shape, dtype=np.int64)
    # In pieces that fit the cache: four times faster on long recordings.
    piece = max(1, (1 << 15) // (config.hop * len(x)))
    for start in range(0, count, piece):
        stop = min(count, start + piece)
        last = (stop - 1) * config.hop + config.window
        detail, _ = details(x, config, start=start * config.hop, stop=last)
        if hop == span:
            part = detail.reshape(len(x), stop - start, span)
            p2p[:, start:stop] = part.max(axis=2) - part.min(axis=2)
            channels, hits = np.nonzero(p2p[:, start:stop] > config.threshold)
            if len(hits):
                crossing = part[channels, hits]
                running = np.maximum.accumulate(crossing, axis=1) - np.minimum.accumulate(crossing, axis=1)
                first[channels, start + hits] = np.argmax(running > config.threshold, axis=1)
        else:
            p2p[:, start:stop] = sliding(detail, span)[:, span - 1 :: hop]
    return p2p, p2p > config.threshold, first


def cop(forces: NDArray[np.uint16], min_load: int = 1) -> Arrays:
    """sum, mx, my, x, y, valid of each frame of ``forces`` [frames, rows, columns]."""
    from meissner.twins.cop.cop import cop_divide, moments

    frames, rows, columns = forces.shape
    sums = np.empty((3, frames), dtype=np.int64)
    piece = max(1, (1 << 17) // (rows * columns))  # fits the cache as int64
    for start in range(0, frames, piece):
        sums[:, start : start + piece] = moments(forces[start : start + piece])
    total, mx, my = sums
    x, y, valid = cop_divide(total, mx, my, rows, columns, min_load=min_load)
    return {"sum": total, "mx": mx, "my": my, "x": x, "y": y, "valid": valid}


def cop4(codes: Ints, config: "Cop4Config") -> "Cop4":
    """``Cop4`` of codes [samples, 4]; ``config``: Cop4Config."""
    from meissner.twins.cop import cop4 as electrodes

    return electrodes.cop4(codes, config.registers, config.sample_bits, config.terms)


def cop_slip(codes: Ints, config: "Cop4Config", lag: int, registers: "CopSlipRegisters") -> ElectrodesSlip:
    """``Cop4`` and ``CopSlipResult`` of codes [samples, 4]; ``registers``: CopSlipRegisters."""
    from meissner.twins.cop.cop_slip import CopSlip

    found = cop4(codes, config)
    return found, CopSlip(lag, registers).process(found.x, found.y, found.load, found.pressed)


def demodulate(samples: Ints, carrier: Carrier) -> Ints:
    """Amplitudes [...] of carriers [..., samples]; ``carrier``: meissner.engines.Carrier."""
    return carrier.block.amplitude(np.asarray(samples)[..., carrier.skip :], carrier.shift)[0]


def calibrate(codes: NDArray[np.int32], calibration: "Calibration") -> NDArray[np.uint16]:
    """Forces of codes; ``calibration``: meissner.calibration.Calibration."""
    from meissner.twins.frontend.calibrate import forces as calibrated

    offset, gain, dead = calibration.offset, calibration.gain, calibration.dead
    return calibrated(codes, offset, gain, calibration.gain_shift, mask=dead)
