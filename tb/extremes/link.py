"""Extremes of rtl/link: numbers, times and counters where they wrap around, packets of all lengths, bit
times.
"""

from fractions import Fraction

import hypothesis.strategies as st

from meissner.twins.link import bridge, cobs, crc32, packet, packet_slip, uart_rx, uart_tx
from meissner.twins.link.decoder import Decoder
from reference import exact
from verify.extremes import row

BAUDS = [
    (1200, 300),
    (12_000_000, 300),
    (12_000_000, 3_000_000),
    (12_000_000, 921_600),
    (25_000_000, 115_200),
    (100_000_000, 25_000_000),
    (133_333_333, 921_601),
    (400_000_000, 300),
    (400_000_000, 100_000_000),
    (400_000_000, 99_999_999),
    (268_435_456, 1_000_000),
    (4001, 1000),
    (48_000_000, 11_999_999),
]


def little(value, count):
    """Little-endian, two's complement: by powers of 256."""
    return bytes(value // 256**k % 256 for k in range(count))


@row("crc32", {"": "0"}, rtl=["tb/link/test_crc32.py::test_crc32"])
def crc32_(see):
    lines = [
        b"",
        b"\0",
        b"\xff",
        b"123456789",
        bytes(256),
        b"\xff" * 256,
        bytes(range(256)),
        b"\0" * (100_000 if see.long else 2_000),
    ]
    for data in lines:
        register = crc32.crc32(data)
        see.near(register ^ 0xFFFFFFFF, exact.crc32(data), f"{len(data)} bytes {data[:3]!r}")
        # The register after any message and its checksum is the residue.
        whole = crc32.crc32(data + little(register ^ 0xFFFFFFFF, 4))
        see.near(whole, crc32.RESIDUE, f"residue of {len(data)} bytes")
    see.near(exact.crc32(b"123456789"), 0xCBF43926, "the check value that every catalogue prints")
    for bits in (1, 2, 7, 8, 16, 31, 32):
        words = [0, 1, 2**bits - 1, 2 ** (bits - 1)] * 8
        line = [word >> k & 1 for word in words for k in range(bits)]
        data = bytes(
            sum(bit << k for k, bit in enumerate(line[at : at + 8])) for at in range(0, len(line), 8)
        )
        see.near(crc32.crc32(words, bits) ^ 0xFFFFFFFF, exact.crc32(data), f"{bits} bits a step")
    for bits in (0, 33):
        see.refused(crc32.crc32, [0], bits)


def framed(kind, number, time, payload):
    body = bytes([kind]) + little(number, 1) + little(time, 6) + payload
    return body + little(exact.crc32(body), 4)


TIMES = [0, 1, 2**32 - 1, 2**32, 2**47, 2**48 - 1]


@row(
    "packet",
    {"": "0"},
    ends="number and image turn over at 256, time at 2^48, statistics at 2^32: by contract (docs/link.md)",
    rtl=["tb/link/test_packet.py::test_packet"],
)
def packet_(see):
    kinds = {
        "slip": (
            1,
            lambda: packet.slip_event(65535, 2**24 - 1, 4),
            little(65535, 2) + little(2**24 - 1, 3) + b"\4",
        ),
        "cop": (
            2,
            lambda: packet.cop_frame(-(2**23), 2**23 - 1, 2**40 - 1, True),
            little(-(2**23), 3) + little(2**23 - 1, 3) + little(2**40 - 1, 5) + b"\1",
        ),
        "longest load": (
            2,
            lambda: packet.cop_frame(2**20, -(2**20), 65535 * 1024 * 1024, False),
            little(2**20, 3) + little(-(2**20), 3) + little(65535 * 1024 * 1024, 5) + b"\0",
        ),
        "health": (4, lambda: packet.health(1024 * 1024 - 1, 7), little(1024 * 1024 - 1, 3) + b"\7"),
        "statistic": (5, lambda: packet.statistic(255, 2**32 - 1), b"\xff" + little(2**32 - 1, 4)),
    }
    for one in see.covering(
        kind=[*kinds], number=[0, 1, 254, 255, 256, 257], time=[*TIMES, 2**48, 2**48 + 1]
    ):
        kind, payload, wanted = kinds[one["kind"]]
        got = packet.packet(kind, one["number"], one["time"], payload())
        see.same(got, framed(kind, one["number"] % 256, one["time"] % 2**48, wanted), one)
    for taxels in (1, 115, 116, 117, 65536 if see.long else 4096):
        for chunk in (1, 64, 116):
            if taxels // chunk > 1100 and not see.long:
                continue
            parts = packet.image_chunks(256, [65535] * taxels, chunk)
            see.near(len(parts), -(-taxels // chunk), (taxels, chunk))
            see.same(
                (parts[0][:5], parts[-1][1]),
                (little(0, 1) + bytes([len(parts) == 1]) + little(0, 3), 1),
                (taxels, chunk),
            )
            see.near(int.from_bytes(parts[-1][2:5], "little"), (len(parts) - 1) * chunk, (taxels, chunk))
            see.same(all(len(part) + 12 <= 253 for part in parts), True, (taxels, chunk))
    for chunk in (0, 117):
        see.refused(packet.image_chunks, 0, [0], chunk)
    # 1000 packets: the number wraps three times, the time once; none is missed or damaged.
    host, line = Decoder(), b""
    for k in range(1000):
        line += cobs.encode(packet.packet(5, k, 2**48 - 500 + k, packet.statistic(0, 2**32 - 1)))
    found = host.next(line)
    see.near(len(found), 1000, "three turns of the number")
    see.near(host.missed + host.damaged, 0, "three turns of the number")
    see.all_near(
        [p.time for p in found[498:503]], [2**48 - 2, 2**48 - 1, 0, 1, 2], ["the turn of the time"] * 5
    )
    see.all_near([p.number for p in found[254:258]], [254, 255, 0, 1], ["the turn of the number"] * 4)


@row(
    "packet_slip",
    {"": "0"},
    ends="refused beyond P2pBits",
    rtl=["tb/link/test_packet_slip.py::test_packet_slip"],
)
def packet_slip_(see):
    for bits in (1, 17, 24):
        events = [
            (time, p2p, state) for time in TIMES for p2p in exact.ends(0, 2**bits - 1) for state in range(5)
        ]
        got = packet_slip.packets(events * 2, bits)
        for k, (time, p2p, state) in enumerate(events * 2):
            see.same(
                got[k], framed(1, k % 256, time, little(0, 2) + little(p2p, 3) + bytes([state])), (bits, k)
            )
        see.refused(packet_slip.packets, [(0, 2**bits, 0)], bits)
    for bits in (0, 25):
        see.refused(packet_slip.packets, [], bits)


def unstuffed(frame):
    """The host's loop for unstuffing, from docs/link.md."""
    packet_, place = bytearray(frame[:-1]), len(frame) - 1
    code = frame[place]
    while code <= place:
        place -= code
        code = frame[place]
        packet_[place] = 0
    return bytes(packet_) if code == place + 1 else None


@row("cobs", {"": "0"}, ends="refused beyond 253 bytes", rtl=["tb/link/test_cobs.py::test_cobs"])
def cobs_(see):
    def check(body):
        frame = cobs.encode(body)
        see.same(
            (frame[0], frame[-1], 0 in frame[1:-1], len(frame)),
            (0, 0, False, len(body) + 3),
            f"{len(body)} bytes",
        )
        see.same(
            (unstuffed(frame[1:-1]), cobs.decode(frame[1:-1])),
            (body, body),
            lambda: f"{body[:20]!r}, {len(body)} bytes",
        )
        plain, out = cobs.stuff(body)[1:-1], b""  # as in any COBS library: a code before each run
        while plain:
            out, plain = out + plain[1 : plain[0]] + b"\0", plain[plain[0] :]
        see.same(out[:-1], body, lambda: f"stuffed {body[:20]!r}, {len(body)} bytes")

    for length in (1, 2, 12, 252, 253):
        for body in (
            bytes(length),
            b"\1" * length,
            b"\xff" * length,
            bytes(k % 2 for k in range(length)),
            b"\0" + b"\xfe" * (length - 1),
            b"\xfd" * (length - 1) + b"\0",
        ):
            check(body)
    for length in (0, 254):
        see.refused(cobs.encode, bytes(length))
    see.given(check, body=st.binary(min_size=1, max_size=253))


@row(
    "uart_tx",
    {"": "1/32 clock"},
    ends="refused beyond a quarter of the clock, below 300 baud and above 400 MHz",
    rtl=["tb/link/test_uart_tx.py::test_uart_tx"],
)
def uart_tx_(see):
    """Mean length of a bit; the carry of sixteenths loses nothing over any number of bytes."""
    for clk, baud in BAUDS:
        bit = Fraction(uart_tx.sixteenths(clk, baud), 16)
        see.near(bit, Fraction(clk, baud), (clk, baud))
        data = [0x00, 0xFF, 0x55, 0xAA] * (4 if clk // baud < 1000 else 1)
        if clk // baud > 20_000:
            data = data[:1] if see.long else []
        line, at = uart_tx.levels(data, clk, baud), 0
        see.near(len(line), int(10 * len(data) * bit), (clk, baud), limit=0)
        for k, level in enumerate(
            level for byte in data for level in (0, *(byte >> p & 1 for p in range(8)), 1)
        ):
            begin, at = at, int(bit * (k + 1))
            see.same(set(line[begin:at]), {level}, lambda: f"{clk} / {baud}, bit {k}")
    for bad in ((1199, 300), (12_000_000, 299), (12_000_000, 3_000_001), (400_000_001, 1_000_000)):
        see.refused(uart_tx.sixteenths, *bad)


@row(
    "uart_rx",
    {"": "0"},
    ends="refused as the sender; a byte without its stop bit is lost",
    rtl=["tb/link/test_uart_rx.py::test_uart_rx"],
)
def uart_rx_(see):
    """Bytes on a line with the largest tolerated baud error: half a bit less two clocks, over nine and a half
    bits.
    """
    for clk, baud in BAUDS:
        bit = Fraction(clk, baud)
        if bit > 2000 and not see.long:
            continue
        room = (bit / 2 - 2) / (Fraction(19, 2) * bit) if bit > 5 else 0
        for off in (0, room * 9 / 10, -room * 9 / 10):
            data = [0x00, 0xFF, 0x55, 0xAA, 0x80, 0x01] if bit < 2000 else [0x55]
            bits = (
                [1] * 3
                + [level for byte in data for level in (0, *(byte >> p & 1 for p in range(8)), 1)]
                + [1] * 3
            )
            edges = [round(k * bit * (1 + off)) for k in range(len(bits) + 1)]
            line = [level for k, level in enumerate(bits) for _ in range(edges[k + 1] - edges[k])]
            found = uart_rx.UartRx(clk, baud).process(line)
            see.same(
                [byte for _, byte in found], data, lambda: f"{clk} / {baud}, {float(100 * off):.2f} % off"
            )
            see.near(len(found), len(data), (clk, baud))


@row(
    "bridge",
    {"": "0"},
    ends="addresses beyond 12 bits and damaged frames are counted, not executed",
    rtl=["tb/link/test_bridge.py::test_bridge"],
)
def bridge_(see):
    line, wanted = b"", []
    for one in see.covering(
        write=[0, 1], tag=[0, 1, 255], address=[0, 1, 4094, 4095], data=[0, 1, 2**31, 2**32 - 1]
    ):
        write, tag, address, data = one.values()
        body = bytes([write, tag]) + little(address, 2) + little(data, 4)
        line += bridge.command(write, tag, address, data)
        wanted.append((write, tag, address, data))
        see.same(
            bridge.answer(tag, 2, address, data), bytes([tag, 2]) + little(address, 2) + little(data, 4), one
        )
        see.same(
            cobs.stuff(body + little(exact.crc32(body), 4)), bridge.command(write, tag, address, data), one
        )
    see.same(bridge.accesses(line), (wanted, 0), "all at once")
    see.near(len(wanted), see.pairs, "all at once")
    beyond = bytes([0, 7]) + little(4096, 2) + little(0, 4)
    beyond = cobs.stuff(beyond + little(exact.crc32(beyond), 4))
    see.same(bridge.accesses(beyond + line), (wanted, 1), "an address of 13 bits first")
    for place in range(1, len(line) // 8):
        broken = bytearray(line[: line.index(b"\0", 1) + 1])
        if place < len(broken) - 1:
            broken[place] ^= 0xFF if broken[place] != 0xFF else 0x0F
            see.same(bridge.accesses(bytes(broken))[0], [], f"byte {place} broken")
    for bad in ((2, 0, 0), (0, 0, 4096), (0, 0, -1)):
        see.refused(bridge.command, *bad)
