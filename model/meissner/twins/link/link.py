"""Bit-exact twins of rtl/link/msn_link.sv: payloads of a core's results, packets to levels of the line and
back; and msn_link_slip.sv: slip events of one channel as levels."""

from meissner.twins.link import packet as p
from meissner.twins.link.cobs import encode
from meissner.twins.link.decoder import Decoder
from meissner.twins.link.packet import packets
from meissner.twins.link.uart import UartRx, levels


def line_of(packets, clk_hz=25_000_000, baud_hz=3_000_000):
    """The levels of the line, one per clock, for packets sent back-to-back."""
    return levels(b"".join(map(encode, packets)), clk_hz, baud_hz)


def packets_of(line, clk_hz=25_000_000, baud_hz=3_000_000):
    """(packets, the decoder that read them) from the levels of a line that is idle at the start."""
    decoder = Decoder()
    found = UartRx(clk_hz, baud_hz).process(line)
    return decoder.next(bytes(byte for _, byte in found if byte is not None)), decoder


def payloads(events=(), cops=()):
    """(slip, cop) payloads, each with its frame, of ``events`` (frame, channel, p2p, state) and ``cops``
    (x, y, load, pressed)."""
    slip = [(frame, p.slip_event(channel, p2p, state)) for frame, channel, p2p, state in events]
    return slip, [(frame, p.cop_frame(*cop)) for frame, cop in enumerate(cops)]


def link_slip(events, p2p_bits=18, clk_hz=12_000_000, baud_hz=1_000_000):
    """The levels, one per clock, of events (time, p2p, state) sent back-to-back."""
    return line_of(packets(events, p2p_bits), clk_hz, baud_hz)
