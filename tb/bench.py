"""Shared by every testbench: build a block, run its cocotb tests, drive and watch its streams."""

import hashlib
import os
import random
import re
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import cocotb
import cocotb_tools.config
import numpy as np
import pytest
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge, Timer
from cocotb_tools.check_results import get_results
from cocotb_tools.runner import get_runner

import bodies
import icarus
import recorder
from bodies import applies
from meissner.builds import toolchain

# Not --coverage: that adds state machines, which give no points and stop Verilator 5.048 at some sources.
COVERAGE_FLAGS = ("--coverage-line", "--coverage-toggle", "--coverage-expr")
ONES = "+verilator+rand+reset+1"  # registers start as ones: what needs the reset shows it
SEED = int(os.environ.get("MEISSNER_SEED", "1"))
POWERUPS = int(os.environ.get("MEISSNER_POWERUP", "0"))
SIM = os.environ.get("MEISSNER_SIM", "verilator")  # or icarus
# The runner calls make itself, past Verilator's -MAKEFLAGS; larger models need the first variable. A build
# runs once or twice: the compiler's time is more than what its optimising saves.
MAKEFLAGS = "-- CFG_CXXFLAGS_PCH_I=-include OPT_FAST=-O0"
# Whose assertions say the values they compare: to go through every other module, numpy's too, takes a second.
os.environ.setdefault("COCOTB_REWRITE_ASSERTION_FILES", "test_*.py *_by_hand.py")
if os.environ.get("MEISSNER_INSTANCE"):  # one of many in a top without ports, of verify.regress
    cocotb.top = getattr(cocotb.top, os.environ["MEISSNER_INSTANCE"])
if recorder.FILE:
    recorder.install()
for folder in ("libs_dir", "share_dir"):  # the runner writes them into a makefile
    setattr(cocotb_tools.config, folder, toolchain.for_make(getattr(cocotb_tools.config, folder)))


def passed(results, name, *plusargs):
    """The names of the tests of a run, by the runner's file of results; AssertionError if one failed."""
    tests, failures = get_results(results)
    assert tests > 0, f"{name}: no cocotb test ran"  # the runner itself accepts an empty run
    how = " ".join([f"MEISSNER_SEED={SEED}", *plusargs])
    assert failures == 0, f"{name}: {failures} of {tests} failed ({how})"
    cases = list(ElementTree.parse(results).iter("testcase"))
    bodies.RAN.update(f"{case.get('classname')}.{case.get('name')}" for case in cases)
    return [case.get("name") for case in cases]


def run(stage, block, parameters=None, test_filter=None, module=None, sources=None, include=None):
    """Build ``msn_<block>`` with Verilator and run the cocotb tests of tb/<stage>/test_<block>.py.

    ``module``: another test file of that stage, in place of test_<block>; ``sources``: other files than those
    of rtl/rtl.f; ``include``: a folder with a header that they include.
    """
    parameters = parameters or {}
    module = module or f"test_{block}"
    file = module.removeprefix("test_")
    name = "-".join([file, *([] if block in file else [block]), *(f"{k}{v}" for k, v in parameters.items())])
    name += f"-{(include or sources[-1].parent).name}" if sources else ""
    name = name.replace("'", "")  # of sized numbers
    if len(name) > 150:  # a file's name has 255 at most
        name = f"{name[:100]}-{hashlib.sha256(name.encode()).hexdigest()[:12]}"
    evidence = os.environ.get("MEISSNER_COVERAGE")  # a folder for the counts; see docs/coverage.md
    where = "coverage/builds" if evidence else "tb" if SIM == "verilator" else SIM
    build_dir = toolchain.folder_for_make(toolchain.BUILD / where / name)
    sources = sources or toolchain.sources_of(f"msn_{block}")
    flags = [*toolchain.VERILATOR_FLAGS]
    if SIM == "icarus":
        if reason := icarus.refused(block, parameters):
            pytest.skip(f"Icarus: {reason}")
        sources, flags = icarus.adapted(sources, build_dir / "adapted"), ["-g2012"]
    elif evidence:
        sources, flags = [*sources, *covers(sources)], [*flags, *COVERAGE_FLAGS]
    sources = [toolchain.for_make(source) for source in sources]
    os.environ.update(toolchain.environment())
    os.environ["MAKEFLAGS"] = MAKEFLAGS
    runner = get_runner(SIM)
    runner.build(
        sources=sources,
        hdl_toplevel=f"msn_{block}",
        includes=[include] if include else [],
        parameters=parameters,
        build_args=flags,
        build_dir=build_dir,
        timescale=("1ns", "1ps"),
    )

    def simulate(select, *plusargs):
        """Run the tests that ``select`` names; the names of those that ran."""
        results = runner.test(
            hdl_toplevel=f"msn_{block}",
            test_module=f"{stage}.{module}",
            build_dir=build_dir,
            test_dir=build_dir,
            test_filter=select,
            plusargs=[*plusargs],
            seed=SEED,
        )
        return passed(results, name, *plusargs)

    if POWERUPS:
        powerups(simulate, test_filter, int(hashlib.sha256(name.encode()).hexdigest()[:6], 16))
        return
    start = [ONES]
    if evidence:
        asks = Path(os.environ["PYTEST_CURRENT_TEST"].split("::")[0])  # the file, whosever tests it runs
        folder = Path(evidence) / asks.stem.removeprefix("test_")
        folder.mkdir(parents=True, exist_ok=True)
        which = hashlib.sha256(f"{name} {test_filter}".encode()).hexdigest()[:12]
        # From zeros: the way from ones to the reset's values would count as a toggle.
        start = [f"+verilator+coverage+file+{folder / which}.dat"]
    simulate(test_filter, *start)


