"""Registers: every address of the map and unused ones, every byte strobe, commits between and together with
writes, status read through, errors for absent features. Random accesses, bit for bit as the twin.
Settings wider than the build: test_registers_ends.
"""

import itertools
import random
import subprocess
import sys

import cocotb
import pytest
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge

import bench
import members
from meissner.builds.toolchain import ROOT
from meissner.twins.link.register_map import GROUPS
from meissner.twins.link.registers import RESET_BITS, WIDTHS, Registers, reset_word, struct_bytes, struct_word

FEATURES = [group.name for group in GROUPS if group.feature]
STROBES = [(group.name, register.name) for group in GROUPS for register in group.registers if register.strobe]


def member(group, register, field):
    return f"{group}_{members.member(register, field)}"


def put(dut, status):
    """Drive the core's side: {(group, register, field): value}."""
    values = {member(*key): value for key, value in status.items()}
    dut.status_i.value = members.word(members.STATUS, values)


def parameter(name):
    return "".join(part.capitalize() for part in name.split("_"))


def keys(kind):
    return [
        (group.name, register.name, field)
        for group in GROUPS
        for register in group.registers
        for field in register.fields
        if field.kind == kind
    ]


async def begin(dut):
    present = [name for name in FEATURES if int(getattr(dut, parameter(name)).value)]
    draw = random.Random(bench.SEED)
    status = {(g, r, f.name): draw.randrange(f.most + 1) for g, r, f in keys("status")}
    put(dut, status)
    await bench.start(dut, bus_valid_i=0, commit_i=0)
    widths = {name: getattr(dut, f"{name.capitalize()}Bits").value.to_unsigned() for name in WIDTHS}
    return Registers(present, dut.Resets.value.to_unsigned(), widths), status, draw


def compare(dut, twin, pulses):
    seen = members.of(members.CFG, bench.read(dut.cfg_o))
    for g, r, f in keys("setting"):
        assert seen[member(g, r, f.name)] == twin.setting(g, r, f.name), (g, r, f.name)
    for g, r, f in keys("command"):
        assert seen[member(g, r, f.name)] == ((g, r, f.name) in pulses), (g, r, f.name)
    for g, r in STROBES:
        assert seen[f"{g}_{r}_written"] == ((g, r, "written") in pulses), (g, r)
    assert bench.read(dut.pending_o) == twin.pending


