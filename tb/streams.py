"""Start and reset a block, drive its streams and watch them, clock by clock."""

import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge, Timer
from cocotb.utils import get_sim_time

import icarus
from bodies import applies
from runner import ONES, SIM
from stimulus import SEED, as_signed, force_beats


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
    """Hold the synchronous reset; for one clock, the shortest, nothing can leave a block by itself."""
    dut.rst_i.value = 1
    for _ in range(clocks):
        await RisingEdge(dut.clk_i)
    dut.rst_i.value = 0


async def inputs_in_reset(dut, *resting, also=()):
    """While a reset holds, every bit of every input at both levels: the outputs ``resting`` stay 0.

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


# Benches read some million values. Of cocotb's own object: ``handle.value`` makes a LogicArray of the levels,
# a character a bit, at five times the time.


def read(handle):
    """The unsigned integer on a port; AssertionError if it is none."""
    bits = handle._handle.get_signal_val_binstr()
    try:
        return int(bits, 2)
    except ValueError:
        raise AssertionError(f"{handle._name} is {bits}") from None


def high(handle):
    """Whether a port of one bit is 1; X is not."""
    return handle._handle.get_signal_val_binstr() == "1"


def putter(port):
    """A function that writes a port, as unsigned, where the value changes: most writes repeat one."""
    mask, before = (1 << len(port)) - 1, None

    def put(value):
        nonlocal before
        value &= mask
        if value != before:
            port.value = before = value

    return put


async def stream(dut, beats, fields, gaps=None, stalls=None, drain=40, count=None, hold=False):
    """Send ``beats`` (dicts of input field: value) and return the list of beats that came out.

    ``fields``: output field names; a beat out is a dict of field: int (signed if the name ends in "~").
    Ends when every beat was taken and ``drain`` ready clocks passed with nothing coming out, or after
    ``count`` beats. The payload is driven to a wrong value while not valid, so that nobody samples it
    then. While the block is stalled, valid and data must hold. ``hold``: what was offered stays so until
    it is taken; otherwise an offer may be withdrawn.
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


# For tests of what registers hold before any reset: Icarus begins with unknowns.
starts_known = applies(lambda dut: SIM != "icarus")


async def turn_over(
    dut,
    *counters,
    most=1,
    span=40,
    wiggled=("in_valid_i", "in_last_i"),
    wraps=True,
    beside=(),
    still=(),
    **inputs,
):
    """The ``counters`` from their greatest value to 0: one of 32 bits never gets there by counting.

    Nothing was reset yet, and registers start as ones, so each counter does, unless this build has none and
    says 0: each counts by no more than ``most`` a clock, whatever comes, and within ``span`` clocks it has,
    if it ``wraps``. Where registers start with random values (``powerups``) it does so from there. Must be
    the first test of all (``stage=-1``), declared ``starts_known``. ``inputs``: of other inputs than those
    that are ``wiggled``; ``beside``: registers' outputs that count nothing here: it is only seen that they
    begin as those do; ``still``: counters that need not turn over, as what they count may not come: they too
    lose no bit.
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


def offer(dut, beat):
    """Put the fields of ``beat`` on their ports; in_valid_i is the caller's."""
    for name, value in beat.items():
        port = getattr(dut, f"in_{name}_i")
        port.value = int(value) & ((1 << len(port)) - 1)


async def taken(dut, beats, timeout=40):
    """How many of ``beats`` go in while nobody takes what comes out, until ``timeout`` clocks took none."""
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
    """Let ``count`` clocks pass; of many only the first two and the last one are met, at their period."""
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
