"""A core seen from outside, by its pins, packets and registers: a host that reads packets byte by byte or
from the line, and registers at their addresses in docs/registers.md; the clock of each edge at a pin.
Addresses and layouts are written here from docs/, not taken from the register map or the decoder."""

import struct
import zlib
from dataclasses import dataclass

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge, Timer, ValueChange
from cocotb.utils import get_sim_time

import bench

PERIOD_NS = 250
SLIP, COP, IMAGE, HEALTH, STATISTIC, CHANGE, STATES, CLASS, ANSWER = 1, 2, 3, 4, 5, 6, 7, 8, 16
# docs/link.md: the counters sent as statistics, with their index.
STATISTICS = {
    "dropped": 0,
    "overrun": 1,
    "timeout": 2,
    "slip_damaged": 3,
    "slip_blanked": 4,
    "cop_damaged": 5,
    "image_dropped": 6,
    "rejected": 7,
    "changes_lost": 8,
}
# docs/registers.md.
ADDRESS = {
    **{"core.id": 0x000, "core.version": 0x004, "core.features": 0x008, "core.size": 0x00C},
    **{"core.clk_khz": 0x010, "core.scratch": 0x014, "core.hold": 0x020},
    **{"adc.enable": 0x100, "adc.period": 0x104, "adc.dropped": 0x108, "adc.overrun": 0x10C},
    **{"adc.timeout": 0x110, "adc.mistagged": 0x114, "adc.over_range": 0x118},
    **{"slip.threshold": 0x200, "slip.gross_threshold": 0x204, "slip.contact_level": 0x208},
    **{"slip.release_level": 0x20C, "slip.contact_rises": 0x210, "slip.hold": 0x214},
    **{"slip.refractory": 0x218, "slip.blank": 0x21C, "slip.damaged": 0x220, "slip.blanked": 0x224},
    **{"scan.enable": 0x300, "scan.settle": 0x304, "scan.period": 0x308, "scan.interleave": 0x30C},
    **{"scan.dropped": 0x310, "scan.overrun": 0x314, "scan.held": 0x318, "scan.lost": 0x31C},
    **{"health.band": 0x400, "health.jump": 0x404, "health.low": 0x408, "health.high": 0x40C},
    **{"health.use": 0x410, "health.still": 0x414, "health.rail": 0x418, "health.blink": 0x41C},
    **{"health.clear": 0x420, "health.report": 0x424},
    **{"health.dead": 0x428, "health.railed": 0x42C, "health.blinking": 0x430},
    **{"tare.contact": 0x480, "tare.step": 0x484, "tare.force": 0x488, "tare.at_start": 0x48C},
    **{"tare.average": 0x490, "tare.load": 0x494, "tare.word": 0x498, "tare.zero": 0x49C},
    **{"tare.write": 0x4A0, "tare.state": 0x4A4, "tare.tared": 0x4A8, "tare.refused": 0x4AC},
    **{"tare.swallowed": 0x4B0, "calibrate.preset": 0x500, "calibrate.word": 0x504},
    **{"calibrate.offset": 0x508, "calibrate.gain": 0x50C, "calibrate.write": 0x510},
    **{"calibrate.swap": 0x514, "calibrate.swapping": 0x518, "cop.min_load": 0x600, "cop.damaged": 0x604},
    **{"cop4.rail": 0x700, "cop4.kx": 0x704, "cop4.shift_x": 0x708, "cop4.ky": 0x70C},
    **{"cop4.shift_y": 0x710, "cop4.kf": 0x714, "cop4.shift_load": 0x718, "cop4.p0": 0x71C},
    **{"cop4.p1": 0x720, "cop4.p2": 0x724, "cop4.p3": 0x728, "cop4.p4": 0x72C, "cop4.p5": 0x730},
    **{"cop4.min_load": 0x734, "cop4.top": 0x738, "cop4.idle": 0x73C, "cop4.busy": 0x740},
    **{"cop4.imbalance": 0x744, "cop_slip.drop": 0x800, "cop_slip.move": 0x804},
    **{"cop_slip.min_load": 0x808, "cop_slip.hold": 0x80C, "cop_slip.refractory": 0x810},
    **{"link.images": 0x900, "link.packets": 0x904, "link.cop_dropped": 0x908},
    **{"link.image_dropped": 0x90C, "link.rejected": 0x910, "link.events": 0x914, "link.states": 0x918},
    "link.changes_lost": 0x91C,
    **{"grip.enable": 0xA00, "grip.period": 0xA04, "grip.step": 0xA08, "grip.decay": 0xA0C},
    **{"grip.minimum": 0xA10, "grip.maximum": 0xA14, "grip.rate": 0xA18, "grip.watchdog": 0xA1C},
    **{"grip.rule": 0xA20, "grip.mode": 0xA24, "grip.immediate": 0xA28, "grip.override": 0xA2C},
    **{"grip.override_value": 0xA30, "grip.divide": 0xA34, "grip.low": 0xA38, "grip.high": 0xA3C},
    **{"grip.rail": 0xA40, "grip.command": 0xA44, "grip.increment": 0xA48, "grip.fault": 0xA4C},
    **{"grip.faulty": 0xA50, "grip.commands": 0xA54, "grip.tightenings": 0xA58, "grip.speed_gain": 0xA5C},
    "grip.boost": 0xA60,
    **{"shear_speed.enable": 0xB00, "shear_speed.k0": 0xB04, "shear_speed.k1": 0xB08},
    **{"shear_speed.exponent": 0xB0C, "shear_speed.vi_min": 0xB10, "shear_speed.vi_max": 0xB14},
    **{"shear_speed.noise": 0xB18, "shear_speed.still": 0xB1C, "shear_speed.full": 0xB20},
    **{"shear_speed.limit": 0xB24, "shear_speed.travel": 0xB28, "shear_speed.hold": 0xB2C},
    **{"shear_speed.hold_cycles": 0xB30, "shear_speed.select": 0xB34},
    **{f"shear_speed.channel{channel}": 0xB38 + 4 * channel for channel in range(8)},
    **{"shear_speed.vi": 0xB58, "shear_speed.rise": 0xB5C, "shear_speed.windows": 0xB60},
    **{"forest.size": 0xC00, "forest.room": 0xC04, "forest.nodes": 0xC08, "forest.leaves": 0xC0C},
    **{"forest.target": 0xC10, "forest.address": 0xC14, "forest.high": 0xC18, "forest.data": 0xC1C},
    **{"forest.clear": 0xC20, "forest.swap": 0xC24, "forest.state": 0xC28, "forest.written": 0xC2C},
    **{"forest.feature": 0xC30, "forest.start": 0xC34, "forest.slip": 0xC38, "forest.grip": 0xC3C},
    **{"forest.label": 0xC40, "forest.best": 0xC44, "forest.select": 0xC48, "forest.votes": 0xC4C},
    **{"forest.decisions": 0xC50, "forest.changes": 0xC54, "forest.missed": 0xC58, "forest.absent": 0xC5C},
    **{"forest.late": 0xC60, "forest.broken": 0xC64},
    **{"display.enable": 0xD00, "display.increment": 0xD04, "display.burst_period": 0xD08},
    **{"display.burst_on": 0xD0C, "display.top": 0xD10, "display.most": 0xD14, "display.duty": 0xD18},
    **{"display.watchdog": 0xD1C, "display.stop": 0xD20, "display.source": 0xD24, "display.floor": 0xD28},
    **{"display.step": 0xD2C, "display.marker": 0xD30, "display.cue": 0xD34, "display.octant": 0xD38},
    **{"display.health": 0xD3C, "display.levels": 0xD40, "display.size": 0xD44, "display.state": 0xD48},
    **{"display.dropped": 0xD4C, "display.faults": 0xD50},
}


