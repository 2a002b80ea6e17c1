"""msn_adc_store against its twin: both ends of the range, these with any one bit inverted, then random codes;
words at random gaps, in order and not, a follower that stalls; complete frames, and bad ones.

Every sample leaves once it and all channels before it have arrived, pending_o is set until the last one is
taken, and a reset empties the store. The begin of a frame discards samples that wait for a channel that never
came, and changes nothing else.
"""

import random

import cocotb
import pytest
from cocotb.triggers import NextTimeStep, ReadOnly, RisingEdge

import bench
from meissner.twins.frontend.adc_store import channels_of_word, samples


def codes_of(draw, data_bits):
    """Endless codes: both ends of the range, each with any one bit inverted, then random ones."""
    top = (1 << data_bits) - 1
    ends = (0, top, top >> 1, (top >> 1) + 1)
    for end in ends:
        yield end
        yield from (end ^ 1 << bit for bit in range(data_bits))
    while True:
        yield draw.choice([*ends, draw.randint(0, top)])


def lanes_of(arriving, codes, data_bits):
    """The codes of a word's channels side by side; 0 on a lane whose code is not needed."""
    return sum(
        0 if channel is None else codes[channel] << lane * data_bits for lane, channel in enumerate(arriving)
    )


@cocotb.test(timeout_time=10, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.6])
async def matches_model(dut, stall_rate):
    names = ("Channels", "Lanes", "LaneChannels", "DataBits", "SampleBits", "Signed")
    channels, lanes, lane_channels, data_bits, sample_bits, is_signed = (
        getattr(dut, name).value.to_unsigned() for name in names
    )
    await bench.start(dut, begin_i=0, in_word_i=0, in_data_i=0, in_bad_i=0)
    draw = random.Random(bench.SEED)
    endless = codes_of(draw, data_bits)
    for frame in range(80):
        codes = [next(endless) for _ in range(channels)]
        data, over = samples(codes, data_bits, sample_bits, is_signed)
        here = [False] * channels
        taken = 0
        words = list(range(min(channels, lane_channels)))
        if frame % 4 == 3:
            draw.shuffle(words)
        while taken < channels:
            word = words[0] if words else 0
            arriving = channels_of_word(word, channels, lanes, lane_channels)
            begins = draw.random() < 0.3 and (here[taken] or not any(here))
            dut.begin_i.value = int(begins)
            offer = bool(words) and not begins and draw.random() < 0.3
            dut.in_valid_i.value = int(offer)
            dut.in_word_i.value = word % (1 << len(dut.in_word_i))
            dut.in_data_i.value = lanes_of(arriving, codes, data_bits)
            ready = draw.random() >= stall_rate
            dut.out_ready_i.value = int(ready)
            await ReadOnly()
            assert dut.out_valid_o.value == int(here[taken])
            takes = here[taken] and ready
            assert dut.pending_o.value == int(sum(here) > taken)
            if takes:
                beat = [bench.read(port) for port in (dut.out_id_o, dut.out_last_o, dut.out_user_o)]
                assert beat == [taken, taken == channels - 1, over[taken]]
                assert bench.as_signed(bench.read(dut.out_data_o), sample_bits) == data[taken]
                taken += 1
            if offer:
                for channel in arriving:
                    if channel is not None:
                        here[channel] = True
                words.pop(0)
            await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.6])