def covers(sources):
    """The functional cover points of ``sources``' modules, which bind themselves to them."""
    folder = toolchain.ROOT / "tb/coverage"
    files = [folder / f"cover_{path.stem.removeprefix('msn_')}.sv" for path in sources]
    return [folder / "bin.svh", *(path for path in files if path.exists())]


def powerups(simulate, test_filter, first):
    """Run the tests with registers that start with random values, ``POWERUPS`` times, seeds from ``first``.

    Only a run's first test meets them, the others what the one before left: so all tests run with the first
    seed, and with each further one the test whose turn it is alone.
    """
    random_start = "+verilator+rand+reset+2"
    tests = simulate(test_filter, random_start, f"+verilator+seed+{first + 1}")
    for turn in range(1, POWERUPS):
        alone = rf"\b{re.escape(tests[turn % len(tests)])}$"
        simulate(alone, random_start, f"+verilator+seed+{first + 1 + turn}")


def refuses(block, parameters, of=None, sources=None):
    """Elaborate ``msn_<block>`` with illegal parameters; the message, of ``msn_<of>``, that stopped it.

    ``sources``: as for ``run``.
    """
    command = ["verilator", "--lint-only", "-Wall", "--top-module", f"msn_{block}"]
    command += [f"-G{k}={v}" for k, v in parameters.items()]
    done = subprocess.run(
        command + [str(path) for path in sources or toolchain.sources_of(f"msn_{block}")],
        env=toolchain.environment(),
        capture_output=True,
        text=True,
    )
    assert done.returncode != 0, f"msn_{block} accepted {parameters}"
    fatal = [line for line in done.stderr.splitlines() if f"msn_{of or block}: " in line]
    assert fatal, f"msn_{block} stopped without its own message:\n{done.stderr}"
    return fatal[0]


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


def pauses(rate, role):
    """A stall pattern: true with probability ``rate``; each ``role`` of a test has a sequence of its own.

    Two equal sequences at both ends of a block pause both in the same clocks: it never waits with a beat
    offered, nor is it ever ready with none. The seed is in the name of what failed (``run``).
    """
    draw = random.Random(f"{SEED} {role}")
    return lambda: draw.random() < rate


def gaps_and_stalls(gap_rate, stall_rate=None):
    """The two patterns of ``stream``; of one rate if only one is given."""
    stall_rate = gap_rate if stall_rate is None else stall_rate
    return pauses(gap_rate, "gaps"), pauses(stall_rate, "stalls")


def read(handle):
    """The integer on a port, signed where it was declared so in ``signed_ports``."""
    value = handle.value
    assert value.is_resolvable, f"{handle._name} is {value}"
    return int(value)


