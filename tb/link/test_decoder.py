"""The host's decoder: all types encoded and decoded, chunks cut anywhere, unknown types, payloads of wrong
length; corruption of any kind loses only the packets that it touches; random and mutated bytes never crash or
hang it and never give a packet that was not sent."""

import zlib

import numpy as np
import pytest

from meissner.twins.link import decoder as decoder_module
from meissner.twins.link import packet as p
from meissner.twins.link.cobs import MAX_BYTES, decode, encode
from meissner.twins.link.decoder import Decoder


def payloads(rng):
    wide = lambda bits: int(rng.integers(0, 1 << bits))
    yield p.SLIP, p.slip_event(wide(16), wide(24), wide(3))
    yield p.COP, p.cop_frame(wide(24) - (1 << 23), -wide(14), wide(40), wide(1))
    yield p.HEALTH, p.health(wide(24), wide(8))
    yield p.STATISTIC, p.statistic(wide(8), wide(32))
    yield p.CHANGE, p.state_change(wide(16), wide(24), wide(3), wide(3), wide(1))
    yield p.STATES, p.states([wide(3) for _ in range(1 + wide(6))])[0]
    yield p.CLASS, p.class_change(wide(16), wide(16), wide(32))
    yield p.ANSWER, bytes(rng.bytes(8))
    for payload in p.image_chunks(wide(8), rng.integers(0, 1 << 16, 150).tolist(), 64):
        yield p.IMAGE, payload
    yield 77, rng.bytes(20)  # a type that does not exist yet


def stream_of(rng, count):
    """Packets to send, and their frames."""
    sent = []
    while len(sent) < count:
        sent += [(kind, len(sent) + k, payload) for k, (kind, payload) in enumerate(payloads(rng))]
    packets = [p.packet(kind, number, number << 20, payload) for kind, number, payload in sent]
    return packets, [encode(packet) for packet in packets]


def bytes_of(packets):
    return [p.packet(q.kind, q.number, q.time, q.payload) for q in packets]


def test_all_types_there_and_back_in_any_pieces():
    rng = np.random.default_rng(1)
    packets, frames = stream_of(rng, 60)
    line = b"".join(frames)
    decoder = Decoder()
    cuts = np.sort(rng.integers(0, len(line), 200))
    got = [q for part in np.split(np.frombuffer(line, np.uint8), cuts) for q in decoder.next(part.tobytes())]
    assert bytes_of(got) == packets
    assert decoder.damaged == 0
    first = got[:11]
    assert first[0].fields.keys() == {"channel", "p2p", "state"}
    assert p.slip_event(**first[0].fields) == first[0].payload
    assert p.cop_frame(**first[1].fields) == first[1].payload
    assert p.health(**first[2].fields) == first[2].payload
    assert p.statistic(**first[3].fields) == first[3].payload
    assert p.state_change(**first[4].fields) == first[4].payload
    assert p.states(first[5].fields["states"]) == [first[5].payload]
    assert p.class_change(**first[6].fields) == first[6].payload
    images = [q.fields for q in first if q.kind == p.IMAGE]
    assert [i["first"] for i in images] == [0, 64, 128]
    assert [i["last"] for i in images] == [False, False, True]
    assert [len(i["taxels"]) for i in images] == [64, 64, 22]
    assert got[11].fields == {}


def test_payload_of_another_length_is_no_packet():
    for kind in p.KNOWN:
        for length in (0, 1, 2, 3, 6, 10, 14):
            if (kind, length) not in ((p.SLIP, 6), (p.CHANGE, 6)):
                decoder = Decoder()
                assert decoder.next(encode(p.packet(kind, 0, 0, bytes(length)))) == []
                assert decoder.damaged == 1


@pytest.mark.parametrize("kind", ["flip", "overwrite", "insert", "delete", "zero", "burst"])
def test_corruption_loses_only_the_packet_it_touches(kind):
    rng = np.random.default_rng(3)
    packets, frames = stream_of(rng, 40)
    for _ in range(400):
        hit = int(rng.integers(0, len(frames)))
        frame = bytearray(frames[hit])
        at = int(rng.integers(0, len(frame)))
        if kind == "flip":
            frame[at] ^= 1 << int(rng.integers(0, 8))
        elif kind == "overwrite":
            frame[at] = int(rng.integers(0, 256))
        elif kind == "insert":
            frame.insert(at, int(rng.integers(0, 256)))
        elif kind == "delete":
            del frame[at]
        elif kind == "zero":
            frame[at] = 0
        else:
            frame[at : at + 20] = rng.bytes(int(rng.integers(0, 300)))
        decoder = Decoder()
        got = bytes_of(decoder.next(b"".join([*frames[:hit], bytes(frame), *frames[hit + 1 :]])))
        others = packets[:hit] + packets[hit + 1 :]
        assert got in (packets, others)
        if got == others and 0 < hit < len(frames) - 1:
            assert decoder.damaged >= (bytes(frame).strip(b"\0") != b"")


def test_random_and_mutated_bytes(monkeypatch):
    """Every decoded packet was sent; no byte is decoded twice; a frame without end is not kept for ever."""
    looked = []
    monkeypatch.setattr(decoder_module, "decode", lambda frame: looked.append(len(frame)) or decode(frame))
    rng = np.random.default_rng(4)
    packets, frames = stream_of(rng, 30)
    sent, line = set(packets), b"".join(frames)
    decoder, found, given = Decoder(), 0, 0
    for round_ in range(2000):
        if round_ % 3 == 0:
            data = rng.integers(0, rng.choice([2, 4, 256]), rng.integers(0, 600)).astype(np.uint8)
        else:
            start = int(rng.integers(0, len(line) - 400))
            data = np.frombuffer(line[start : start + 400], np.uint8).copy()
            data[rng.integers(0, len(data), rng.integers(0, 5))] = rng.integers(0, 256)
        given += len(data)
        for q in decoder.next(data.tobytes()):
            body = bytes_of([q])[0]
            assert zlib.crc32(body[:-4]) == int.from_bytes(body[-4:], "little")
            assert body in sent
            found += 1
    assert found > 500
    assert decoder.damaged > 500
    assert given > 400_000 and 0 < sum(looked) <= given
    decoder.next(bytes([7]) * 10_000_000)
    assert len(decoder._frame) == MAX_BYTES + 2
    assert decoder.next(b"\0" + frames[0]) != []
