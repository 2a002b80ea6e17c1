"""The host's decoders, in Python and in C, and its logs against bytes made by hand from docs/link.md: every
kind of packet, each field at its full width with a different byte in each place, both ends of signed numbers,
times and packet numbers across their wrap-around. Except for the code under test, nothing here comes from
meissner.twins.link."""

import numpy as np
import pytest

from host.test_packet_c import decode_c  # noqa: F401 - a fixture
from meissner import host
from meissner.builds import units
from meissner.host import line, log, packets
from meissner.twins.link.decoder import Decoder

LATE = "54 76 98 ba dc fe"  # 280,223,976,814,164 clocks, lowest byte first
LATE_TICKS = 280_223_976_814_164


def crc32(data):
    """CRC-32/ISO-HDLC, bit by bit."""
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xEDB88320 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


def frame(text):
    """The bytes on the line for a packet given in hexadecimal without its checksum."""
    body = bytes.fromhex(text)
    return stuffed(body + crc32(body).to_bytes(4, "little"))


def stuffed(body):
    """As in docs/link.md: each zero, and the end, is replaced by one plus the number of bytes since the
    previous zero."""
    out, since = [], 1
    for byte in [*body, 0]:
        out.append(byte if byte else since)
        since = since + 1 if byte else 1
    return bytes([0, *out, 0])


def test_the_loops_above():
    assert crc32(b"123456789") == 0xCBF43926  # the checksum's published check value
    # The page's own example.
    assert stuffed(bytes.fromhex("01 00 02 03 00")) == bytes.fromhex("00 01 02 02 03 03 01 00")


# Bytes of the packet: type, number, time, payload; then the values of its fields.
WIRE = {
    "slip": (f"01 fd {LATE} dc fe ef cd ab 04", {"channel": 65_244, "p2p": 11_259_375, "state": 4}),
    "slip of the load": (f"01 fe {LATE} ff ff 05 00 00 02", {"channel": 65_535, "p2p": 5, "state": 2}),
    "cop, least and most": (
        f"02 ff {LATE} 00 00 80 ff ff 7f 76 98 ba dc fe 01",
        {"x": -8_388_608, "y": 8_388_607, "load": 1_094_624_909_430, "pressed": 1},
    ),
    "cop, most and least": (
        f"02 00 {LATE} ff ff 7f 00 00 80 01 00 00 00 80 ff",
        {"x": 8_388_607, "y": -8_388_608, "load": 549_755_813_889, "pressed": 1},
    ),
    "cop, either side of 0": (
        f"02 01 {LATE} ff ff ff 01 00 00 02 00 00 00 00 00",
        {"x": -1, "y": 1, "load": 2, "pressed": 0},
    ),
    "cop, a byte of its own each": (
        f"02 02 {LATE} 56 34 92 bc 9a 78 09 08 07 06 05 01",
        {"x": -7_195_562, "y": 7_903_932, "load": 21_575_960_585, "pressed": 1},
    ),
    "image, last part": (
        f"03 03 {LATE} c8 01 56 34 12 02 01 ff ff 00 80",
        {"image": 200, "last": 1, "first": 1_193_046, "taxels": (258, 65_535, 32_768)},
    ),
    "image, not the last": (
        f"03 04 {LATE} 09 00 03 00 00 fe ca",
        {"image": 9, "last": 0, "first": 3, "taxels": (51_966,)},
    ),
    "health": (f"04 05 {LATE} ba dc fe 07", {"taxel": 16_702_650, "faults": 7}),
    "statistic": (f"05 06 {LATE} 06 98 ba dc fe", {"index": 6, "counter": 4_275_878_552}),
    "answer": (
        f"10 07 {LATE} a5 01 fc 0f ef cd ab 89",
        {"tag": 165, "status": 1, "address": 4_092, "data": 2_309_737_967},
    ),
    "unknown": (f"4d 08 {LATE} 01 02 03", {}),
}
STREAM = b"".join(frame(text) for text, _ in WIRE.values())


def test_the_decoder_in_python():
    got, decoder = [], Decoder()
    for byte in STREAM:  # one by one
        got += decoder.next(bytes([byte]))
    assert (len(got), decoder.damaged) == (len(WIRE), 0)
    for packet, (text, fields) in zip(got, WIRE.values(), strict=True):
        assert packet.fields == fields, text
        assert (packet.kind, packet.number) == tuple(bytes.fromhex(text)[:2])
        assert packet.time == LATE_TICKS


def test_the_decoder_in_c(decode_c):  # noqa: F811 - the fixture
    lines = []
    for text, fields in WIRE.values():
        kind, number = bytes.fromhex(text)[:2]
        values = [fields[name] for name in fields if name != "taxels"]
        values += fields.get("taxels", ()) if fields else (1, 2, 3)
        lines.append(" ".join(map(str, (kind, number, LATE_TICKS, *values))))
    assert decode_c(STREAM) == [*lines, "damaged 0 missed 0"]


