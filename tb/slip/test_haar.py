"""msn_haar against its model and the model against PyWavelets: sign, scale, odd lengths, constants, the
extremes of the number range, levels 1 to 3, 1 to 1024 channels, chunks, gaps and stalls, restarts; masks that
change."""

import cocotb
import numpy as np
import pytest
import pywt

import bench
from meissner.twins.slip.haar import Haar, haar, masked_groups


def parameters(dut):
    return [getattr(dut, name).value.to_unsigned() for name in ("Channels", "Level", "SampleBits")]


def masks(dut, rng, x):
    """Masks for x (a fifth of the samples, and at times all of them), and the masks that the model gets."""
    mask = (rng.random(x.shape) < 0.2) | (np.arange(x.shape[1]) % 40 > 30)
    return mask, mask & bool(dut.Mask.value.to_unsigned())


def check(beats, x, level, restarts=(0,), mask=None):
    """Compare beats with the model of x [channels, n], every field."""
    channels = x.shape[0]
    mask = np.zeros(x.shape, bool) if mask is None else mask
    detail, total = haar(x, level, mask)
    assert len(beats) == detail.size
    assert np.array_equal(bench.column(beats, "detail", channels), detail)
    assert np.array_equal(bench.column(beats, "total", channels), total)
    assert np.array_equal(bench.column(beats, "mask", channels), masked_groups(mask, level))
    assert np.array_equal(bench.column(beats, "id", channels)[:, 0], np.arange(channels))
    assert [b["last"] for b in beats] == [i % channels == channels - 1 for i in range(len(beats))]
    assert [b["restart"] for b in beats] == [i // channels in restarts for i in range(len(beats))]


FIELDS = ["detail~", "total~", "id", "last", "restart", "mask"]


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5])
async def matches_model(dut, stall_rate):
    channels, level, bits = parameters(dut)
    await bench.start(dut)
    length = 101 if channels < 50 else 9
    rng = np.random.default_rng(bench.SEED)
    x = bench.extremes_then_random(rng, channels, length, bits)
    if length > 60:  # the largest sums and details of each level, of both signs
        low, high = bench.width(bits)
        runs = np.concatenate([np.repeat([1, 1, 0, 0, 1, 0, 0, 1], 4), np.repeat([1, 0, 0, 1], 2)])
        x[:, 16:56] = np.where(runs, high, low)
    mask, used = masks(dut, rng, x)
    pauses = bench.gaps_and_stalls(stall_rate)
    got = await bench.stream(dut, bench.frames(data=x, mask=mask), FIELDS, *pauses)
    check(got, x, level, mask=used)


@bench.applies(lambda dut, surplus: surplus < 2 ** parameters(dut)[1])
@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(surplus=[1, 2, 3, 4, 7])
async def restart_begins_a_new_group(dut, surplus):
    """A restart drops the unfinished group, at whatever level it is."""
    channels, level, bits = parameters(dut)
    await bench.start(dut)
    rng = np.random.default_rng(bench.SEED + 1)
    first = bench.extremes_then_random(rng, channels, 2**level + surplus, bits)
    second = bench.extremes_then_random(rng, channels, 2 ** (level + 1), bits)
    mask, used = masks(dut, rng, first)
    mask[:, 2**level :] = used[:, 2**level :] = True  # masks in the unfinished group must not matter
    beats = bench.frames(data=first, mask=mask) + bench.frames(data=second, mask=np.zeros(second.shape))
    got = await bench.stream(dut, beats, FIELDS)
    x = np.concatenate([first[:, : 2**level], second], axis=1)
    used = np.concatenate([used[:, : 2**level], np.zeros(second.shape, bool)], axis=1)
    check(got, x, level, restarts=(0, 1), mask=used)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def takes_samples_until_a_result_waits(dut):
    """With results not taken, the first group goes in, and one more sample for each level in the pipeline."""
    channels, level, _ = parameters(dut)
    await bench.start(dut, out_ready_i=0)
    beats = bench.frames(data=np.arange(channels * 2 ** (level + 1)).reshape(-1, channels).T)
    assert await bench.taken(dut, beats) == (2**level - 1) * channels + level


def sample_by_sample(beats, channels, level):
    """The results for any beats, in complete frames or not: the levels are computed one after the other."""
    for _ in range(level):
        even, odd_next, restart, out = [(0, 0)] * channels, False, 0, []
        for beat in beats:
            (before, dark), even = even[0], [*even[1:], (beat["total"], beat["mask"])]
            odd = odd_next and not beat["restart"]
            if odd:
                masked = dark or beat["mask"]
                pair = {"detail": before - beat["total"], "total": before + beat["total"]}
                marks = {"mask": int(masked), "restart": restart}
                out.append(beat | ({"detail": 0, "total": 0} if masked else pair) | marks)
            else:
                restart = beat["restart"]
            odd_next = not odd if beat["last"] else odd_next
        beats = out
    return beats


