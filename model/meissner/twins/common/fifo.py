"""Bit-exact twin of rtl/common/msn_fifo.sv: every entry leaves unchanged, in order."""


def fifo(entries, depth=16, width=8):
    """The entries that leave the FIFO."""
    if depth < 2 or depth & (depth - 1):
        raise ValueError(f"depth = {depth} must be a power of two, 2 or more")
    if width < 1:
        raise ValueError(f"width = {width} must be at least 1")
    return [entry & (1 << width) - 1 for entry in entries]