async def whole_frames_wait_for_their_last_word(dut, stall_rate):
    """Nothing leaves before the last word; if that is bad, nothing leaves at all."""
    names = ("Channels", "DataBits", "SampleBits", "Signed")
    channels, data_bits, sample_bits, is_signed = (getattr(dut, name).value.to_unsigned() for name in names)
    await bench.start(dut, begin_i=0, in_word_i=0, in_data_i=0, in_bad_i=0)
    draw = random.Random(bench.SEED)
    endless = codes_of(draw, data_bits)
    for frame in range(80):
        bad = frame % 3 == 1 or draw.random() < 0.2
        codes = [0] * channels if bad else [next(endless) for _ in range(channels)]
        data, over = samples(codes, data_bits, sample_bits, is_signed)
        word = taken = after = 0
        while word < channels or (after < 5 if bad else taken < channels):
            begins = word == 0 and draw.random() < 0.3
            dut.begin_i.value = int(begins)
            offer = word < channels and not begins and draw.random() < 0.5
            dut.in_valid_i.value = int(offer)
            dut.in_word_i.value = min(word, channels - 1)
            dut.in_data_i.value = codes[word] if offer else draw.getrandbits(data_bits)
            dut.in_bad_i.value = int(offer and bad and word == channels - 1)
            ready = draw.random() >= stall_rate
            dut.out_ready_i.value = int(ready)
            await ReadOnly()
            here = word == channels and not bad
            assert dut.out_valid_o.value == dut.pending_o.value == int(here)
            if here and ready:
                beat = [bench.read(port) for port in (dut.out_id_o, dut.out_last_o, dut.out_user_o)]
                assert beat == [taken, taken == channels - 1, over[taken]]
                assert bench.as_signed(bench.read(dut.out_data_o), sample_bits) == data[taken]
                taken += 1
            after += word == channels
            word += offer
            await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_frames_begin_forgets_what_would_wait_for_ever(dut):
    """Channel 0 leaves, 1 never comes, 2 waits until a frame begins; that frame is complete and in order."""
    names = ("Channels", "Lanes", "LaneChannels", "DataBits", "SampleBits", "Signed")
    channels, lanes, lane_channels, data_bits, sample_bits, is_signed = (
        getattr(dut, name).value.to_unsigned() for name in names
    )
    words = min(channels, lane_channels)
    await bench.start(dut, begin_i=0, in_word_i=0, in_data_i=0, in_bad_i=0, out_ready_i=1)

    async def put(word, codes):
        arriving = channels_of_word(word, channels, lanes, lane_channels)
        dut.in_valid_i.value = 1
        dut.in_word_i.value = word
        dut.in_data_i.value = lanes_of(arriving, codes, data_bits)
        await RisingEdge(dut.clk_i)
        dut.in_valid_i.value = 0

    for gap in range(1, words):
        for word in range(words):
            if word != gap:
                await put(word, [0] * channels)
        await bench.clocks(dut, channels + 2)
        await ReadOnly()
        assert dut.out_valid_o.value == 0
        left = words > gap + 1 or lanes > 1
        assert dut.pending_o.value == int(left)
        await RisingEdge(dut.clk_i)
        dut.begin_i.value = 1
        await RisingEdge(dut.clk_i)
        dut.begin_i.value = 0
        await ReadOnly()
        assert dut.pending_o.value == 0
        await RisingEdge(dut.clk_i)
        codes = [(gap + 3 * channel + 1) % (1 << data_bits) for channel in range(channels)]
        data, _ = samples(codes, data_bits, sample_bits, is_signed)
        seen = []
        for word in range(words + channels + 2):
            if word < words:
                await put(word, codes)
            else:
                await RisingEdge(dut.clk_i)
            await ReadOnly()
            if dut.out_valid_o.value == 1:
                seen.append(
                    (bench.read(dut.out_id_o), bench.as_signed(bench.read(dut.out_data_o), sample_bits))
                )
            await NextTimeStep()
        assert seen == list(enumerate(data))


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def reset_empties_it(dut):
    await bench.start(dut, begin_i=0, in_word_i=0, in_data_i=5, in_bad_i=0)
    dut.in_valid_i.value = 1
    await RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    await ReadOnly()
    assert dut.out_valid_o.value == 1
    await RisingEdge(dut.clk_i)
    await bench.reset(dut)
    await ReadOnly()
    assert dut.out_valid_o.value == 0
    assert dut.pending_o.value == 0


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def meets_every_other_event(dut):
    """One lane: a code in the clock in which the sample before it leaves; the begin of a frame while a sample
    is offered, in the clock in which the last one leaves, and a clock later; values and numbers worked out by
    hand."""
    channels = dut.Channels.value.to_unsigned()
    await bench.start(dut, begin_i=0, in_word_i=0, in_data_i=0, in_bad_i=0)

    async def clock(word=None, code=0, ready=0, begin=0):
        """One clock; returns the sample offered in it, (number, value), or None."""
        dut.in_valid_i.value, dut.begin_i.value, dut.out_ready_i.value = int(word is not None), begin, ready
        dut.in_word_i.value, dut.in_data_i.value = word or 0, code
        await ReadOnly()
        offered = (
            (bench.read(dut.out_id_o), bench.read(dut.out_data_o)) if dut.out_valid_o.value == 1 else None
        )
        await RisingEdge(dut.clk_i)
        return offered

    # A code for channel 0 in the clock in which its earlier sample leaves: it follows the other channels'.
    assert await clock(0, 101) is None
    assert await clock(0, 102, ready=1) == (0, 101)
    for channel in range(1, channels):
        assert await clock(channel, 200 + channel, ready=1) is None
        assert await clock(ready=0) == (channel, 200 + channel)
        assert await clock(ready=1) == (channel, 200 + channel)
    assert await clock() == await clock(ready=1) == (0, 102)
    for channel in range(1, channels):
        assert await clock(channel, 300 + channel) is None
        assert await clock(ready=1) == (channel, 300 + channel)
    # A begin while a sample is offered, stalled and taken, and in the clock in which the last one leaves.
    for channel in range(channels):
        await clock(channel, 400 + channel)
    assert await clock(begin=1) == (0, 400)
    for channel in range(channels):
        assert await clock(begin=1, ready=1) == (channel, 400 + channel)
    assert await clock(begin=1) is None and await clock() is None
    assert await clock(0, 500) is None
    assert await clock(ready=1) == (0, 500)
    # A begin with nothing offered: channel 0 is next, whichever channel left last.
    assert await clock(begin=1) is None
    assert await clock(0, 600) is None
    assert await clock(ready=1) == (0, 600)


