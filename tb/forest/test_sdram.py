"""msn_sdram at the pins of a part model that refuses what the data sheets forbid: words loaded and read back,
reads of random banks, of one bank and of one row, with gaps; clocks by hand and bounds for a node; refreshes
between them; a load and a refresh among reads; a reset in the middle; both ends of the data's round trip."""

import random
from itertools import pairwise
from types import SimpleNamespace

import cocotb
import pytest
from cocotb.clock import Clock

import bench
from harness.refusals import refusals, refused
from meissner.builds.pins import description
from meissner.twins.forest import sdram as twin
from parts import sdram
from parts.timing import now

ROWS = 64  # refreshed in a 128th of 64 ms: the same rate, seen in a short run
# By ClkKhz: ps of half a period; the shortest and the longest round trip of data that can be sampled.
CLOCKS = {100_000: (5000, 2.6, 8.4), 133_000: (3760, 1.3, 4.7), 25_000: (20_000, 0.0, 13.4)}


def clk_khz(dut):
    return dut.ClkKhz.value.to_unsigned()


FAST = bench.applies(lambda dut: clk_khz(dut) >= 100_000)
REFRESHES = {100_000: 780, 133_000: 1038}  # clocks from one to the next, less than 7.8125 us


def part(dut, end=0):
    pins = {name: getattr(dut, f"sdram_{name}_o") for name in ("cke", "cs_n", "ras_n", "cas_n", "we_n", "ba")}
    pins |= {name: getattr(dut, f"sdram_{name}_o") for name in ("a", "dqm", "dq_enable", "dq")}
    pins |= {"dq_o": pins["dq"], "dq_oe": pins["dq_enable"], "dq_i": dut.sdram_dq_i, "clk": dut.clk_i}
    given = {"t_power": 1000 * dut.PowerUpUs.value.to_unsigned(), "t_ref_max": 64e6 * ROWS / 8192}
    round_ns = CLOCKS[clk_khz(dut)][1 + end]
    return sdram.Sdram(SimpleNamespace(**pins), sdram.Limits(**given), round_ns=round_ns, rows=ROWS)


async def up(dut, end=0):
    half = CLOCKS[clk_khz(dut)][0]
    Clock(dut.clk_i, 2 * half, unit="ps", period_high=half).start()
    for name in ("req_valid", "load_valid", "req_address", "req_tag"):
        getattr(dut, f"{name}_i").value = 0
    await bench.RisingEdge(dut.clk_i)
    await bench.reset(dut)
    model = part(dut, end)
    await bench.RisingEdge(dut.clk_i)
    while not bench.high(dut.up_o):
        await bench.RisingEdge(dut.clk_i)
    return model


def word_of(address):
    """Another word at each address, each beat another."""
    return (address * 0x9E37_79B9_7F4A_7C15 + 0x1234_5678_9ABC_DEF1) % (1 << 64)


def fill(model, addresses):
    for address in addresses:
        for bank, row, column, beat in twin.beats(address, word_of(address)):
            model.memory[bank, row, column] = beat


async def read(dut, addresses, flight=None, gap=0.0):
    """Read all; (clocks from the first request to the last answer, latencies). Each tag in flight is used
    once; a request waits for a free one."""
    draw = random.Random(bench.SEED)
    free = list(range(1 << len(dut.req_tag_i)))
    free = free[: flight or len(free)]
    draw.shuffle(free)
    waiting, latencies, sent, clock, first = {}, [], 0, 0, None
    put_valid, put_address, put_tag = map(bench.putter, (dut.req_valid_i, dut.req_address_i, dut.req_tag_i))
    offered = False
    while len(latencies) < len(addresses):
        offered = sent < len(addresses) and bool(free) and (offered or draw.random() >= gap)
        put_valid(offered)
        if offered:
            put_address(addresses[sent])
            put_tag(free[0])
        await bench.ReadOnly()
        if offered and bench.high(dut.req_ready_o):
            first = clock if first is None else first
            waiting[free.pop(0)] = addresses[sent], clock
            sent, offered = sent + 1, False
        if bench.high(dut.rsp_valid_o):
            tag = bench.read(dut.rsp_tag_o)
            address, since = waiting.pop(tag)
            data = bench.read(dut.rsp_data_o)
            assert data == word_of(address), f"word {address:#x}: {data:#x}, not {word_of(address):#x}"
            latencies.append(clock - since)
            free.append(tag)
        await bench.RisingEdge(dut.clk_i)
        clock += 1
        assert clock < 400 * len(addresses) + 2000, f"{len(waiting)} reads without an answer"
    put_valid(0)
    return clock - first, latencies


