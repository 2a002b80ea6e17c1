"""The named configurations on engine rtl, from codes at the pins to bytes of the line: every packet equals
the model's, with its frame's time, and none is missing, also for arrays on which many taxels slip. The host
finds such a core, also through a pty, and shows slip and CoP."""

import tomllib
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

import bench
from harness.command import ended
from meissner import host
from meissner.builds import config
from meissner.engines.rtl_core import CoreOnPins
from meissner.host.pty import Pty
from meissner.scenes.core_stimulus import codes_of
from meissner.twins import core
from meissner.twins.link import bridge
from meissner.twins.link import packet as p
from meissner.twins.link.decoder import Decoder
from meissner.twins.link.register_map import GROUPS

ADDRESS = {
    f"{group.name}.{register.name}": register.address for group in GROUPS for register in group.registers
}
SECONDS = {"slip1": 0.9, "fingertip": 0.1, "cop4": 0.25, "full": 0.1}
# Frames to skip: to a held object shortly before it slips; cop4 slips 158 frames later.
SKIPPED = {"slip1": 30_000, "cop4": 150}


def images(packets):
    found = []
    for q in packets:
        if q.kind == p.IMAGE:
            if q.fields["first"] == 0:
                found.append((q.time, []))
            found[-1][1].extend(q.fields["taxels"])
    return found


def check(build, got, expected, frames):
    """Compare ``got``, the packets of ``frames`` frames begun, with the model's; the last two frames may be
    incomplete."""
    due = lambda found: [item for item in found if item[0] < frames - 2]
    # More taxels are touched in a frame than the queue takes, so of an array the starts alone are on time.
    kinds = (p.SLIP,) if build.kind == "array" else (p.SLIP, p.CHANGE)
    slips, cops = ([q for q in got if q.kind in kinds] for kinds in (kinds, (p.COP,)))
    events = [event for event in expected.changes if event[1] in kinds]
    heard = Counter()
    for q in got:
        if q.kind == p.CHANGE:  # each begins where the host's state is
            assert q.fields["told"] == heard[q.fields["channel"]] != q.fields["state"]
        if q.kind in (p.SLIP, p.CHANGE):
            heard[q.fields["channel"]] = q.fields["state"]
    assert [(q.kind, q.payload) for q in slips] == [(kind, payload) for _, kind, payload in events][
        : len(slips)
    ]
    assert len(slips) >= len(due(events))
    zero = cops[0].time if cops else slips[0].time - events[0][0] * build.period_clocks
    starts = {frame: zero + frame * build.period_clocks for frame in range(frames)}
    assert [q.time for q in slips] == [starts[frame] for frame, *_ in events][: len(slips)]
    if build.kind != "channels":
        # A CoP frame replaces an unsent earlier one, which does not happen with events as sparse as here.
        assert [q.payload for q in cops] == [payload for _, payload in expected.cop][: len(cops)]
        assert [q.time for q in cops] == [starts[frame] for frame, _ in expected.cop][: len(cops)]
        assert len(cops) >= len(due(expected.cop)) == frames - 2
    if build.link.images:
        frame_of = {time: frame for frame, time in starts.items()}
        whole = [(time, taxels) for time, taxels in images(got) if len(taxels) == expected.images.shape[1]]
        assert whole
        for time, taxels in whole:
            assert taxels == expected.images[frame_of[time]].tolist()


