"""msn_forest_memory against its model: every word of both banks written and read, in sizes that are no power
of two; requests with gaps, and the bank not read written at the same time; exact clocks; a word by hand."""

import random

import cocotb
import pytest

import bench
from harness.refusals import refusals
from meissner.twins.forest.forest import Forest, stored


def sizes(dut):
    names = ("Features", "FeatureBits", "Nodes", "Banks")
    return [getattr(dut, name).value.to_unsigned() for name in names]


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def answers_after_two_clocks(dut):
    features, bits, nodes, banks = sizes(dut)
    draw = random.Random(bench.SEED)
    await bench.start(dut, req_valid_i=0, write_i=0)
    words, due = {}, [None, None]
    for clock in range(6 * nodes * banks + 20):
        write = clock < nodes * banks or draw.random() < 0.5
        bank, address = divmod(clock % (nodes * banks), nodes)
        data = draw.getrandbits(64)
        dut.write_i.value, dut.write_bank_i.value = int(write), bank
        dut.write_address_i.value, dut.write_data_i.value = address, data
        read = clock > nodes * banks and draw.random() < 0.7
        asked = (draw.randrange(banks), draw.randrange(nodes), draw.randrange(1 << len(dut.req_tag_i)))
        read &= asked[:2] != (bank, address)
        dut.req_valid_i.value = int(read)
        dut.req_bank_i.value, dut.req_address_i.value, dut.req_tag_i.value = asked
        await bench.ReadOnly()
        assert dut.req_ready_o.value == 1
        answer = due.pop(0)
        assert dut.rsp_valid_o.value == int(answer is not None)
        if answer:
            assert (bench.read(dut.rsp_data_o), bench.read(dut.rsp_tag_o)) == answer
        due.append((stored(words[asked[:2]], features, bits), asked[2]) if read else None)
        if write:
            words[bank, address] = data
        await bench.RisingEdge(dut.clk_i)
    await bench.reset(dut)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def forgets_requests_at_a_reset(dut):
    await bench.start(dut, req_valid_i=1, write_i=0, req_bank_i=0, req_address_i=0)
    await bench.clocks(dut, 3)
    dut.req_valid_i.value = 0
    await bench.reset(dut)
    for _ in range(4):
        await bench.ReadOnly()
        assert dut.rsp_valid_o.value == 0
        await bench.RisingEdge(dut.clk_i)


EVIDENCE = {"faults": {"driver": {"kept": "memory"}}}

SPACE = lambda draw: {
    "Features": draw.randint(1, 256),
    "FeatureBits": draw.randint(2, 22),
    "Nodes": draw.randint(1, 90),
    "Banks": draw.randint(1, 2),
    "Walkers": draw.randint(1, 64),
}


@pytest.mark.parametrize(
    "features, bits, nodes, banks, walkers",
    [(9, 22, 37, 2, 16), (1, 2, 1, 1, 1), (256, 13, 2, 2, 64), (5, 8, 64, 1, 3)],
)
def test_forest_memory(features, bits, nodes, banks, walkers):
    size = {"Features": features, "FeatureBits": bits, "Nodes": nodes, "Banks": banks, "Walkers": walkers}
    bench.run("forest", "forest_memory", size)


def test_a_word_by_hand():
    """Kind 2, feature 5, threshold -3, leaf 258: all there with 3 bits of index and 3 of threshold."""
    word = 2 << 62 | 5 << 54 | (1 << 22) - 3 << 32 | 258
    assert stored(word, 6, 3) == word
    assert stored(word, 4, 3) == word - (4 << 54)  # feature 1
    assert stored(word, 6, 2) == 2 << 62 | 5 << 54 | 1 << 32 | 258  # 1 in two bits
    assert stored((1 << 64) - 1, 256, 22) == (1 << 64) - 1


test_refuses_illegal_parameters = refusals(
    "forest_memory",
    Forest,
    {"Features": 0},
    {"Features": 257},
    {"FeatureBits": 1},
    {"FeatureBits": 23},
    {"Nodes": 0},
    {"Banks": 3},
    alone=({"Walkers": 0},),
    **dict.fromkeys(("features", "classes", "trees", "nodes", "leaves"), 1),
)