@pytest.mark.parametrize(
    "numbers, missed", [([254, 255, 0, 1], 0), ([254, 1], 2), ([5, 5], 255), ([255, 254], 254)]
)
def test_numbers_wrap(decode_c, numbers, missed):  # noqa: F811
    data = b"".join(frame(f"04 {number:02x} {LATE} 01 00 00 02") for number in numbers)
    assert [packet.number for packet in Decoder().next(data)] == numbers
    assert decode_c(data)[-1] == f"damaged 0 missed {missed}"


@pytest.mark.parametrize(
    "time, ticks", [("ff" * 6, (1 << 48) - 1), ("00" * 6, 0), ("00 00 00 00 00 80", 1 << 47)]
)
def test_times_have_48_bits(decode_c, time, ticks):  # noqa: F811
    data = frame(f"05 00 {time} 01 02 00 00 00")
    assert Decoder().next(data)[0].time == ticks
    assert decode_c(data)[0] == f"5 0 {ticks} 1 2"


class Said:
    """The other end of a line, which has sent these bytes and sends no more."""

    def __init__(self, data):
        self.data = data

    def read(self, count):
        found, self.data = self.data[:count], self.data[count:]
        return found


def listening(data, **known):
    """A host that only listens to a core, which sent these bytes."""
    return host.Core(line.Pipe(Said(data)), units.Units(**known), registers=False, say=lambda _: None)


IMAGE = [f"03 08 {LATE} c8 00 00 00 00 02 01 ff ff", f"03 09 {LATE} c8 01 02 00 00 00 80 fe ca"]  # 2x2 taxels


@pytest.mark.parametrize("kind", ["npz", "mcap"])
def test_a_log_keeps_every_bit(tmp_path, kind):
    """Statistics come last here; the other packets' times do not show the core's current time."""
    left_out = ("image", "answer", "unknown", "statistic")
    logged = [text for name, (text, _) in WIRE.items() if not name.startswith(left_out)]
    stream = b"".join(map(frame, [*logged, *IMAGE, WIRE["statistic"][0]]))
    core = listening(stream, clk_khz=1000, rows=2, columns=2)
    with log.recording(tmp_path / f"a.{kind}", core) as recording:
        for item in core.packets(0.05):
            recording.add(item)
    found = log.read(tmp_path / f"a.{kind}")
    wanted = {
        "slip_channel": [65_244, 65_535],
        "slip_p2p": [11_259_375, 5],
        "slip_state": [4, 2],
        "cop_x": [-8_388_608, 8_388_607, -1, -7_195_562],
        "cop_y": [8_388_607, -8_388_608, 1, 7_903_932],
        "cop_load": [1_094_624_909_430, 549_755_813_889, 2, 21_575_960_585],
        "cop_pressed": [True, True, False, True],
        "image": [[[258, 65_535], [32_768, 51_966]]],
        "image_number": [200],
        "health_taxel": [16_702_650],
        "health_faults": [7],
        "statistics_index": [6],
        "statistics_value": [4_275_878_552],
    }
    assert {name: found[name].tolist() for name in wanted} == wanted
    for name, count in (("slip", 2), ("cop", 4), ("image", 1), ("health", 1), ("statistics", 1)):
        assert found[f"{name}_time"].tolist() == count * [LATE_TICKS]


@pytest.mark.parametrize("kind", ["npz", "mcap"])
def test_stamps_go_on_across_the_end_of_48_bits(tmp_path, kind):
    """1 MHz: a clock is 1000 ns. The core's time wraps around to 0, which is not a reset."""
    times = [(1 << 48) - 700, (1 << 48) - 1, 4, 1004, 1000]
    texts = [f"05 {n:02x} {t.to_bytes(6, 'little').hex()} 01 02 00 00 00" for n, t in enumerate(times[:4])]
    texts += [f"04 04 {times[4].to_bytes(6, 'little').hex()} 01 00 00 02"]
    data = b"".join(map(frame, texts))
    core = listening(data, clk_khz=1000)
    with log.recording(tmp_path / f"a.{kind}", core) as recording:
        for item in core.packets(0.05):
            recording.add(item)
    found = log.read(tmp_path / f"a.{kind}")
    assert core.counts.restarts == 0
    assert found["statistics_time"].tolist() == times[:4] and found["health_time"].tolist() == [1000]
    assert np.diff(found["statistics_ns"]).tolist() == [699_000, 5_000, 1_000_000]
    assert found["health_ns"][0] == found["statistics_ns"][3] - 4_000


@pytest.mark.parametrize("before, after, restarts", [
    (1000, 999, 1), (1000, 1000, 0), (1000, 1001, 0), ((1 << 48) - 5, 3, 0), (1 << 47, 3, 1),
    (1000, 1000 + (1 << 47), 0), ((1 << 48) - 1, (1 << 40) - 1, 0), ((1 << 48) - 1, 1 << 40, 1),
])  # fmt: skip
def test_a_time_that_goes_back_is_a_reset(before, after, restarts):
    data = b"".join(
        frame(f"05 {n:02x} {t.to_bytes(6, 'little').hex()} 01 02 00 00 00")
        for n, t in ((0, before), (1, after))
    )
    core = listening(data, clk_khz=1000)
    assert all(isinstance(item, packets.Statistics) for item in core.packets(0.05))
    assert core.counts.restarts == restarts
