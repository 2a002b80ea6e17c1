"""Bit-exact twin of rtl/link/msn_cobs.sv, and its inverse: frames without a zero, codes after their runs."""

MAX_BYTES = 253  # of a packet: longer runs would need a code for "no zero here"


def encode(packet):
    """The bytes on the line: 00, the packet with a distance for each zero and for its end, 00."""
    if not 1 <= len(packet) <= MAX_BYTES:
        raise ValueError(f"a packet of {len(packet)} bytes is not 1 .. {MAX_BYTES} long")
    frame, count = bytearray(b"\0"), 1
    for byte in packet:
        frame.append(byte or count)
        count = count + 1 if byte else 1
    return bytes(frame) + bytes([count, 0])


def decode(frame):
    """The packet in ``frame``, the bytes between two zeros; None if no packet encodes to these bytes."""
    if not 2 <= len(frame) <= MAX_BYTES + 1 or 0 in frame:
        return None
    packet = bytearray(frame[:-1])
    place = len(frame) - 1
    code = frame[place]
    while code <= place:
        place -= code
        code, packet[place] = packet[place], 0
    return bytes(packet) if code == place + 1 else None


def stuff(packet):
    """Plain COBS with its delimiters, as the core's bridge takes it: 00, codes before their runs, 00."""
    return b"\0" + encode(packet[::-1])[-2:0:-1] + b"\0"
