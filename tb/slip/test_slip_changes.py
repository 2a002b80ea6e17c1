"""msn_slip_changes against its model, and the model against a reference written from docs/link.md and scenes
worked out by hand: every change to every state, starts that wait and others that do not, changes without
room that come late or are lost, each bit of the mask alone, several channels in one detail, frames cut
anywhere, resets; the states that the host reads, also in the clock in which they change."""

from itertools import product

import cocotb
import numpy as np
import pytest

import bench
import members
from harness.refusals import refusals
from meissner.twins.slip.slip_changes import SlipChanges
from reference.slip_changes import CONTACT, GROSS, INCIPIENT, NONE, RELEASE, ChangesReference

LEGAL = {  # what may follow: state and whether it is the start of a slip
    NONE: [(NONE, 0), (CONTACT, 0)],
    CONTACT: [(CONTACT, 0), (INCIPIENT, 1), (GROSS, 1), (RELEASE, 0), (NONE, 0)],
    INCIPIENT: [(INCIPIENT, 0), (GROSS, 0), (CONTACT, 0), (RELEASE, 0), (NONE, 0)],
    GROSS: [(GROSS, 0), (CONTACT, 0), (RELEASE, 0), (NONE, 0)],
    RELEASE: [(RELEASE, 0), (CONTACT, 0), (NONE, 0)],
}


def walk(rng, channels, details, cut=0.1):
    """[(channel, state, raised, last)] of random details; a frame may be cut off after any channel."""
    states, found = [NONE] * channels, []
    for _ in range(details):
        stop = int(rng.integers(channels)) if rng.random() < cut else channels - 1
        for channel in range(stop + 1):
            options = LEGAL[states[channel]]
            states[channel], raised = options[int(rng.integers(len(options)))]
            found.append((channel, states[channel], raised, int(channel == channels - 1)))
    return found


class Port:
    """Offers decisions and takes changes; ``lost`` and ``changes``: what left."""

    def __init__(self, dut):
        self.dut, self.changes = dut, []

    async def offer(self, channel, state, raised=0, last=1, room=1, stall=0, p2p=7):
        """Offer until it is taken, a change ``stall`` clocks after it came out; returns the clocks waited."""
        dut, waited, seen = self.dut, 0, 0
        values = {"raised": raised, "last": last, "state": state, "p2p": p2p, "id": channel}
        dut.in_i.value, dut.in_valid_i.value = members.word("decision", values), 1
        while True:
            dut.room_i.value = room
            dut.out_ready_i.value = int(seen >= stall)
            await bench.ReadOnly()
            out, ready = dut.out_valid_o.value == 1, dut.in_ready_o.value == 1
            if out:
                seen += 1
                if dut.out_ready_i.value == 1:
                    assert ready
                    self.changes.append(members.of("change", bench.read(dut.out_o)))
            await bench.RisingEdge(dut.clk_i)
            if ready:
                dut.in_valid_i.value = 0
                return waited
            waited += 1
            assert waited < 99 + stall


def change(channel, p2p, start, late, told, state):
    return {"start": int(start), "late": int(late), "told": told, "state": state, "p2p": p2p, "id": channel}


def size(dut):
    return dut.Channels.value.to_unsigned()


async def begin(dut, events=31):
    await bench.start(dut, cfg_events_i=events, in_i=0, room_i=1, read_id_i=0)
    await bench.clocks(dut, size(dut) + 2)
    return Port(dut)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(room=[1.0, 0.5, 0.05])