@bench.applies(lambda dut: parameters(dut)[0] <= 50)
@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.4])
async def marks_count_for_the_sample_they_come_with(dut, stall_rate):
    """Complete frames fill the memories; then ids, `last` and restarts are random."""
    channels, level, bits = parameters(dut)
    await bench.start(dut)
    rng = np.random.default_rng(bench.SEED)
    low, high = bench.width(bits)
    x = rng.integers(low, high + 1, (channels, 2**level))
    beats = bench.frames(data=x, mask=np.zeros(x.shape))
    for _ in range(400):
        marks = {"last": rng.random() < 0.5, "restart": rng.random() < 0.1, "mask": rng.random() < 0.2}
        data, number = int(rng.integers(low, high + 1)), int(rng.integers(0, 2 ** len(dut.in_id_i)))
        beats.append({"data": data, "id": number} | {name: int(mark) for name, mark in marks.items()})
    pauses = bench.gaps_and_stalls(stall_rate)
    got = await bench.stream(dut, beats, FIELDS, *pauses)
    used = [{"total": b["data"], **b, "mask": int(b["mask"] and dut.Mask.value.to_unsigned())} for b in beats]
    expected = sample_by_sample(used, channels, level)
    assert got == [{name: beat[name] for name in got[0]} for beat in expected]


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    channels, level, bits = parameters(dut)
    await bench.start(dut)
    x = bench.extremes_then_random(np.random.default_rng(bench.SEED), channels, 2 ** (level + 1), bits)
    mask = np.zeros(x.shape, bool)
    beats = bench.frames(data=x, mask=mask)
    for cut in {2**k for k in range(level)} | {2**level}:
        await bench.taken(dut, beats[: cut * channels], timeout=3)
        dut.in_valid_i.value = 1  # nothing may be taken during a reset
        await bench.reset(dut)
        dut.in_valid_i.value = 0
        check(
            await bench.stream(dut, bench.frames(restart=False, data=x, mask=mask), FIELDS),
            x,
            level,
            (),
            mask,
        )


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def latency_is_one_clock_a_level(dut):
    channels, level, _ = parameters(dut)
    await bench.start(dut, out_ready_i=1)
    beats = bench.frames(data=np.arange(channels * 2**level).reshape(2**level, channels).T)
    dut.in_valid_i.value = 1
    for beat in beats:
        bench.offer(dut, beat)
        await bench.RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    await bench.clocks(dut, level - 1)
    await bench.ReadOnly()
    assert dut.out_valid_o.value == 1
    assert bench.read(dut.out_id_o) == channels - 1
    assert dut.out_last_o.value == 1


EVIDENCE = {
    "equivalence": {"size": {"Channels": 3}, "reset_size": {"Channels": 1, "Mask": 1}},
    "mutants": {"whole": True},
    "faults": {"size": {"Level": 2, "Mask": 0}, "settle": 8, "driver": {"phases": 8}},
    "icarus": {
        "refused": "a packed vector of vectors of which a process drives one element and an "
        "assignment another: refused"
    },
}

SPACE = lambda draw: {
    "Channels": draw.randint(1, 30),
    "Level": draw.randint(1, 3),
    "SampleBits": draw.randint(4, 18),
    "Mask": draw.randint(0, 1),
}


@pytest.mark.parametrize(
    "channels, level, mask",
    [(1, 1, 0), (3, 2, 0), (7, 3, 0), (1, 3, 0), (1024, 1, 0), (1, 1, 1), (3, 2, 1), (7, 3, 1)],
)
def test_haar(channels, level, mask):
    bench.run("slip", "haar", {"Channels": channels, "Level": level, "SampleBits": 17, "Mask": mask})


@pytest.mark.parametrize("level", [1, 2, 3])
@pytest.mark.parametrize("length", [8, 64, 101, 1007])
def test_model_against_pywavelets(level, length):
    """sqrt(2)**level times cD and cA, same sign; the samples left over at odd lengths give no result."""
    x = bench.extremes_then_random(np.random.default_rng(level), 3, length, 17)
    whole = length >> level << level
    detail, total = haar(x, level)
    coefficients = pywt.wavedec(x[:, :whole].astype(float), "haar", mode="periodization", level=level)
    scale = np.sqrt(2.0) ** level
    assert detail.dtype == np.int64
    assert np.array_equal(np.rint(coefficients[1] * scale), detail)
    assert np.array_equal(np.rint(coefficients[0] * scale), total)
    assert np.abs(coefficients[1] * scale - detail).max() < 1e-9


@pytest.mark.parametrize("value", [-65536, -1, 0, 1, 4095, 65535])
@pytest.mark.parametrize("level", [1, 2, 3])
def test_constant_gives_exactly_zero(value, level):
    detail, total = haar(np.full((2, 40), value), level)
    assert not detail.any()
    assert np.all(total == value * 2**level)


def test_model_in_chunks():
    x = np.random.default_rng(3).integers(-9, 9, (2, 100))
    for level in (1, 2, 3):
        twin = Haar(2, level)
        parts = [twin.next(part)[0] for part in np.split(x, [1, 2, 7, 50], axis=1)]
        assert np.array_equal(np.concatenate(parts, axis=1), twin.process(x)[0])


def test_refuses_illegal_parameters():
    assert "Level = 4" in bench.refuses("haar", {"Level": 4})
    assert "Channels = 4097" in bench.refuses("haar", {"Channels": 4097})
    assert "SampleBits = 1" in bench.refuses("haar", {"SampleBits": 1})
    with pytest.raises(ValueError, match="level = 4"):
        haar(np.zeros(8), 4)
    for channels in (0, 4097):
        with pytest.raises(ValueError, match=f"channels = {channels} must lie in 1 .. 4096"):
            Haar(channels)