async def load(dut, addresses, taken=None):
    """Load all; the clocks. ``taken``: those in which a word was."""
    clock = 0
    for address in addresses:
        dut.load_valid_i.value, dut.load_address_i.value = 1, address
        dut.load_data_i.value = word_of(address)
        ready = False
        while not ready:
            await bench.ReadOnly()
            ready = bench.high(dut.load_ready_o)
            await bench.RisingEdge(dut.clk_i)
            clock += 1
        if taken is not None:
            taken.append(clock)
    dut.load_valid_i.value = 0
    await bench.clocks(dut, 2)  # the last beat is on its way
    return clock


def random_addresses(count, seed=1, rows=8192):
    draw = random.Random(seed)
    return [draw.randrange(4) << 20 | draw.randrange(rows) << 7 | draw.randrange(128) for _ in range(count)]


CORNERS = [bank << 20 | row << 7 | column for bank in range(4) for row in (0, 8191) for column in (0, 127)]


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(end=[0, 1])
async def reads_what_was_loaded(dut, end):
    """Corners of the address and random words; the data's way back as short and as long as can be sampled."""
    model = await up(dut, end)
    addresses = CORNERS + random_addresses(60)
    await load(dut, addresses)
    assert all(
        int(model.memory[bank, row, column]) == beat
        for address in addresses
        for bank, row, column, beat in twin.beats(address, word_of(address))
    )
    random.Random(3).shuffle(addresses)
    await read(dut, addresses * 3)
    assert model.counts["WRITE"] == len(addresses) and model.counts["READ"] == 3 * len(addresses)


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(gap=[0.0, 0.7], flight=[None, 1])
async def reads_at_random(dut, gap, flight):
    model = await up(dut)
    addresses = random_addresses(bench.rounds(300))
    fill(model, addresses)
    await read(dut, addresses, flight, gap)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def clocks_by_hand(dut):
    """One read: 3 of the queue, 2 to decide, ACT to READ, ReadClocks and a clock to the first beat, 3 to the
    last one. The next of that bank follows when the row was open for ACT to READ and 4, and closed; that of
    another bank after 4, as the data lines allow. 21 ns are 3 clocks at 100 and 133 MHz, 1 at 25 MHz."""
    latency, cycle = {100_000: (16, 10), 133_000: (16, 10), 25_000: (14, 7)}[clk_khz(dut)]
    model = await up(dut)
    addresses = [bank << 20 | row << 7 for bank in range(4) for row in range(8)]
    fill(model, addresses)
    found = await read(dut, addresses[:1])
    assert found[1] == [latency], found
    await bench.clocks(dut, 20)
    same = addresses[:4]
    clocks, _ = await read(dut, same)
    assert clocks == latency + 1 + cycle * 3
    await bench.clocks(dut, 20)
    clocks, _ = await read(dut, addresses[::8])
    assert clocks == latency + 1 + 4 * 3