async def clock(dut, twin, status, access=None, commit=False, compared=True):
    """One clock with an access or none, and with a commit or none; the answer is checked one clock later.

    ``compared``: whether to compare every port too.
    """
    dut.bus_valid_i.value = int(access is not None)
    write, address, data, strobe = access or (1, 0x200, 0xFFFF_FFFF, 15)  # not valid: must not matter
    for name, value in (("write", write), ("address", address), ("wdata", data), ("strobe", strobe)):
        getattr(dut, f"bus_{name}_i").value = value
    dut.commit_i.value = int(commit)
    await RisingEdge(dut.clk_i)
    if commit:  # it takes what was written before this clock
        twin.commit()
    answer = twin.access(write, address, data, strobe, status) if access else None
    dut.bus_valid_i.value = 0
    dut.commit_i.value = 0
    await ReadOnly()
    assert bench.read(dut.bus_done_o) == 0, "answered too early"
    if compared:
        compare(dut, twin, answer[2] if answer else set())
    await RisingEdge(dut.clk_i)
    await ReadOnly()
    assert bench.read(dut.bus_done_o) == (answer is not None)
    if answer:
        assert (bench.read(dut.bus_rdata_o), bool(bench.read(dut.bus_error_o))) == answer[:2], access
    if compared:
        compare(dut, twin, set())
    await RisingEdge(dut.clk_i)
    await ReadOnly()
    assert bench.read(dut.bus_done_o) == 0, "an access was answered twice"
    await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def answers_every_address(dut):
    twin, status, draw = await begin(dut)
    for address in range(4096):
        await clock(dut, twin, status, (0, address, 0, 15), compared=False)
        known = address & ~3 in twin.addresses
        await clock(dut, twin, status, (1, address, draw.getrandbits(32), 15), compared=known)
    for address in range(0, 4096, 4):
        await clock(dut, twin, status, (0, address, 0, 0), compared=False)
    compare(dut, twin, set())


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def matches_model_on_random_accesses(dut):
    twin, status, draw = await begin(dut)
    known = [register.address for group in GROUPS for register in group.registers]
    for count in range(bench.rounds(2000)):
        if count % 100 == 0:
            for key, field in ((key, field) for *key, field in keys("status")):
                status[*key, field.name] ^= draw.choice((field.most, draw.randrange(field.most + 1)))
            put(dut, status)
        commit = draw.random() < 0.3
        access = None
        if draw.random() < 0.8:
            address = draw.choice(known) if draw.random() < 0.95 else draw.randrange(4096)
            data = draw.choice((0, 0xFFFF_FFFF, draw.getrandbits(32)))
            access = (int(draw.random() < 0.7), address, data, draw.choice((15, 15, draw.randrange(16))))
        await clock(dut, twin, status, access, commit)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def strobes_guard_every_flag(dut):
    """Flags at 0 and 1, written with 0 and 1, with and without the strobe of their byte."""
    twin, status, _ = await begin(dut)
    flags = {(g, r) for g, r, field in keys("setting") if field.most == 1}
    for group in GROUPS:
        for register in group.registers:
            if (group.name, register.name) not in flags:
                continue
            for before, data, strobe in itertools.product((0, 0xFFFF_FFFF), (0, 0xFFFF_FFFF), (0, 15)):
                await clock(dut, twin, status, (1, register.address, before, 15), compared=False)
                await clock(dut, twin, status, (1, register.address, data, strobe), True, compared=False)
                await clock(dut, twin, status, (0, register.address, 0, 15), compared=False)
            compare(dut, twin, set())


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def every_bit_is_its_own(dut):
    """All settings and all status fields with all ones, all zeros, and every second bit."""
    twin, status, _ = await begin(dut)
    for data in (0xFFFF_FFFF, 0, 0xAAAA_AAAA, 0x5555_5555):
        for group in GROUPS:  # an `enable` last: while it is 1, some others cannot be written
            switches = [register.address for register in group.registers if register.name == "enable"]
            others = [register.address for register in group.registers if register.name != "enable"]
            for address in switches:
                await clock(dut, twin, status, (1, address, 0, 15), compared=False)
            for address in others + switches:
                await clock(dut, twin, status, (1, address, data, 15), compared=False)
        await clock(dut, twin, status, None, True)
        for key, field in ((key, field) for *key, field in keys("status")):
            status[*key, field.name] = data & field.most
        put(dut, status)
        for group in GROUPS:
            for register in group.registers:
                await clock(dut, twin, status, (0, register.address, 0, 15), compared=False)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def answers_an_access_every_clock(dut):
    twin, status, draw = await begin(dut)
    known = [register.address for group in GROUPS for register in group.registers]
    dut.bus_valid_i.value = 1
    due = None  # the answer to the previous access
    for _ in range(500):
        address = draw.choice(known) if draw.random() < 0.8 else draw.randrange(4096)
        access = (draw.randrange(2), address, draw.getrandbits(32), draw.choice((15, draw.randrange(16))))
        for name, value in zip(("write", "address", "wdata", "strobe"), access):
            getattr(dut, f"bus_{name}_i").value = value
        await RisingEdge(dut.clk_i)
        expected = twin.access(*access, status)[:2]
        await ReadOnly()
        assert dut.bus_done_o.value == (due is not None)
        assert due is None or (bench.read(dut.bus_rdata_o), bool(bench.read(dut.bus_error_o))) == due
        due = expected
        await FallingEdge(dut.clk_i)
    dut.bus_valid_i.value = 0
    await RisingEdge(dut.clk_i)
    await ReadOnly()
    assert dut.bus_done_o.value == 1
    assert (bench.read(dut.bus_rdata_o), bool(bench.read(dut.bus_error_o))) == due
    await RisingEdge(dut.clk_i)
    await ReadOnly()
    assert dut.bus_done_o.value == 0
    compare(dut, twin, set())


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def starts_over_at_reset(dut):
    twin, status, draw = await begin(dut)
    known = [register.address for group in GROUPS for register in group.registers]
    for g in GROUPS:
        for register in g.registers:
            await clock(dut, twin, status, (1, register.address, draw.getrandbits(32), 15), True)
    for write in (0, 1):  # an access in the clock of the reset gets no answer
        dut.bus_valid_i.value, dut.bus_write_i.value, dut.bus_address_i.value = 1, write, known[0]
        await bench.reset(dut)
        dut.bus_valid_i.value = 0
        twin.reset()
        await ReadOnly()
        assert dut.bus_done_o.value == 0
        compare(dut, twin, set())
        await RisingEdge(dut.clk_i)