EVIDENCE = {
    "equivalence": {"size": {"Lanes": 2}, "reset": {"ties": {"begin_i": "!in_valid_i"}}},
    "faults": {"inside": ["adc_spi", "u_store."]},
}


@pytest.mark.parametrize(
    "parameters",
    [{"Channels": 1}, {"Channels": 2}, {"Channels": 5}, {"Channels": 7, "SampleBits": 13}],
    ids=str,
)
def test_adc_store(parameters):
    bench.run("frontend", "adc_store", parameters, test_filter=r"^(?!.*whole_)")


def test_adc_store_of_two_lanes():
    parameters = {"Channels": 7, "Lanes": 2, "LaneChannels": 4, "DataBits": 16, "Signed": 1}
    bench.run("frontend", "adc_store", parameters, test_filter=r"^(?!.*(whole_|meets_))")


@pytest.mark.parametrize("channels", [1, 2, 3, 8])
def test_adc_store_whole(channels):
    bench.run("frontend", "adc_store", {"Channels": channels, "Whole": 1}, test_filter="whole_")


def test_refuses_whole_on_two_lanes():
    assert "Whole" in bench.refuses("adc_store", {"Channels": 8, "Lanes": 2, "Whole": 1})
    with pytest.raises(ValueError):
        channels_of_word(0, 8, 2, 4, whole=True)


@pytest.mark.parametrize(("sample_bits", "is_signed"), [(12, 0), (11, 1)])
def test_refuses_too_few_bits(sample_bits, is_signed):
    assert "SampleBits" in bench.refuses("adc_store", {"SampleBits": sample_bits, "Signed": is_signed})
    with pytest.raises(ValueError):
        samples([0], 12, sample_bits, is_signed)


def test_twin_refuses_what_is_no_code():
    for code in (-1, 4096):
        with pytest.raises(ValueError):
            samples([code], 12, 17, False)
