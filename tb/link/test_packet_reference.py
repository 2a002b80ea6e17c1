"""Packets and commands byte by byte, written by hand from docs/link.md; checksums by zlib."""

import zlib

import numpy as np
import pytest

from meissner.twins.link import bridge, packet
from meissner.twins.link.cobs import decode, encode, stuff
from meissner.twins.link.decoder import Decoder
from meissner.twins.link.packet import packets
from meissner.twins.slip.slip_changes import Change


def with_crc(text):
    body = bytes.fromhex(text)
    return body + zlib.crc32(body).to_bytes(4, "little")


HEAD = "85 060504030201"  # number 389 mod 256, time 0x010203040506
LITERALS = [
    (packet.SLIP, packet.slip_event(0x0201, 0x050403, 2), "01", "0102 030405 02"),
    (packet.SLIP, packet.slip_event(65535, 7, 3), "01", "ffff 070000 03"),
    (packet.CHANGE, packet.state_change(0x0201, 0x050403, 1, 3, False), "06", "0102 030405 31"),
    (packet.CHANGE, packet.state_change(0, 9, 4, 1, True), "06", "0000 090000 94"),
    (packet.STATES, packet.states([1, 2, 3, 4, 0, 1])[0], "07", "0000 0600 21 43 10 00"),
    (packet.STATES, packet.states([2], 65535)[0], "07", "ffff 0100 02 00"),
    (packet.COP, packet.cop_frame(-2, 0x4000, 0x0504030201, True), "02", "feffff 004000 0102030405 01"),
    (packet.COP, packet.cop_frame(0x123456, -8388608, 0, False), "02", "563412 000080 0000000000 00"),
    (packet.HEALTH, packet.health(0x030201, 1), "04", "010203 01"),
    (packet.HEALTH, packet.health(9, 6), "04", "090000 06"),
    (packet.CLASS, packet.class_change(0x0201, 65535, 0x07060504), "08", "0102 ffff 04050607"),
    (packet.STATISTIC, packet.statistic(3, 0x07060504), "05", "03 04050607"),
    (packet.ANSWER, bridge.answer(0xA1, 2, 0x0214, 0x04030201), "10", "a1 02 1402 01020304"),
]


@pytest.mark.parametrize("kind, payload, code, text", LITERALS)
def test_packets_by_hand(kind, payload, code, text):
    expected = with_crc(f"{code} {HEAD} {text}")
    assert packet.packet(kind, 389, 0x7F_0102_0304_0506, payload) == expected


def test_an_image_by_hand():
    """Image number 300 mod 256, three taxels in parts of two."""
    assert [part.hex(" ") for part in packet.image_chunks(300, [1, 0x0203, 65535], 2)] == [
        "2c 00 00 00 00 01 00 03 02",
        "2c 01 02 00 00 ff ff",
    ]
    assert [part.hex(" ") for part in packet.image_chunks(128, [7, 8], 2)] == ["80 01 00 00 00 07 00 08 00"]


FIELDS = [
    {"channel": 0x0201, "p2p": 0x050403, "state": 2},
    {"channel": 65535, "p2p": 7, "state": 3},
    {"channel": 0x0201, "p2p": 0x050403, "state": 1, "told": 3, "late": False},
    {"channel": 0, "p2p": 9, "state": 4, "told": 1, "late": True},
    {"first": 0, "left": 6, "states": (1, 2, 3, 4, 0, 1)},
    {"first": 65535, "left": 1, "states": (2,)},
    {"x": -2, "y": 0x4000, "load": 0x0504030201, "pressed": True},
    {"x": 0x123456, "y": -8388608, "load": 0, "pressed": False},
    {"taxel": 0x030201, "faults": 1},
    {"taxel": 9, "faults": 6},
    {"label": 0x0201, "told": 65535, "votes": 0x07060504},
]


@pytest.mark.parametrize("literal, fields", list(zip(LITERALS, FIELDS)))
def test_the_host_reads_them_by_hand(literal, fields):
    found = Decoder().next(encode(with_crc(f"{literal[2]} {HEAD} {literal[3]}")))
    assert [(one.kind, one.number, one.time, one.fields) for one in found] == [
        (literal[0], 133, 0x010203040506, fields)
    ]


def test_slip_packets_by_hand():
    told = [Change(True, False, 1, 2), Change(True, False, 1, 3), Change(False, True, 3, 1)]
    assert packets([(0x0A, 41, told[0]), (0x0B, 300, told[1]), (0x0C, 5, told[2])]) == [
        with_crc("01 00 0a0000000000 0000 290000 02"),
        with_crc("01 01 0b0000000000 0000 2c0100 03"),
        with_crc("06 02 0c0000000000 0000 050000 b1"),
    ]