THRESHOLD, HOLD, SWAP, SWAPPING, DROPPED = 0x200, 0x214, 0x514, 0x518, 0x310  # docs/registers.md


@bench.applies(lambda dut: all(int(getattr(dut, name).value) for name in ("Slip", "Scan", "Calibrate")))
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def what_meets_in_one_clock(dut):
    """By hand. A write and a commit in one clock: the core gets the value written before, and the new one
    stays pending. A read in the clock before a write gives the old value, in the clock after it the new one.
    A status is sampled in the clock before the answer. A command pulses in the clock after its write,
    whatever is read then."""
    await begin(dut)
    seen, answers, number, swapping = [], {}, 0, 0

    async def clock(access=None, commit=0):
        """A tuple (address, data) writes, an address reads. Returns the core's threshold and hold, and
        pending."""
        nonlocal number, swapping
        dut.bus_valid_i.value, dut.bus_write_i.value = int(access is not None), int(isinstance(access, tuple))
        address, data = access if isinstance(access, tuple) else (access or 0, 0xDEAD)
        dut.bus_address_i.value, dut.bus_wdata_i.value, dut.bus_strobe_i.value = address, data, 15
        dut.commit_i.value = commit
        status = {"scan_dropped": 7000 + number, "calibrate_swapping": swapping}
        dut.status_i.value = members.word(members.STATUS, status)
        await ReadOnly()
        if dut.bus_done_o.value == 1:
            assert dut.bus_error_o.value == 0
            answers[number - 2] = bench.read(dut.bus_rdata_o)  # to the access of two clocks ago
        pulse = members.of(members.CFG, bench.read(dut.cfg_o))["calibrate_swap"]
        swapping = pulse  # the core reports it one clock later, here for one clock
        await RisingEdge(dut.clk_i)
        number += 1
        seen.append(pulse)
        await ReadOnly()
        cfg = members.of(members.CFG, bench.read(dut.cfg_o))
        got = cfg["slip_threshold"], cfg["slip_hold"], bench.read(dut.pending_o)
        await FallingEdge(dut.clk_i)
        return got

    assert (await clock((THRESHOLD, 301)))[1:] == (0, 1)
    assert (await clock((HOLD, 17)))[1:] == (0, 1)
    assert await clock(commit=1) == (301, 17, 0)
    # The same register, and the other one of the group, written in the clock of the commit and in the clocks
    # around it.
    assert await clock((THRESHOLD, 302)) == (301, 17, 1)
    assert await clock((THRESHOLD, 303), commit=1) == (302, 17, 1)
    assert await clock() == (302, 17, 1)
    assert await clock((HOLD, 18), commit=1) == (303, 17, 1)
    assert await clock(commit=1) == (303, 18, 0)
    assert await clock((HOLD, 19), commit=1) == (303, 18, 1)
    assert await clock((THRESHOLD, 304), commit=1) == (303, 19, 1)
    assert await clock(commit=1) == (304, 19, 0)
    assert await clock(commit=1) == (304, 19, 0)
    # Reads around a write and around its commit: a read gives the value written last.
    first = number
    for access in (HOLD, (HOLD, 20), HOLD, (HOLD, 21), (HOLD, 22), HOLD, THRESHOLD):
        await clock(access)
    assert await clock(HOLD, commit=1) == (304, 22, 0)
    assert await clock(HOLD) == (304, 22, 0)
    await clock()
    await clock()
    told = [answers[n] for n in range(first, number - 2)]
    assert told == [19, 0, 20, 0, 0, 22, 304, 22, 22]
    # A status that changes in every clock, read in consecutive clocks, between writes to other registers.
    first = number
    for access in (DROPPED, DROPPED, (HOLD, 23), DROPPED, None, DROPPED):
        await clock(access)
    await clock()
    await clock()
    due = {at: 7000 + first + at + 1 for at in (0, 1, 3, 5)} | {2: 0}
    assert {at - first: value for at, value in answers.items() if at >= first} == due
    # A command, with its status read in the clock of the pulse and in the clocks around it; it pulses only
    # once.
    first = number
    for access in (SWAPPING, (SWAP, 1), SWAPPING, SWAPPING, SWAP, (SWAP, 0), SWAPPING, None, None):
        await clock(access)
    assert seen[first:] == [0, 0, 1, 0, 0, 0, 0, 0, 0]
    assert [answers[first + at] for at in (0, 2, 3, 6)] == [0, 1, 0, 0]