async def access(dut, write, address, data=0, strobe=15):
    """(data, error) of one access on the bus of ``dut``."""
    dut.bus_valid_i.value, dut.bus_write_i.value, dut.bus_strobe_i.value = 1, int(write), strobe
    dut.bus_address_i.value, dut.bus_wdata_i.value = address, data & 0xFFFF_FFFF
    await RisingEdge(dut.clk_i)
    dut.bus_valid_i.value = 0
    await ReadOnly()
    while dut.bus_done_o.value != 1:
        await RisingEdge(dut.clk_i)
        await ReadOnly()
    answer = bench.read(dut.bus_rdata_o), bench.read(dut.bus_error_o)
    await RisingEdge(dut.clk_i)
    return answer


@dataclass(frozen=True)
class Packet:
    """``at``: the clock in which its first byte was offered."""

    kind: int
    number: int
    time: int
    payload: bytes
    at: int


def signed(data):
    return int.from_bytes(data, "little", signed=True)


def unsigned(data):
    return int.from_bytes(data, "little")


def slip_of(packet):
    """(channel, peak-to-peak, state)"""
    data = packet.payload
    assert packet.kind == SLIP and len(data) == 6
    return unsigned(data[0:2]), unsigned(data[2:5]), data[5]


def changes_of(packets):
    """[(time, channel, state before, state)] of the packets about changes; a slip starts from contact, and
    none is late."""
    found = [packet for packet in packets if packet.kind in (SLIP, CHANGE)]
    assert all(packet.payload[5] & 0x88 == 0 and len(packet.payload) == 6 for packet in found)
    before = lambda packet: 1 if packet.kind == SLIP else packet.payload[5] >> 4
    return [(q.time, unsigned(q.payload[0:2]), before(q), q.payload[5] & 7) for q in found]


