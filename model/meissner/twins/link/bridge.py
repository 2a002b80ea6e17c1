"""Bit-exact twin of rtl/link/msn_bridge.sv: register accesses as bytes on a serial line."""

import struct
import zlib

from meissner.twins.link.cobs import decode, stuff
from meissner.twins.shared import one_of, within

READ, WRITE = 0, 1
DONE, BUS_ERROR, NO_ANSWER = 0, 1, 2


def command(operation, tag, address, data=0):
    """The bytes of a request for an access."""
    one_of((READ, WRITE), operation=operation)
    within(address=(address, 0, 4095))
    body = struct.pack("<BBHI", operation, tag & 255, address, data)
    return stuff(body + struct.pack("<I", zlib.crc32(body)))


def answer(tag, status, address, data):
    """Payload of the answer's packet."""
    return struct.pack("<BBHI", tag, status, address, data)


def accesses(line):
    """Accesses that back-to-back bytes request: ([(operation, tag, address, data)], frames rejected).

    Each command is assumed to be answered before the next one ends.
    """
    found, rejected = [], 0
    for frame in line.split(b"\0")[:-1]:
        body = decode(frame[::-1])
        body = None if body is None else body[::-1]
        good = (
            body is not None and len(body) == 12 and zlib.crc32(body[:8]) == struct.unpack("<I", body[8:])[0]
        )
        fields = struct.unpack("<BBHI", body[:8]) if good else None
        if good and fields[0] < 2 and fields[2] < 4096:
            found.append(fields)
        else:
            rejected += bool(frame)
    return found, rejected
