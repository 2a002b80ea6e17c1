"""msn_array_forces against its model, with all stages and without any, per taxel and by row and column, one
to eight lanes: forces taxel by taxel, centres of pressure, reports and counts, of complete and damaged
frames, with gaps and stalls; commands to the stages between two frames; the clocks of every frame; the
minimum load; resets."""

import random

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
import members
from meissner.twins.frontend.health import Limits, reports
from meissner.twins.sensor.array_forces import ArrayForces

LIMITS = Limits(
    band=5, jump=30, low=-900, high=901, over_range_enable=True, edges=True, still=12, rail=1, blink=29
)
TARE = {"contact": 20, "step": 37}
PRESET = 5000


def number(dut, name):
    return getattr(dut, name).value.to_unsigned()


def twin_of(dut):
    """As it is after a reset."""
    size = [number(dut, name) for name in ("Rows", "Columns", "Lanes")]
    health, tare, log2 = (number(dut, name) for name in ("Health", "Tare", "TareLog2"))
    kinds = {
        "row_column": bool(number(dut, "RowColumn")),
        "gain_shift": number(dut, "GainShift"),
        "min_load": 2,
    }
    kinds |= {"fraction_bits": number(dut, "FractionBits"), "bits_per_clock": number(dut, "BitsPerClock")}
    twin = ArrayForces(
        *size, LIMITS if health else None, TARE | {"tare_log2": log2} if tare else None, **kinds
    )
    twin.calibrate.table.preset = PRESET
    return twin


def small(dut):
    return number(dut, "Rows") * number(dut, "Columns") <= 100


