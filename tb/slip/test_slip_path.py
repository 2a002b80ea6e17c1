"""msn_slip_path: decisions against the twins, at every channel count up to 7 and above; at most 8
clocks from the sample that completes a group to its decision; damaged frames; reset in mid-frame."""

from dataclasses import replace

import cocotb
import numpy as np
import pytest

import bench
import members
from meissner.twins.slip.config import SlipConfig
from meissner.twins.slip.haar import haar, masked_groups
from meissner.twins.slip.slip import Slip
from meissner.twins.slip.slip_path import decide

FIELDS = ["state", "raised", "over", "p2p", "id", "last", "end"]
LEVELS = {"contact_level": 200, "release_level": 100, "threshold": 60, "gross_threshold": 110}
LEVELS |= {"keep_threshold": 35}
TIMES = {"hold": 3, "refractory": 4, "blank": 5}


def parameters(dut):
    return [getattr(dut, n).value.to_unsigned() for n in ("Channels", "Level", "Window", "Hop")]


def pace(dut):
    """Arguments for bench.stream: the serial path takes longer, and an offer must hold until it is taken."""
    return {"hold": True, "drain": 80} if dut.Serial.value.to_unsigned() else {}


def settings(dut):
    _, level, window, hop = parameters(dut)
    return SlipConfig(window=window, hop=hop, level=level, **LEVELS, **TIMES)


async def begin(dut, config):
    dut.in_mask_i.value = 0
    await bench.start(dut, actuator_moving_i=0, cfg_i=members.slip_word(config))


