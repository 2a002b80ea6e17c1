"""Twin of rtl/link/msn_core_link.sv: payloads of what a core has to say."""

from meissner.twins.link import packet as p


def payloads(events=(), cops=()):
    """(slip, cop) of events (frame, channel, p2p, state) and (x, y, load, pressed), each with its frame."""
    slip = [(frame, p.slip_event(channel, p2p, state)) for frame, channel, p2p, state in events]
    return slip, [(frame, p.cop_frame(*cop)) for frame, cop in enumerate(cops)]
