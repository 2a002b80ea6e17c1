"""msn_cobs against its model, and the model against COBS itself, written out: all short packets of 0 and 1,
every length up to the longest, all zeros, none, the first 00 sent before the packet; gaps and stalls, reset
in mid-packet; decoding of every single-byte change and of random bytes."""

import itertools

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.link.cobs import MAX_BYTES, decode, encode, stuff


def beats_of(packets):
    """The packets' bytes. The last packet is announced, the one before it is not, and so on."""
    return [
        {"data": byte, "last": index == len(packet) - 1, "begin": (len(packets) - number) % 2}
        for number, packet in enumerate(packets)
        for index, byte in enumerate(packet)
    ]


def packets_of(rng, longest):
    """Packets with few and many zeros: critical lengths, then random ones."""
    lengths = [1, 1, 2, 3, longest, longest, *rng.integers(1, longest + 1, 20)]
    packets = [bytes(longest), bytes([255] * longest), bytes([1]), b"\0"]
    for length in lengths:
        share = rng.choice([0, 0.02, 0.5, 0.95])
        data = rng.integers(1, 256, length) * (rng.random(length) >= share)
        packets.append(bytes(data.astype(np.uint8)))
    return packets


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(gap_rate=[0.0, 0.5], stall_rate=[0.0, 0.5])
async def matches_model(dut, gap_rate, stall_rate):
    packets = packets_of(np.random.default_rng(bench.SEED), dut.MaxBytes.value.to_unsigned())
    await bench.start(dut, in_begin_i=0)
    # in_valid_i passes through to out_valid_o, so with stalls an offer must not be withdrawn.
    pauses, hold = bench.gaps_and_stalls(gap_rate, stall_rate), bool(gap_rate and stall_rate)
    got = await bench.stream(dut, beats_of(packets), ["data"], *pauses, hold=hold)
    assert bytes(beat["data"] for beat in got) == b"".join(map(encode, packets))


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def opens_the_frame_before_the_packet_is_there(dut):
    await bench.start(dut, in_begin_i=0, out_ready_i=1)
    for clock in range(10):
        dut.in_begin_i.value = int(clock >= 3)
        await bench.ReadOnly()
        assert dut.out_valid_o.value == (clock == 3)
        if clock == 3:
            assert bench.read(dut.out_data_o) == 0
        await bench.RisingEdge(dut.clk_i)
    got = await bench.stream(dut, beats_of([b"\1\0\2"]), ["data"], count=5)
    assert bytes(beat["data"] for beat in got) == encode(b"\1\0\2")[1:]


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def recovers_after_reset(dut):
    await bench.start(dut, in_begin_i=0)
    packet = b"\3\0\4\0"
    for cut in range(1, 9):
        await bench.stream(dut, beats_of([packet]), ["data"], count=cut)
        dut.in_valid_i.value = 0
        await bench.reset(dut)
        got = await bench.stream(dut, beats_of([packet]), ["data"])
        assert bytes(beat["data"] for beat in got) == encode(packet)


EVIDENCE = {
    "faults": {"driver": {"end": 0}},
}


@pytest.mark.parametrize("longest", [18, 253])
def test_cobs(longest):
    bench.run("link", "cobs", {"MaxBytes": longest})


def plain_cobs(packet):
    """COBS as it is usually defined, for packets under 254 bytes."""
    return b"".join(bytes([len(run) + 1]) + run for run in packet.split(b"\0"))


def test_model_against_plain_cobs():
    rng = np.random.default_rng(1)
    packets = packets_of(rng, 253) + [
        bytes(p) for n in range(1, 8) for p in itertools.product((0, 1), repeat=n)
    ]
    for packet in packets:
        assert encode(packet)[1:-1] == plain_cobs(packet[::-1])[::-1]
        assert stuff(packet)[1:-1] == plain_cobs(packet)
        assert 0 not in encode(packet)[1:-1]
        assert decode(encode(packet)[1:-1]) == packet


def test_decode_gives_only_what_encodes_to_the_frame():
    rng = np.random.default_rng(2)
    for _ in range(20_000):
        frame = bytes(rng.integers(0, rng.choice([3, 6, 256]), rng.integers(0, 12)).astype(np.uint8))
        packet = decode(frame)
        if packet is not None:
            assert encode(packet)[1:-1] == frame
    for frame in (b"", b"\1", bytes([9] * 255), bytes([1] * 300), b"\2\2", b"\1\0\1"):
        assert decode(frame) is None or encode(decode(frame))[1:-1] == frame


def test_refuses_illegal_parameters():
    assert "MaxBytes = 254" in bench.refuses("cobs", {"MaxBytes": 254})
    assert "MaxBytes = 0" in bench.refuses("cobs", {"MaxBytes": 0})
    for length in (0, MAX_BYTES + 1):
        with pytest.raises(ValueError, match=f"{length} bytes"):
            encode(bytes(length))
