"""Bit-exact twins of rtl/link/msn_link.sv: payloads of a core's results, packets to levels of the line and
back; and msn_link_slip.sv: changes of one channel as levels."""

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


def payloads(changes=(), cops=()):
    """([(frame, type, payload)] of ``changes`` (frame, channel, p2p, Change), [(frame, payload)] of ``cops``
    (x, y, load, pressed))."""
    found = [(frame, *p.change_of(channel, p2p, change)) for frame, channel, p2p, change in changes]
    return found, [(frame, p.cop_frame(*cop)) for frame, cop in enumerate(cops)]


def link_slip(changes, p2p_bits=18, clk_hz=12_000_000, baud_hz=1_000_000):
    """The levels, one per clock, of changes (time, p2p, Change) sent back-to-back."""
    return line_of(packets(changes, p2p_bits), clk_hz, baud_hz)
