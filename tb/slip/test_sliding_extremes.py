"""msn_sliding_extremes against its model: both tap counts, several lags and channel counts, full-scale
values, values that differ in one bit only, for each bit, gaps and stalls, and restarts before and after every
lag has filled."""

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.slip.peak_to_peak import sliding_extremes

FIELDS = ["high~", "low~", "side", "last", "restart"]


def beats_of(high, low):
    channels, length = high.shape
    side = np.arange(channels * length).reshape(length, channels).T % 200
    beats = bench.frames(high=high, low=low, side=side)
    for beat in beats:
        del beat["id"]
    return beats


def near(rng, channels, reach, bits):
    """Integers [channels, n]: runs of ``reach`` frames that differ in one bit only; two runs for each bit."""
    turns = -(-2 * bits // channels)
    bit = (np.arange(channels)[:, None] + channels * np.arange(turns)) % bits
    low, high = bench.width(bits)
    base = np.repeat(rng.integers(low, high + 1, (channels, turns)), reach, axis=1)
    values = base ^ (rng.integers(0, 2, base.shape) << np.repeat(bit, reach, axis=1))
    return np.where(values > high, values - 2 * (high + 1), np.where(values < low, values - 2 * low, values))


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5])
async def matches_model(dut, stall_rate):
    channels, lag, taps, bits = (
        getattr(dut, name).value.to_unsigned() for name in ("Channels", "Lag", "Taps", "DetailBits")
    )
    await bench.start(dut)
    rng = np.random.default_rng(bench.SEED)
    sent, expected = [], []
    # Restart when only some lags have filled, when all just have, and late.
    lengths = (1, lag, (taps - 1) * lag, 3 * taps * lag + 20)
    runs = [[bench.extremes_then_random(rng, channels, n, bits) for _ in range(2)] for n in lengths]
    runs += [[near(rng, channels, taps * lag + 8, bits) for _ in range(2)]]
    for high, low in runs:
        sent += beats_of(high, low)
        for beat, top, bottom in zip(
            beats_of(high, low), *(a.T.ravel() for a in sliding_extremes(high, low, lag, taps))
        ):
            expected.append(beat | {"high": int(top), "low": int(bottom)})
    pauses = bench.gaps_and_stalls(stall_rate)
    assert await bench.stream(dut, sent, FIELDS, *pauses) == expected


EVIDENCE = {
    "equivalence": {
        "size": {"Channels": 3},
        "reset_size": {"Channels": 1, "Taps": 2},
        "reset": {"framed": True},
    },
    "faults": {"size": {"Channels": 3}, "settle": 14},
}

SPACE = lambda draw: {
    "Channels": draw.randint(1, 12),
    "Lag": draw.randint(1, 8),
    "Taps": draw.choice([2, 4]),
    "SideBits": 8,
    "DetailBits": draw.randint(8, 20),
}


@pytest.mark.parametrize("channels, lag, taps", [(1, 1, 4), (1, 1, 2), (3, 2, 4), (16, 8, 4)])
def test_sliding_extremes(channels, lag, taps):
    parameters = {"Channels": channels, "Lag": lag, "Taps": taps, "SideBits": 8, "DetailBits": 18}
    bench.run("slip", "sliding_extremes", parameters)


def test_model_against_brute_force():
    x = np.random.default_rng(1).integers(-50, 50, (2, 60))
    for lag, taps in ((1, 2), (3, 4), (20, 4)):
        high, low = sliding_extremes(x, x, lag, taps)
        for t in range(60):
            seen = x[:, [t - j * lag for j in range(taps) if t >= j * lag]]
            assert np.array_equal(high[:, t], seen.max(axis=1))
            assert np.array_equal(low[:, t], seen.min(axis=1))


def test_refuses_illegal_parameters():
    assert "Taps = 3" in bench.refuses("sliding_extremes", {"Taps": 3})
    assert "Lag = 0" in bench.refuses("sliding_extremes", {"Lag": 0})
    assert "SideBits = 0" in bench.refuses("sliding_extremes", {"SideBits": 0})
    with pytest.raises(ValueError, match="taps = 3"):
        sliding_extremes([1], [1], 1, 3)
    with pytest.raises(ValueError, match="lag = 0"):
        sliding_extremes([1], [1], 0, 2)
