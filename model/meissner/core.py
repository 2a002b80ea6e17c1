"""Twin of rtl/msn_core.sv: the packets of whole frames of samples."""

from dataclasses import dataclass

import numpy as np

from meissner.cop.array import Array
from meissner.cop.cop4 import cop4
from meissner.cop.cop_slip import CopSlip
from meissner.frontend.calibration_preset import preset
from meissner.frontend.health import Limits
from meissner.link import packet as p
from meissner.slip.slip import State
from meissner.slip.slip_path import decide

OF_LOAD = 65535  # channel of a slip event that comes from the load of four electrodes


@dataclass(frozen=True)
class Expected:
    """Payloads in order, each with the index of its frame: ``slip``, ``cop``; ``images`` [frames, taxels]."""

    slip: list
    cop: list
    images: np.ndarray | None


def of_channels(samples, config, moving=None, mask=None, change=None):
    """Slip events of samples [frames, channels]; ``config``: SlipConfig.

    ``mask`` [frames, channels]: samples not to be trusted; ``change``: (frame, threshold) from which frame on
    another threshold holds.
    """
    found = decide(np.asarray(samples).T, config, moving, None if mask is None else mask.T, change)
    group = 1 << config.level
    events = [
        ((detail + 1) * group - 1, p.slip_event(channel, int(found.p2p[channel, detail]), state))
        for detail, channel in np.argwhere(found.raised.T)
        for state in [int(found.state[channel, detail])]
    ]
    return Expected(events, [], None)


def of_array(array, samples, slip=None, over=None):
    """Everything of samples [frames, rows, columns]; ``slip``: SlipConfig.

    ``array``: meissner.cop.array.Array; it keeps what it learns, as the core does.
    """
    forces, mask = array.forces(samples, over)
    x, y, load, pressed = array.cop.of_forces(forces)
    cops = [(n, p.cop_frame(*map(int, row))) for n, row in enumerate(zip(x, y, load, pressed))]
    images = forces.reshape(len(forces), -1)
    events = []
    if slip is not None:
        events = of_channels(images, slip, mask=mask.reshape(len(mask), -1)).slip
    return Expected(events, cops, images)


def of_electrodes(samples, registers, terms=None, lag=16, slip=None):
    """CoP frames and slip events of samples [frames, 4]; ``slip``: CopSlipRegisters."""
    found = cop4(samples, registers, correction=terms)
    rows = zip(found.x, found.y, found.load, found.pressed)
    cops = [(n, p.cop_frame(*map(int, row))) for n, row in enumerate(rows)]
    events = []
    if slip is not None:
        slips = CopSlip(lag, slip).process(found.x, found.y, found.load, found.pressed)
        events = [
            (int(n), p.slip_event(OF_LOAD, int(slips.octant[n]), State.INCIPIENT))
            for n in np.flatnonzero(slips.raised)
        ]
    return Expected(events, cops, None)


def samples_of(config, codes):
    """Signed samples of a converter's codes, and which were over range, of the same shape."""
    mask = (1 << config.part.data_bits) - 1
    return config.converter.samples(np.asarray(codes) & mask)


def array_from_reset(size, gain, limits=None, tare=None, **kinds):
    """meissner.cop.array.Array as a core has it from reset on: preset gains, the first tare asked for.

    ``size``: what has ``rows``, ``columns``, ``lanes``, ``sample_bits``; all else as Array takes it.
    """
    twin = Array(size, limits, tare, **kinds)
    table, row_column = twin.cop.calibrate.table, kinds.get("row_column", False)
    for of_row, word, offset, value in preset(size.rows, size.columns, size.lanes, gain, row_column):
        table.write_row(word, offset, value) if of_row else table.write(word, offset, value)
    twin.cop.calibrate.swap()
    if tare:
        twin.tare.tare(force=True)
    return twin


def array_of(config):
    """meissner.cop.array.Array of a configuration from reset on."""
    limits = tare = None
    if config.array["health"]:
        given = {k.removeprefix("health."): v for k, v in config.settings.items() if k.startswith("health.")}
        limits = Limits(**given)
    if config.array["tare"]:
        tare = {"contact": config.tare["contact_codes"], "step": config.tare["step"]}
    parameters, settings = config.parameters, config.settings
    kinds = {"row_column": bool(parameters["RowColumn"]), "gain_shift": parameters["GainShift"]}
    kinds |= {"min_load": settings["cop.min_load"]}
    return array_from_reset(config.scan, settings["calibrate.preset"], limits, tare, **kinds)


def expected(config, codes):
    """What a core of ``config`` says of whole frames of codes from reset on: shape as of engines.rtl_core."""
    samples, over = samples_of(config, codes)
    if config.kind == "array":
        return of_array(array_of(config), samples, config.slip, over)
    if config.kind == "electrodes":
        lag, slip = config.cop_slip or (16, None)
        return of_electrodes(samples, config.cop4.registers, config.cop4.terms, lag, slip)
    return of_channels(samples, config.slip)
