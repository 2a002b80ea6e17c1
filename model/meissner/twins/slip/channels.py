"""Bit-exact twin of rtl/slip/msn_channels.sv: acquisition, then decisions about every channel."""

from meissner.twins.slip.slip_path import decide


def of_codes(codes, acquire, config, moving=None, mask=None):
    """Decisions about raw codes [channels, frames] taken by ``acquire`` (frontend.acquire.Acquire).

    ``config``, ``moving``, ``mask``: as in slip_path.decide; a mask only with a stream.
    """
    if mask is not None and acquire.part is not None:
        raise ValueError("a mask must go with a stream: a converter's samples have none")
    samples, _ = acquire.samples(codes)
    return decide(samples, config, moving, mask)
