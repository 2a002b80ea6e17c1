"""The host's side of docs/link.md: packets from the bytes of a line, valid or not."""

import struct
import zlib
from dataclasses import dataclass

from meissner.twins.link import packet as p
from meissner.twins.link.cobs import MAX_BYTES, decode
from meissner.twins.link.states import CHUNK


@dataclass(frozen=True)
class Packet:
    """``kind``: a type of link.packet; ``time``: clocks; ``fields``: the payload's, {} for unknown types."""

    kind: int
    number: int
    time: int
    payload: bytes
    fields: dict


def fields_of(kind, payload):
    """The payload's fields by name; {} for an unknown type; None if the length does not fit the type."""
    size = {p.SLIP: 6, p.CHANGE: 6, p.COP: 12, p.HEALTH: 4, p.STATISTIC: 5, p.CLASS: 8, p.ANSWER: 8}.get(
        kind, len(payload)
    )
    if size != len(payload):
        return None
    if kind == p.SLIP:
        channel, low, high, state = struct.unpack("<HHBB", payload)
        return {"channel": channel, "p2p": low | high << 16, "state": state}
    if kind == p.CHANGE:
        channel, low, high, state = struct.unpack("<HHBB", payload)
        told, late = state >> 4 & 7, bool(state >> 7)
        return {"channel": channel, "p2p": low | high << 16, "state": state & 7, "told": told, "late": late}
    if kind == p.STATES:
        if len(payload) < 6:
            return None
        first, left = struct.unpack("<HH", payload[:4])
        count = min(CHUNK, left)
        if len(payload) != 4 + 2 * -(-count // 4):
            return None
        states = [byte >> shift & 7 for byte in payload[4:] for shift in (0, 4)]
        return {"first": first, "left": left, "states": tuple(states[:count])}
    if kind == p.COP:
        x, y = (int.from_bytes(payload[at : at + 3], "little", signed=True) for at in (0, 3))
        load = int.from_bytes(payload[6:11], "little")
        return {"x": x, "y": y, "load": load, "pressed": bool(payload[11] & 1)}
    if kind == p.HEALTH:
        return {"taxel": int.from_bytes(payload[:3], "little"), "faults": payload[3]}
    if kind == p.STATISTIC:
        return dict(zip(("index", "counter"), struct.unpack("<BI", payload)))
    if kind == p.CLASS:
        return dict(zip(("label", "told", "votes"), struct.unpack("<HHI", payload)))
    if kind == p.ANSWER:
        return dict(zip(("tag", "status", "address", "data"), struct.unpack("<BBHI", payload)))
    if kind == p.IMAGE:
        if len(payload) < 7 or len(payload) % 2 == 0:
            return None
        taxels = struct.unpack(f"<{(len(payload) - 5) // 2}H", payload[5:])
        first = int.from_bytes(payload[2:5], "little")
        return {"image": payload[0], "last": bool(payload[1] & 1), "first": first, "taxels": taxels}
    return {}


class Decoder:
    """``next`` takes bytes, split anywhere, and returns the packets that they complete.

    ``damaged``: number of invalid frames. Lost packets are counted by host.boots, which knows resets.
    """

    def __init__(self):
        self.reset()

    def reset(self):
        self._frame, self.damaged = bytearray(), 0

    def next(self, data):
        found = []
        for piece in bytes(data).split(b"\0")[:-1]:
            self._frame += piece[: MAX_BYTES + 2]
            if self._frame:
                packet = self._packet(bytes(self._frame[: MAX_BYTES + 2]))
                self.damaged += packet is None
                found += [packet] if packet else []
            self._frame.clear()
        # Of an overlong frame, only enough bytes are kept to make it invalid.
        rest = bytes(data).rsplit(b"\0", 1)[-1]
        self._frame += rest[: max(0, MAX_BYTES + 2 - len(self._frame))]
        return found

    def _packet(self, frame):
        body = decode(frame)
        if body is None or len(body) < 12 or zlib.crc32(body[:-4]) != int.from_bytes(body[-4:], "little"):
            return None
        kind, number, time = body[0], body[1], int.from_bytes(body[2:8], "little")
        payload = body[8:-4]
        fields = fields_of(kind, payload)
        if fields is None:
            return None
        return Packet(kind, number, time, payload, fields)