async def matches_model(dut, room):
    rng = np.random.default_rng(bench.SEED)
    channels = size(dut)
    port, expected = await begin(dut), []
    for events in (31, int(rng.integers(32))):
        dut.cfg_events_i.value = events
        await bench.reset(dut)
        await bench.clocks(dut, channels + 2)
        twin, before = SlipChanges(channels, events), None
        for channel, state, raised, last in walk(rng, channels, max(12, 400 // channels)):
            free, p2p, stall = int(rng.random() < room), int(rng.integers(1 << 24)), int(rng.integers(3))
            number = channel if channels > 1 else int(rng.integers(1 << 16))  # of a single channel: any
            waited = await port.offer(number, state, raised, last, free, stall, p2p)
            # Clocks until the states are there of a channel that does not follow: nothing else may wait.
            ways = [(before + 1 + k) % channels for k in (0, 1)] if before is not None else [channel]
            cut = ways.index(channel) if channel in ways else 2
            found = twin.next(channel, state, raised, free)
            assert waited == cut + (stall if found else 0)
            expected += [change(number, p2p, *found)] if found else []
            if rng.random() < 0.2:
                await bench.clocks(dut, int(rng.integers(1, 4)))
            before = channel
        await bench.clocks(dut, 3)
        assert port.changes == expected and bench.read(dut.lost_o) == twin.lost
        states = []
        for channel in range(channels):
            dut.read_id_i.value = channel
            await bench.clocks(dut, 1)
            await bench.ReadOnly()
            states.append(bench.read(dut.read_state_o))
            await bench.RisingEdge(dut.clk_i)
        assert states == twin.now


# (decisions of channel 0 as (state, raised, room), what leaves as (start, late, told, state), lost)
BY_HAND = [
    # A whole slip: touched, slips, slips grossly, holds again, let go, gone.
    (
        [(0, 0, 1), (1, 0, 1), (1, 0, 1), (2, 1, 1), (2, 0, 1), (3, 0, 1), (1, 0, 1), (4, 0, 1), (0, 0, 1)],
        [(0, 0, 0, 1), (1, 0, 1, 2), (0, 0, 2, 3), (0, 0, 3, 1), (0, 0, 1, 4), (0, 0, 4, 0)],
        0,
    ),
    # No room for the contact: it comes late with the next detail that has room, and once.
    ([(1, 0, 0), (1, 0, 0), (1, 0, 1), (1, 0, 1)], [(0, 1, 0, 1)], 0),
    # A start needs no room; the contact before it is lost.
    ([(1, 0, 0), (2, 1, 0)], [(1, 0, 0, 2)], 1),
    # Released before there was room: one lost, and what comes is not late.
    ([(1, 0, 0), (4, 0, 1)], [(0, 0, 0, 4)], 1),
    # Touched and let go unheard: three changes lost, and there is nothing to say.
    ([(1, 0, 0), (4, 0, 0), (0, 0, 0), (0, 0, 1)], [], 3),
    # A slip that ends unheard and starts again: the start is sent though the host believes that it slips.
    ([(1, 0, 1), (2, 1, 1), (1, 0, 0), (2, 1, 0)], [(0, 0, 0, 1), (1, 0, 1, 2), (1, 0, 2, 2)], 1),
    # A start and its own end without room, then late.
    ([(1, 0, 1), (3, 1, 0), (1, 0, 0), (1, 0, 1)], [(0, 0, 0, 1), (1, 0, 1, 3), (0, 1, 3, 1)], 0),
]


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def does_as_worked_out_by_hand(dut):
    channels, lost = size(dut), 0
    port = await begin(dut)
    for decisions, leaves, more in BY_HAND:
        await bench.reset(dut)
        await bench.clocks(dut, channels + 2)
        port.changes.clear()
        for state, raised, room in decisions:
            for channel in range(channels):  # the others rest, and keep their own state
                values = (state, raised) if channel == channels - 1 else (NONE, 0)
                await port.offer(channel, *values, int(channel == channels - 1), room)
        await bench.clocks(dut, 2)
        assert port.changes == [change(channels - 1, 7, *one) for one in leaves]
        assert bench.read(dut.lost_o) == more, decisions
        lost += more
    assert lost == 6


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def each_bit_of_the_mask_is_its_own_states(dut):
    """Once around all states with a single bit of the mask, and with all others."""
    channels = size(dut)
    port = await begin(dut)
    way = [(CONTACT, 0), (INCIPIENT, 1), (GROSS, 0), (CONTACT, 0), (RELEASE, 0), (NONE, 0)]
    for events in [1 << bit for bit in range(5)] + [31 ^ 1 << bit for bit in range(5)] + [0]:
        dut.cfg_events_i.value = events
        await bench.reset(dut)
        await bench.clocks(dut, channels + 2)
        port.changes.clear()
        for state, raised in way:
            for channel in range(channels):
                await port.offer(channel, state, raised, int(channel == channels - 1))
        told = [NONE, CONTACT, INCIPIENT, GROSS, CONTACT, RELEASE]
        wanted = [
            change(channel, 7, raised, 0, before, state)
            for (state, raised), before in zip(way, told)
            for channel in range(channels)
            if events >> state & 1
        ]
        assert port.changes == wanted, events


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_state_is_read_in_the_clock_in_which_it_changes(dut):
    """read_state_o is the state after every decision taken before or in the clock of read_id_i."""
    channels = size(dut)
    port = await begin(dut)
    for state in (CONTACT, RELEASE, CONTACT, RELEASE, NONE):
        for channel in range(channels):
            dut.read_id_i.value = channel
            assert await port.offer(channel, state, 0, int(channel == channels - 1)) == 0
            await bench.ReadOnly()
            assert bench.read(dut.read_state_o) == state
            await bench.RisingEdge(dut.clk_i)


@bench.applies(lambda dut: size(dut) > 2)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def one_decision_a_clock_whatever_comes_first(dut):
    """From reset on: the first decision waits until the memories are cleared, all others go one a clock, and
    a frame cut off costs two clocks, or one if the second channel ahead comes."""
    channels = size(dut)
    port = await begin(dut)
    await bench.reset(dut)
    assert await port.offer(0, NONE, last=0) == channels
    waits = [
        await port.offer(channel, NONE, last=int(channel == channels - 1)) for channel in range(1, channels)
    ]
    waits += [await port.offer(channel, NONE, last=0) for channel in range(2)]
    assert waits == [0] * (channels + 1)
    assert [await port.offer(channel, CONTACT, last=0) for channel in range(2)] == [1 + (channels > 3), 0]
    assert [one["id"] for one in port.changes] == [0, 1]


@bench.applies(lambda dut: size(dut) > 1)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_reset_forgets_whatever_channel_comes_first(dut):
    """Offered from the reset on, while the states before it are being cleared."""
    channels = size(dut)
    port = await begin(dut)
    for first in range(channels):
        for channel in range(channels):
            await port.offer(channel, CONTACT, last=int(channel == channels - 1))
        port.changes.clear()
        await bench.reset(dut)
        await port.offer(first, RELEASE)
        assert port.changes == [change(first, 7, 0, 0, NONE, RELEASE)]
        await bench.reset(dut)
        await bench.clocks(dut, channels + 2)


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    await bench.turn_over(dut, "lost_o", most=3, wraps=False)


EVIDENCE = {"equivalence": {"size": {"Channels": 5}}}

SPACE = lambda draw: {"Channels": draw.randint(1, 40)}


@pytest.mark.parametrize("channels", [1, 2, 5, 64])
def test_slip_changes(channels):
    bench.run("slip", "slip_changes", {"Channels": channels})


test_refuses_illegal_parameters = refusals("slip_changes", SlipChanges, {"Channels": 0}, {"Channels": 4097})


def test_model_by_hand():
    for decisions, leaves, lost in BY_HAND:
        twin, reference = SlipChanges(3), ChangesReference(3)
        found = [twin.next(1, *one) for one in decisions]
        assert [one for one in found if one] == leaves and twin.lost == lost
        assert [reference.decision(1, *one) for one in decisions] == found and reference.lost == lost


@pytest.mark.parametrize("events, room", [*product([31, 1, 2, 4, 8, 16, 21, 0], [1.0, 0.5, 0.1, 0.0])])
def test_model_against_the_reference(events, room):
    """Also: every change is sent, lost or still owed, and what was sent is what the host then has."""
    rng = np.random.default_rng(events)
    twin, reference, host = SlipChanges(4, events), ChangesReference(4, events), [NONE] * 4
    again = 0  # starts of a slip that the host took for one that went on
    for channel, state, raised, _ in walk(rng, 4, 400):
        free = bool(rng.random() < room)
        found = twin.next(channel, state, raised, free)
        assert found == reference.decision(channel, state, bool(raised), free)
        if found:
            assert found.told == host[channel] or events != 31
            host[channel] = found.state
        again += bool(found and found.start and found.told == found.state)
    owed = sum(map(len, reference.owed))
    assert twin.lost == reference.lost and twin.now == reference.state
    if events == 31:
        assert reference.sent + reference.lost + owed == reference.changes
        assert [host[k] if reference.owed[k] else reference.state[k] for k in range(4)] == host
        assert (twin.lost > 0) == (room < 1) and (again > 0) == (room < 1)
