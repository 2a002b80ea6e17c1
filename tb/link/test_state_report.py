"""msn_state_report against its model: the words of each packet in time for the line's fastest reader, at
every number of channels around a word and a packet; a state that changes while the report is under way is the
newer one from its word on; asked again before, during and between packets; the model by hand."""

import cocotb
import numpy as np
import pytest

import bench
from harness.refusals import refusals
from meissner.twins.link.states import report

FASTEST = 4  # clocks from one byte to the next


def size(dut):
    return dut.Channels.value.to_unsigned(), dut.First.value.to_unsigned()


class Reader:
    """Takes packets as msn_packet does; ``states`` are those of the memory, which answers a clock later."""

    def __init__(self, dut, states):
        self.dut, self.states = dut, list(states)
        self.ask = 0

    async def clock(self, take=0, step=0):
        """One clock; the word in it."""
        dut = self.dut
        dut.take_i.value, dut.step_i.value, dut.report_i.value, self.ask = take, step, self.ask, 0
        await bench.ReadOnly()
        place, word, self.end = bench.read(dut.read_id_o), bench.read(dut.word_o), dut.end_o.value == 1
        await bench.RisingEdge(dut.clk_i)
        dut.read_state_i.value = self.states[place] if place < len(self.states) else 7
        return word

    async def packet(self, pause=FASTEST, after=lambda words: None):
        """(first, left, words); each half word is read ``pause`` clocks after the one before."""
        dut, words = self.dut, []
        await self.clock()
        assert dut.chunk_valid_o.value == 1
        first, left = bench.read(dut.chunk_first_o), bench.read(dut.chunk_left_o)
        await self.clock(take=1)
        for _ in range(8):
            await self.clock()
        after(0)
        while True:
            halves = []
            for step in (0, 1):
                for _ in range(pause - 1):
                    await self.clock()
                halves.append(await self.clock(step=step))
            words.append(halves[0] & 0xFF | halves[1] & 0xFF00)
            after(len(words))
            if self.end:
                return first, left, words
            assert len(words) < 40


async def begin(dut):
    channels, first = size(dut)
    states = np.random.default_rng(bench.SEED).integers(0, 5, channels).tolist()
    await bench.start(dut, report_i=0, take_i=0, step_i=0, read_state_i=0)
    await bench.clocks(dut, 3)
    return Reader(dut, states), first


async def rest(reader):
    for _ in range(3):
        await reader.clock()


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(pause=[FASTEST, 9])
async def sends_the_models_words(dut, pause):
    reader, first = await begin(dut)
    for _ in range(2):
        await bench.ReadOnly()
        assert dut.chunk_valid_o.value == 0
        await bench.RisingEdge(dut.clk_i)
        reader.ask = 1
        await reader.clock()
        await rest(reader)
        for expected in report(reader.states, first):
            assert await reader.packet(pause) == expected
        await rest(reader)
        reader.states.reverse()


@bench.applies(lambda dut: size(dut)[0] > 4)
@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(when=[0, 1])
async def a_word_has_the_states_of_its_own_time(dut, when):
    """All states change when the first word has been fetched, or when the second begins to be."""
    reader, _ = await begin(dut)
    channels, _ = size(dut)
    reader.states, reader.ask = [1] * channels, 1
    await reader.clock()
    await rest(reader)
    words, changed = [], lambda count: count < when or setattr(reader, "states", [4] * channels)
    for _ in report(reader.states):
        words += (await reader.packet(after=changed))[2]
        await rest(reader)
    wanted = [1] * 4 + [4] * (channels - 4)
    assert words == [word for _, _, part in report(wanted) for word in part]


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def asked_again_it_starts_over(dut):
    reader, first = await begin(dut)
    packets = report(reader.states, first)
    # Thrice before it begins, also while it waits: once.
    for _ in range(3):
        reader.ask = 1
        await reader.clock()
        await reader.clock()
    for expected in packets:
        await rest(reader)
        assert await reader.packet() == expected
    await rest(reader)
    await bench.ReadOnly()
    assert dut.chunk_valid_o.value == 0
    await bench.RisingEdge(dut.clk_i)
    # During the first packet: this is completed, and then everything comes.
    reader.ask = 1
    await reader.clock()
    await rest(reader)
    assert await reader.packet(after=lambda count: setattr(reader, "ask", int(count == 1))) == packets[0]
    await rest(reader)
    for expected in packets:
        assert await reader.packet() == expected
        await rest(reader)
    await bench.ReadOnly()
    assert dut.chunk_valid_o.value == 0
    await bench.RisingEdge(dut.clk_i)
    # A reset forgets the request.
    reader.ask = 1
    await reader.clock()
    await bench.reset(dut)
    await rest(reader)
    await bench.ReadOnly()
    assert dut.chunk_valid_o.value == 0
    await bench.RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_report_comes_after_an_upset(dut):
    """Of each register, at rest: once what waits has been read, a report is the model's again."""
    reader, first = await begin(dut)
    for register in (dut.sending, dut.asked, dut.chunk_valid_o, dut.place, dut.which, dut.fits_q):
        await rest(reader)
        register.value = (1 << len(register)) - 1
        await rest(reader)
        while dut.chunk_valid_o.value == 1:
            await reader.packet()
            await rest(reader)
        reader.ask = 1
        await reader.clock()
        await rest(reader)
        for expected in report(reader.states, first):
            assert await reader.packet() == expected, register._name
            await rest(reader)


EVIDENCE = {
    "equivalence": {"size": {"Channels": 5}},
    # A frame is a report: asked for again during a packet, it comes after that one.
    "faults": {
        "size": {"Channels": 5},
        "settle": 2,
        "driver": {"frame": "report_i", "strobe": "step_i", "join": 1, "repeat": 4},
    },
}


@pytest.mark.parametrize(
    "channels, first", [(1, 65535), (1, 0), (4, 0), (5, 0), (128, 0), (129, 0), (263, 0)]
)
def test_state_report(channels, first):
    bench.run("link", "state_report", {"Channels": channels, "First": first})


def test_state_report_of_the_most_channels():
    bench.run("link", "state_report", {"Channels": 4096}, "sends_the_models_words")


def _model(channels=8, first=0):
    return report([0] * channels, first)


test_refuses_illegal_parameters = refusals(
    "state_report", _model, {"Channels": 0}, {"Channels": 4097}, {"First": 65536, "Channels": 1}, {"First": 1}
)


def test_model_by_hand():
    assert report([3], 65535) == [(65535, 1, [0x0003])]
    assert report([1, 2, 3, 4, 0, 1]) == [(0, 6, [0x4321, 0x0010])]
    states = [1] * 127 + [2, 3, 4]
    assert report(states) == [(0, 130, [0x1111] * 31 + [0x2111]), (128, 2, [0x0043])]
