"""Three channels at the pins of a MAX11125, packets and commands on the line: each slip setting, through its
register, changes what it should and nothing else; no two have the same value, each limit is met exactly and
missed by one. Events are those of a loop written from docs/slip.md, each with the clock of the CS edge that
began its frame; each counter has its own value, in its register and in its statistic."""

import cocotb
import numpy as np

import bench
from core import pins
from core.wires import SEEN
from parts.max1112x import Max1112x

PERIOD = 181
CHANNELS, WINDOW = 3, 4
NONE, CONTACT, INCIPIENT, GROSS, RELEASE = range(5)
SETTINGS = {
    **{"threshold": 201, "gross_threshold": 603, "contact_level": 2000, "release_level": 1500},
    **{"contact_rises": 1, "hold": 3, "refractory": 5, "blank": 7},
}
# Per channel: the sum of a detail's two samples, from which detail on, and their difference in some details.
LEVELS = {0: {0: 900}, 1: {0: 1000, 2: 3000, 26: 1600, 29: 1400, 30: 1000}, 2: {0: 1200, 4: 2600, 31: 1000}}
STEPS = {
    0: {3: 900, 9: -900, 21: 700},
    1: {5: 300, 9: -300, 11: 300, 17: 400, 19: 210, 21: 704, 27: 300},
    2: {13: 250, 15: 230, 23: 605, 25: -202},
}
DETAILS = 32
MOVING = (27, 28)  # details during which the actuator moves


def scene():
    """Codes [frames, channels]."""
    codes = np.zeros((2 * DETAILS, CHANNELS), dtype=int)
    for channel in range(CHANNELS):
        level = 0
        for detail in range(DETAILS):
            level = LEVELS[channel].get(detail, level)
            step = STEPS[channel].get(detail, 0)
            codes[2 * detail, channel] = (level + step) // 2
            codes[2 * detail + 1, channel] = (level - step) // 2
    return codes