def as_signed(value, bits):
    """Two's complement reading of an unsigned port value."""
    return value - (1 << bits) if value >> (bits - 1) & 1 else value


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
    received = []
    sent = quiet = 0
    held = None
    waiting = False
    while (quiet < drain or sent < len(beats)) and (count is None or len(received) < count):
        offer = sent < len(beats) and (waiting or not (gaps and gaps()))
        dut.in_valid_i.value = int(offer)
        if beats:
            for name, value in beats[sent if offer else sent - 1].items():
                port = getattr(dut, f"in_{name}_i")
                mask = (1 << len(port)) - 1
                port.value = (int(value) if offer else ~int(value)) & mask
        ready = not (stalls and stalls())
        dut.out_ready_i.value = int(ready)
        await ReadOnly()
        valid = dut.out_valid_o.value == 1
        if valid:
            values = [as_signed(read(p), bits) if bits else read(p) for p, bits in zip(ports, signed)]
            assert held is None or held == values, f"payload changed while stalled: {held} -> {values}"
        assert held is None or valid, "valid was withdrawn while stalled"
        held = values if valid and not ready else None
        if valid and ready:
            received.append(dict(zip(names, values)))
        took = bool(offer and dut.in_ready_o.value == 1)
        waiting = hold and offer and not took
        quiet = 0 if valid or took else quiet + ready
        sent += took
        await RisingEdge(dut.clk_i)
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


async def taken(dut, beats, patience=40):
    """How many of ``beats`` go in while nobody takes what comes out, until ``patience`` clocks took none."""
    dut.out_ready_i.value = 0
    sent = quiet = 0
    while sent < len(beats) and quiet < patience:
        dut.in_valid_i.value = 1
        offer(dut, beats[sent])
        await ReadOnly()
        took = dut.in_ready_o.value == 1
        sent += took
        quiet = 0 if took else quiet + 1
        await RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    return sent


def time(clock):
    """A time for each clock, 48 bits of which none stays as it is for long."""
    return (clock * 0x9E37_79B9_7F4A_7C15 >> 8) % (1 << 48)


async def clocks(dut, count):
    """Let ``count`` clocks pass."""
    for _ in range(count):
        await RisingEdge(dut.clk_i)


def frames(restart=True, **payload):
    """Interleave payload arrays [channels, n] into beats: n frames, channels in order, ``last`` on the final.

    ``restart`` marks the first frame, as msn_frame_check does after reset.
    """
    arrays = {name: np.atleast_2d(values) for name, values in payload.items()}
    channels, length = next(iter(arrays.values())).shape
    return [
        {name: int(a[channel, frame]) for name, a in arrays.items()}
        | {"id": channel, "last": channel == channels - 1, "restart": restart and frame == 0}
        for frame in range(length)
        for channel in range(channels)
    ]


def column(beats, field, channels):
    """The values of one output field as an array [channels, frames]."""
    return np.array([beat[field] for beat in beats], dtype=np.int64).reshape(-1, channels).T


def width(bits):
    """Smallest and largest signed integer of ``bits`` bits."""
    return -(1 << (bits - 1)), (1 << (bits - 1)) - 1


def extremes_then_random(rng, channels, length, bits):
    """Integers [channels, length] that begin with full-scale steps of both signs, then are random."""
    low, high = width(bits)
    x = rng.integers(low, high + 1, (channels, length))
    corners = np.array([high, low, low, high, high, high, low, low, 0, -1, -1, 0, 1, 0])
    x[:, : len(corners)] = corners[:length]
    return x