WRITES = [  # of ones, by hand: (address, strobe): (error, pulse or None, pending), then what is read
    (0x510, 0b0000, False, None, False, 0x000),  # calibrate.write: lanes in byte 0, row in byte 1
    (0x510, 0b0010, False, None, False, 0x100),
    (0x510, 0b1100, False, None, False, 0x100),
    (0x510, 0b0001, False, "calibrate_write_written", False, 0x1FF),
    (0x4A0, 0b1110, False, None, False, 0x00),  # tare.write
    (0x4A0, 0b0001, False, "tare_write_written", False, 0xFF),
    (0x514, 0b1110, False, None, False, 0),  # calibrate.swap
    (0x514, 0b0001, False, "calibrate_swap", False, 0),
    (0x214, 0b0000, False, None, False, 0x0000),  # slip.hold: 16 bits, at a frame's start
    (0x214, 0b1100, False, None, False, 0x0000),
    (0x214, 0b0010, False, None, True, 0xFF00),
    (0x48C, 0b1111, True, None, False, 1),  # tare.at_start: at reset
    (0xB10, 0b1111, False, None, False, 0x3FFFFFF),  # shear_speed.vi_min: while off
    (0xB00, 0b0001, False, None, False, 1),  # shear_speed.enable
    (0xB14, 0b1111, True, None, False, 0x19999A),  # vi_max, 1677722 in 26 bits
    (0xB2C, 0b0001, False, None, False, 1),  # shear_speed.hold: at once, also while on
    (0xC1C, 0b1110, False, None, False, 0xFFFFFF00),  # forest.data: acts with its lowest byte
    (0xC1C, 0b0001, False, "forest_data_written", False, 0xFFFFFFFF),
    (0xC30, 0b1010, False, None, False, 0x3F00FF00),  # forest.feature: value, then index
    (0xC30, 0b0101, False, "forest_feature_written", False, 0x3FFFFFFF),
]


@bench.applies(lambda dut: all(int(getattr(dut, parameter(name)).value) for name in FEATURES))
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def what_a_write_does_not_reach_stays(dut):
    """Without its byte no command, no strobe and nothing that waits; no write at reset or while on."""
    await begin(dut)
    told = []
    for address, strobe, *_ in WRITES:
        pulses, answers = set(), []
        for write in (1, 0):
            dut.bus_valid_i.value, dut.bus_write_i.value, dut.bus_address_i.value = 1, write, address
            dut.bus_wdata_i.value, dut.bus_strobe_i.value = 0xFFFF_FFFF, strobe if write else 15
            for _ in range(3):
                await RisingEdge(dut.clk_i)
                dut.bus_valid_i.value = 0
                await ReadOnly()
                cfg = members.of(members.CFG, bench.read(dut.cfg_o))
                pulses |= {name for name in cfg if name.endswith(("_written", "swap")) and cfg[name]}
                if dut.bus_done_o.value == 1:
                    answers += [(bool(dut.bus_error_o.value), bench.read(dut.bus_rdata_o))]
                await FallingEdge(dut.clk_i)
        waits = bool(dut.pending_o.value)
        told.append((address, strobe, answers[0][0], *(pulses or {None}), waits, answers[1][1]))
        dut.commit_i.value = 1
        await RisingEdge(dut.clk_i)
        dut.commit_i.value = 0
    assert told == WRITES


