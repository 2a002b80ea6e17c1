"""Bit-exact twins of rtl/cop/msn_cop4.sv, position and load from the codes of the four electrodes, and of
msn_electrodes.sv, which passes complete frames of them."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meissner.twins.common.ratio import ratio
from meissner.twins.cop.cop4_correct import LOAD_SHIFT, SHIFT_TOP, cop4_correct
from meissner.twins.shared import LOAD_BITS, fits, within

SCALE_BITS = 17  # of kx, ky, kf


def check_sample_bits(sample_bits):
    """Raise ValueError unless the RTL can be built for samples of this many bits."""
    within(sample_bits=(sample_bits, 4, 24))


def check_samples(samples, sample_bits):
    """``samples`` as int64 [n, 4] if they fit the RTL's input; ValueError if not."""
    samples = np.asarray(samples, dtype=np.int64)
    if samples.ndim != 2 or samples.shape[1] != 4:
        raise ValueError(f"the codes of E1..E4 must have the shape [samples, 4], not {samples.shape}")
    half = 1 << sample_bits - 1
    outside = samples[(samples < -half) | (samples >= half)]
    if outside.size:
        raise ValueError(f"code {outside[0]} lies outside {-half} .. {half - 1}")
    return samples


@dataclass(frozen=True)
class Cop4Registers:
    """The registers of msn_cop4, in codes unless stated otherwise.

    ``rail``: 2V0; ``kx`` / 2**``shift_x`` = Cx, ``ky`` / 2**``shift_y`` = Cy;
    ``kf`` / 2**(8 + ``shift_load``) = Kf / (65536 LSBs); ``min_load``: LSBs; ``top``: the converter's largest
    code; ``idle``, ``busy``: levels of an electrode without and with current; ``imbalance``: the largest
    difference between the two expressions of the current.
    """

    rail: int
    kx: int
    shift_x: int
    ky: int
    shift_y: int
    kf: int
    shift_load: int
    top: int
    idle: int
    busy: int
    imbalance: int
    min_load: int = 1

    def check(self, sample_bits=17):
        """Raise ValueError unless every value fits its register."""
        check_sample_bits(sample_bits)
        half = 1 << sample_bits - 1
        limits = dict.fromkeys(("kx", "ky", "kf"), (0, (1 << SCALE_BITS) - 1))
        limits |= dict.fromkeys(("shift_x", "shift_y", "shift_load"), (0, SHIFT_TOP))
        limits |= dict.fromkeys(("idle", "busy"), (-half, half - 1))
        limits |= {"rail": (0, 2 * half - 1), "top": (0, half - 1), "imbalance": (0, 4 * half - 1)}
        limits |= {"min_load": (0, (1 << LOAD_BITS) - 1)}
        fits(self, **limits)


class Cop4(NamedTuple):
    """Results [n]: ``x``, ``y`` int32 Q2.14, ``load`` int64 LSBs, flags bool; bit 0 of ``open`` is E1."""

    x: NDArray[np.int32]
    y: NDArray[np.int32]
    load: NDArray[np.int64]
    pressed: NDArray[np.bool_]
    over: NDArray[np.bool_]
    saturated: NDArray[np.bool_]
    imbalance: NDArray[np.bool_]
    open: NDArray[np.int64]


def totals(samples, registers):
    """E1-E3, E2-E4, N, M, D [n] of samples [n, 4]."""
    e1, e2, e3, e4 = np.asarray(samples, dtype=np.int64).T
    return e1 - e3, e2 - e4, registers.rail - e1 - e3, registers.rail + e2 + e4, e1 + e3 - e2 - e4


def faults(samples, registers):
    """saturated, imbalance (bool [n]) and open (int [n], bit 0 for E1) of samples [n, 4]."""
    samples = np.asarray(samples, dtype=np.int64)
    _, _, n, m, _ = totals(samples, registers)
    upper = np.where([False, True, False, True], -1 - samples, samples)  # as if all were upper electrodes
    idle, busy = upper >= registers.idle, upper <= registers.busy
    opened = (idle & busy[:, [2, 3, 0, 1]]) @ np.array([1, 2, 4, 8])
    saturated = ((samples >= registers.top) | (samples <= -registers.top - 1)).any(axis=1)
    return saturated, abs(n - m) > registers.imbalance, opened


def position(samples, registers):
    """x, y [n] in Q2.14, whether they are valid or not."""
    dx, dy, n, m, _ = totals(samples, registers)
    x = ratio(registers.kx, np.where(n > 0, dx, 0), n << registers.shift_x)
    y = ratio(registers.ky, np.where(m > 0, dy, 0), m << registers.shift_y)
    return x, y


def results(samples, registers, x, y, load):
    """``Cop4`` with position and load gated by the minimum load and the faults."""
    saturated, imbalance, opened = faults(samples, registers)
    over = load >= 1 << LOAD_BITS
    load = np.minimum(load, (1 << LOAD_BITS) - 1)
    pressed = (load > 0) & (load >= registers.min_load) & ~saturated & ~imbalance & (opened == 0)
    x, y = (np.where(pressed, value, 0).astype(np.int32) for value in (x, y))
    return Cop4(x, y, load, pressed, over, saturated, imbalance, opened)


def cop4(samples, registers, sample_bits=17, correction=None):
    """Position, load and faults of ``samples`` [n, 4], the codes of E1..E4: ``Cop4``.

        x = Cx (E1-E3) / N     y = Cy (E2-E4) / M     load = Kf N / D

    N = 2V0-E1-E3, M = 2V0+E2+E4, D = E1+E3-E2-E4. Each result is rounded once, to nearest, ties away from
    zero; x and y saturate at +-1.0, the load at 65535 LSBs. Against the formula on the same codes, the error
    of x is below 0.5 + |x| (1/8 + 8192/N) LSBs of Q2.14 (1/8: kx, for Cx of 2 or more; 8192/N: 2V0 as a whole
    code), that of the load below 0.5 + load (1/2kf + 1/2N) of its LSBs. N above 2V0, which no sensor gives,
    saturates at 2V0 in the load's numerator.

    ``correction``: cop4_correct.CorrectionRegisters of a core built with Correct, which removes the layers'
    own voltage drop from D. Its shift must equal the load's (LOAD_SHIFT + shift_load).
    """
    registers.check(sample_bits)
    samples = check_samples(samples, sample_bits)
    _, _, n, _, d = totals(samples, registers)
    x, y = position(samples, registers)
    n = np.clip(n, 0, registers.rail)
    den = d << LOAD_SHIFT + registers.shift_load
    if correction is not None:
        if correction.shift != LOAD_SHIFT + registers.shift_load:
            raise ValueError(
                f"the correction's shift, {correction.shift}, must equal the load's, "
                f"{LOAD_SHIFT + registers.shift_load}"
            )
        den = cop4_correct(x, y, n, d, correction)
    return results(samples, registers, x, y, ratio(registers.kf, n, den, LOAD_BITS))


def electrodes(beats, sample_bits=17):
    """([(e1, e2, e3, e4)] of complete frames, number of damaged ones) of ``beats``: (data, id, last)."""
    within(sample_bits=(sample_bits, 2, None))
    found, frame, lost = [], [], 0
    for data, channel, last in beats:
        frame.append((channel, data))
        if last:
            whole = [channel for channel, _ in frame] == [0, 1, 2, 3]
            found += [tuple(data for _, data in frame)] if whole else []
            lost += not whole
            frame = []
    whole_so_far = [channel for channel, _ in frame] == list(range(len(frame))) and len(frame) < 4
    return found, lost + (not whole_so_far)