@FAST
@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(kind=["random", "turns"])
async def clocks_a_word(dut, kind):
    """At most 4.15 clocks for 32 random reads in flight or if banks take turns, 4.2 for 16; refreshes
    included."""
    model = await up(dut)
    addresses = random_addresses(2000)
    if kind == "turns":
        addresses = [number % 4 << 20 | address % (1 << 20) for number, address in enumerate(addresses)]
    fill(model, addresses)
    before = model.counts["REF"]
    clocks, latencies = await read(dut, addresses)
    dut._log.info(f"{kind}: {clocks / len(addresses):.3f} clocks a word, latency up to {max(latencies)}")
    many = len(dut.req_tag_i) == 5
    assert clocks <= {"random": 4.15 if many else 4.2, "turns": 4.15}[kind] * len(addresses)
    assert abs((model.counts["REF"] - before) - clocks / REFRESHES[clk_khz(dut)]) <= 1


@FAST
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def one_bank_alone(dut):
    """Ten clocks a word: open, read, close."""
    model = await up(dut)
    addresses = [address & 0xFFFFF | 2 << 20 for address in random_addresses(500)]
    fill(model, addresses)
    clocks, _ = await read(dut, addresses)
    assert 10 * 500 <= clocks <= 10.4 * 500, clocks


@FAST
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def loads_and_reads_take_turns(dut):
    """Neither waits for ever: each load lets reads go on for 64 clocks, then it comes as soon as all rows are
    closed, a refresh between them at most. Without reads it does not wait."""
    model = await up(dut)
    addresses = random_addresses(600, rows=64)
    fill(model, addresses)
    others = [address | 1 << 19 for address in random_addresses(60, 2)]
    seen = []
    loading = cocotb.start_soon(load(dut, others, seen))
    clocks, _ = await read(dut, addresses)
    among = [clock for clock in seen if clock < clocks - 100]
    gaps = [later - clock for clock, later in pairwise(among)]
    # 64, one to decide, 11 of a load; three open banks take 20, a refresh 14 more.
    assert min(gaps) >= 64 + 12 and max(gaps) <= 64 + 12 + 20 + 14, gaps
    assert len(gaps) >= clocks // 110 - 2
    await loading
    assert model.counts["WRITE"] == 60
    await read(dut, others)


async def commands(dut, opened, taken):
    """Lists the banks of the rows opened and of the reads."""
    while True:
        await bench.ReadOnly()
        if not bench.high(dut.sdram_cs_n_o):
            which = tuple(bench.high(getattr(dut, f"sdram_{name}_n_o")) for name in ("ras", "cas", "we"))
            for kind, banks in (((0, 1, 1), opened), ((1, 0, 1), taken)):
                if which == kind:
                    banks.append(bench.read(dut.sdram_ba_o))
        await bench.RisingEdge(dut.clk_i)


@FAST
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def banks_take_turns(dut):
    """The next waiting bank above the last one is opened, and read: after each bank, each set of them."""
    model = await up(dut)
    words = [bank << 20 | 5 for bank in range(4)]
    fill(model, words)
    opened, taken = [], []
    watch = cocotb.start_soon(commands(dut, opened, taken))
    for last in range(4):
        for chosen in range(1, 16):
            await read(dut, words[last : last + 1])
            await bench.clocks(dut, 10)
            opened.clear()
            taken.clear()
            loading = cocotb.start_soon(load(dut, [7]))  # all reads wait for it
            await bench.RisingEdge(dut.clk_i)
            banks = [bank for bank in range(4) if chosen >> bank & 1]
            await read(dut, [words[bank] for bank in banks])
            await loading
            turns = sorted(banks, key=lambda bank: (bank - last - 1) % 4)
            assert opened == [0, *turns], (last, banks)
            assert taken == turns, (last, banks)
    watch.cancel()


