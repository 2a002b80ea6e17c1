"""A scanned array of 3 rows and 4 columns, two columns a conversion, at the pins of an AD7606: each setting
of scan, health, tare, calibration and CoP, through its register, changes what it should and nothing else. No
two settings have the same value; results are worked out by hand from docs/ and written as numbers; each limit
is met exactly and missed by one. Each packet has the clock of its frame's first CONVST edge; each counter has
its own value, in its register and in its statistic."""

from fractions import Fraction

import cocotb
import numpy as np

import bench
from core import pins
from core.wires import SEEN
from meissner.twins.link.registers import RESET_BITS, reset_word
from parts.ad7606 import Ad7606

ROWS, COLUMNS = 3, 4
PERIOD = 701
CONVERSIONS = 6  # in a frame: two groups of columns in each row
DEAD, RAILED, BLINKING = 1, 2, 4
ZERO = np.array([[100, 103, 109, 110], [121, 127, 130, 138], [142, 145, 151, 160]])


class Prompt(Ad7606):
    """Without the delays of its bits: other tests check that the core allows for them."""

    def drive(self, lane, bit, delay, hold=0.0):
        self.miso.value = bit

    def release(self, lane, delay):
        pass


# The settings of the two builds: with and without a first averaging.
RESETS = [reset_word({"calibrate.preset": 8192, "tare.at_start": start}) for start in (1, 0)]
no_zero_at_the_start = bench.applies(lambda dut: dut.Resets.value.to_unsigned() == RESETS[1])


