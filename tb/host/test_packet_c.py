"""host/msn_packet.c against the host's decoder in Python, packet by packet and counter by counter: every
known type and unknown ones, every payload length; complete, mutated, cut and random streams. Built with all
warnings as errors, and with the sanitizers where available, so that a read outside a frame fails."""

import struct
import subprocess
import zlib
from itertools import pairwise

import numpy as np
import pytest

from meissner.builds.toolchain import ROOT
from meissner.twins.link import packet as p
from meissner.twins.link.cobs import encode
from meissner.twins.link.decoder import Decoder

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-Wconversion")
SANITIZERS = ("-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")


@pytest.fixture(scope="module")
def decode_c(tmp_path_factory):
    program = tmp_path_factory.mktemp("c") / "decode"
    sources = [ROOT / "host/msn_packet.c", ROOT / "tb/host/packet_main.c"]
    command = ["cc", *STRICT, "-I", ROOT / "host", *sources, "-o", program]
    if subprocess.run([*command, *SANITIZERS], capture_output=True).returncode:
        done = subprocess.run([*command, "-O2"], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr

    def decode(line):
        done = subprocess.run([program], input=line, capture_output=True)
        assert done.returncode == 0, done.stderr.decode()
        return done.stdout.decode().splitlines()

    return decode


def expected(line):
    decoder, lines = Decoder(), []
    packets = decoder.next(line)
    for q in packets:
        values = q.fields.values() if q.fields else q.payload
        flat = [n for value in values for n in (value if isinstance(value, tuple) else (value,))]
        lines.append(" ".join(str(int(n)) for n in (q.kind, q.number, q.time, *flat)))
    missed = sum((later.number - q.number - 1) % 256 for q, later in pairwise(packets))
    return [*lines, f"damaged {decoder.damaged} missed {missed}"]


def frames(rng, count):
    """Frames of packets of every type and payload length, valid and invalid."""
    lengths = {p.SLIP: 6, p.CHANGE: 6, p.COP: 12, p.HEALTH: 4, p.STATISTIC: 5, p.CLASS: 8, p.ANSWER: 8}
    for number in range(count):
        kind = int(rng.choice([*p.KNOWN, 0, 77]))
        lengths[p.STATES] = 4 + 2 * int(rng.integers(1, 33))
        length = lengths.get(kind, int(rng.integers(0, 242)))
        if rng.random() < 0.2:
            length = int(rng.integers(0, 242))
        payload = rng.choice([0, 1, 255, *rng.integers(0, 256, 5)], length).astype(np.uint8).tobytes()
        if kind == p.STATES and rng.random() < 0.8:  # often as many channels as the length says, or one more
            payload = (
                payload[:2] + struct.pack("<H", max(0, 2 * length - 8) + int(rng.integers(2))) + payload[4:]
            )
        yield encode(p.packet(kind, number * int(rng.integers(1, 3)), int(rng.integers(0, 1 << 48)), payload))


def mutated(rng, line):
    line = bytearray(line)
    for _ in range(len(line) // 40):
        kind, at = int(rng.integers(0, 4)), int(rng.integers(0, len(line)))
        if kind == 0:
            line[at] ^= 1 << int(rng.integers(0, 8))
        elif kind == 1:
            line[at:at] = rng.bytes(int(rng.integers(1, 300)))
        elif kind == 2:
            del line[at : at + int(rng.integers(1, 30))]
        else:
            line[at] = 0
    return bytes(line)


def test_whole_packets(decode_c):
    line = b"".join(frames(np.random.default_rng(1), 2000))
    lines = expected(line)
    assert decode_c(line) == lines
    assert len(lines) > 1000 and len({text.split()[0] for text in lines}) == 12


def test_states_of_every_number_of_channels(decode_c):
    """1 to 300 channels left; a word too few and one too many are no packet."""
    packets = []
    for left in range(1, 301):
        payload = p.states([k % 5 for k in range(left)], 0)[0]
        packets += [p.packet(p.STATES, 0, 0, part) for part in (payload, payload[:-2], payload + b"ab")]
    line = b"".join(map(encode, packets))
    lines = expected(line)
    assert decode_c(line) == lines
    assert len(lines) == 301 and lines[-1].startswith("damaged 600 ")
    assert lines[4] == "7 0 0 0 5 0 1 2 3 4"


def test_ends_of_signed_numbers(decode_c):
    ends = (-(1 << 23), -(1 << 23) + 1, -1, 0, 1, (1 << 23) - 1)
    line = b"".join(encode(p.packet(p.COP, 0, 0, p.cop_frame(x, y, 1, 1))) for x in ends for y in ends)
    assert decode_c(line) == expected(line)


def test_mutated_streams(decode_c):
    rng = np.random.default_rng(2)
    line = mutated(rng, b"".join(frames(rng, 4000)))
    lines = expected(line)
    assert decode_c(line) == lines
    assert len(lines) > 500 and int(lines[-1].split()[1]) > 500


def test_cut_streams(decode_c):
    rng = np.random.default_rng(3)
    line = b"".join(frames(rng, 6))
    for cut in range(0, len(line), 31):
        assert decode_c(line[:cut]) == expected(line[:cut])
        assert decode_c(line[cut:]) == expected(line[cut:])


def test_random_bytes(decode_c):
    rng = np.random.default_rng(4)
    for most in (2, 4, 256):
        line = rng.integers(0, most, 100_000).astype(np.uint8).tobytes()
        assert decode_c(line) == expected(line)
    good = encode(p.packet(p.SLIP, 1, 2, p.slip_event(3, 4, 2)))
    for line in (bytes([7]) * 1_000_000 + good, good[1:], b"\0" * 99 + good):
        assert decode_c(line) == expected(line)


def test_frames_with_every_code(decode_c):
    """Stuffed frames with arbitrary codes: the decoder's walk along them stays inside the frame."""
    rng = np.random.default_rng(5)
    line = bytearray()
    for length in range(1, 258):
        for code in (1, length - 1, length, length + 1, 255):
            frame = rng.integers(1, 256, length).astype(np.uint8)
            frame[-1] = max(1, min(255, code))
            line += frame.tobytes() + b"\0"
    assert decode_c(bytes(line)) == expected(bytes(line))


def test_checksum(decode_c):
    """A packet with one wrong bit in its checksum, for each bit: none is accepted."""
    good = p.packet(p.HEALTH, 0, 0, p.health(5, 6))
    line = b""
    for bit in range(32):
        wrong = bytearray(good)
        wrong[len(good) - 4 + bit // 8] ^= 1 << bit % 8
        line += encode(bytes(wrong))
    assert decode_c(line) == ["damaged 32 missed 0"]
    assert zlib.crc32(good[:-4]) == int.from_bytes(good[-4:], "little")
