"""msn_forest_features against its model, and the model against a loop of its formula and a window worked out
by hand: both ends of the number range, windows of one frame and more, one channel and nine, restarts, resets,
gaps and stalls, chunks; every engine."""

import cocotb
import numpy as np
import pytest

import bench
from harness.refusals import refusals
from meissner.engines.features.forest_features.engines import ENGINES
from meissner.twins.forest.forest_features import ForestFeatures

FIELDS = ["data~", "last"]


def parameters(dut):
    return [getattr(dut, name).value.to_unsigned() for name in ("Channels", "SampleBits", "Window")]


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5])
async def matches_model(dut, stall_rate):
    """Three recordings, each from a restart on; the second one is too short for a window."""
    channels, bits, window = parameters(dut)
    await bench.start(dut)
    rng, beats, expected = np.random.default_rng(bench.SEED), [], []
    for length in (3 * window + 20, window, window + 9):
        x = bench.extremes_then_random(rng, channels, length, bits)
        beats += bench.frames(data=x)
        for row in ForestFeatures(channels, window, bits).process(x).tolist():
            expected += [{"data": value, "last": 0} for value in row[:-1]] + [{"data": row[-1], "last": 1}]
    pauses = bench.gaps_and_stalls(stall_rate)
    assert await bench.stream(dut, beats, FIELDS, *pauses, hold=True) == expected


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def offers_the_first_feature_to_a_follower_that_is_not_ready(dut):
    """In the third clock after the frame's last sample, for as long as it is not taken."""
    channels, _, window = parameters(dut)
    await bench.start(dut, out_ready_i=0)
    dut.in_valid_i.value = 1
    for beat in bench.frames(data=np.arange(channels * (window + 1)).reshape(-1, channels).T):
        bench.offer(dut, beat)
        await bench.RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    for clock in range(9):
        await bench.ReadOnly()
        assert bench.read(dut.out_valid_o) == (clock >= 2)
        assert clock < 2 or bench.as_signed(bench.read(dut.out_data_o), len(dut.out_data_o)) == channels
        await bench.RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def sends_a_window_in_as_many_clocks_and_takes_no_sample_meanwhile(dut):
    """The first feature is offered 3 clocks after the frame's last sample; then one a clock."""
    channels, _, window = parameters(dut)
    await bench.start(dut, out_ready_i=1)
    beats = bench.frames(data=np.arange(channels * (window + 1)).reshape(-1, channels).T)
    dut.in_valid_i.value = 1
    for beat in beats:
        bench.offer(dut, beat)
        await bench.ReadOnly()
        assert (dut.in_ready_o.value, dut.out_valid_o.value) == (1, 0)
        await bench.RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    seen = []
    for _ in range(channels * window + 5):
        await bench.ReadOnly()
        seen.append((bench.read(dut.in_ready_o), bench.read(dut.out_valid_o)))
        await bench.RisingEdge(dut.clk_i)
    words = channels * window
    assert [ready for ready, _ in seen[:words]] == [0] * words and seen[words][0] == 1
    assert [valid for _, valid in seen] == [0] * 2 + [1] * words + [0] * 3


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def recovers_after_reset(dut):
    """Reset for one clock at random times, in a frame, between two, and while features are sent."""
    channels, bits, window = parameters(dut)
    await bench.start(dut, out_ready_i=1)
    rng = np.random.default_rng(bench.SEED)
    for _ in range(20):
        x = bench.extremes_then_random(rng, channels, window + 4, bits)
        beats = bench.frames(data=x)
        dut.in_valid_i.value = 1
        sent = 0
        for _ in range(int(rng.integers(1, 2 * channels * (window + 3)))):
            bench.offer(dut, beats[min(sent, len(beats) - 1)])
            await bench.ReadOnly()
            sent += bench.read(dut.in_ready_o)
            await bench.RisingEdge(dut.clk_i)
        dut.in_valid_i.value = 0
        await bench.reset(dut)
        await bench.ReadOnly()
        assert (bench.read(dut.in_ready_o), bench.read(dut.out_valid_o)) == (1, 0)
        await bench.RisingEdge(dut.clk_i)
        rows = ForestFeatures(channels, window, bits).process(x).tolist()
        got = await bench.stream(dut, beats, FIELDS)
        assert [beat["data"] for beat in got] == [value for row in rows for value in row]
        assert [beat["last"] for beat in got] == ([0] * (channels * window - 1) + [1]) * len(rows)


EVIDENCE = {
    "equivalence": {"size": {"Channels": 3}},
    "faults": {"size": {"Channels": 3}, "settle": 4},  # a window, and the frames around it
}

SPACE = lambda draw: {
    "Channels": draw.randint(1, 12),
    "SampleBits": draw.randint(4, 18),
    "Window": draw.randint(1, 9),
}


@pytest.mark.parametrize("channels, bits, window", [(9, 17, 6), (1, 8, 1), (3, 6, 2)])
def test_forest_features(channels, bits, window):
    parameters = {"Channels": channels, "SampleBits": bits, "Window": window}
    bench.run("forest", "forest_features", parameters)


def test_a_window_by_hand():
    """Two channels: 10, 13, 9, 9 and -5, -5, 5, 4. Steps +3, -4, 0 and 0, +10, -1."""
    x = [[10, 13, 9, 9], [-5, -5, 5, 4]]
    assert ForestFeatures(2, 2).process(x).tolist() == [[3, 0, -4, 10], [-4, 10, 0, -1]]
    assert ForestFeatures(2, 3).process(x).tolist() == [[3, 0, -4, 10, 0, -1]]
    assert ForestFeatures(2, 4).process(x).shape == (0, 8)


@pytest.mark.parametrize("engine", ["float", "fixed", "rtl"])
@pytest.mark.parametrize("channels, window, length", [(9, 6, 50), (2, 3, 3), (2, 3, 4)])
def test_every_engine_gives_what_a_loop_gives(engine, channels, window, length):
    x = bench.extremes_then_random(np.random.default_rng(4), channels, 50, 17)[:, :length]
    rows = []
    for n in range(window, length):
        rows.append([])
        for k in range(n - window + 1, n + 1):
            rows[-1] += [int(x[c, k]) - int(x[c, k - 1]) for c in range(channels)]
    found = ENGINES[engine](x, window)
    assert found.dtype == np.int64 and found.tolist() == rows and found.shape[1] == channels * window


def test_model_in_chunks():
    x = bench.extremes_then_random(np.random.default_rng(3), 3, 60, 17)
    twin = ForestFeatures(3, 5)
    parts = [twin.next(part) for part in np.split(x, [1, 2, 2, 9, 40], axis=1)]
    assert np.array_equal(np.concatenate(parts), twin.process(x))


test_refuses_illegal_parameters = refusals(
    *("forest_features", ForestFeatures, {"Channels": 0}, {"Channels": 4097}),
    *({"Window": 0}, {"Window": 257}, {"SampleBits": 1}),
)