class Core:
    """The array from reset on; with tare.at_start it averages the first two frames into the zeros."""

    async def begin(self, dut, **first):
        self.dut, self.codes, self.done = dut, None, 0

        def part(dut):
            ports = (dut.adc_miso_i, dut.adc_convst_o, dut.adc_busy_i, dut.adc_reset_o, self.code)
            return Prompt(dut.adc_cs_n_o, dut.adc_sclk_o, *ports, conversion_ns=3995)

        self.host, self.part = await pins.begin(dut, part)
        await self.host.write(**first)
        self.converts = pins.Edges(self.host, dut.adc_convst_o)
        await self.host.write(scan__period=PERIOD, scan__settle=5)
        await pins.rest(dut, 100)
        return self

    def code(self, channel, _):
        """All eight inputs at a CONVST edge: two columns of the selected group in the driven row."""
        conversion = len(self.part.frames) - self.before
        frame = self.codes[min(conversion // CONVERSIONS, len(self.codes) - 1)]
        row, column = bench.read(self.dut.row_o), 2 * bench.read(self.dut.group_o) + channel
        assert row in (1, 2, 4)
        return int(frame[row.bit_length() - 1][column]) & 0xFFFF if channel < 2 else 0x7777

    async def scan(self, frames, period=None):
        """Scan ``frames`` [.., 3, 4]; return the packets and the clocks of the CONVST edges by frame."""
        first, since = len(self.host.packets), len(self.converts.at)
        self.codes, self.before = frames, len(self.part.frames)
        if period:
            await self.host.write(scan__period=period)
        await self.host.write(scan__enable=1)
        while len(self.converts.at) < since + CONVERSIONS * len(frames):
            await pins.rest(self.dut, 11)
        await self.host.write(scan__enable=0)
        await pins.rest(self.dut, PERIOD)
        edges = np.array(self.converts.at[since:]).reshape(-1, CONVERSIONS)
        assert len(edges) == len(frames)
        return self.host.packets[first:], edges

    async def images(self, frames):
        packets, edges = await self.scan(frames)
        images = [packet for packet in packets if packet.kind == pins.IMAGE]
        assert [packet.time for packet in images] == edges[:, 0].tolist()
        return [pins.image_of(packet) for packet in images]

    async def images_sent(self, frames):
        packets, _ = await self.scan(frames)
        return sum(packet.kind == pins.IMAGE for packet in packets)

    async def faults(self, frames):
        """The taxels reported: {taxel: (faults, index of the frame in which it was reported)}."""
        packets, edges = await self.scan(frames)
        found = {}
        for packet in packets:
            if packet.kind == pins.HEALTH:
                taxel, faults = pins.health_of(packet)
                found[taxel] = faults, int(np.searchsorted(edges[:, 0], packet.time) - 1)
        return found


def flat(array):
    return np.asarray(array).ravel().tolist()


def at(row, column, value):
    """A frame that is zero except for one taxel."""
    frame = np.zeros((ROWS, COLUMNS), dtype=int)
    frame[row, column] = value
    return frame


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def the_scans_settings_at_the_pins(dut):
    """Clocks from a row's change to CONVST and from frame to frame, the order of rows, the times of all
    packets."""
    core = await Core().begin(dut)
    order = []

    async def watch():
        while True:
            await cocotb.triggers.RisingEdge(dut.adc_convst_o)
            order.append((bench.read(dut.row_o), bench.read(dut.group_o)))

    cocotb.start_soon(watch())
    lines = [pins.Edges(core.host, dut.row_o, bit=row) for row in range(ROWS)]
    straight = [(1, 0), (1, 1), (2, 0), (2, 1), (4, 0), (4, 1)]
    crossed = [(1, 0), (1, 1), (4, 0), (4, 1), (2, 0), (2, 1)]
    for change, rows, settle, period in (
        ({}, straight, 5, 701),
        ({"settle": 9}, straight, 9, 701),
        ({"interleave": 1}, crossed, 9, 701),
        ({"period": 757, "interleave": 0}, straight, 9, 757),
    ):
        order.clear()
        for line in lines:
            line.at.clear()
        await core.host.set({f"scan.{name}": value for name, value in change.items()})
        packets, edges = await core.scan([ZERO + 10 * n for n in range(4)])
        assert order == rows * 4
        assert set(np.diff(edges[:, 0])) == {period}, change
        rises = np.sort([at for line in lines for at in line.at])
        assert set(edges.ravel() - rises) == {settle}, change
        for kind in (pins.IMAGE, pins.COP):
            times = [packet.time for packet in packets if packet.kind == kind]
            assert times == edges[:, 0].tolist()


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def each_setting_of_the_zeros(dut):
    core = await Core().begin(dut)
    read, write = core.host.read, core.host.write
    await write(tare__contact=40, tare__step=0)
    # The first two frames are averaged; until then the forces are twice the codes.
    found = await core.images([ZERO - 1, ZERO + 1, ZERO + at(1, 2, 41), ZERO + at(2, 1, 40)])
    assert found == [flat(2 * ZERO - 2), flat(2 * ZERO + 2), flat(at(1, 2, 82)), flat(at(2, 1, 80))]
    assert await read("tare.tared", "tare.refused", "tare.swallowed", "tare.state") == [1, 0, 0, 0]
    # Contact is more than 40: bit 2 of the state.
    await core.images([ZERO + at(2, 1, 41)])
    assert await read("tare.state") == [4]
    # Refused while something presses, unless forced; bit 1 is a tare in progress.
    await write(tare__average=1)
    assert await read("tare.state") == [6]
    await core.images([ZERO + at(2, 1, 41)] * 2)
    assert await read("tare.tared", "tare.refused", "tare.state") == [1, 1, 4]
    await write(tare__force=1, tare__average=1)
    found = await core.images([ZERO + at(2, 1, 41)] * 3)
    assert found == [flat(at(2, 1, 82))] * 2 + [flat(at(2, 1, 0))]
    assert await read("tare.tared", "tare.refused", "tare.state") == [2, 1, 0]
    # 205 / 4096 per frame reach half a code after ten frames, and half a code rounds up.
    await write(tare__step=205, tare__force=0)
    moved = ZERO + at(2, 1, 41) + at(0, 3, 5)
    found = await core.images([moved] * 12)
    assert found == [flat(at(0, 3, 10))] * 10 + [flat(at(0, 3, 8))] * 2
    # Frames are swallowed while zeros are loaded: bit 0.
    await write(tare__step=0, tare__load=1)
    assert await core.images_sent([ZERO] * 3) == 0
    assert await read("tare.swallowed", "tare.state") == [3, 1]
    await write(tare__word=6, tare__zero=-77, tare__write=1)
    await write(tare__word=9, tare__zero=89, tare__write=0)  # for no lane
    await write(tare__load=0)
    found = await core.images([ZERO + at(2, 1, 41) + at(0, 3, 1)])
    assert found == [flat(at(1, 2, 2 * (130 + 77)))]
    assert await read("tare.tared", "tare.refused", "tare.swallowed", "tare.state") == [2, 1, 3, 4]


@no_zero_at_the_start
@cocotb.test(timeout_time=100, timeout_unit="ms")
async def without_a_zero_at_the_start_codes_stay(dut):
    """A gain for each taxel takes effect from the frame after the swap on; images can be switched off."""
    core = await Core().begin(dut, tare__step=0)
    assert await core.images([ZERO] * 4) == [flat(2 * ZERO)] * 4
    assert await core.host.read("tare.tared", "calibrate.swapping") == [0, 0]
    gains = [4096 + 272 * word for word in range(12)]
    for word, gain in enumerate(gains):
        await core.host.write(calibrate__word=word, calibrate__gain=gain, calibrate__offset=word + 1)
        await core.host.write(calibrate__write=1)
    await core.host.write(calibrate__word=5, calibrate__gain=1, calibrate__write=0)  # for no lane
    await core.host.write(calibrate__write=0x100)  # a row's entry, which this build lacks
    assert await core.images([ZERO]) == [flat(2 * ZERO)]
    await core.host.write(calibrate__swap=1)
    wanted = [(2 * code * gain + 4096) // 8192 for code, gain in zip(flat(ZERO), gains)]
    assert await core.images([ZERO]) == [wanted]
    assert await core.host.read("calibrate.swapping") == [0]
    await core.host.write(link__images=0)
    assert await core.images_sent([ZERO]) == 0
    await core.host.write(link__images=1)
    assert await core.images([ZERO]) == [wanted]


def cop_of(forces, least):
    """(x, y, load, pressed): docs/cop.md in exact rationals."""
    load = int(forces.sum())
    if load == 0 or load < least:
        return 0, 0, load, 0
    i, j = np.indices(forces.shape)
    x = Fraction(int(((2 * j - 3) * forces).sum()), 3 * load)
    y = Fraction(int(((2 - 2 * i) * forces).sum()), 2 * load)
    return *(int(abs(v) * 16384 + Fraction(1, 2)) * (1 if v > 0 else -1) for v in (x, y)), load, 1


@no_zero_at_the_start
@cocotb.test(timeout_time=100, timeout_unit="ms")
async def the_least_load_and_the_centre(dut):
    core = await Core().begin(dut, tare__step=0)
    frames = [ZERO, ZERO + at(0, 3, 700), ZERO + at(2, 0, 900), ZERO + at(1, 1, 1)]
    load = int(2 * frames[0].sum())
    for least in (1, load, load + 1, load + 2, load + 1400, load + 1801):
        await core.host.write(cop__min_load=least)
        packets, edges = await core.scan(frames)
        cops = [packet for packet in packets if packet.kind == pins.COP]
        assert [pins.cop_of(packet) for packet in cops] == [cop_of(2 * frame, least) for frame in frames]
        assert [packet.time for packet in cops] == edges[:, 0].tolist()
        assert bench.read(dut.pressed_o) == int(load + 2 >= least)
    assert await core.host.read("cop.damaged") == [0]


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def slip_of_taxels(dut):
    """Steps just above and exactly at each threshold; blanked details are counted."""
    core = await Core().begin(dut, tare__step=0)
    await core.host.write(slip__threshold=201, slip__gross_threshold=603, slip__contact_level=700)
    await core.host.write(slip__release_level=300, slip__hold=1, slip__refractory=2, slip__blank=3)
    frames = [ZERO + 200 * (n > 1) for n in range(14)]
    # Detail 3 is blanked, detail 5 is not; forces are twice the codes.
    frames[6] = frames[6] + at(0, 1, 101)
    frames[10] = frames[10] + at(0, 2, 101) + at(1, 0, 302) + at(1, 3, 105) + at(2, 1, 100) + at(2, 3, 301)
    packets, edges = await core.scan(frames)
    slips = [packet for packet in packets if packet.kind == pins.SLIP]
    assert [pins.slip_of(packet) for packet in slips] == [(2, 202, 2), (4, 604, 3), (7, 210, 2), (11, 602, 2)]
    assert {packet.time for packet in slips} == {edges[11, 0]}
    assert await core.host.read("slip.damaged", "slip.blanked") == [0, 1]


ALL = np.ones((ROWS, COLUMNS), dtype=int)


def moving(count, *still, by=30):
    """Frames in which all taxels except ``still`` go up and down."""
    step = ALL.copy()
    for row, column in still:
        step[row, column] = 0
    return [ZERO + by * (n % 2) * step for n in range(count)]


@cocotb.test(timeout_time=200, timeout_unit="ms")
async def each_setting_of_health(dut):
    """The first frame after a clear only sets the codes that later ones are compared with."""
    core = await Core().begin(dut, tare__step=0)
    base = {"band": 29, "jump": 60, "low": 50, "high": 900, "use": 3, "still": 0, "rail": 0, "blink": 0}

    async def reported(frames, **changed):
        await core.host.set({f"health.{name}": value for name, value in (base | changed).items()})
        await core.host.write(health__clear=1)
        found = await core.faults(frames)
        counts = await core.host.read("health.dead", "health.railed", "health.blinking")
        for count, kind in zip(counts, (DEAD, RAILED, BLINKING)):
            assert count == sum(1 for faults, _ in found.values() if faults & kind)
        return found

    # It counts four a frame from the third frame on, as moves of the neighbours are known a frame later.
    assert await reported(moving(8, (1, 1)), still=20) == {5: (DEAD, 6)}
    assert await reported(moving(8, (1, 1)), still=24) == {5: (DEAD, 7)}
    assert await reported(moving(8, (1, 1)), still=20, band=30) == {}
    # One a frame in a corner, if edges count.
    assert await reported(moving(9, (2, 3)), still=6) == {11: (DEAD, 7)}
    assert await reported(moving(9, (2, 3)), still=6, use=1) == {}
    # At or beyond a limit in every sixteenth frame; over-range, if that is enabled.
    ends = ZERO.copy() + 20
    ends[0, 1], ends[1, 2], ends[2, 0], ends[2, 3] = 900, 899, 50, 51
    assert {taxel: fault for taxel, (fault, _) in (await reported([ends] * 17, rail=1)).items()} == {
        1: RAILED,
        8: RAILED,
    }
    assert await reported([ends] * 17, rail=2) == {}
    assert set(await reported([ends] * 17, rail=1, high=899, low=51)) == {1, 6, 8, 11}
    full = ZERO + at(1, 3, 32767 - 138)
    assert set(await reported([full] * 17, rail=1, high=40000)) == {7}
    assert set(await reported([full] * 17, rail=1, high=40000, use=2)) == set()
    # A jump of a taxel alone counts 16, one frame later.
    jumps = [ZERO + at(1, 1, 61) * (n % 2) for n in range(6)]
    assert await reported(jumps, blink=32) == {5: (BLINKING, 3)}
    assert await reported(jumps, blink=48) == {5: (BLINKING, 4)}
    assert await reported(jumps, blink=32, jump=61) == {}
    assert await reported(jumps, blink=32) == {5: (BLINKING, 3)}
    # Masked from then on, reported again on request, and then no more.
    await core.host.write(health__report=1)
    assert await core.faults([jumps[0]] * 2) == {5: (BLINKING, 0)}
    assert await core.faults([jumps[0]] * 2) == {}
    await core.host.write(health__clear=1)
    await core.scan([ZERO])
    assert await core.host.read("health.dead", "health.railed", "health.blinking") == [0, 0, 0]


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def every_taxel_fails_while_the_host_sleeps(dut):
    """All twelve are at the limit for the sixteenth time, and the host stalls for three frames around that:
    each is reported once, in that frame or in a later one."""
    core = await Core().begin(dut, tare__step=0)
    settings = {"band": 29, "jump": 60, "low": 50, "high": 900, "use": 3, "still": 0, "rail": 1, "blink": 0}
    await core.host.set({f"health.{name}": value for name, value in settings.items()})
    await core.host.write(health__clear=1)
    first = len(core.converts.at)

    async def hold():
        while len(core.converts.at) < first + 14 * CONVERSIONS:
            await pins.rest(dut, 11)
        dut.out_ready_i.value = 0
        await pins.rest(dut, 3 * PERIOD)
        dut.out_ready_i.value = 1

    holding = cocotb.start_soon(hold())
    packets, _ = await core.scan([np.full((ROWS, COLUMNS), 900)] * 40)
    await holding
    found = [pins.health_of(packet) for packet in packets if packet.kind == pins.HEALTH]
    assert sorted(found) == [(taxel, RAILED) for taxel in range(12)]
    assert await core.host.read("health.dead", "health.railed", "health.blinking") == [0, 12, 0]


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def what_goes_wrong_is_counted_where_it_belongs(dut):
    core = await Core().begin(dut)
    counters = ("scan.dropped", "scan.overrun", "scan.held", "scan.lost", "tare.swallowed")
    _, edges = await core.scan([ZERO] * 4, period=300)
    assert set(np.diff(edges[:, 0])) == {600}
    assert await core.host.read(*counters) == [0, 4, 0, 0, 0]
    core.part.hold_busy(0)
    await core.scan([ZERO], period=9000)
    core.part.hold_busy(None)
    assert await core.host.read(*counters) == [0, 4, 0, 6, 0]
    assert await core.host.statistics() == {0: 0, 1: 4, 2: 6, 3: 0, 4: 0, 5: 0, 6: 0, 7: 0, 8: 0}


@no_zero_at_the_start
@cocotb.test(timeout_time=100, timeout_unit="ms")
async def a_frame_that_waits_for_the_host_keeps_its_time(dut):
    """All taxels slip at once, and the host stalls for three frames: no event is lost. The next frame waits
    in the scan's buffer, which holds all of it, so the scan is never held; the two frames after it are
    dropped, and CoP and image of the frame that slipped are replaced by newer ones before they are sent."""
    core = await Core().begin(dut, tare__step=0)
    await core.host.write(slip__threshold=99, slip__gross_threshold=0x3FFFF, slip__contact_level=1)
    await core.host.write(link__events=0b01100)  # changes to slip alone, which are all starts here

    async def hold():
        while len(core.converts.at) < 4 * CONVERSIONS:
            await pins.rest(dut, 11)
        dut.out_ready_i.value = 0
        await pins.rest(dut, 3 * PERIOD)
        dut.out_ready_i.value = 1

    holding = cocotb.start_soon(hold())
    packets, edges = await core.scan([ZERO, ZERO, ZERO, ZERO + 50] + [ZERO] * 6)
    await holding
    slips = [packet for packet in packets if packet.kind == pins.SLIP]
    assert [pins.slip_of(packet) for packet in slips] == [(taxel, 100, 2) for taxel in range(12)]
    assert {packet.time for packet in slips} == {edges[3, 0]}
    sent = edges[[0, 1, 2, 4, 7, 8, 9], 0].tolist()
    for kind in (pins.COP, pins.IMAGE):
        assert [packet.time for packet in packets if packet.kind == kind] == sent
    counters = ("scan.dropped", "scan.overrun", "link.cop_dropped", "link.image_dropped", "scan.held")
    assert await core.host.read(*counters) == [2, 0, 1, 1, 0]


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def each_counter_has_its_own_register_and_statistic(dut):
    """Every bit, by values put where they are counted."""
    core = await Core().begin(dut)
    await pins.says_what_it_is(core.host, "slip scan health tare calibrate cop link", ROWS, COLUMNS)
    array, link = dut.gen_array.u_sensor, dut.u_link.gen_packets.u_packet
    scan, path = array.gen_adc.u_scan_adc.u_scan, dut.u_slip.gen_slip.u_slip_path.gen_parallel
    health, tare = array.u_forces.gen_health.u_health, array.u_forces.gen_tare.u_tare
    sources = {
        **{"scan.dropped": scan.u_buffer.dropped_o, "scan.overrun": scan.u_plan.overrun_o},
        **{"scan.held": scan.u_plan.held_o, "scan.lost": scan.lost},
        **{"slip.damaged": path.u_frame_filter.damaged_o, "slip.blanked": path.u_slip.blanked_o},
        **{f"health.{name}": getattr(health, f"{name}_count") for name in ("dead", "railed", "blinking")},
        **{f"tare.{name}": getattr(tare, f"{name}_count") for name in ("tared", "refused", "swallowed")},
        "cop.damaged": array.u_forces.u_cop.u_accumulate.damaged_o,
        "link.cop_dropped": link.cop_dropped_o,
        "link.image_dropped": link.gen_image.u_chunks.u_store.dropped_o,
    }
    places = {"scan.dropped": 0, "scan.overrun": 1, "scan.lost": 2, "slip.damaged": 3}
    places |= {"slip.blanked": 4, "cop.damaged": 5, "link.image_dropped": 6}
    await pins.counters_are_their_own(core.host, sources, places)


def test_settings_array():
    build = {"Adc": 2, "ClkKhz": 4000, "Array": 1, "Rows": ROWS, "Columns": COLUMNS, "AdcChannels": 2}
    build |= {"Health": 1, "Tare": 1, "TareLog2": 1, "Image": 1, "Window": 4, "Hop": 4, "Uart": 0}
    build |= {"SlipDepth": 2, "StatisticBits": 10}
    for word, only in zip(RESETS, (None, "without_a_zero|the_least_load|a_frame_that_waits")):
        build["Resets"] = f"{RESET_BITS}'h{word:x}"
        bench.run("core", "core", build, only, module="test_settings_array", inside=SEEN)
