"""msn_ram against its model: every word, then reads and writes at random, with clocks without a read, never
of one word in one clock. The ECP5 version gets the same with a model of its block RAM, at each width of the
cell, words of several cells, and what is left to LUT RAM."""

import random

import cocotb
import pytest
from cocotb.triggers import FallingEdge

import bench
from harness.refusals import refusals
from meissner.builds import toolchain
from meissner.twins.common.delay import Ram

ECP5 = [
    toolchain.ROOT / name
    for name in (
        "rtl/msn_pkg.sv",
        "model/meissner/engines/cells/ram.sv",
        "model/meissner/engines/cells/ecp5.sv",
        "rtl/ecp5/msn_ram.sv",
    )
]


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(rest_rate=[0.0, 0.5])
async def matches_model(dut, rest_rate):
    words, width = dut.Words.value.to_unsigned(), dut.Width.value.to_unsigned()
    draw, twin = random.Random(bench.SEED), Ram(words, width)
    bench.Clock(dut.clk_i, 10, unit="ns").start()
    reads = 0
    # every word written and read in order, the ends in the other order, then any
    order = [*range(words), *[draw.randrange(words) for _ in range(bench.rounds(500))]]
    places = order + order[::-1] + [draw.randrange(words) for _ in range(bench.rounds(1000))]
    for clock, place in enumerate(places):
        write = None
        if clock < len(order) or draw.random() < 0.5:
            write = (place if clock < len(order) else draw.randrange(words), draw.getrandbits(width))
        read = place if clock >= len(order) and draw.random() >= rest_rate else None
        if write is not None and read == write[0]:
            write = None
        await FallingEdge(dut.clk_i)
        dut.write_i.value, dut.read_i.value = int(write is not None), int(read is not None)
        dut.write_address_i.value, dut.write_data_i.value = write or (draw.randrange(words), 0)
        dut.read_address_i.value = draw.randrange(words) if read is None else read
        expected = twin.clock(read, write)
        reads += read is not None
        await bench.RisingEdge(dut.clk_i)
        await bench.ReadOnly()
        if reads >= 2:
            assert bench.read(dut.out_data_o) == expected, clock


EVIDENCE = {
    "equivalence": {"size": {"Words": 5}, "reset": {"ties": {"read_i": 1}, "clocks": 2}},
    "faults": {"settle": 4, "driver": {"frame": "read_i", "kept": "memory"}},
}

SPACE = lambda draw: {"Words": draw.randint(1, 90), "Width": draw.randint(1, 40)}

SIZES = [
    (1, 3),
    (5, 17),
    (64, 16),
    (65, 16),
    (512, 37),
    (512, 18),
    (513, 19),
    (1500, 10),
    (3000, 5),
    (5000, 3),
    (9000, 2),
]


@pytest.mark.parametrize("sources", [None, ECP5], ids=["common", "ecp5"])
@pytest.mark.parametrize("words, width", SIZES)
def test_ram(words, width, sources):
    bench.run("common", "ram", {"Words": words, "Width": width}, sources=sources)


test_refuses_illegal_parameters = refusals("ram", Ram, {"Words": 0}, {"Width": 0}, words=4)


def test_the_ecp5_version_refuses_them_too():
    assert "Words = 0" in bench.refuses("ram", {"Words": 0}, sources=ECP5)
    assert "Width = 0" in bench.refuses("ram", {"Width": 0}, sources=ECP5)
