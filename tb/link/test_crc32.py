"""msn_crc32 against its model, and the model against zlib: bytes, bits, entire words; without a step no
change; clear in mid-packet; the residue of a packet with its checksum; draining bit by bit."""

import zlib

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.link.packet import RESIDUE, crc32


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def matches_model(dut):
    bits = dut.Bits.value.to_unsigned()
    rng = np.random.default_rng(bench.SEED)
    bench.Clock(dut.clk_i, 10, unit="ns").start()
    dut.step_i.value = 1
    for length in (0, 1, 2, 100):
        values = [int(v) for v in rng.integers(0, 1 << bits, length)]
        dut.clear_i.value = 1
        dut.in_data_i.value = int(rng.integers(0, 1 << bits))
        await bench.clocks(dut, 1)
        dut.clear_i.value = 0
        for value in values:
            while rng.random() < 0.3:
                dut.step_i.value = 0
                await bench.clocks(dut, 1)
            dut.step_i.value = 1
            dut.in_data_i.value = value
            await bench.clocks(dut, 1)
        dut.step_i.value = 0
        await bench.ReadOnly()
        assert bench.read(dut.out_crc_o) == crc32(values, bits)
        await bench.clocks(dut, 1)
        dut.step_i.value = 1


@bench.applies(lambda dut: dut.Bits.value.to_unsigned() == 1)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def drains_bit_by_bit(dut):
    bench.Clock(dut.clk_i, 10, unit="ns").start()
    dut.clear_i.value, dut.step_i.value = 1, 1
    await bench.clocks(dut, 1)
    dut.clear_i.value = 0
    for byte in b"123456789":
        for place in range(8):
            dut.in_data_i.value = byte >> place & 1
            await bench.clocks(dut, 1)
    sent = 0
    dut.step_i.value = 0
    for place in range(32):
        await bench.ReadOnly()
        low = bench.read(dut.out_crc_o) & 1
        sent |= (1 - low) << place
        await bench.RisingEdge(dut.clk_i)
        dut.step_i.value, dut.in_data_i.value = 1, low
        await bench.RisingEdge(dut.clk_i)
        dut.step_i.value = 0
    assert sent == 0xCBF43926


EVIDENCE = {
    "equivalence": {"size": {"Bits": 8}, "reset": {"reset": "clear_i"}},
    # The sum stays until the first byte of the next packet.
    "faults": {"settle": 2, "driver": {"frame": "clear_i", "join": 1, "repeat": 4}},
}

SPACE = lambda draw: {"Bits": draw.randint(1, 32)}


@pytest.mark.parametrize("bits", [1, 8, 32])
def test_crc32(bits):
    bench.run("link", "crc32", {"Bits": bits})


def test_model_against_zlib():
    rng = np.random.default_rng(1)
    assert crc32(b"123456789") ^ 0xFFFFFFFF == 0xCBF43926
    for length in range(40):
        data = rng.bytes(length)
        checksum = zlib.crc32(data)
        assert crc32(data) ^ 0xFFFFFFFF == checksum
        assert crc32(data + checksum.to_bytes(4, "little")) == RESIDUE
        bits = [byte >> place & 1 for byte in data for place in range(8)]
        assert crc32(bits, 1) == crc32(data)


def test_refuses_illegal_parameters():
    assert "Bits = 33" in bench.refuses("crc32", {"Bits": 33})
    assert "Bits = 0" in bench.refuses("crc32", {"Bits": 0})
    for bits in (0, 33):
        with pytest.raises(ValueError, match=f"bits = {bits}"):
            crc32([], bits)