@FAST  # the other build waits 200 us for the part, too long for a short run's 500 us
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def refreshes_at_rest(dut):
    """All 64 rows in 500 us; the part model checks each."""
    model = await up(dut)
    before, rounds = model.counts["REF"], 77
    await bench.clocks(dut, rounds * REFRESHES[clk_khz(dut)])
    assert abs(model.counts["REF"] - before - rounds) <= 1


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def recovers_after_reset(dut):
    """A reset at any moment of reads and loads: no old answer comes, and all works after it."""
    model = await up(dut)
    draw = random.Random(bench.SEED)
    seen = []
    for trial in range(12):
        addresses = random_addresses(200, trial)
        fill(model, addresses)
        busy = cocotb.start_soon(read(dut, addresses) if trial % 3 else load(dut, addresses))
        for _ in range(draw.randrange(20, 400)):
            await bench.RisingEdge(dut.clk_i)
        busy.cancel()
        dut.req_valid_i.value = dut.load_valid_i.value = 0
        # What is in progress ends untimely; a row that was just opened stays open while the part is set up.
        model.report = seen.append
        await bench.reset(dut)
        model.began, model.power, model.mode, model.refreshes, model.mode_at = now(), None, None, 0, None
        model.writing, model.refreshed = None, type(model.refreshed)([now()] * ROWS, ROWS)
        clock = 0
        while clock < 2 or not bench.high(dut.up_o):
            clock += 1
            await bench.ReadOnly()
            assert not bench.high(dut.rsp_valid_o) and not bench.high(dut.load_ready_o)
            await bench.RisingEdge(dut.clk_i)
        assert all("both drive" in str(each) or "t_ras_max" in str(each) for each in seen), seen
        model.report = model.fail
        fill(model, addresses)
        await read(dut, addresses[:20])


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def rests_in_reset(dut):
    await bench.inputs_in_reset(
        dut, "rsp_valid_o", "load_ready_o", "sdram_cke_o", "sdram_dq_enable_o", "up_o"
    )
    assert dut.sdram_cs_n_o.value == 1


@pytest.mark.parametrize(
    "khz, wait, bits, queue, clocks", [(100_000, 2, 5, 32, 4), (133_000, 5, 4, 8, 4), (25_000, 200, 3, 2, 3)]
)
def test_sdram(khz, wait, bits, queue, clocks):
    given = {"ClkKhz": khz, "PowerUpUs": wait, "TagBits": bits, "Queue": queue, "ReadClocks": clocks}
    bench.run("forest", "sdram", given)


def test_pins_of_the_ulx3s():
    """As many as the part has, by its name of each; none is listed twice, which `description` refuses."""
    found = description("ulx3s").sdram
    wide = {"ba": 2, "a": 13, "dqm": 2, "dq": 16}
    assert {name: len(lines) for name, lines in found.items() if isinstance(lines, list)} == wide
    assert {*found} == {"clk", "cke", "cs_n", "ras_n", "cas_n", "we_n", *wide}
    assert (found["we_n"], found["a"][10], found["dq"][15], found["dqm"][1]) == ("T20", "N19", "J17", "E20")


def test_model_by_hand():
    model = twin.Sdram(queue=4)
    model.load((1 << 22) - 1, 0x4444_3333_2222_1111)
    model.load(0, 7)
    assert model.read([0, (1 << 22) - 1, 0]).tolist() == [7, 0x4444_3333_2222_1111, 7]
    assert twin.beats(2 << 20 | 5 << 7 | 3, 0x4444_3333_2222_1111) == [
        (2, 5, 12 + beat, 0x1111 * (beat + 1)) for beat in range(4)
    ]
    refused(twin.Sdram, {"queue": 1}, {"queue": 12})
    refused(twin.Sdram().load, {"address": 1 << 22}, {"address": -1}, {"word": 1 << 64}, address=0, word=0)
    assert "Depth = 12" in bench.refuses("sdram", {"Queue": 12}, of="fifo")


EVIDENCE = {
    "equivalence": {"size": {"Queue": 2}},
    "mutants": {"unsolved": True},
    "faults": {"none": "an upset may leave out a refresh or close no row: the words have to be loaded again"},
}

test_refuses_illegal_parameters = refusals(
    "sdram",
    twin.Sdram,
    {"ClkKhz": 19_999},
    {"ClkKhz": 133_001},
    {"PowerUpUs": 0},
    {"PowerUpUs": 1001},
    {"TagBits": 0},
    {"TagBits": 17},
    {"ReadClocks": 2},
    {"ReadClocks": 7},
)
