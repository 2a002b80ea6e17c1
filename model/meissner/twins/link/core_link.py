"""Twin of rtl/link/msn_core_link.sv: payloads of a core's results."""

from meissner.twins.link import packet as p


def payloads(events=(), cops=()):
    """(slip, cop) payloads, each with its frame, of ``events`` (frame, channel, p2p, state) and ``cops``
    (x, y, load, pressed)."""
    slip = [(frame, p.slip_event(channel, p2p, state)) for frame, channel, p2p, state in events]
    return slip, [(frame, p.cop_frame(*cop)) for frame, cop in enumerate(cops)]
