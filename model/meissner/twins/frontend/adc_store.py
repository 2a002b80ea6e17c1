"""Bit-exact twin of rtl/frontend/msn_adc_store.sv."""

import numpy as np


def samples(codes, data_bits, sample_bits, signed):
    """Signed samples and over-range flags of raw ``codes``.

    An unsigned code is taken as it is, a two's complement code is sign-extended; a code at either end of the
    part's range is over-range.
    """
    if sample_bits < data_bits + (not signed):
        raise ValueError(f"sample_bits = {sample_bits} must hold a code of {data_bits} bits")
    codes = np.asarray(codes, dtype=np.int64)
    full = 1 << data_bits
    if np.any((codes < 0) | (codes >= full)):
        raise ValueError(f"a code does not fit {data_bits} bits")
    value = np.where(codes >= full // 2, codes - full, codes) if signed else codes
    bottom = -full // 2 if signed else 0
    return value, (value == bottom) | (value == bottom + full - 1)


def channels_of_word(word, channels, lanes, lane_channels, whole=False):
    """The channels whose codes arrive with ``word``, lane by lane (None: that lane's code is not used)."""
    if whole and lanes > 1:
        raise ValueError(f"lanes = {lanes} must be 1: whole waits for one lane's last word")
    arriving = [word + lane * lane_channels for lane in range(lanes)]
    return [channel if channel < channels else None for channel in arriving]
