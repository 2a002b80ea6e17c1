"""msn_frame_check against its model: whole frames pass, every kind of damage is dropped, counted once,
and followed by a restart. Damage: missing, doubled, swapped samples; last early, late or lost."""

import random

import cocotb
import pytest

import bench
from meissner.common.frame_check import FrameCheck


def damaged_stream(channels, frames, rate, seed):
    """Ids and lasts of frames of which a share ``rate`` is damaged in a random way."""
    draw = random.Random(seed)
    beats = []
    for _ in range(frames):
        frame = [(c, c == channels - 1) for c in range(channels)]
        if draw.random() < rate:
            at = draw.randrange(channels)
            kind = draw.choice(["missing", "doubled", "wrong id", "early last", "lost last", "late last"])
            if kind == "missing":
                del frame[at]
            elif kind == "doubled":
                frame.insert(at, frame[at])
            elif kind == "wrong id":
                frame[at] = ((frame[at][0] + 1) % max(channels, 2), frame[at][1])
            elif kind == "early last":
                frame = [*frame[:at], (at, True)]
            elif kind == "lost last":
                frame[-1] = (channels - 1, False)
            else:
                frame = [*frame[:-1], (channels - 1, False), (channels - 1, True)]
        beats += frame
    return beats


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize(rate=[0.0, 0.4], stall_rate=[0.0, 0.5])
async def matches_model(dut, rate, stall_rate):
    channels = dut.Channels.value.to_unsigned()
    beats = damaged_stream(channels, 300 if channels < 50 else 6, rate, bench.SEED)
    model = FrameCheck(channels)
    kept, restart = model.process(*zip(*beats))
    await bench.start(dut, in_valid_i=0, out_ready_i=0)
    gaps, stalls = bench.pauses(stall_rate), bench.pauses(stall_rate)
    index = passed = 0
    while index < len(beats):
        offer, ready = not gaps(), not stalls()
        dut.in_valid_i.value = int(offer)
        dut.in_id_i.value, dut.in_last_i.value = beats[index][0], int(beats[index][1])
        dut.out_ready_i.value = int(ready)
        await bench.ReadOnly()
        assert dut.out_valid_o.value == int(offer and kept[index]), f"beat {index}"
        if offer and kept[index]:
            assert dut.out_restart_o.value == int(restart[index]), f"beat {index}"
        taken = offer and dut.in_ready_o.value == 1
        assert taken == (offer and (ready or not kept[index])), f"beat {index}"
        passed += taken and kept[index]
        index += taken
        await bench.RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    await bench.clocks(dut, 1)
    assert bench.read(dut.damaged_o) == model.damaged
    assert passed == sum(kept)
    assert (model.damaged == 0) == (rate == 0.0)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def restarts_after_reset_in_mid_frame(dut):
    channels = dut.Channels.value.to_unsigned()
    await bench.start(dut, in_valid_i=1, out_ready_i=1, in_id_i=0, in_last_i=int(channels == 1))
    await bench.clocks(dut, 1)
    await bench.reset(dut)
    dut.in_id_i.value, dut.in_last_i.value = 0, int(channels == 1)
    await bench.ReadOnly()
    assert dut.out_valid_o.value == 1
    assert dut.out_restart_o.value == 1
    assert bench.read(dut.damaged_o) == 0


@pytest.mark.parametrize("channels", [1, 2, 5, 8, 100])
def test_frame_check(channels):
    bench.run("common", "frame_check", {"Channels": channels})


def test_refuses_illegal_parameters():
    assert "Channels = 0" in bench.refuses("frame_check", {"Channels": 0})
    with pytest.raises(ValueError, match="channels = 0"):
        FrameCheck(0)