def test_a_command_by_hand():
    """Write 0x04030201 to 0x214 with tag 7; read 0x208 with tag 0x55; COBS encoded."""
    write = with_crc("01 07 1402 01020304")
    assert 0 not in write
    assert bridge.command(1, 7, 0x214, 0x04030201) == b"\0\x0d" + write + b"\0"
    assert bridge.accesses(b"\0\x0d" + write + b"\0") == ([(1, 7, 0x214, 0x04030201)], 0)
    read = with_crc("00 55 0802 00000000")
    assert 0 not in read[8:]
    line = bytes.fromhex("00 01 04 55 08 02 01 01 01 05") + read[8:] + b"\0"
    assert bridge.command(0, 0x55, 0x208) == line
    assert bridge.accesses(line) == ([(0, 0x55, 0x208, 0)], 0)


def test_what_is_no_command():
    for text in ("02 07 1402 01020304", "01 07 1412 01020304"):  # unknown operation; address above 4095
        body = with_crc(text)
        assert 0 not in body
        assert bridge.accesses(b"\0\x0d" + body + b"\0") == ([], 1)
    spoilt = bytearray(b"\0\x0d" + with_crc("01 07 1402 01020304") + b"\0")
    spoilt[-2] ^= 1
    assert bridge.accesses(bytes(spoilt)) == ([], 1)


def test_checksums_are_zlib_s():
    rng = np.random.default_rng(1)
    for length in (1, 12, 240):
        payload = rng.bytes(length)
        assert packet.packet(77, 1, 2, payload) == with_crc(f"4d 01 020000000000 {payload.hex()}")


# docs/link.md: each zero, and the end, is replaced by one more than the bytes since the zero before.
STUFFED = [
    ("01 00 02 03 00", "00 01 02 02 03 03 01 00"),
    ("00", "00 01 01 00"),
    ("00 00", "00 01 01 01 00"),
    ("07", "00 07 02 00"),
    ("07 00 09", "00 07 02 09 02 00"),
    ("ff " * 253, "00 " + "ff " * 253 + "fe 00"),
]


@pytest.mark.parametrize("packet_, line", STUFFED, ids=range(len(STUFFED)))
def test_stuffing_by_hand(packet_, line):
    assert encode(bytes.fromhex(packet_)) == bytes.fromhex(line)
    assert decode(bytes.fromhex(line)[1:-1]) == bytes.fromhex(packet_)


def test_plain_cobs_by_hand():
    """Host to core, where each code precedes its run."""
    assert stuff(bytes.fromhex("01 00 02 03 00")) == bytes.fromhex("00 02 01 03 02 03 01 00")
    assert stuff(bytes(1)) == bytes.fromhex("00 01 01 00")


def test_what_a_host_drops_by_hand():
    """Frames that do not decode, are under 12 bytes or have a wrong checksum are counted; empty ones are
    not."""
    whole, other = (encode(with_crc(f"63 {number} 000000000000 aa")) for number in ("07", "09"))
    least, short = encode(with_crc("63 08 000000000000")), encode(with_crc("63 08 0000000000"))
    spoilt = bytes([whole[0], whole[1] ^ 1]) + whole[2:]
    bad_end = whole[:-2] + bytes([len(whole) + 9, 0])
    for dropped, damaged in ((b"\0\0\0", 0), (short, 1), (spoilt, 1), (bad_end, 1), (b"\0\x05\x05\0", 1)):
        decoder = Decoder()
        assert [one.number for one in decoder.next(whole + dropped + other)] == [7, 9]
        assert decoder.damaged == damaged
    decoder = Decoder()
    assert [one.number for one in decoder.next(whole + least + other)] == [7, 8, 9]
    assert decoder.damaged == 0


def test_a_lost_zero_by_hand():
    """Each packet has its own zero on both sides: losing one costs nothing, losing both costs two packets."""
    frames = [encode(with_crc(f"63 0{number} 000000000000")) for number in (1, 2, 3)]
    one_lost = frames[0] + frames[1][1:] + frames[2]
    both_lost = frames[0][:-1] + frames[1][1:] + frames[2]
    assert [one.number for one in Decoder().next(one_lost)] == [1, 2, 3]
    decoder = Decoder()
    assert [one.number for one in decoder.next(both_lost)] == [3]
    assert decoder.damaged == 1


def test_a_known_type_of_another_length_is_dropped_and_an_unknown_is_passed():
    decoder = Decoder()
    found = decoder.next(encode(with_crc(f"04 {HEAD} 010203 01 00")) + encode(with_crc(f"63 {HEAD} 01")))
    assert [(one.kind, one.payload) for one in found] == [(0x63, b"\1")]