# By hand from the blocks' pages: every setting's address, bits and, where it is not 0, value after reset.
SETTINGS = """014 32, 020 1, 100 1, 104 24, 200 20 1048575, 204 20 1048575, 208 20, 20C 20, 210 1 1,
214 16, 218 16, 21C 16, 228 20 1048575, 300 1, 304 16 1, 308 32, 30C 1, 400 17 2, 404 17, 408 17,
40C 17 65535, 410 2 3, 414 8, 418 8, 41C 8, 480 17 64, 484 8 1, 488 1, 48C 1 1, 494 1, 498 20, 49C 17,
4A0 8, 500 16, 504 20, 508 17, 50C 16, 510 9, 600 32 1, 700 17 65535, 704 17, 708 4, 70C 17, 710 4,
714 17, 718 4, 71C 18, 720 18, 724 18, 728 18, 72C 18, 730 18, 734 16 1, 738 16 65535, 73C 17 65535,
740 17 65535, 744 18 262143, 800 8 128, 804 16, 808 16, 80C 16, 810 16, 900 1 1, 914 5 31, A00 1,
A04 24 1000000, A08 16 256, A0C 16, A10 16 1024, A14 16 60000, A18 16 2048, A1C 16 20, A20 1, A24 1,
A28 1, A2C 1, A30 16, A34 8, A38 17, A3C 17 4095, A40 8 8, A5C 16, A60 3, B00 1, B04 26, B08 18, B0C 16,
B10 26, B14 26, B18 26, B1C 26, B20 17, B24 24, B28 32, B2C 1, B30 8, B34 3, C10 24, C14 22, C18 32,
C1C 32, C30 30, C38 32, C3C 1, C48 16, D00 1, D04 32, D08 12, D0C 12, D10 8 255, D14 12 4095,
D18 16 20000, D1C 4 3, D20 16 2000, D24 1, D28 16 1, D2C 16, D30 1, D34 8, D38 3, D3C 1 1, D40 25"""
AT_RESET = (0x48C, 0xD14, 0xD18, 0xD1C, 0xD20)  # what is written has no effect
SETTINGS = {int(row.split()[0], 16): tuple(map(int, row.split()[1:])) for row in SETTINGS.split(",")}
# docs/shear_speed.md: 1.55 V, -0.27, n = 0.11, 2 to 4 V, 0.1 V, 2.5 mV, 4.99 V, 3 mm/s, 0.01 mm in 6.4 ms.
VOLT = 819.2  # codes; a level is a sum of 512
RUBBER = {0xB04: 1.55 * VOLT * 512, 0xB08: (4 - 0.27) * 65536, 0xB0C: 2048 / 0.11, 0xB10: 2 * VOLT * 512}
RUBBER |= {0xB14: 4 * VOLT * 512, 0xB18: 0.1 * VOLT * 512, 0xB1C: 0.0025 * VOLT * 512, 0xB20: 4.99 * VOLT}
RUBBER |= {0xB24: 3 << 20, 0xB28: 0.01 / 0.0064 * 2**20}


def whole(dut):
    """Every group, and the reset values of the map: those of another build have their own scratch."""
    present = all(int(getattr(dut, parameter(name)).value) for name in FEATURES)
    return present and dut.Resets.value.to_unsigned() & 0xFFFF_FFFF == 0


