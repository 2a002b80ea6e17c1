"""Twins of rtl/sensor: msn_sensor_array.sv, forces, centres of pressure and faults of complete frames;
msn_sensor_channels.sv, samples in complete frames; msn_sensor_cop4.sv, centres and slip of electrodes."""

from dataclasses import dataclass

import numpy as np

from meissner.twins.cop.cop4 import cop4
from meissner.twins.cop.cop_slip import CopSlip
from meissner.twins.sensor.array_forces import ArrayForces
from meissner.twins.slip.slip import State


def sensor_channels(acquire, codes):
    """Samples [frames, channels] of ``codes`` of that shape: the gate changes their timing, not their values.

    ``acquire``: meissner.twins.frontend.acquire.Acquire.
    """
    samples, _ = acquire.samples(codes)
    return samples


def sensor_cop4(samples, registers, terms=None, lag=16, slip=None):
    """(x, y, load, pressed) and (state, raised, octant) of each frame of samples [frames, 4].

    ``registers``: Cop4Registers; ``terms``: of the correction; ``slip``: CopSlipRegisters or None.
    """
    found = cop4(samples, registers, correction=terms)
    cop = [tuple(map(int, row)) for row in zip(found.x, found.y, found.load, found.pressed)]
    if slip is None:
        return cop, []
    slips = CopSlip(lag, slip).process(found.x, found.y, found.load, found.pressed)
    states = np.where(slips.slip, State.INCIPIENT, np.where(found.pressed, State.CONTACT, State.NONE))
    return cop, list(zip(states.tolist(), slips.raised.tolist(), slips.octant.tolist()))


class Array(ArrayForces):
    """A scanned array; ``scan``: ScanAdc, ScanDemod or, of a stream, any object with ``rows`` and
    ``columns``, and ``lanes`` if there are several. The rest as in ArrayForces."""

    def __init__(self, scan, limits=None, tare=None, **kinds):
        lanes = getattr(scan, "lanes", 1)  # the demodulator gives one amplitude at a time
        super().__init__(scan.rows, scan.columns, lanes, limits, tare, **kinds)
        self.scan = scan

    def latency(self, settle, **given):
        """Clocks of each step, by name: the scan's, then ``health``, ``tare``, ``cop`` and two sums.

        ``compute``: from the last sample to the result; ``total``: from a frame's first convert start to the
        result. ``given``: further arguments of the scan's latency.
        """
        steps = self.scan.latency(settle, **given) | self.steps
        tail = sum(self.steps.values())
        return steps | {"compute": steps["out"] + tail, "total": steps["last_beat"] + tail}


@dataclass(frozen=True)
class Sensed:
    """``forces``, ``mask`` [frames, taxels]; ``cop``: (x, y, load, pressed) of each frame."""

    forces: np.ndarray
    mask: np.ndarray
    cop: list


def sensor_array(array, samples, over=None):
    """``Sensed`` of samples [frames, rows, columns]; ``array`` keeps its learned state, as the core does."""
    forces, mask = array.forces(samples, over)
    cop = [tuple(map(int, row)) for row in zip(*array.cops(forces))]
    return Sensed(forces.reshape(len(forces), -1), mask.reshape(len(mask), -1), cop)


def from_reset(scan, gain, limits=None, tare=None, **kinds):
    """Array as a core has it after reset: preset gains, the first tare requested. The rest as in Array."""
    twin = Array(scan, limits, tare, **kinds)
    twin.calibrate.table.preset = gain
    if tare:
        twin.tare.tare(force=True)
    return twin