def recording(rng, channels, samples):
    """Codes that rest near 0, are pressed to about 150, with more or less noise: every state is visited."""
    pressed = np.repeat(rng.random((channels, samples // 25 + 1)) < 0.7, 25, axis=1)[:, :samples]
    tremor = np.repeat(rng.choice([5, 25, 60], (channels, samples // 10 + 1)), 10, axis=1)[:, :samples]
    return pressed * 150 + rng.integers(-tremor, tremor + 1)


def beats_of(x, **flags):
    beats = bench.frames(data=x, **flags)
    for beat in beats:
        del beat["restart"]
    return beats


def expected(x, config, mask=None, moving=False):
    """The twins' decisions as output beats, and their ``decide``."""
    found = decide(x, config, np.full(x.shape[1] >> config.level, moving), mask)
    ends = np.broadcast_to(found.end, found.p2p.shape)
    over = found.p2p > config.threshold
    if mask is not None:
        over &= ~masked_groups(mask, config.level)
    rows = bench.frames(state=found.state, over=over, p2p=found.p2p, end=ends, raised=found.raised)
    return [{field: row[field] for field in FIELDS} for row in rows], found


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    await bench.turn_over(dut, "damaged_o", "blanked_o", wraps=False)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.5])
async def matches_model(dut, stall_rate):
    """With masks of single samples and of up to two windows, in which a channel may take any value."""
    channels, _, window, _ = parameters(dut)
    config, rng = settings(dut), np.random.default_rng(bench.SEED)
    await begin(dut, config)
    x = recording(rng, channels, 3001 if channels < 100 else 40)
    mask = None
    if dut.Mask.value.to_unsigned():
        mask = rng.random(x.shape) < 0.002
        for channel, at in rng.integers(0, [x.shape[0], x.shape[1]], (6 * channels, 2)):
            mask[channel, at : at + rng.integers(1, 2 * window)] = True
        x = np.where(mask, rng.integers(-65536, 65536, x.shape), x)
    should, found = expected(x, config, mask)
    pauses = bench.gaps_and_stalls(stall_rate)
    beats = beats_of(x) if mask is None else beats_of(x, mask=mask)
    assert await bench.stream(dut, beats, FIELDS, *pauses, **pace(dut)) == should
    assert bench.read(dut.blanked_o) == found.blanked
    assert bench.read(dut.damaged_o) == 0
    if channels < 100:
        assert {row["over"] for row in should} == {False, True}
        assert len(np.unique(found.state)) == 5


def any_settings(rng, run, dut):
    """x, moving, config: each bit of each timer alone, levels and thresholds of any size; then all random."""
    channels, level, window, hop = parameters(dut)
    rises, moving, top = bool(run % 2), run % 4 == 2, 1 << 17 + level
    shift = run % 9
    x = (recording(rng, channels, 160) << shift) + rng.integers(0, 1 << shift, (channels, 160))
    sizes = [v << shift for v in (60, 110, 100 << level, 60 << level)] + rng.integers(0, 1 << shift, 4)
    sizes = [*sizes, int(rng.integers(0, 60 << shift))]
    if run >= 16:
        x = rng.integers(-1 << 16, 1 << 16, x.shape)
        sizes = [*rng.integers(0, top, 2), *rng.integers(-top // 2, top // 2, 2), rng.integers(0, top)]
    sign = 1 if rises else -1
    names = ("threshold", "gross_threshold", "contact_level", "release_level", "keep_threshold")
    registers = dict(zip(names, (int(v) * s for v, s in zip(sizes, (1, 1, sign, sign, 1)))))
    times = zip(("hold", "refractory", "blank"), (run, run + 5, run + 10))
    registers |= {name: 1 << at % 16 for name, at in times}
    return sign * x - (sign < 0), moving, SlipConfig(window, hop, level, contact_rises=rises, **registers)


# The serial path has its own test: tb/slip/test_slip_serial.py.
@bench.applies(lambda dut: parameters(dut)[0] <= 100 and not dut.Serial.value.to_unsigned())
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def settings_of_any_size_match_the_model(dut):
    rng, blanked = np.random.default_rng(bench.SEED), 0
    for run in range(24):
        x, moving, config = any_settings(rng, run, dut)
        await begin(dut, config)
        dut.actuator_moving_i.value = int(moving)
        should, found = expected(x, config, moving=moving)
        assert await bench.stream(dut, beats_of(x), FIELDS) == should, config
        assert bench.read(dut.blanked_o) == found.blanked
        blanked += found.blanked
    assert blanked > 0


@bench.applies(lambda dut: not dut.Serial.value.to_unsigned())  # serial: tb/slip/test_slip_serial.py
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def decides_at_most_8_clocks_after_the_pair(dut):
    """A crossing in the last channel; clocks count from the one that took the crossing sample."""
    channels, level, window, hop = parameters(dut)
    config = settings(dut)
    await begin(dut, config)
    dut.out_ready_i.value = 1
    group = 1 << level
    x = np.zeros((channels, 2 * group), dtype=int)
    x[-1, -1] = 1000
    dut.in_valid_i.value = 1
    for beat in beats_of(x):
        bench.offer(dut, beat)
        await bench.RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    clock = 0
    while clock == 0 or dut.out_valid_o.value == 0 or dut.out_over_o.value == 0:
        if clock:
            await bench.RisingEdge(dut.clk_i)
        clock += 1
        await bench.ReadOnly()
    stages = (window // group).bit_length() // 2
    exact = level + 3 + (2 if hop == window else 3 if 2 * hop == window else 1 + stages)
    dut._log.info(f"decision {clock} clocks after the sample pair, {channels} channels")
    assert bench.read(dut.out_id_o) == channels - 1
    assert clock == exact
    assert clock <= 8 + (level == 3)
    if (level, window) == (1, 64):  # the README's
        assert clock == {64: 6, 32: 7, 2: 8}[hop]


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(frames=[36, 37], lost=["first", "middle"])
async def starts_again_after_a_damaged_frame(dut, frames, lost):
    """A lost sample is counted as damage; from the next complete frame on, results are as after a reset.

    The damaged frame is the even or the odd one of a pair; the results of earlier frames are not checked.
    """
    channels = parameters(dut)[0]
    config = settings(dut)
    await begin(dut, config)
    rng = np.random.default_rng(bench.SEED + 1)
    length = 300 if channels < 100 else 20
    before, after = recording(rng, channels, frames), recording(rng, channels, length)
    broken = beats_of(before)
    if channels == 1:
        broken[-1]["last"] = 0  # with one channel a lost `last` is the only possible damage
        broken.append(broken[-1] | {"last": 1})
    else:
        del broken[-channels + (channels // 2 if lost == "middle" and channels > 2 else 0)]
    should, _ = expected(after, config)
    got = await bench.stream(dut, broken + beats_of(after), FIELDS, **pace(dut))
    assert got[len(got) - len(should) :] == should
    assert bench.read(dut.damaged_o) == 1


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def recovers_after_reset_in_mid_frame(dut):
    channels = parameters(dut)[0]
    config = settings(dut)
    await begin(dut, config)
    rng = np.random.default_rng(bench.SEED + 2)
    first = beats_of(recording(rng, channels, 7))
    await bench.stream(dut, first[: len(first) - channels // 2], FIELDS, **(pace(dut) | {"drain": 1}))
    await bench.reset(dut)
    # Again with every stage full, as the follower stalls.
    dut.out_ready_i.value = 0
    dut.in_valid_i.value = 1
    for beat in beats_of(recording(rng, channels, 100)):
        bench.offer(dut, beat)
        await bench.ReadOnly()
        full = dut.in_ready_o.value == 0
        await bench.RisingEdge(dut.clk_i)
        if full:
            break
    assert full
    dut.in_valid_i.value = 0
    await bench.reset(dut)
    x = recording(rng, channels, 200 if channels < 100 else 10)
    should, watched = expected(x, config)
    assert await bench.stream(dut, beats_of(x), FIELDS, **pace(dut)) == should
    assert bench.read(dut.blanked_o) == watched.blanked


EVIDENCE = {
    "equivalence": {"boxes": True},
    "faults": {
        "size": {"Channels": 3, "Window": 16},
        "short": {"TimerBits": 5},
        "settle": 160,
        "driver": {"phases": 16},
    },
    "icarus": {"runs": {"Serial": 1}},
}


@pytest.mark.parametrize(
    "parameters",
    [
        {"Channels": 1},
        {"Channels": 1, "Serial": 1},
        {"Channels": 2, "Hop": 32},
        {"Channels": 5, "Hop": 2},
        {"Channels": 7, "Level": 3},
        {"Channels": 3, "Level": 2, "Window": 16, "Hop": 12},
        {"Channels": 1024},
        {"Channels": 3, "Window": 16, "Mask": 1},
        {"Channels": 4, "Level": 2, "Window": 32, "Hop": 16, "Mask": 1},
        {"Channels": 3, "Level": 3, "Window": 64, "Hop": 8, "Mask": 1},
        {"Channels": 2, "Window": 16, "Hop": 2, "Mask": 1},
    ],
)
def test_slip_path(parameters):
    bench.run(
        "slip", "slip_path", {"Level": 1, "Window": 64, "Hop": parameters.get("Window", 64)} | parameters
    )


@pytest.mark.parametrize(
    "parameters",
    [
        {"Channels": 3, "Level": 2, "Window": 32, "Hop": 16, "Mask": 1},
        {"Channels": 2, "Window": 16, "Hop": 2},
    ],
)
def test_slip_path_by_hand(parameters):
    """Against a plain loop instead of the models: slip/slip_path_by_hand.py."""
    bench.run("slip", "slip_path", {"Level": 1} | parameters, module="slip_path_by_hand")


@pytest.mark.parametrize(
    "parameters, message",
    [
        ({"Window": 48}, "Window = 48"),
        ({"Window": 2}, "Window = 2"),
        ({"Window": 8, "Hop": 8, "Level": 3}, "Window = 8"),
        ({"Hop": 3}, "Hop = 3"),
        ({"Hop": 66}, "Hop = 66"),
        ({"Serial": 1, "Hop": 32}, "Serial = 1"),
        ({"Serial": 1, "Channels": 2}, "Serial = 1"),
        ({"Serial": 1, "Mask": 1}, "Mask = 1"),
        ({"SampleBits": 20, "Level": 1}, "SampleBits = 20 must be at most 19"),
        ({"SampleBits": 19, "Level": 2, "Window": 64}, "SampleBits = 19 must be at most 18"),
        ({"TimerBits": 17}, "TimerBits = 17"),
    ],
)
def test_refuses_illegal_parameters(parameters, message):
    assert message in bench.refuses("slip_path", parameters)


@pytest.mark.parametrize("level", [1, 2, 3])
@pytest.mark.parametrize("masked", [False, True])
def test_the_models_threshold_may_change_between_frames(level, masked):
    """The new threshold applies to each detail that a frame from the change on completes."""
    config, group = SlipConfig(level=level, window=64, **LEVELS, **TIMES), 1 << level
    x = recording(np.random.default_rng(5), 2, 400)
    mask = np.zeros(x.shape, bool) if masked else None
    p2p, total = decide(x, config).p2p, haar(x, level)[1]
    seen = set()
    for frame in (0, 1, 2, 7, 8, 9, 200, 399):
        twin, states = Slip(2, config), []
        for n in range(p2p.shape[1]):
            late = (n + 1) * group > frame
            twin.config = replace(config, threshold=20) if late else config
            states.append(twin.next(p2p[:, n : n + 1], total[:, n : n + 1], np.zeros(1, bool)))
        state = decide(x, config, mask=mask, change=(frame, 20)).state
        assert np.array_equal(state, np.concatenate(states, axis=1))
        seen.add(state.tobytes())
    assert len(seen) > 1


@pytest.mark.parametrize(
    "channels, hop, mask, message",
    [(1, 32, False, "hop = window"), (2, 64, False, "one channel"), (1, 64, True, "without a mask")],
)
def test_the_model_refuses_what_the_serial_path_cannot_do(channels, hop, mask, message):
    x = np.zeros((channels, 64), dtype=int)
    with pytest.raises(ValueError, match=message):
        decide(x, SlipConfig(hop=hop), mask=x > 0 if mask else None, serial=True)
