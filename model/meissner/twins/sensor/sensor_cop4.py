"""Twin of rtl/sensor/msn_sensor_cop4.sv: centres of pressure and slip of four electrodes."""

import numpy as np

from meissner.twins.cop.cop4 import cop4
from meissner.twins.cop.cop_slip import CopSlip
from meissner.twins.slip.slip import State


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
