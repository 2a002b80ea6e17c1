"""msn_spi_shift: words of random bits, alone and in a row, on two lanes, against the twin's bits and clocks.

The input line is right only in one clock of each bit, the one before its last, and wrong in all others: a
sample taken in any other clock fails.
"""

import random

import cocotb
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from meissner.twins.frontend import spi_shift


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def words_match_the_model(dut):
    names = ("Bits", "DataBits", "Lanes", "Half", "IdleHigh", "Lead")
    bits, data_bits, lanes, half, idle, lead = (getattr(dut, name).value.to_unsigned() for name in names)
    before_first = half * lead
    await bench.start(dut, start_i=0, again_i=0, command_i=0, spi_miso_i=0)
    draw = random.Random(bench.SEED)
    ends = [(1 << data_bits) - 1, 0]  # then random ones
    for words in (1, 2, 1, 3, 1):
        command = ends.pop(0) if ends else draw.getrandbits(data_bits)
        lines = [[draw.getrandbits(1) for _ in range(bits * words)] for _ in range(lanes)]
        sent, found, done, toggles = [], [], None, 0
        dut.command_i.value = command
        dut.start_i.value = 1
        before = idle
        for clock in range(spi_shift.done_clock(bits, half, words, lead) + 3):
            # Right only in the clock before the bit's last, where the register must sample.
            index, phase = divmod(clock - 1 - before_first, 2 * half)
            right = phase == 2 * half - 2
            levels = [line[index] ^ (not right) if 0 <= index < len(line) else 0 for line in lines]
            dut.spi_miso_i.value = sum(level << lane for lane, level in enumerate(levels))
            dut.again_i.value = int(index < bits * (words - 1))
            await ReadOnly()
            low = 1 <= clock <= spi_shift.word_clock(bits, half, words, lead)
            assert dut.spi_cs_n_o.value == int(not low)
            runs = 1 <= clock <= spi_shift.done_clock(bits, half, words, lead)
            assert dut.run_o.value == int(runs)
            sclk = int(dut.spi_sclk_o.value)
            driven = 0 <= index < bits * words and (phase >= half) != lead
            assert sclk == idle ^ driven, f"SCLK in clock {clock}"
            toggles += sclk != before
            # The part samples the command at the edge in the middle of a bit.
            if sclk != before and driven != lead and 0 <= index < bits:
                sent.append(int(dut.spi_mosi_o.value))
            before = sclk
            if dut.word_o.value == 1:
                number = len(found)
                assert clock == spi_shift.word_clock(bits, half, number + 1, lead)
                data = bench.read(dut.data_o)
                found.append([data >> lane * data_bits & (1 << data_bits) - 1 for lane in range(lanes)])
            if dut.done_o.value == 1:
                assert done is None
                done = clock
            await RisingEdge(dut.clk_i)
            dut.start_i.value = 0
        assert done == spi_shift.done_clock(bits, half, words, lead)
        assert toggles == 2 * bits * words
        assert sent[:data_bits] == spi_shift.command_line(command, bits, data_bits)
        cut = [[line[n * bits : (n + 1) * bits] for line in lines] for n in range(words)]
        assert found == [[spi_shift.word(line, data_bits) for line in lines] for lines in cut]


EVIDENCE = {
    "equivalence": {"reset": {"qualifiers": {"spi_mosi_o": "!spi_cs_n_o", "data_o": "done_o word_o"}}},
    "faults": {"settle": 2, "driver": {"frame": "start_i", "strobe": "word_o", "repeat": 4}},
}


@pytest.mark.parametrize(
    "parameters",
    [
        {"Half": 3},
        {"Bits": 16, "DataBits": 16, "Lanes": 2, "Half": 1, "IdleHigh": 1},
        {"Bits": 16, "DataBits": 16, "Half": 1, "IdleHigh": 1, "Lead": 1},
        {"Bits": 16, "DataBits": 12, "Half": 3, "Lead": 1},
    ],
    ids=str,
)
def test_spi_shift(parameters):
    spi_shift.check(parameters.get("Bits", 19), parameters.get("DataBits", 12), parameters["Half"])
    bench.run("frontend", "spi_shift", parameters)


@pytest.mark.parametrize("parameters", [{"Half": 0}, {"DataBits": 1}, {"DataBits": 20}], ids=str)
def test_refuses_what_cannot_work(parameters):
    assert next(iter(parameters)) in bench.refuses("spi_shift", parameters)
    with pytest.raises(ValueError):
        spi_shift.check(19, parameters.get("DataBits", 12), parameters.get("Half", 13))
