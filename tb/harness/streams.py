"""Start and reset a block; drive and watch its streams, clock by clock."""

import random
from itertools import pairwise

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge, Timer
from cocotb.utils import get_sim_time

from harness import icarus, recorder
from harness.applicable import applies, is_top, whole
from harness.runner import ONES, SIM
from harness.stimulus import SEED, as_signed, force_beats


def unbroken(packets):
    """Whether each of a core's ``packets`` has the number after the last one's, mod 256: none is lost."""
    return all((later.number - packet.number) % 256 == 1 for packet, later in pairwise(packets))


async def start(dut, **inputs):
    """Start a 10 ns clock, idle the streams, set other ``inputs``, and reset the block."""
    Clock(dut.clk_i, 10, unit="ns").start()
    for name in ("in_valid_i", "out_ready_i"):
        if hasattr(dut, name):
            getattr(dut, name).value = 0
    for name, value in inputs.items():
        getattr(dut, name).value = value
    await RisingEdge(dut.clk_i)
    await reset(dut, icarus.RESET if SIM == "icarus" else 1)


async def reset(dut, clocks=1):
    """Hold the synchronous reset. By default for one clock, the shortest: nothing can leave the block
    meanwhile."""
    dut.rst_i.value = 1
    for _ in range(clocks):
        await RisingEdge(dut.clk_i)
    dut.rst_i.value = 0


async def inputs_in_reset(dut, *resting, also=()):
    """During a reset, drive every bit of every input to both levels: the outputs ``resting`` must stay 0.

    ``also``: inputs whose names do not end in _i.
    """
    inputs = [port for port in dut if port._name.endswith("_i") and port._name not in ("clk_i", "rst_i")]
    inputs += [getattr(dut, name) for name in also]
    Clock(dut.clk_i, 10, unit="ns").start()
    dut.rst_i.value = 1
    for bits in ("00", "01", "10", "00"):
        for port in inputs:
            port.value = int((bits * len(port))[-len(port) :], 2)
        await clocks(dut, 2)
        await ReadOnly()
        for name in resting:
            assert read(getattr(dut, name)) == 0, f"{name} with inputs of {bits} in reset"
        await RisingEdge(dut.clk_i)


# Benches read some million values. cocotb's own ``handle.value`` makes a LogicArray, one character a bit, and
# takes five times as long.


def read(handle):
    """The unsigned integer on a port; AssertionError if a bit is X or Z."""
    bits = handle._handle.get_signal_val_binstr()
    try:
        return int(bits, 2)
    except ValueError:
        raise AssertionError(f"{handle._name} is {bits}") from None


def high(handle):
    """Whether a one-bit port is 1; X counts as 0."""
    return handle._handle.get_signal_val_binstr() == "1"


def putter(port):
    """A function that writes a port as unsigned, and only if the value changes: most writes repeat the
    last."""
    mask, before = (1 << len(port)) - 1, None

    def put(value):
        nonlocal before
        value &= mask
        if value != before:
            port.value = before = value

    return put