class Contact:
    """One channel, detail by detail: docs/slip.md."""

    def __init__(self):
        self.state, self.quiet, self.deaf, self.blanks, self.window = NONE, 0, 0, False, []

    def step(self, first, second, place, moving, s):
        """(event or None, details blanked)"""
        if place % (WINDOW // 2) == 0:
            self.window = []
        self.window.append(first - second)
        p2p, level = max(self.window) - min(self.window), first + second
        if s["contact_rises"]:
            pressed, lifted = level >= s["contact_level"], level < s["release_level"]
        else:
            pressed, lifted = level <= s["contact_level"], level > s["release_level"]
        over, gross = p2p > s["threshold"], p2p > s["gross_threshold"]
        before, event, blanked = self.state, None, 0
        if before in (CONTACT, INCIPIENT, GROSS) and lifted:
            self.state, self.quiet = RELEASE, 0
        elif before in (INCIPIENT, GROSS):
            blanked = int(over and moving)
            if over and not moving:
                self.quiet = 0
                self.state = GROSS if gross else before
            else:
                self.quiet += 1
                if self.quiet > s["hold"]:
                    self.state, self.deaf, self.blanks = CONTACT, s["refractory"], False
        elif before == CONTACT:
            blanked = int(over and (moving or (self.deaf > 0 and self.blanks)))
            if over and not moving and not self.deaf:
                self.state, self.quiet = GROSS if gross else INCIPIENT, 0
                event = p2p, self.state
            self.deaf = max(0, self.deaf - 1)
        elif pressed:
            self.state, self.deaf, self.blanks = CONTACT, s["blank"], True
        elif before == RELEASE:
            self.quiet += 1
            if self.quiet > s["hold"]:
                self.state = NONE
        return event, blanked


def run(contacts, codes, s):
    """The results of a pass of ``codes``: events [(frame, (channel, p2p, state))], details blanked, and after
    each detail (touched, gross, slip) of all channels together."""
    events, blanked, flags = [], 0, []
    for detail in range(len(codes) // 2):
        for channel, contact in enumerate(contacts):
            pair = codes[2 * detail : 2 * detail + 2, channel].tolist()
            event, ignored = contact.step(*pair, detail, detail in MOVING, s)
            blanked += ignored
            if event:
                events.append((2 * detail + 1, (channel, *event)))
        states = [contact.state for contact in contacts]
        touched = any(state in (CONTACT, INCIPIENT, GROSS) for state in states)
        flags.append((int(touched), int(GROSS in states), int(GROSS in states or INCIPIENT in states)))
    return events, blanked, flags


class Prompt(Max1112x):
    """Without the delays of its bits: other tests check that the core allows for them."""

    def drive(self, lane, bit, delay, hold=0.0):
        self.miso.value = bit


class Core:
    async def begin(self, dut):
        self.dut, self.codes, self.frame = dut, None, -1

        def part(dut):
            return Prompt(dut.adc_cs_n_o, dut.adc_sclk_o, dut.adc_mosi_o, dut.adc_miso_i, 12, self.code)

        self.host, self.part = await pins.begin(dut, part, pins.LineHost)
        self.starts = pins.Edges(self.host, dut.adc_cs_n_o, to=0, gap=45)  # of a frame, not of a word
        await self.host.write(adc__period=PERIOD)
        await self.host.set({f"slip.{name}": value for name, value in SETTINGS.items()})
        return self

    def code(self, channel, _):
        """A frame asks for channel 0 first, and for one channel more than it uses."""
        if channel == 0:
            self.frame += 1
        if channel >= CHANNELS:
            return 0
        return int(self.codes[max(0, min(self.frame, len(self.codes) - 1))][channel])

    async def convert(self, codes, period=PERIOD, every=1, moving=MOVING):
        """Convert frames of ``codes``, one in ``every`` ticks; returns (slip packets, convert starts, flags
        after each detail)."""
        first, since, flags = len(self.host.packets), len(self.starts.at), []
        self.codes, self.frame = codes, -1
        await self.host.write(adc__period=period)
        # A command takes effect with its last byte.
        *enable, go = self.host.command(1, 250, pins.ADDRESS["adc.enable"], 1)
        *disable, stop = self.host.command(1, 249, pins.ADDRESS["adc.enable"], 0)
        await self.host.send([*enable, go])
        for n in range(len(codes)):
            while len(self.starts.at) <= since + n:
                await pins.rest(self.dut, 5)
            self.dut.actuator_moving_i.value = int(n // 2 in moving)
            if n == 2:
                cocotb.start_soon(self.host.send(disable))
            if n == len(codes) - 1:
                await self.host.send([stop])
                await pins.rest(self.dut, 200)
            else:
                await pins.rest(self.dut, every * period - 30)
            if n % 2:
                flags.append(self.flags())
        self.dut.actuator_moving_i.value = 0
        await pins.rest(self.dut, 4000)  # until the line is idle
        starts = self.starts.at[since:]
        assert len(starts) == len(codes)
        return self.host.of_kind(pins.SLIP, first), starts, flags

    def flags(self):
        return tuple(bench.read(getattr(self.dut, f"{name}_o")) for name in ("touched", "gross", "slip"))


@cocotb.test(timeout_time=200, timeout_unit="ms")
async def each_setting_changes_its_own_events(dut):
    core = await Core().begin(dut)
    codes, contacts, total = scene(), [Contact() for _ in range(CHANNELS)], 0
    changes = [{}, {"threshold": 299}, {"threshold": 300}, {"gross_threshold": 703}, {"gross_threshold": 704}]
    changes += [{"contact_level": 2600}, {"contact_level": 2601}, {"release_level": 1600}]
    changes += [{"release_level": 1601}, {"contact_rises": 0}, {"hold": 4}, {"refractory": 2}, {"blank": 6}]
    outcomes = {}
    for change in changes:
        await core.host.set({f"slip.{name}": value for name, value in change.items()})
        await bench.clocks(dut, 200)
        slips, starts, flags = await core.convert(codes)
        events, blanked, wanted = run(contacts, codes, SETTINGS | change)
        total += blanked
        assert [pins.slip_of(packet) for packet in slips] == [event for _, event in events], change
        assert set(np.diff(starts)) == {PERIOD}
        assert [packet.time for packet in slips] == [starts[frame] for frame, _ in events]
        assert flags == wanted, change
        assert await core.host.read("slip.damaged", "slip.blanked") == [0, total], change
        outcomes[tuple(change.items())] = str(events), blanked, str(wanted)
        await core.host.set({f"slip.{name}": SETTINGS[name] for name in change})
    assert len(set(outcomes.values())) >= len(changes) - 3, "limits met exactly change nothing"


@cocotb.test(timeout_time=200, timeout_unit="ms")
async def every_change_is_sent_and_each_bit_of_events_is_its_own(dut):
    """All changes of all channels in order, with their times; then each state alone; then the states on
    request, which are those of the last detail also while the converter is off."""
    core = await Core().begin(dut)
    codes, contacts, seen = scene(), [Contact() for _ in range(CHANNELS)], set()
    for events in (0b11111, 0b00001, 0b00010, 0b00100, 0b01000, 0b10000, 0):
        await core.host.set({"link.events": events})
        first = len(core.host.packets)
        _, starts, _ = await core.convert(codes, period=600)
        wanted = []
        for detail in range(DETAILS):
            for channel, contact in enumerate(contacts):
                before = contact.state
                pair = codes[2 * detail : 2 * detail + 2, channel].tolist()
                contact.step(*pair, detail, detail in MOVING, SETTINGS)
                if contact.state != before and events >> contact.state & 1:
                    wanted.append((starts[2 * detail + 1], channel, before, contact.state))
        assert pins.changes_of(core.host.packets[first:]) == wanted, events
        seen |= {(before, after) for *_, before, after in wanted}
        await core.host.write(link__states=1)
        await pins.rest(dut, 2000)
        states = [contact.state for contact in contacts]
        assert core.host.of_kind(pins.STATES)[-1].payload == bytes(
            [0, 0, 3, 0, states[0] | states[1] << 4, states[2]]
        )
    assert seen >= {(0, 1), (1, 2), (1, 3), (2, 1), (3, 1), (1, 4), (4, 0)}
    assert len(core.host.of_kind(pins.STATES)) == 7
    assert await core.host.read("link.changes_lost") == [0]


@cocotb.test(timeout_time=200, timeout_unit="ms")
async def settings_that_are_held_take_effect_with_one_frame(dut):
    """While core.hold is 1 the core keeps the settings of before, though frames pass; then it takes all."""
    core = await Core().begin(dut)
    codes, contacts = scene(), [Contact() for _ in range(CHANNELS)]
    changes = {"threshold": 300, "gross_threshold": 704, "hold": 4}
    seen = []
    for hold, settings in ((1, SETTINGS), (0, SETTINGS | changes)):
        await core.host.set({"core.hold": hold})
        if hold:
            await core.host.set({f"slip.{name}": value for name, value in changes.items()})
            assert await core.host.read("slip.threshold", "slip.hold") == [300, 4]
        await bench.clocks(dut, 200)
        slips, _, flags = await core.convert(codes)
        events, _, wanted = run(contacts, codes, settings)
        assert [pins.slip_of(packet) for packet in slips] == [event for _, event in events]
        assert flags == wanted
        seen.append(wanted)
    assert seen[0] != seen[1]


@cocotb.test(timeout_time=200, timeout_unit="ms")
async def what_goes_wrong_is_counted_where_it_belongs(dut):
    """5 samples at an end of the range, 2 answers of another channel, 3 corrupted commands, 9 ticks too
    early: no other counter changes."""
    core = await Core().begin(dut)
    counters = ("adc.dropped", "adc.overrun", "adc.timeout", "adc.mistagged", "adc.over_range")
    counters += ("link.rejected",)
    await core.host.write(slip__threshold=200_000)
    codes = np.full((8, CHANNELS), 1500)
    codes[2], codes[5, 0], codes[6, 2] = 0, 4095, 4095
    await core.convert(codes)
    assert await core.host.read(*counters) == [0, 0, 0, 0, 5, 0]
    spoilt = bytearray(core.host.command(0, 7, 0, 0))
    spoilt[4] ^= 2
    for _ in range(3):
        await core.host.send(spoilt)
    assert await core.host.read(*counters) == [0, 0, 0, 0, 5, 3]
    core.part.spoil = lambda answer: answer ^ 0x1000 if core.frame in (1, 4) else answer
    _, starts, _ = await core.convert(np.full((8, CHANNELS), 1500))
    assert np.diff(starts).tolist() == [181, 362, 181, 181, 362, 181, 181]
    # Each time the part is set up again, which takes a tick.
    assert await core.host.read(*counters) == [0, 2, 0, 2, 5, 3]
    core.part.spoil = None
    _, starts, _ = await core.convert(np.full((8, CHANNELS), 1500), every=2, period=120)
    assert set(np.diff(starts)) == {240}
    assert await core.host.read(*counters) == [0, 9, 0, 2, 5, 3]
    # Packets begun before the answer, whose number is the next.
    (begun,) = await core.host.read("link.packets")
    assert begun == max(n for n, packet in enumerate(core.host.packets) if packet.kind == pins.ANSWER)
    assert await core.host.statistics() == {0: 0, 1: 9, 2: 0, 3: 0, 4: 0, 5: 0, 6: 0, 7: 3, 8: 0}


@cocotb.test(timeout_time=200, timeout_unit="ms")
async def what_the_converter_does_not_give_is_a_fault_of_every_finger(dut):
    """An answer with another channel's number, in a very long period; a shorter period setting ends it
    immediately."""
    core = await Core().begin(dut)
    fault = ("grip.fault", "grip.faulty", "adc.mistagged")
    for spoilt, expected in ((False, [0, 0, 0]), (True, [2, 7, 1])):
        await core.host.set({"grip.enable": 0, "grip.period": 0xFF_FFFF, "grip.rail": 0})
        await core.host.set({"grip.enable": 1})
        core.part.spoil = (lambda answer: answer ^ 0x1000 if core.frame == 1 else answer) if spoilt else None
        await core.convert(np.full((8, CHANNELS), 1500))
        await core.host.set({"grip.period": 12_000})
        assert await core.host.read(*fault) == expected
        await pins.rest(dut, 24_000)
        assert await core.host.read(*fault) == [0, 0, expected[2]]


@cocotb.test(timeout_time=200, timeout_unit="ms")
async def each_counter_has_its_own_register_and_statistic(dut):
    """Every bit, by values put where they are counted."""
    core = await Core().begin(dut)
    await pins.says_what_it_is(core.host, "adc slip link grip", 1, CHANNELS)
    spi, path = dut.gen_channels.u_sensor.u_acquire.gen_adc.u_adc_spi, dut.u_slip.gen_slip.u_slip_path
    names = ("dropped", "overrun", "timeout", "mistagged", "over_range")
    sources = {f"adc.{name}": getattr(spi, f"{name}_o") for name in names}
    sources["slip.damaged"] = path.gen_parallel.u_frame_filter.damaged_o
    sources["slip.blanked"] = path.gen_parallel.u_slip.blanked_o
    sources["link.changes_lost"] = dut.u_link.gen_changes.u_changes.lost_o
    sources["link.rejected"] = dut.u_link.gen_registers.u_bridge.rejected_o
    places = {"adc.dropped": 0, "adc.overrun": 1, "adc.timeout": 2, "slip.damaged": 3, "slip.blanked": 4}
    await pins.counters_are_their_own(
        core.host, sources, places | {"link.rejected": 7, "link.changes_lost": 8}
    )


def test_settings_channels():
    build = {"Adc": 5, "ClkKhz": 4000, "Channels": CHANNELS, "BaudHz": 1_000_000, "StatisticBits": 11}
    build |= {"Window": WINDOW, "Hop": WINDOW, "SlipDepth": 16, "Grip": 1}
    bench.run("core", "core", build, module="test_settings_channels", inside=SEEN)