def force_frames(rng, rows, columns):
    """Forces [frames, rows, columns]: the telling frames of an array of this size, then random ones."""
    i, j = np.indices((rows, columns))
    corner = np.full((rows, columns), 65535)
    corner[0, 0] = 1
    frames = [
        np.zeros((rows, columns)),
        np.full((rows, columns), 65535),
        np.ones((rows, columns)),
        corner,
        corner[::-1, ::-1],
        65535 * ((i + j) % 2),
        65535 * (j % 2),
        65535 * (i % 2),
        np.minimum(i, rows - 1 - i) + np.minimum(j, columns - 1 - j) + 1,  # symmetric both ways
    ]
    for row, column in {
        (0, 0),
        (0, columns - 1),
        (rows - 1, 0),
        (rows - 1, columns - 1),
        (rows // 2, columns // 3),
    }:
        for force in (1, 65535):
            single = np.zeros((rows, columns))
            single[row, column] = force
            frames.append(single)
    for _ in range(4):
        frames.append(rng.integers(0, 65536, (rows, columns)))
        frames.append(rng.integers(0, 65536, (rows, columns)) * (rng.random((rows, columns)) < 0.1))
    return np.array(frames).astype(np.int64)


def force_beats(forces, lanes=1, surplus=0xA5A5):
    """Beats of frames [frames, rows, columns]; the surplus lanes of a row's last beat hold ``surplus``."""
    count, rows, columns = forces.shape
    row_beats = -(-columns // lanes)
    padded = np.full((count, rows, row_beats * lanes), surplus, dtype="<u2")
    padded[:, :, :columns] = forces
    words = padded.reshape(count, rows * row_beats, lanes)
    return [
        {"data": int.from_bytes(word.tobytes(), "little"), "last": index == len(frame) - 1}
        for frame in words
        for index, word in enumerate(frame)
    ]


def lane_word(values, bits):
    """Integers of ``bits`` bits side by side in one word, the first lowest."""
    return sum((int(value) & ((1 << bits) - 1)) << (bits * lane) for lane, value in enumerate(values))


def lane_values(word, lanes, bits, signed=False):
    """What ``lane_word`` put together."""
    values = [word >> (bits * lane) & ((1 << bits) - 1) for lane in range(lanes)]
    return [as_signed(value, bits) for value in values] if signed else values


def lane_beats(frames, lanes, bits, surplus=0, **flags):
    """Beats of an array's frames [frames, rows, columns]: data, id, last, and a bit per lane of each of
    ``flags`` (arrays of the same shape); the surplus lanes of a row's last beat hold ``surplus``."""
    count, rows, columns = np.shape(frames)
    row_beats = -(-columns // lanes)

    def words(array, fill):
        padded = np.full((count, rows, row_beats * lanes), fill, dtype=np.int64)
        padded[:, :, :columns] = array
        return padded.reshape(count, rows * row_beats, lanes)

    data = words(frames, surplus)
    flags = {name: words(array, 0) for name, array in flags.items()}
    return [
        {"data": lane_word(data[frame, beat], bits), "id": beat, "last": beat == rows * row_beats - 1}
        | {name: lane_word(array[frame, beat], 1) for name, array in flags.items()}
        for frame in range(count)
        for beat in range(rows * row_beats)
    ]


def damage(beats, length, draw):
    """Beats of frames of ``length`` beats with about every third one damaged in a random way."""
    sent = []
    for at in range(0, len(beats), length):
        part = [dict(beat) for beat in beats[at : at + length]]
        where = draw.randrange(length)
        kind = draw.choice(["whole"] * 9 + ["missing", "doubled", "id", "early", "lost", "late"])
        if kind == "missing":
            del part[where]
        elif kind == "doubled":
            part.insert(where, dict(part[where]))
        elif kind == "id":
            part[where]["id"] = (part[where]["id"] + 1) % length
        elif kind == "early":
            part = part[: where + 1]
            part[-1]["last"] = True
        elif kind == "lost":
            part[-1]["last"] = False
        elif kind == "late":
            part += [dict(part[-1])]
            part[-2]["last"] = False
        sent += part
    return sent


async def force_frame(dut, frame, lanes, fields):
    """Send one frame without a gap; return its result and the clocks from the last beat to the result."""
    dut.in_valid_i.value = 1
    dut.out_ready_i.value = 1
    for beat in force_beats(frame[None], lanes):
        dut.in_data_i.value, dut.in_last_i.value = beat["data"], int(beat["last"])
        await RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    waited = 1
    await ReadOnly()
    while dut.out_valid_o.value != 1:
        await RisingEdge(dut.clk_i)
        await ReadOnly()
        waited += 1
    names = [field.rstrip("~") for field in fields]
    ports = [getattr(dut, f"out_{name}_o") for name in names]
    values = [as_signed(read(p), len(p)) if f.endswith("~") else read(p) for p, f in zip(ports, fields)]
    await RisingEdge(dut.clk_i)
    return dict(zip(names, values)), waited