async def stream(dut, beats, fields, gaps=None, stalls=None, drain=40, count=None, hold=False):
    """Send ``beats`` (dicts of input field: value) and return the list of beats that came out.

    ``fields``: output field names; an output beat is a dict of field: int (signed if the name ends in "~").
    Ends when every beat was taken and ``drain`` ready clocks passed without an output beat, or after
    ``count`` output beats. While valid is low the payload is driven to wrong values, so that a block that
    samples it then fails. While the output is stalled, its valid and data must hold. ``hold``: an offered
    beat stays offered until it is taken; otherwise an offer may be withdrawn.
    """
    names = [field.rstrip("~") for field in fields]
    ports = [getattr(dut, f"out_{name}_o") for name in names]
    signed = [len(port) if field.endswith("~") else 0 for field, port in zip(fields, ports)]
    outputs = list(zip(ports, signed))
    put = {name: putter(getattr(dut, f"in_{name}_i")) for name in {name for beat in beats for name in beat}}
    put_valid, put_ready = putter(dut.in_valid_i), putter(dut.out_ready_i)
    out_valid, in_ready = dut.out_valid_o, dut.in_ready_o
    settled, edge = ReadOnly(), RisingEdge(dut.clk_i)
    received = []
    sent = quiet = 0
    held = None
    waiting = False
    while (quiet < drain or sent < len(beats)) and (count is None or len(received) < count):
        offer = sent < len(beats) and (waiting or not (gaps and gaps()))
        put_valid(offer)
        if beats:
            for name, value in beats[sent if offer else sent - 1].items():
                put[name](int(value) if offer else ~int(value))
        ready = not (stalls and stalls())
        put_ready(ready)
        await settled
        valid = high(out_valid)
        if valid:
            values = [as_signed(read(p), bits) if bits else read(p) for p, bits in outputs]
            assert held is None or held == values, f"payload changed while stalled: {held} -> {values}"
        assert held is None or valid, "valid was withdrawn while stalled"
        held = values if valid and not ready else None
        if valid and ready:
            received.append(dict(zip(names, values)))
        took = offer and high(in_ready)
        waiting = hold and offer and not took
        quiet = 0 if valid or took else quiet + ready
        sent += took
        await edge
    dut.in_valid_i.value = 0
    return received


# For tests of register values before any reset: on Icarus they are unknown.
starts_known = applies(lambda dut: SIM != "icarus")


async def turn_over(
    dut,
    *counters,
    most=1,
    span=40,
    wiggled=("in_valid_i", "in_last_i"),
    wraps=True,
    again=True,
    beside=(),
    still=(),
    **inputs,
):
    """Check that ``counters`` wrap around from their greatest value: 32 bits never get there by counting.

    Runs before any reset, when registers start as ones and so do the counters (a counter that this build
    lacks reads 0): in each clock a counter grows by at most ``most``, whatever the inputs, and if ``wraps``,
    it must leave its greatest value within ``span`` clocks; and ``again`` each value of ``carries``, unless
    its events do not recur: then another test uses ``counts_on``. With random initial values it counts from
    there. Must be the first test of all (``stage=-1``), declared ``starts_known``. ``wiggled``:
    inputs driven at random; ``inputs``: values of other inputs; ``beside``: register outputs of which only
    the initial value is checked; ``still``: counters that need not wrap, as their events may not occur, but
    are checked otherwise.
    """
    ports, draw = [getattr(dut, counter) for counter in (*counters, *still)], random.Random(SEED)
    wiggled = [name for name in wiggled if hasattr(dut, name)]
    for name, value in (dict.fromkeys(wiggled, 0) | {"out_ready_i": 1, "rst_i": 0} | inputs).items():
        if hasattr(dut, name):
            getattr(dut, name).value = value
    await Timer(1, "ns")
    tops = [(1 << len(port)) - 1 for port in ports]
    first = before = [read(port) for port in ports]
    ones = ONES.lstrip("+") in cocotb.plusargs
    for name in (*counters, *beside, *still):
        value, top = read(getattr(dut, name)), (1 << len(getattr(dut, name))) - 1
        assert not ones or value in (0, top), f"{name} begins with {value:x}"
    Clock(dut.clk_i, 10, unit="ns").start()

    for clock in range(span):
        await RisingEdge(dut.clk_i)
        await ReadOnly()
        now = [read(port) for port in ports]
        counted = [(after - value) & top for value, after, top in zip(before, now, tops)]
        assert max(counted) <= most, f"{(*counters, *still)}: {before} -> {now}"
        before = now
        await FallingEdge(dut.clk_i)
        for name in wiggled:
            getattr(dut, name).value = int(clock < span - 1 and draw.random() < 0.5)
    for counter, at_first, at_last, top in zip(counters, first, before, tops):
        assert not wraps or at_first != top or at_last != top, f"{counter} did not turn over"
    await RisingEdge(dut.clk_i)
    if ones and wraps and again and whole(dut):
        here = [counter for counter, value in zip(counters, first) if value]
        await counts_on(dut, *here, most=most, span=span, wiggled=wiggled)