def cop_of(packet):
    """(x, y, load, pressed)"""
    data = packet.payload
    assert packet.kind == COP and len(data) == 12
    return signed(data[0:3]), signed(data[3:6]), unsigned(data[6:11]), data[11]


def image_of(packet):
    """The image taxels in one packet."""
    data = packet.payload
    assert packet.kind == IMAGE and data[1] == 1 and unsigned(data[2:5]) == 0
    return list(struct.unpack(f"<{(len(data) - 5) // 2}H", data[5:]))


def health_of(packet):
    """(taxel, faults)"""
    assert packet.kind == HEALTH and len(packet.payload) == 4
    return unsigned(packet.payload[0:3]), packet.payload[3]


def statistic_of(packet):
    """(index, counter)"""
    assert packet.kind == STATISTIC and len(packet.payload) == 5
    return packet.payload[0], unsigned(packet.payload[1:5])


async def rest(dut, clocks):
    """Let ``clocks`` pass without awaiting each."""
    await Timer(clocks * PERIOD_NS - PERIOD_NS // 2, "ns")
    await RisingEdge(dut.clk_i)


class Host:
    """``packets``: all since reset; ``clock()``: the core's time, in clocks since reset."""

    begins = 4  # clocks from a packet's time to its first byte, if it need not wait

    def __init__(self, dut):
        self.dut, self.packets, self.data, self.began = dut, [], bytearray(), None
        self.zero = 0
        cocotb.start_soon(self._watch())

    def clock(self):
        """The core's time: 0 after the last edge in reset."""
        return round(get_sim_time("ns") / PERIOD_NS) - self.zero

    async def _watch(self):
        """A byte must stay until it is taken; none is offered in the next clock."""
        while True:
            await RisingEdge(self.dut.out_valid_o)
            await ReadOnly()
            if not self.data:
                self.began = self.clock()
            self.data.append(bench.read(self.dut.out_data_o))
            if self.dut.out_last_o.value == 1:
                self._keep(bytes(self.data))
                self.data.clear()

    def _keep(self, data):
        assert zlib.crc32(data[:-4]) == unsigned(data[-4:])
        assert data[1] == len(self.packets) % 256, "a packet is missing"
        self.packets.append(Packet(data[0], data[1], unsigned(data[2:8]), data[8:-4], self.began))

    def of_kind(self, kind, since=0):
        return [packet for packet in self.packets[since:] if packet.kind == kind]

    async def access(self, write, address, data=0):
        """(data, error) of one access."""
        return await access(self.dut, write, address, data)

    async def write(self, **values):
        """Write ``group__register=value`` in this order."""
        for name, value in values.items():
            assert (await self.access(True, ADDRESS[name.replace("__", ".")], value))[1] == 0, name

    async def set(self, values):
        """Write {"group.register": value} in this order."""
        await self.write(**{name.replace(".", "__"): value for name, value in values.items()})

    async def read(self, *names):
        found = []
        for name in names:
            data, error = await self.access(False, ADDRESS[name])
            assert error == 0, name
            found.append(data)
        return found

    async def statistics(self):
        """The next value of each statistic, by index; each packet's time must be that of its own sending."""
        first = len(self.packets)
        while len(self.of_kind(STATISTIC, first)) < 10:
            await rest(self.dut, 200)
        got = self.of_kind(STATISTIC, first)[1:]
        assert {packet.at - packet.time for packet in got} == {self.begins}
        return dict(map(statistic_of, got))


class LineHost(Host):
    """The same on the serial line: each packet is between two zeros, and answers are among them."""

    bit = 4  # clocks
    begins = 1  # from the time of a packet that need not wait to the line's start bit

    async def _watch(self):
        while True:
            await FallingEdge(self.dut.tx_o)
            at, byte = self.clock(), 0
            await Timer((3 * self.bit - 1) * PERIOD_NS // 2, "ns")
            for bit in range(8):
                byte |= int(self.dut.tx_o.value) << bit
                await Timer(self.bit * PERIOD_NS, "ns")
            assert self.dut.tx_o.value == 1, "no stop bit"
            if byte:
                self.data.append(byte)
            elif self.data:
                self._unstuff(self.data)
                self.data.clear()
                self.began = None
            else:
                self.began = at

    def _unstuff(self, frame):
        """docs/link.md: each code follows its run, so the frame is decoded from its end."""
        place = len(frame) - 1
        code = frame[place]
        while code <= place:
            place -= code
            code, frame[place] = frame[place], 0
        assert code == place + 1
        self._keep(bytes(frame[:-1]))

    async def send(self, data):
        for byte in data:
            for level in (0, *(byte >> bit & 1 for bit in range(8)), 1):
                self.dut.rx_i.value = level
                await Timer(self.bit * PERIOD_NS, "ns")

    @staticmethod
    def command(write, tag, address, data):
        """12 bytes, plain COBS, between zeros."""
        body = struct.pack("<BBHI", write, tag, address, data & 0xFFFF_FFFF)
        runs = (body + struct.pack("<I", zlib.crc32(body))).split(b"\0")
        return b"\0" + b"".join(bytes([len(run) + 1]) + run for run in runs) + b"\0"

    async def access(self, write, address, data=0):
        tag, first = len(self.packets) % 251, len(self.packets)
        await self.send(self.command(write, tag, address, data))
        for _ in range(100):
            answers = self.of_kind(ANSWER, first)
            if answers:
                (got,) = answers
                assert got.payload[0] == tag and got.payload[1] < 2
                assert unsigned(got.payload[2:4]) == address
                await RisingEdge(self.dut.clk_i)
                return unsigned(got.payload[4:8]), got.payload[1]
            await rest(self.dut, 100)
        raise AssertionError("no answer")


class Edges:
    """Clocks at which a pin rose, or fell; with ``gap`` only edges at least that many clocks after the one
    before."""

    def __init__(self, host, pin, to=1, bit=0, gap=0):
        self.host, self.pin, self.to, self.bit, self.at = host, pin, to, bit, []
        self.gap, self.latest = gap, -1 << 30
        cocotb.start_soon(self._watch())

    async def _watch(self):
        before = int(self.pin.value) >> self.bit & 1
        while True:
            await ValueChange(self.pin)
            level = int(self.pin.value) >> self.bit & 1
            if level != before and level == self.to:
                now = self.host.clock()
                if now - self.latest >= self.gap:
                    self.at.append(now)
                self.latest = now
            before = level


async def begin(dut, part, kind=Host, reset=3):
    """Start the clock, the converter ``part(dut)`` and a reset; return a host of ``kind`` and the result of
    ``part``."""
    idle = {"actuator_moving_i": 0, "in_valid_i": 0, "rx_i": 1, "bus_valid_i": 0, "out_ready_i": 1}
    for port, value in (idle | {"adc_miso_i": 0, "adc_busy_i": 0, "rst_i": 1}).items():
        getattr(dut, port).value = value
    Clock(dut.clk_i, PERIOD_NS, unit="ns").start()
    await bench.clocks(dut, 2)  # nothing leaves in reset, whatever the registers began with
    host, made = kind(dut), part(dut)
    await bench.clocks(dut, reset)
    host.zero = round(get_sim_time("ns") / PERIOD_NS)
    dut.rst_i.value = 0
    return host, made


async def says_what_it_is(host, groups, rows, columns):
    """``groups``: the register groups that it has, from docs/registers.md's list without core."""
    order = ("adc", "slip", "scan", "health", "tare", "calibrate", "cop", "cop4", "cop_slip", "link", "grip")
    order += ("shear_speed", "forest", "display")
    features = sum(1 << order.index(group) for group in groups.split())
    await host.set({"core.scratch": 0xA5C3_0F96})
    names = ("core.id", "core.features", "core.size", "core.clk_khz", "core.scratch")
    assert await host.read(*names) == [0x4D53_4E52, features, columns << 16 | rows, 4000, 0xA5C3_0F96]
    assert (await host.access(False, 0xFFC))[1] == 1, "there is no such register"


def put(sources, turn):
    """Put a different value into each counter, each bit being both 0 and 1 over ``turn`` 0 and 1; return the
    values."""
    values = {}
    for place, (name, source) in enumerate(sources.items()):
        mask = (1 << len(source)) - 1
        values[name] = ((place + 1) * 0x9E37_79B5 ^ (0xFFFF_FFFF * turn)) & mask
        source.value = values[name]
    assert len(set(values.values())) == len(values), values
    return values


async def counters_are_their_own(host, sources, statistics):
    """``sources``: {register, or a name if it has none: where it is counted}; ``statistics``: {name: index}.

    Each value is read in its register and in its statistic; statistics without a counter here are 0.
    """
    for turn in (0, 1):
        values = put(sources, turn)
        await bench.clocks(host.dut, 2)
        names = [name for name in sources if name in ADDRESS]
        assert await host.read(*names) == [values[name] for name in names]
        expected = dict.fromkeys(range(9), 0) | {index: values[name] for name, index in statistics.items()}
        assert await host.statistics() == expected
