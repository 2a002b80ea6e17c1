"""Bit-exact twin of rtl/link/msn_packet_slip.sv: the packets of slip events of one channel."""

from meissner.twins.link.packet import SLIP, packet, slip_event
from meissner.twins.shared import within


def packets(events, p2p_bits=24):
    """The packets of ``events``: tuples of time (of the convert start, clocks since reset), p2p, state."""
    within(p2p_bits=(p2p_bits, 1, 24))
    if any(not 0 <= p2p < 1 << p2p_bits for _, p2p, _ in events):
        raise ValueError(f"a peak-to-peak does not fit {p2p_bits} bits")
    return [
        packet(SLIP, number, time, slip_event(0, p2p, state))
        for number, (time, p2p, state) in enumerate(events)
    ]
