"""Engine ``rtl``: the Verilated core behind batch C++ drivers, complete numpy arrays in and out.

Each stage imports its driver on use, so a scene loads only those of its features.
"""


def watch(x, config, moving=None):
    """Run the slip path over ``x`` [channels, samples] with ``moving`` [samples]; returns Watched."""
    from meissner.engines import rtl_slip

    return rtl_slip.watch(x, config, moving)


def watch_pins(recording, config, waves=None):
    """Run a scene's recording through the pins of its converter; see rtl_slip."""
    from meissner.engines import rtl_slip

    return rtl_slip.watch_pins(recording, config, waves)


def windows(x, config, count):
    """(p2p, slip, first) [channels, windows]; ``first``: a tumbling window's first detail over, else 0."""
    from meissner.engines import rtl_slip

    return rtl_slip.windows(x, config, count)


def cop(forces, min_load=1, waves=None):
    """sum, mx, my, x, y, valid of each frame of ``forces`` [frames, rows, columns]."""
    from meissner.engines import rtl_cop

    return rtl_cop.cop(forces, min_load, waves)


def cop4(codes, config, waves=None):
    """``Cop4`` of codes [samples, 4] on the core for ``config`` (Cop4Config)."""
    from meissner.engines import rtl_cop4

    return rtl_cop4.cop4(codes, config, waves)


def cop_slip(codes, config, lag, registers, waves=None):
    """``Cop4`` and ``CopSlipResult`` of codes [samples, 4]: msn_cop4, then msn_cop_slip on its results."""
    from meissner.engines import rtl_cop4

    return rtl_cop4.cop_slip(codes, config, lag, registers, waves)


def demodulate(samples, carrier):
    """Amplitudes [...] of carriers [..., samples]; ``carrier``: meissner.engines.Carrier."""
    from meissner.engines import rtl_frontend

    return rtl_frontend.demodulate(samples, carrier)


def calibrate(codes, calibration):
    """Forces [frames, rows, columns] of codes; ``calibration``: meissner.calibration.Calibration."""
    from meissner.engines import rtl_frontend

    return rtl_frontend.calibrate(codes, calibration)