@bench.applies(whole)
@cocotb.test(timeout_time=1, timeout_unit="ms")
async def bits_and_reset_of_every_setting(dut):
    """By literal values: what is read after reset, and once ones were written to all that can be written."""
    settings = {(g, r) for g, r, _ in keys("setting")}
    assert set(SETTINGS) == {r.address for g in GROUPS for r in g.registers if (g.name, r.name) in settings}
    await begin(dut)
    for write in (False, True):
        for address, (bits, *reset) in sorted(SETTINGS.items(), key=lambda row: row[0] == 0xB00):
            for writes in (1, 0) if write else (0,):
                dut.bus_valid_i.value, dut.bus_write_i.value, dut.bus_address_i.value = 1, writes, address
                dut.bus_wdata_i.value, dut.bus_strobe_i.value = 0xFFFF_FFFF, 15
                for _ in range(3):
                    await RisingEdge(dut.clk_i)
                    dut.bus_valid_i.value = 0
            wanted = round(RUBBER.get(address, reset[0] if reset else 0))
            wanted = (1 << bits) - 1 if write and address not in AT_RESET else wanted
            assert (hex(address), bench.read(dut.bus_rdata_o)) == (hex(address), wanted)


EVIDENCE = {
    "equivalence": {
        "reset": {"qualifiers": {"bus_rdata_o": "bus_done_o", "bus_error_o": "bus_done_o"}},
    },
    "faults": {"keeps_settings": True},
}


@pytest.mark.parametrize(
    "features", [FEATURES, [], FEATURES[::2], pytest.param(FEATURES[1::2], marks=pytest.mark.long)], ids=len
)
def test_registers(features):
    bench.run("link", "registers", {parameter(name): int(name in features) for name in FEATURES})


def test_registers_with_reset_values_of_their_own():
    values = {"slip.threshold": 23, "slip.contact_level": -5, "scan.settle": 999, "health.use.edges": 0}
    word = reset_word(values | {"core.scratch": 0xDEADBEEF, "link.images": 0})
    bench.run("link", "registers", {"Resets": f"{RESET_BITS}'h{word:x}"})
    twin = Registers(resets=word)
    assert twin.setting("slip", "threshold", "value") == 23
    assert twin.setting("slip", "contact_level", "value") == (1 << 20) - 5
    assert twin.setting("health", "use", "edges") == 0 and twin.setting("health", "use", "user") == 1
    assert reset_word({}) == Registers().resets


@pytest.mark.parametrize(
    "values, sentence",
    [
        ({"slip.treshold": 1}, "'slip.treshold' is not a setting"),
        ({"scan.settle": 65536}, "scan.settle = 65536"),
    ],
)
def test_refuses_reset_values_that_are_none(values, sentence):
    with pytest.raises(ValueError, match=sentence):
        reset_word(values)


def test_the_generated_files_are_what_their_source_gives():
    done = subprocess.run(
        [sys.executable, "tools/make/registers.py", "--check"], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


def test_a_group_has_room_and_every_setting_fits():
    taken = [register.address for group in GROUPS for register in group.registers]
    assert len(set(taken)) == len(taken) and all(a % 4 == 0 and a < 4096 for a in taken)
    for group in GROUPS:
        for register in group.registers:
            assert all(0 <= field.reset <= field.most for field in register.fields), register.name


def test_an_unknown_feature_is_refused():
    with pytest.raises(ValueError, match="must be one of"):
        Registers(["telepathy"])


def test_the_word_of_a_groups_struct():
    """By hand: adc has a bit and 24 bits, the first setting highest; slip as tb/members.py places it."""
    assert struct_word("adc", {"enable": 1, "period": 5}, {}) == 0x100_0005
    assert struct_word("adc", {"enable": 0, "period": 0xFF_FFFF}, {}) == 0xFF_FFFF
    assert struct_bytes("adc", {"enable": 1, "period": 0x1234}, {}) == bytes.fromhex("34120001")
    places = members.PLACES["slip_cfg"].items()
    values = {name: bits + at if bits > 1 else 1 for at, (name, (_, bits)) in enumerate(places)}
    values |= {"contact_level": -77, "release_level": -131_072, "threshold": 262_143}
    widths = {"detail": 18, "timer": 16}
    assert struct_word("slip", values, widths) == members.word("slip_cfg", values)
    for name, value in (("contact_level", -131_073), ("threshold", 262_144), ("hold", 65_536), ("blank", -1)):
        with pytest.raises(ValueError, match=f"slip.{name} = {value} is wider than the core has bits for"):
            struct_word("slip", values | {name: value}, widths)