@pytest.mark.parametrize("name", SECONDS)
def test_every_packet_is_the_models(name):
    build = config.load(name)
    codes = codes_of(build)[SKIPPED.get(name, 0) :]
    if name == "full":
        codes = codes[:: max(1, len(codes) // 25)]  # compress the press into a few frames
    with CoreOnPins(build, codes) as built:
        decoder = Decoder()
        got = decoder.next(built.run(round(SECONDS[name] * 1000 * build.clk_khz)))
        frames = built.frames
    assert decoder.damaged == 0 and bench.unbroken(got)
    expected = core.expected(build, codes[np.arange(frames) % len(codes)])
    assert expected.slip or build.kind == "array"
    check(build, got, expected, frames)


SOON = {"slip.hold": 2, "slip.refractory": 1, "slip.blank": 3}
PATCH = {  # the rows and columns of the taxels that slip
    "fingertip": (range(3), range(1, 3)),
    "array64": (range(20, 30), range(7, 13)),
    "full": (range(33, 38), range(50, 52)),  # its images leave room for one event per frame
}
SLIPS = 2  # per taxel of the patch, one in each window except the first


def sliding(build, rows, columns):
    """Codes [frames, rows, columns]: unpressed while the zeros settle; then a patch is pressed, and each of
    its taxels drops for one sample in every window, each at its own time."""
    i, j = np.indices(build.shape)
    window = build.slip.window
    codes = np.tile(30 + (3 * i + 5 * j) % 17, ((SLIPS + 1) * window + 4, 1, 1))
    for k, (row, column) in enumerate((row, column) for row in rows for column in columns):
        codes[20:, row, column] += 900 + 7 * k
        for slip in range(1, SLIPS + 1):
            codes[slip * window + 2 * (4 + 5 * k % 11) + 1, row, column] -= 150 + 3 * k + 20 * slip
    return codes


@pytest.mark.parametrize("name", PATCH)
def test_every_taxel_that_slips_is_reported(name):
    """The times of the slip states are first written over the line, short enough for a slip in every
    window."""
    build = config.load(name)
    codes = sliding(build, *PATCH[name])
    decoder, got = Decoder(), []
    with CoreOnPins(build, codes) as built:
        for tag, (register, value) in enumerate(SOON.items()):
            built.write(bridge.command(bridge.WRITE, tag, ADDRESS[register], value))
            got += decoder.next(built.run(round(0.0006 * 1000 * build.clk_khz)))
        got += decoder.next(built.run(len(codes) * build.period_clocks - built.now))
        frames = built.frames
    assert decoder.damaged == 0 and bench.unbroken(got)
    answers = [q.fields["status"] for q in got if q.kind == p.ANSWER]
    assert answers == [bridge.DONE] * len(SOON)
    changed = {register.partition(".")[2]: value for register, value in SOON.items()}
    build = replace(build, slip=replace(build.slip, **changed))
    expected = core.expected(build, codes[:frames])
    rows, columns = PATCH[name]
    slips = Counter(int.from_bytes(payload[:2], "little") for _, payload in expected.slip)
    assert slips == {row * codes.shape[2] + column: SLIPS for row in rows for column in columns}
    check(build, got, expected, frames)


def test_the_host_finds_a_core_behind_a_pty_and_hears_slip_and_cop():
    build = config.load("cop4")
    with (
        CoreOnPins(build, codes_of(build)[SKIPPED["cop4"] :]) as built,
        Pty(built) as pty,
        host.connect(pty.url, build.units, timeout_s=600.0) as found,
    ):
        assert found["core.clk_khz"] == build.clk_khz
        assert found["cop4.kx"] == build.settings["cop4.kx"]
        seen = set()
        for packet in found.packets():
            seen.add(type(packet))
            if seen >= {host.SlipEvent, host.CopFrame}:
                break
    assert seen >= {host.SlipEvent, host.CopFrame}


def test_live_shows_a_core_on_verilator():
    code, shown, _ = ended(lambda lines: lines and "load" in lines[-1], "live", "core:cop4")
    assert code == 0 and "load" in shown[-1] and "slip" in shown[-1], shown


# The published slip, then the plate held for 0.3 s and let go: (s, type, the state before, the state).
STORY = [(0.42, 6, 0, 1), (3.86, 1, 1, 2), (4.20, 6, 2, 3), (5.65, 6, 3, 1), (5.80, 6, 1, 4), (5.95, 6, 4, 0)]


@pytest.mark.parametrize("smallest", [False, True])
def test_the_line_tells_the_whole_slip(smallest):
    """Every change of acrylic_slip's channel in order, and on request its state; nothing is lost."""
    tables = tomllib.loads((config.FOLDER / "slip1.toml").read_text("utf-8"))
    tables["clock"]["mhz"] = 4.0
    if not smallest:
        tables["link"], tables["slip"]["serial"] = {"baud": 1_000_000, "statistics": False}, False
    build = config.read("plate", tables)
    scene = codes_of(build)
    codes = np.concatenate([scene, np.repeat(scene[-1:], 3000, axis=0), np.full((3000, 1), 4095)])
    decoder, got = Decoder(), []
    with CoreOnPins(build, codes) as built:
        got += decoder.next(built.run((len(codes) - 2) * build.period_clocks))
        if not smallest:
            built.write(bridge.command(bridge.WRITE, 3, ADDRESS["link.states"], 1))
            built.write(bridge.command(bridge.READ, 4, ADDRESS["link.changes_lost"]))
            got += decoder.next(built.run(20 * build.period_clocks))
    assert decoder.damaged == 0 and bench.unbroken(got)
    told = [q for q in got if q.kind in (p.SLIP, p.CHANGE)]
    assert [(q.kind, q.payload) for q in told] == [
        (kind, payload) for _, kind, payload in core.expected(build, codes).changes
    ]
    seconds = [round(q.time / (1000 * build.clk_khz), 2) for q in told]
    before = [1 if q.kind == p.SLIP else q.fields["told"] for q in told]
    assert [*zip(seconds, (q.kind for q in told), before, (q.fields["state"] for q in told))] == STORY
    if not smallest:
        (states,) = [q.fields for q in got if q.kind == p.STATES]
        assert states == {"first": 0, "left": 1, "states": (0,)}
        answers = [(q.fields["tag"], q.fields["status"], q.fields["data"]) for q in got if q.kind == p.ANSWER]
        assert answers == [(3, bridge.DONE, 0), (4, bridge.DONE, 0)]
