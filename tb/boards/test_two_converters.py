"""A user's configuration with two or three converters on a board's top, from its pins to its serial line: an
MCP3208 model written from the data sheet at each DOUT, a terminal at tx_o. Every taxel of the image is the
code of its own converter, channel and row; the codes are literals, all different."""

import os

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import Edge, FallingEdge, First, RisingEdge, Timer

import bench
from boards import users
from harness.compile_models import Units
from meissner.builds import boards, toolchain
from meissner.twins.link import packet as p
from meissner.twins.link.decoder import Decoder

BIT_PS = 333_333  # 3 Mbaud
# By the number of converters: codes [converter][channel][row], all different, and the image, row by row.
CODES = {
    # Column = 2 × channel + converter.
    2: (
        [[[101, 1102], [203, 1204]], [[2305, 3306], [2407, 3408]]],
        [101, 2305, 203, 2407, 1102, 3306, 1204, 3408],
    ),
    # Column = 3 × channel + converter; columns 10 and 11 are none.
    3: (
        [
            [[11, 12], [13, 14], [15, 16], [17, 18]],
            [[21, 22], [23, 24], [25, 26], [27, 28]],
            [[31, 32], [33, 34], [35, 36], [37, 38]],
        ],
        [11, 21, 31, 13, 23, 33, 15, 25, 35, 17, 12, 22, 32, 14, 24, 34, 16, 26, 36, 18],
    ),
}


async def mcp3208(dut, converter, miso, code_of):
    """``code_of(channel)`` gives its code when it is asked for. Start, SGL, D2 to D0 on rising edges 1 to 5;
    B11 to B0 leave on falling edges 7 to 18."""
    while True:
        if dut.adc_cs_n_o.value:
            await FallingEdge(dut.adc_cs_n_o)
        bits, falling, code = [], 0, 0
        while True:
            await First(Edge(dut.adc_sclk_o), RisingEdge(dut.adc_cs_n_o))
            if dut.adc_cs_n_o.value:
                break
            if dut.adc_sclk_o.value:
                bits.append(int(dut.adc_mosi_o.value))
                if len(bits) == 5:
                    assert bits[:2] == [1, 1], "no start bit, or a differential input"
                    code = code_of(4 * bits[2] + 2 * bits[3] + bits[4])
            elif bits:
                falling += 1
                miso[converter] = code >> 18 - falling & 1 if 7 <= falling <= 18 else 0
                dut.adc_miso_i.value = sum(bit << place for place, bit in enumerate(miso))


async def terminal(dut, received):
    while True:
        await FallingEdge(dut.tx_o)
        await Timer(BIT_PS * 3 // 2, "ps")
        byte = 0
        for place in range(8):
            byte |= int(dut.tx_o.value) << place
            await Timer(BIT_PS, "ps")
        assert dut.tx_o.value == 1
        received.append(byte)


@cocotb.test(timeout_time=200, timeout_unit="ms")
async def every_converter_arrives(dut):
    dut.rx_i.value, dut.moving_i.value, dut.adc_miso_i.value = 1, 0, 0
    codes_of, image = CODES[len(dut.adc_miso_i)]
    miso, received, decoder, images = [0] * len(codes_of), [], Decoder(), []
    cocotb.start_soon(Clock(dut.clk_25m_i, 40, "ns").start())
    row = lambda: {0b01: 0, 0b10: 1}[int(dut.row_o.value)]
    for converter, codes in enumerate(codes_of):
        code_of = lambda channel, codes=codes: codes[channel][row()]
        cocotb.start_soon(mcp3208(dut, converter, miso, code_of))
    cocotb.start_soon(terminal(dut, received))
    while len(images) < 3:
        await Timer(1, "ms")
        for packet in decoder.next(bytes(received)):
            if packet.kind == p.IMAGE:
                images.append(list(packet.fields["taxels"]))
        received.clear()
    # The first frame may have begun before its first codes were available; the others are complete.
    assert images[1:3] == [image, image]
    assert (dut.onboard_cs_n_o.value, dut.onboard_sclk_o.value) == (1, 1)


def simulate(name, module, tmp_path):
    """Names of the tests of ``module`` that passed on a ULX3S with a user's configuration."""
    board = boards.BOARDS["ulx3s"]
    folder = f"build/tb/{module.rpartition('.')[2]}"
    boards.write_board(folder, board, users.write(tmp_path, name, 25.0))
    own = [*board.sources, f"{folder}/{board.top}.sv", "tb/boards/EHXPLLL.sv", "rtl/verilator.vlt"]
    os.environ.update(toolchain.environment())
    runner = Units()
    where = toolchain.ROOT / folder
    runner.build(
        sources=[*toolchain.sources(), *(toolchain.ROOT / path for path in own)],
        includes=[where],
        hdl_toplevel=board.top,
        build_args=toolchain.VERILATOR_FLAGS,
        build_dir=where / "sim",
        timescale=("1ns", "1ps"),
    )
    results = runner.test(
        hdl_toplevel=board.top,
        hdl_toplevel_lang="verilog",  # otherwise the runner takes the waiver file's language for the top's
        test_module=module,
        build_dir=where / "sim",
        test_dir=where,
    )
    return bench.passed(results, name)


@pytest.mark.parametrize("name", ["two", "three"])
def test_two_converters(name, tmp_path):
    assert simulate(name, "boards.test_two_converters", tmp_path) == ["every_converter_arrives"]