class Line:
    """The block with its twin; what leaves it: ``taxels`` (force, mask, id, last), ``cops``, ``faults``."""

    async def begin(self, dut, stall=0.0):
        self.dut, self.twin, self.rng = dut, twin_of(dut), np.random.default_rng(bench.SEED)
        self.draw, self.taxels, self.cops, self.faults = random.Random(bench.SEED), [], [], []
        self.expected, self.due, self.told = ([], [], []), {}, {}  # faults by taxel: due, reported
        self.stall = bench.pauses(stall, "samples")
        twin = self.twin
        self.row_beats = -(-twin.columns // twin.lanes)
        self.length = twin.rows * self.row_beats
        limits = {f"health_{name}": value for name, value in members.limits(LIMITS).items()}
        tare = {f"tare_{name}": value for name, value in TARE.items()}
        self.settings = members.Settings(
            dut, "cfg", **limits, **tare, calibrate_preset=PRESET, cop_min_load=2
        )
        await bench.start(dut, sample_ready_i=0, health_ready_i=1)
        cocotb.start_soon(self.watch())
        return self

    async def watch(self):
        dut, read = self.dut, lambda name: bench.read(getattr(self.dut, name))
        while True:
            ready = not self.stall()
            dut.sample_ready_i.value = int(ready)
            await ReadOnly()
            if ready and dut.sample_valid_o.value == 1:
                self.taxels.append(tuple(read(f"sample_{name}_o") for name in ("data", "mask", "id", "last")))
            if dut.cop_valid_o.value == 1:
                cop = members.of("cop", read("cop_o"))
                self.cops.append((*(bench.as_signed(cop[k], 24) for k in "xy"), cop["load"], cop["pressed"]))
            if dut.health_valid_o.value == 1:
                health = members.of("health", read("health_o"))
                self.faults.append((health["id"], health["faults"]))
            await RisingEdge(dut.clk_i)

    async def load(self):
        """Write a bank of offsets and gains around 1, with every sixth entry of any size, and swap banks."""
        table, rng = self.twin.calibrate.table, self.rng
        entries = [(False, word, lane) for word in range(table.beats) for lane in range(table.lanes)]
        entries += [(True, row, 0) for row in range(table.rows) if table.row_column]
        for of_row, word, lane in entries:
            offset, gain = int(rng.integers(-300, 900)), int(rng.integers(3000, 5000))
            if rng.random() < 1 / 6:
                low, high = bench.width(min(table.offset_bits, 17))
                offset, gain = int(rng.integers(low, high)), int(rng.integers(1 << 16))
            table.put(of_row, word, lane, offset, gain)
            entry = {
                "word": word,
                "offset": offset,
                "gain": gain,
                "write_row": of_row,
                "write_lanes": 1 << lane,
            }
            entry = {f"calibrate_{name}": value for name, value in entry.items()}
            await self.settings.pulse(self.dut.clk_i, calibrate_write_written=1, **entry)
        await self.settings.pulse(self.dut.clk_i, calibrate_swap=1)
        self.twin.calibrate.swap()

    def frames(self, count):
        """Frames that are constant, walk, jump, are pressed and stay at a rail, as beats."""
        shape = count, self.twin.rows, self.twin.columns
        steps = np.cumsum(self.rng.choice([0, 0, 9, -9, 40], (count, 1, 1)), axis=0) % 300
        x = steps + self.rng.integers(-2, 3, shape)
        x += self.rng.integers(0, 60000, shape) * (self.rng.random(shape) < 0.05)
        x = np.where(self.rng.random(shape) < 0.02, self.rng.integers(-65536, 65536, shape), x)
        x[:, 0, 0] = 901
        over = self.rng.random(shape) < 0.02
        return bench.lane_beats(x, self.twin.lanes, 17, surplus=-1, user=over)

    def expect(self, beats):
        """Pass ``beats`` through the twin."""
        twin, (taxels, cops, faults) = self.twin, self.expected
        for beat in beats:
            raw = np.array(bench.lane_values(beat["data"], twin.lanes, 17, signed=True))
            over = bench.lane_values(beat["user"], twin.lanes, 1)
            forces, mask, news, cop = twin.beat(raw, over, beat["id"], beat["last"], beat["fits"])
            faults += reports(news, twin.lanes, twin.columns)
            if forces is None:
                continue
            lanes = (twin.columns - 1) % twin.lanes + 1 if beat["row_last"] else twin.lanes
            taxels += zip(forces[:lanes].tolist(), np.asarray(mask, int)[:lanes].tolist())
            self.ends += [0] * (lanes - 1) + [int(beat["last"])]
            cops += [cop] if cop else []

    async def send(self, beats, gap=lambda: False):
        """``sent`` counts the beats taken."""
        dut, self.sent = self.dut, 0
        for beat in beats:
            while gap():
                dut.in_valid_i.value = 0
                await RisingEdge(dut.clk_i)
            dut.in_valid_i.value = 1
            bench.offer(dut, beat)
            await ReadOnly()
            while dut.in_ready_o.value != 1:
                await RisingEdge(dut.clk_i)
                await ReadOnly()
            await RisingEdge(dut.clk_i)
            self.sent += 1
        dut.in_valid_i.value = 0

    async def agrees(self, beats, *gap):
        """All that leaves for ``beats`` is the twin's."""
        self.taxels.clear(), self.cops.clear(), self.faults.clear()
        self.expected, self.ends = ([], [], []), []
        self.expect(beats)
        await self.send(beats, *gap)
        while len(self.taxels) < len(self.expected[0]) and number(self.dut, "Tap"):
            await RisingEdge(self.dut.clk_i)
        await bench.clocks(self.dut, 80)
        taxels, cops, faults = self.expected
        if number(self.dut, "Tap"):
            assert [taxel[:2] for taxel in self.taxels] == taxels
            assert [taxel[3] for taxel in self.taxels] == self.ends
            ids, place = [], 0
            for end in self.ends:
                ids.append(place % (1 << len(self.dut.sample_id_o)))
                place = 0 if end else place + 1
            assert [taxel[2] for taxel in self.taxels] == ids
        else:
            assert self.taxels == []
        assert self.cops == cops
        # An event that meets a report being split is offered again in the next frame: the order is not the
        # twin's, and the last ones may come with the next beats.
        for taxel, kinds in faults:
            self.due[taxel] = self.due.get(taxel, 0) | kinds
        for taxel, kinds in self.faults:
            assert kinds and kinds & ~self.due.get(taxel, 0) == 0, (taxel, kinds)
            self.told[taxel] = self.told.get(taxel, 0) | kinds
        self.counted()

    def counted(self):
        """The counts and states are the twin's."""
        found = members.of("status", bench.read(self.dut.status_o))
        expected, twin = dict.fromkeys(found, 0) | {"cop_damaged": self.twin.damaged}, self.twin
        for stage, names in (
            ("health", ("dead", "railed", "blinking")),
            ("tare", ("state_taring", "state_pressed", "state_loading", "tared", "refused", "swallowed")),
        ):
            if getattr(twin, stage):
                values = (
                    (name, getattr(getattr(twin, stage), name.removeprefix("state_"))) for name in names
                )
                expected |= {f"{stage}_{name}": int(value) for name, value in values}
        assert found == expected


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def rests_in_reset_whatever_comes(dut):
    await bench.inputs_in_reset(dut, "sample_valid_o", "cop_valid_o", "health_valid_o", "status_o")


@cocotb.test(timeout_time=40, timeout_unit="ms")
@cocotb.parametrize(stall_rate=[0.0, 0.4])
async def matches_model(dut, stall_rate):
    """Frames in groups, every third with damaged ones, and a command to a stage after each group."""
    line = await Line().begin(dut, 1.5 * stall_rate)
    twin, length = line.twin, line.length
    for turn in range(24 if small(dut) else 3):
        if turn in (1, 2):
            await line.load()
        beats = line.frames(8 if small(dut) else 3)
        if turn % 3 == 2:
            beats = bench.damage(beats, length, line.draw) + beats[:length]
            beats = bench.placed(beats, twin.rows, line.row_beats)
        await line.agrees(beats, bench.pauses(stall_rate, "gaps"))
        command = ("none", "tare", "clear", "load", "report", "force")[turn % 6]
        if command in ("clear", "report"):
            await line.settings.pulse(dut.clk_i, **{f"health_{command}": 1})
            if twin.health:
                getattr(twin.health, command)()
        elif command in ("tare", "force"):
            await line.settings.pulse(dut.clk_i, tare_average=1, tare_force=command == "force")
            if twin.tare:
                twin.tare.tare(command == "force")
        elif command == "load":
            line.settings.put(tare_load=1)
            await bench.clocks(dut, 12)
            if twin.tare:
                twin.tare.load(True)
            await line.agrees(line.frames(1))
            for word in range(length):
                zero = {"tare_word": word, "tare_zero": 3 * word + turn, "tare_write": 1}
                await line.settings.pulse(dut.clk_i, tare_write_written=1, **zero)
                if twin.tare:
                    twin.tare.write(word, 3 * word + turn, [0])
            line.settings.put(tare_load=0)
            await bench.clocks(dut, 12)
            if twin.tare:
                twin.tare.load(False)
    assert twin.damaged or not small(dut)
    await line.agrees(line.frames(4))
    assert line.told == line.due and bool(line.due) == bool(twin.health)
    if twin.health and small(dut):
        assert twin.health.railed
    if twin.tare:
        assert twin.tare.tared and twin.tare.swallowed


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def the_first_tare_begins_with_the_preset_gains(dut):
    """With at_start, in spite of a contact, from the first frame on; a write by the host in the first clock
    counts from its swap on."""
    line = await Line().begin(dut)
    line.settings.put(tare_at_start=1)
    await bench.reset(dut)
    line.twin = twin = twin_of(dut)
    wrong = {"calibrate_write_written": 1, "calibrate_write_lanes": 255, "calibrate_gain": 9}
    await line.settings.pulse(dut.clk_i, **wrong)
    await bench.clocks(dut, line.length + twin.rows + 12)
    if twin.tare:
        twin.tare.tare(True)
        assert members.of("status", bench.read(dut.status_o))["tare_state_taring"] == 1
    await line.agrees(line.frames(3 if not small(dut) else 8))


@bench.applies(lambda dut: not number(dut, "Health"))  # a frame's load depends on it alone
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_load_counts_from_the_gate_on(dut):
    """The gate (minimum load) equal to a frame's own load, and one above it."""
    line = await Line().begin(dut)
    await line.load()
    twin, beats = line.twin, line.frames(2 if not small(dut) else 6)
    for beat in beats[: line.length]:  # a load with bits set over the full width
        beat["data"] = bench.lane_word([65535] * twin.lanes, 17)
    for frame in range(len(beats) // line.length):
        one = beats[frame * line.length : (frame + 1) * line.length]
        await line.agrees(one)
        load = line.cops[0][2]
        for gate in (load, load + 1):
            twin.min_load = gate
            line.settings.put(cop_min_load=gate)
            await line.agrees(one)
            assert line.cops[0][3] == (gate == load > 0) or twin.tare


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def clocks_are_as_stated(dut):
    """Each frame alone: from its last beat to its centre of pressure, the same in every frame. With Tap a
    beat comes when the previous one's taxels have left."""
    line = await Line().begin(dut)
    twin, beats = line.twin, line.frames(3)
    stated = sum(twin.steps.values())
    for frame in range(3):
        one, taken, clock, seen = beats[frame * line.length : (frame + 1) * line.length], 0, 0, None
        while seen is None:
            due = not number(dut, "Tap") or clock % twin.lanes == 0
            dut.in_valid_i.value = int(due and taken < len(one))
            bench.offer(dut, one[min(taken, len(one) - 1)])
            await ReadOnly()
            if due and taken < len(one) and dut.in_ready_o.value == 1:
                taken, end = taken + 1, clock
            if dut.cop_valid_o.value == 1:
                seen = clock
            clock += 1
            await RisingEdge(dut.clk_i)
        assert taken == len(one) and seen - end == stated
        await bench.clocks(dut, 20)


@bench.applies(lambda dut: number(dut, "Tap"))
@cocotb.test(timeout_time=20, timeout_unit="ms")
async def loses_nothing_while_nobody_takes_samples(dut):
    line = await Line().begin(dut)
    line.stall = lambda: True
    await bench.clocks(dut, 2)
    beats = line.frames(7)
    line.ends = []
    line.expect(beats)
    sending = cocotb.start_soon(line.send(beats))
    await bench.clocks(dut, 6 * len(beats) * line.twin.lanes)
    assert 0 < line.sent < len(beats) and not line.taxels
    line.stall = lambda: False
    await sending
    while len(line.taxels) < len(line.expected[0]):
        await RisingEdge(dut.clk_i)
    await bench.clocks(dut, 40)
    assert [taxel[:2] for taxel in line.taxels] == line.expected[0] and line.cops == line.expected[1]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def forgets_what_a_reset_interrupts(dut):
    line = await Line().begin(dut)
    for cut in (0.2, 0.5, 1.4):
        await line.load()
        beats = line.frames(2)
        await line.send(beats[: max(1, int(cut * line.length))])
        await bench.reset(dut)
        line.twin = twin_of(dut)
        await bench.clocks(dut, line.length + line.twin.rows + 12)
        await line.agrees(line.frames(2))


EVIDENCE = {
    "equivalence": {"size": {"Rows": 3}, "defined": True, "boxes": True},
    "mutants": {"sets": [0], "limit": 60, "unsolved": True},
    "faults": {
        "size": {"Rows": 3},
        "settle": 4,
        # The tables, the bank in use and whether one is loaded keep a fault until they are written again.
        "driver": {"kept": "memory bank loaded swapping"},
        "kept_inside": {"u_calibrate": "calibrate", "u_tare": "tare", "u_health": "health"},
    },
    "icarus": {"runs": {"Lanes": 1}},
}
WHOLE, BARE = {"Health": 1, "Tare": 1, "TareLog2": 2}, {"Health": 0, "Tare": 0}


@pytest.mark.parametrize(
    "rows, columns, lanes, kind",
    [
        (3, 5, 2, WHOLE),
        (4, 10, 3, WHOLE),
        (3, 5, 1, {"Health": 1, "Tare": 0}),
        (3, 5, 4, {"Health": 0, "Tare": 1, "TareLog2": 2, "Tap": 0}),
        (5, 19, 2, BARE),
        (5, 19, 8, BARE | {"RowColumn": 1, "FractionBits": 10, "BitsPerClock": 1}),
        (32, 32, 1, BARE | {"Tap": 0}),
    ],
    ids=["whole", "three", "health", "tare", "taxels", "grid", "large"],
)
def test_array_forces(rows, columns, lanes, kind):
    bench.run("sensor", "array_forces", {"Rows": rows, "Columns": columns, "Lanes": lanes} | kind)


def test_a_uniform_press_is_uniform_after_calibration_only():
    """Gains spread by 30 %: the image of a uniform press is uniform within 1 % if calibrated, and not
    otherwise."""
    rng = np.random.default_rng(3)
    gain, zero = rng.uniform(0.7, 1.3, (16, 16)), rng.integers(100, 900, (16, 16))
    raw = np.rint(zero + 8000 * gain).astype(np.int64)
    twin = ArrayForces(16, 16)
    for word, (offset, factor) in enumerate(zip(zero.ravel(), np.rint(4096 / gain).astype(int).ravel())):
        twin.calibrate.table.write(word, offset, factor)
    image = twin.calibrate.process(raw)
    x, y, load, _ = twin.cops(image)
    assert np.ptp(raw) / raw.mean() > 0.3
    assert np.ptp(image) / image.mean() < 0.01
    assert max(abs(int(x)), abs(int(y))) <= 3 and abs(load / (256 * 8000) - 1) < 0.01


def test_stated_latency():
    assert ArrayForces(64, 64).steps["cop"] == 14
    assert ArrayForces(64, 64, 8, row_column=True, bits_per_clock=1).steps["cop"] == 36
