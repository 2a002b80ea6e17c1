"""Bit-exact twins of rtl/link/msn_packet.sv: the core's packets and their payloads; msn_packet_slip.sv: those
of one channel's changes; msn_crc32.sv: CRC-32, ISO-HDLC."""

import struct
import zlib

from meissner.twins.link.images import cut
from meissner.twins.link.states import report
from meissner.twins.shared import within

START, RESIDUE = 0xFFFFFFFF, 0xDEBB20E3


def crc32(values, bits=8, start=START):
    """The register after ``values`` of ``bits`` bits each, lowest first; the checksum is its complement."""
    within(bits=(bits, 1, 32))
    crc = start
    for value in values:
        for place in range(bits):
            feedback = (crc ^ value >> place) & 1
            crc = crc >> 1 ^ (0xEDB88320 if feedback else 0)
    return crc


KNOWN = SLIP, COP, IMAGE, HEALTH, STATISTIC, CHANGE, STATES, CLASS, ANSWER = 1, 2, 3, 4, 5, 6, 7, 8, 16
NO_CLASS = 65535  # before the first decision
TIMES = 1 << 48  # a packet's time counts modulo this
# The counters of a core's statistics by index, as msn_core joins them; docs/link.md has the same names.
COUNTERS = (
    *("frames dropped", "overruns", "time-outs", "slip frames damaged", "slip blanked"),
    *("CoP frames damaged", "images dropped", "commands rejected", "slip changes lost"),
)


def packet(kind, number, time, payload):
    """The bytes of a packet: type, number mod 256, time in clocks mod 2**48, payload, CRC-32 of it all."""
    head = struct.pack("<BBQ", kind, number & 255, time % TIMES)[:8]
    return head + payload + struct.pack("<I", zlib.crc32(head + payload))


def slip_event(channel, p2p, state):
    """Payload: channel 16, peak-to-peak 24, state 8 bits."""
    return struct.pack("<HI", channel, p2p)[:5] + bytes([state])


def state_change(channel, p2p, state, told, late=False):
    """Payload: the same, with the state that the host had of the channel in bits 4 .. 6 of the last byte and
    ``late`` in bit 7."""
    return slip_event(channel, p2p, state | told << 4 | late << 7)


def change_of(channel, p2p, change):
    """(type, payload) of a twins.slip.slip_changes.Change."""
    if change.start:
        return SLIP, slip_event(channel, p2p, change.state)
    return CHANGE, state_change(channel, p2p, change.state, change.told, change.late)


def states(of_channels, first=0):
    """Payloads of the states of all channels: first channel 16, channels left 16, four states per 16 bits."""
    return [
        struct.pack(f"<HH{len(words)}H", at, left, *words) for at, left, words in report(of_channels, first)
    ]


def cop_frame(x, y, load, pressed):
    """Payload: x and y, signed 24, load 40, pressed 8 bits."""
    sides = [struct.pack("<i", value)[:3] for value in (x, y)]
    return b"".join(sides) + struct.pack("<Q", load)[:5] + bytes([bool(pressed)])


def class_change(label, told, votes):
    """Payload: the class 16, the one that the host had 16 (65535: none), its votes 32 bits."""
    return struct.pack("<HHI", label, told, votes)


def health(taxel, faults):
    """Payload: taxel 24, faults 8 bits."""
    return struct.pack("<I", taxel)[:3] + bytes([faults])


def statistic(index, counter):
    """Payload: the counter's index 8, its value 32 bits."""
    return struct.pack("<BI", index, counter)


def image_chunks(number, taxels, chunk=64):
    """Payloads of an image: its number mod 256 and 1 in the last chunk (8 bits each), index of the chunk's
    first taxel 24, taxels 16 bits each."""
    payloads = []
    for first, final, part in cut(taxels, chunk):
        head = struct.pack("<BBI", number & 255, final, first)[:5]
        payloads.append(head + struct.pack(f"<{len(part)}H", *part))
    return payloads


def packets(changes, p2p_bits=24):
    """The packets of ``changes`` of channel 0: (time of the convert start since reset, p2p, Change)."""
    within(p2p_bits=(p2p_bits, 1, 24))
    if any(not 0 <= p2p < 1 << p2p_bits for _, p2p, _ in changes):
        raise ValueError(f"a peak-to-peak does not fit {p2p_bits} bits")
    found = [(time, *change_of(0, p2p, change)) for time, p2p, change in changes]
    return [packet(kind, number, time, payload) for number, (time, kind, payload) in enumerate(found)]
