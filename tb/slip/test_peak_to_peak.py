"""msn_peak_to_peak against its model, and the model against SciPy's rank filters and brute force:
tumbling, half-overlapped and sliding windows, any hop, full-scale details, a crossing at every place of a
window, restarts in mid-window, 1 to 1024 channels, gaps and stalls, and the latency of each kind; masked
details, single ones and more than a window in a row."""

import cocotb
import numpy as np
import pytest
from scipy import ndimage

import bench
from meissner.twins.slip.peak_to_peak import PeakToPeak, sliding

FIELDS = ["p2p", "total~", "id", "last", "restart", "end", "mask"]


def parameters(dut):
    return [getattr(dut, n).value.to_unsigned() for n in ("Channels", "Span", "Hop", "DetailBits")]


def expected_beats(detail, total, span, hop, mask=None):
    channels = detail.shape[0]
    mask = np.zeros(detail.shape, bool) if mask is None else mask
    p2p, end = PeakToPeak(channels, span, hop).process(detail, mask)
    ends = np.broadcast_to(end, detail.shape)
    return [
        {k: v for k, v in beat.items() if k != "detail"}
        for beat in bench.frames(detail=detail, p2p=p2p, total=total, end=ends, mask=mask)
    ]


def masks(rng, shape, span):
    """Masks: single details, runs shorter and longer than a window, and in a long recording one to its
    end."""
    mask = rng.random(shape) < 0.15
    for channel in range(shape[0]):
        at = rng.integers(0, shape[1])
        mask[channel, at : at + rng.integers(1, 2 * span + 2)] = True
    if shape[1] > 3 * span:
        mask[-1, -2 * span :] = True
    return mask


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5])
async def matches_model(dut, stall_rate):
    channels, span, hop, bits = parameters(dut)
    await bench.start(dut)
    rng = np.random.default_rng(bench.SEED)
    sent, expected = [], []
    # Restarts: after one detail, in mid-window, exactly at a window's end, and late.
    lengths = (1, span // 2 + 1, span, 4 * span + 3) if channels < 100 else (span + 2,)
    for length in lengths:
        detail = bench.extremes_then_random(rng, channels, length, bits)
        total = bench.extremes_then_random(rng, channels, length, bits)
        mask = masks(rng, detail.shape, span)
        used = mask & bool(dut.Mask.value.to_unsigned())
        if used.any():
            detail = np.maximum(detail, 1 - (1 << (bits - 1)))
        sent += bench.frames(detail=detail, total=total, mask=mask)
        expected += expected_beats(detail, total, span, hop, used)
    pauses = bench.gaps_and_stalls(stall_rate)
    assert await bench.stream(dut, sent, FIELDS, *pauses) == expected


@bench.applies(lambda dut: parameters(dut)[0] <= 100)
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def tells_details_apart_that_hardly_differ(dut):
    """Windows of details that differ only in their last bits, for each number of last bits."""
    channels, span, hop, bits = parameters(dut)
    await bench.start(dut, in_mask_i=0)
    rng = np.random.default_rng(bench.SEED)
    low, high = bench.width(bits)
    common = rng.integers(low, high + 1, (channels, bits, 1))
    few = rng.integers(0, 1 << np.arange(bits)[:, None], (channels, bits, 2 * span))
    detail = (common >> np.arange(bits)[:, None] << np.arange(bits)[:, None] | few).reshape(channels, -1)
    got = await bench.stream(dut, bench.frames(detail=detail, total=detail), FIELDS)
    assert got == [beat | {"mask": 0} for beat in expected_beats(detail, detail, span, hop)]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def takes_details_until_a_result_waits(dut):
    _, span, hop, _ = parameters(dut)
    latency = 2 if hop == span else 3 if 2 * hop == span else 1 + span.bit_length() // 2
    await bench.start(dut, out_ready_i=0, in_mask_i=0)
    beats = [{"detail": 0, "total": 0, "id": 0, "last": 1, "restart": 1}] * 40
    assert await bench.taken(dut, beats) == latency


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    channels, span, hop, bits = parameters(dut)
    await bench.start(dut, in_mask_i=0)
    detail = bench.extremes_then_random(np.random.default_rng(bench.SEED), channels, span + 3, bits)
    beats = bench.frames(detail=detail, total=detail)
    for cut in (1, 2, 3, 5):
        await bench.taken(dut, beats[:cut], timeout=1)
        await bench.reset(dut)
        assert await bench.stream(dut, [], FIELDS) == []
    assert await bench.stream(dut, beats, FIELDS) == expected_beats(detail, detail, span, hop)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def shows_a_crossing_at_every_place_of_a_window(dut):
    channels, span, hop, _ = parameters(dut)
    await bench.start(dut, in_mask_i=0)
    for place in range(0, 2 * span, 1 if channels * span < 300 else 17):
        detail = np.zeros((channels, 3 * span), dtype=np.int64)
        detail[place % channels, place] = 1000
        detail[place % channels, place + span] = -1000
        got = await bench.stream(dut, bench.frames(detail=detail, total=detail), FIELDS)
        assert got == expected_beats(detail, detail, span, hop), f"crossing at detail {place}"


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def latency_is_as_stated(dut):
    _, span, hop, _ = parameters(dut)
    stages = (span.bit_length() - 1 + 1) // 2
    latency = 2 if hop == span else 3 if 2 * hop == span else 1 + stages
    await bench.start(dut, out_ready_i=1, in_mask_i=0)
    dut.in_detail_i.value = dut.in_total_i.value = dut.in_id_i.value = 0
    dut.in_last_i.value = dut.in_restart_i.value = dut.in_valid_i.value = 1
    await bench.RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    for clock in range(1, latency + 2):
        await bench.ReadOnly()
        assert dut.out_valid_o.value == (clock == latency), f"clock {clock}"
        await bench.RisingEdge(dut.clk_i)


EVIDENCE = {
    "equivalence": {
        "size": {"Channels": 3, "Hop": 4},
        "reset_size": {"Channels": 1, "Span": 32, "Hop": 32},
        "reset": {"framed": True},
    },
    "mutants": {"whole": True},
    "faults": {"size": {"Channels": 3, "Hop": 4, "Mask": 0}, "settle": 24, "driver": {"phases": 8}},
}


@pytest.mark.parametrize(
    "channels, span, hop, mask",
    [
        (1, 32, 32, 0),
        (5, 2, 2, 0),
        (1024, 4, 4, 0),
        (1, 32, 16, 0),
        (3, 8, 4, 0),
        (1, 32, 1, 0),
        (2, 16, 1, 0),
        (3, 16, 5, 0),
        (1, 2, 1, 0),
        (5, 8, 8, 1),
        (3, 8, 4, 1),
        (2, 16, 1, 1),
        (1, 32, 19, 1),
    ],
)
def test_peak_to_peak(channels, span, hop, mask):
    size = {"Channels": channels, "Span": span, "Hop": hop, "DetailBits": 18}
    bench.run("slip", "peak_to_peak", size | {"Mask": mask})


@pytest.mark.parametrize("span", [2, 4, 32, 64])
def test_sliding_model_against_scipy(span):
    x = np.random.default_rng(1).integers(-1000, 1000, (3, 300))
    origin = (span - 1) // 2 if span % 2 else span // 2 - 1  # the window ends at the sample
    high = ndimage.maximum_filter1d(x, span, origin=origin, mode="constant", cval=-(10**6))
    low = ndimage.minimum_filter1d(x, span, origin=origin, mode="constant", cval=10**6)
    assert np.array_equal(sliding(x, span)[:, span:], (high - low)[:, span:])


@pytest.mark.parametrize("masked", [False, True])
@pytest.mark.parametrize("span, hop", [(4, 4), (8, 4), (8, 3), (8, 1), (32, 16), (2, 1)])
def test_model_against_brute_force(span, hop, masked):
    """At a window's end p2p is the maximum minus the minimum of its unmasked details, 0 if there are none;
    within a tumbling window it never falls."""
    rng = np.random.default_rng(2)
    x, mask = rng.integers(-99, 99, (3, 150)), masks(rng, (3, 150), span) & masked
    p2p, end = PeakToPeak(3, span, hop).process(x, mask)
    assert np.array_equal(np.flatnonzero(end), np.arange(span - 1, 150, hop))
    empty = 0
    for last in np.flatnonzero(end):
        for channel in range(3):
            at = slice(last - span + 1, last + 1)
            window = x[channel, at][~mask[channel, at]]
            assert p2p[channel, last] == (np.ptp(window) if len(window) else 0)
            empty += not len(window)
    assert bool(empty) == masked
    if hop == span:
        assert (np.diff(p2p, axis=1)[:, (np.arange(149) + 1) % span != 0] >= 0).all()


@pytest.mark.parametrize("span, hop", [(8, 8), (8, 4), (8, 1), (8, 3)])
def test_model_in_chunks(span, hop):
    x = np.random.default_rng(3).integers(-99, 99, (2, 100))
    mask = masks(np.random.default_rng(3), x.shape, span)
    twin, cuts = PeakToPeak(2, span, hop), [1, 2, 5, 13, 14, 50, 66]
    parts = [twin.next(*part) for part in zip(*(np.split(a, cuts, axis=1) for a in (x, mask)))]
    p2p, end = twin.process(x, mask)
    assert np.array_equal(np.concatenate([p for p, _ in parts], axis=1), p2p)
    assert np.array_equal(np.concatenate([e for _, e in parts]), end)


def test_refuses_illegal_parameters():
    assert "Span = 12" in bench.refuses("peak_to_peak", {"Span": 12, "Hop": 12})
    assert "Hop = 33" in bench.refuses("peak_to_peak", {"Span": 32, "Hop": 33})
    assert "Channels = 0" in bench.refuses("peak_to_peak", {"Channels": 0})
    for span, hop, message in ((12, 12, "span = 12"), (32, 33, "hop = 33"), (1, 1, "span = 1")):
        with pytest.raises(ValueError, match=message):
            PeakToPeak(1, span, hop)
    with pytest.raises(ValueError, match="channels = 4097 must lie in"):
        PeakToPeak(4097)
