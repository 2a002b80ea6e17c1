"""Twin of rtl/link/msn_link_slip.sv: slip events of one channel as levels of the line."""

from meissner.twins.link.link import line_of
from meissner.twins.link.packet_slip import packets


def link_slip(events, p2p_bits=18, clk_hz=12_000_000, baud_hz=1_000_000):
    """The levels, one per clock, of events (time, p2p, state) sent back-to-back."""
    return line_of(packets(events, p2p_bits), clk_hz, baud_hz)
