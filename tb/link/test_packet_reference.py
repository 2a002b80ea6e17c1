"""Packets and commands byte by byte, written out by hand from docs/link.md; checksums by zlib."""

import zlib

import numpy as np
import pytest

from meissner.link import bridge, packet
from meissner.link.cobs import encode
from meissner.link.decoder import Decoder
from meissner.link.packet_slip import packets


def with_crc(text):
    body = bytes.fromhex(text)
    return body + zlib.crc32(body).to_bytes(4, "little")


HEAD = "05 060504030201"  # number 261 mod 256, time 0x010203040506
LITERALS = [
    (packet.SLIP, packet.slip_event(0x0201, 0x050403, 2), "01", "0102 030405 02"),
    (packet.SLIP, packet.slip_event(65535, 7, 3), "01", "ffff 070000 03"),
    (packet.COP, packet.cop_frame(-2, 0x4000, 0x0504030201, True), "02", "feffff 004000 0102030405 01"),
    (packet.COP, packet.cop_frame(0x123456, -8388608, 0, False), "02", "563412 000080 0000000000 00"),
    (packet.HEALTH, packet.health(0x030201, 1), "04", "010203 01"),
    (packet.HEALTH, packet.health(9, 6), "04", "090000 06"),
    (packet.STATISTIC, packet.statistic(3, 0x07060504), "05", "03 04050607"),
    (packet.ANSWER, bridge.answer(0xA1, 2, 0x0214, 0x04030201), "10", "a1 02 1402 01020304"),
]


@pytest.mark.parametrize("kind, payload, code, text", LITERALS)
def test_packets_by_hand(kind, payload, code, text):
    expected = with_crc(f"{code} {HEAD} {text}")
    assert packet.packet(kind, 261, 0x7F_0102_0304_0506, payload) == expected


def test_an_image_by_hand():
    """Number 300 mod 256 in parts of two: three taxels."""
    assert [part.hex(" ") for part in packet.image_chunks(300, [1, 0x0203, 65535], 2)] == [
        "2c 00 00 00 00 01 00 03 02",
        "2c 01 02 00 00 ff ff",
    ]


FIELDS = [
    {"channel": 0x0201, "p2p": 0x050403, "state": 2},
    {"channel": 65535, "p2p": 7, "state": 3},
    {"x": -2, "y": 0x4000, "load": 0x0504030201, "pressed": True},
    {"x": 0x123456, "y": -8388608, "load": 0, "pressed": False},
    {"taxel": 0x030201, "faults": 1},
    {"taxel": 9, "faults": 6},
]


@pytest.mark.parametrize("literal, fields", list(zip(LITERALS, FIELDS)))
def test_the_host_reads_them_by_hand(literal, fields):
    found = Decoder().next(encode(with_crc(f"{literal[2]} {HEAD} {literal[3]}")))
    assert [(one.kind, one.number, one.time, one.fields) for one in found] == [
        (literal[0], 5, 0x010203040506, fields)
    ]


def test_slip_packets_by_hand():
    assert packets([(0x0A, 41, 2), (0x0B, 300, 3)]) == [
        with_crc("01 00 0a0000000000 0000 290000 02"),
        with_crc("01 01 0b0000000000 0000 2c0100 03"),
    ]


def test_a_command_by_hand():
    """Write 0x04030201 to 0x214 with tag 7, read 0x208 with tag 0x55: stuffed."""
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
    for text in ("02 07 1402 01020304", "01 07 1412 01020304"):  # no such operation; beyond 4095
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