async def counts_on(dut, *counters, most=1, span=400, wiggled=(), strobe=None, **inputs):
    """Put each of ``carries`` into each counter: with these inputs it must count on from there within
    ``span`` clocks, by at most ``most`` in a clock. ``strobe``: the block's register that makes it count, set
    each time. Only where the block is built beside other sizes: a port of the top cannot be put."""
    draw = random.Random(SEED)
    if is_top(dut):
        return
    for name, value in inputs.items():
        getattr(dut, name).value = value
    for counter in counters:
        port, top = getattr(dut, counter), (1 << len(getattr(dut, counter))) - 1
        for start in carries(port):
            await FallingEdge(dut.clk_i)
            port.value = now = start
            if strobe:
                getattr(dut, strobe).value = 1
            for _ in range(span):
                for name in wiggled:
                    getattr(dut, name).value = draw.getrandbits(1)
                await RisingEdge(dut.clk_i)
                await ReadOnly()
                before, now = now, read(port)
                assert (now - before) & top <= most, f"{counter}: {before:x} -> {now:x}"
                if now != start:
                    break
                await FallingEdge(dut.clk_i)
            assert now != start, f"{counter} does not leave {start:x}"
    await RisingEdge(dut.clk_i)


def carries(port):
    """Values at which a counter that is narrower than ``port``, or loses a carry, counts wrong: 2^k - 1 for
    each k, where all k bits change, and random ones. To put them there ends a recording."""
    recorder.end()
    draw = random.Random(SEED)
    return [(2 << k) - 1 for k in range(len(port))] + [draw.getrandbits(len(port)) for _ in range(4)]


def offer(dut, beat):
    """Put the fields of ``beat`` on their ports; the caller drives in_valid_i."""
    for name, value in beat.items():
        port = getattr(dut, f"in_{name}_i")
        port.value = int(value) & ((1 << len(port)) - 1)


async def taken(dut, beats, timeout=40):
    """How many of ``beats`` go in with the output stalled; ends when none was taken for ``timeout``
    clocks."""
    dut.out_ready_i.value = 0
    sent = quiet = 0
    while sent < len(beats) and quiet < timeout:
        dut.in_valid_i.value = 1
        offer(dut, beats[sent])
        await ReadOnly()
        took = high(dut.in_ready_o)
        sent += took
        quiet = 0 if took else quiet + 1
        await RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    return sent


async def clocks(dut, count):
    """Let ``count`` clocks pass; for a long wait, awaits only the first two edges and the last, by the
    period."""
    edge = RisingEdge(dut.clk_i)
    for _ in range(min(count, 2)):
        before = get_sim_time()
        await edge
    period = get_sim_time() - before if count > 2 else 0
    if count > 3:
        await Timer((count - 2) * period - period // 2, "step")
    if count > 2:
        await edge


async def force_frame(dut, frame, lanes, fields):
    """Send one frame without a gap; return its result and the clocks from the last beat to the result."""
    dut.in_valid_i.value = 1
    dut.out_ready_i.value = dut.in_fits_i.value = 1
    for beat in force_beats(frame[None], lanes):
        dut.in_data_i.value, dut.in_last_i.value = beat["data"], int(beat["last"])
        dut.in_row_last_i.value = int(beat["row_last"])
        await RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    waited = 1
    await ReadOnly()
    while not high(dut.out_valid_o):
        await RisingEdge(dut.clk_i)
        await ReadOnly()
        waited += 1
    names = [field.rstrip("~") for field in fields]
    ports = [getattr(dut, f"out_{name}_o") for name in names]
    values = [as_signed(read(p), len(p)) if f.endswith("~") else read(p) for p, f in zip(ports, fields)]
    await RisingEdge(dut.clk_i)
    return dict(zip(names, values)), waited
