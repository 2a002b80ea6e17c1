"""Events that meet in one clock or one frame in msn_tare, with results worked out by hand: an averaging
requested at every clock around a frame's first and last beat; a contact in the first and last taxel around an
averaging, and inside a damaged frame; zeros written while a frame ends."""

from fractions import Fraction
from math import floor

import cocotb

import bench
import members

CONTACT, TAXELS, AVERAGED = 20, 6, 2


class Line:
    """Offers beats without gaps and records the clock in which each goes in, and the output."""

    def __init__(self, dut):
        self.dut, self.clock, self.taken, self.out = dut, 0, [], []
        self.settings = members.Settings(dut, "tare_cfg", contact=CONTACT)

    async def tick(self, beat=None):
        """One clock; returns whether ``beat`` (value, number, last) went in; an early last does not fit."""
        dut = self.dut
        dut.in_valid_i.value, dut.out_ready_i.value = int(beat is not None), 1
        if beat is not None:
            value, place, last = beat
            marks = bench.marks(place, 2, 3)
            marks |= {"fits": last == marks["last"], "last": last}
            bench.offer(dut, {"data": value, "id": place, **marks})
        await bench.ReadOnly()
        if dut.out_valid_o.value == 1:
            self.out.append(bench.as_signed(bench.read(dut.out_data_o), len(dut.out_data_o)))
        took = beat is not None and dut.in_ready_o.value == 1
        await bench.RisingEdge(dut.clk_i)
        self.clock += 1
        return took

    async def send(self, beats, tare_at=None, force=1):
        """Send all ``beats`` back to back; a tare asked for in the clock ``tare_at``."""
        for beat in beats:
            took = False
            while not took:
                asked = self.clock == tare_at
                self.settings.put(average=asked, force=asked and force)
                at = self.clock
                took = await self.tick(beat)
            self.taken.append(at)
        self.settings.put(average=0)

    async def status(self):
        for _ in range(12):
            await self.tick()
        status = self.state()
        return status["tared"], status["refused"]

    def state(self):
        return members.of("tare_status", bench.read(self.dut.status_o))


def frame(*values):
    """Beats of a frame; a single value is used for every taxel."""
    values = values * TAXELS if len(values) == 1 else values
    return [(value, place, int(place == TAXELS - 1)) for place, value in enumerate(values)]


async def begin(dut):
    await bench.start(dut, cfg_i=0, start_i=0, in_mask_i=0)
    return Line(dut)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def asked_for_at_every_clock_around_a_frames_ends(dut):
    """Requested before a frame's first beat goes in, it averages that frame and the next; requested in that
    clock or later, until the next frame begins, it averages the two frames that follow."""
    levels = [100, -231, 397, 604, -853, 1200, 77]
    beats = [beat for level in levels for beat in frame(level)]
    line = await begin(dut)
    await line.send(beats)
    firsts = line.taken[::TAXELS]
    seen = set()
    for at in range(firsts[1] - 2, firsts[2] + 3):
        await bench.reset(dut)
        line = Line(dut)
        await line.send(beats, tare_at=at)
        first = 1 if at < firsts[1] else 2 if at < firsts[2] else 3
        zero = floor(Fraction(levels[first] + levels[first + 1], AVERAGED) + Fraction(1, 2))
        assert await line.status() == (1, 0)
        zeros = [0] * (first + AVERAGED) + [zero] * (len(levels) - first - AVERAGED)
        raw = [level - own for level, own in zip(levels, zeros) for _ in range(TAXELS)]
        assert line.out == raw, at - firsts[1]
        seen.add(first)
    assert seen == {1, 2, 3}


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_contact_next_to_an_averaging_and_in_it(dut):
    """Frames 1 and 2 are averaged, 3 is the first with the new zero. A contact is more than CONTACT above
    zero. It causes a refusal only in the averaged frames, in the first and in the last taxel alike, unless
    forced."""
    still, met, contact = 9, CONTACT, CONTACT + 1
    line = await begin(dut)
    await line.send(frame(still))
    asked = line.taken[1]
    for number in range(5):
        for place in (0, TAXELS - 1):
            for value, force in ((met, 0), (contact, 0), (contact, 1)):
                frames = [[still] * TAXELS for _ in range(6)]
                # With the new zero of 9, codes of a contact are 9 higher.
                frames[number][place] = value + (still if number > 2 else 0)
                await bench.reset(dut)
                line = Line(dut)
                beats = [beat for values in frames for beat in frame(*values)]
                await line.send(beats, tare_at=asked, force=force)
                refused = int(number in (1, 2) and value == contact and not force)
                which = (number, place, value, force)
                assert await line.status() == (1 - refused, refused), which
                # The last taxel's zero: 9; or of 9 and 20 or 21, floor(14.5 + 1/2) or floor(15 + 1/2), both
                # 15.
                averaged = number in (1, 2) and place == TAXELS - 1
                assert line.out[-1] == (still if refused else -6 if averaged else 0), which
                assert line.state()["state_taring"] == 0


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_contact_inside_a_damaged_frame_is_forgotten(dut):
    """Damage restarts the averaging: 13, averaged before it, is in no zero. A contact in the damaged frame
    causes no refusal, wherever the frame broke off, and is not reported. A contact in a complete frame before
    the damage causes a refusal at that frame's end."""
    still, contact = 9, 500
    line = await begin(dut)
    await line.send(frame(still))
    asked = line.taken[1]
    for length in range(1, TAXELS):
        for place in range(length):
            await bench.reset(dut)
            line = Line(dut)
            await line.send([*frame(still), *frame(13)], tare_at=asked, force=0)  # the second is averaged
            broken = frame(*(contact if at == place else still for at in range(TAXELS)))[:length]
            broken[-1] = (*broken[-1][:2], 1)
            await line.send(broken)
            assert await line.status() == (0, 0)
            assert line.state()["state_pressed"] == 0 and line.state()["state_taring"] == 1
            await line.send(frame(still))
            assert await line.status() == (0, 0) and line.state()["state_taring"] == 1
            await line.send([*frame(still), *frame(still)])
            assert await line.status() == (1, 0), (length, place)
            assert line.out[-TAXELS:] == [0] * TAXELS
    await bench.reset(dut)
    line = Line(dut)
    await line.send(
        [*frame(still), *frame(still, still, contact, still, still, still)], tare_at=asked, force=0
    )
    assert await line.status() == (0, 1)
    assert line.state()["state_pressed"] == 1 and line.state()["state_taring"] == 0


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def one_asked_for_while_one_begins_comes_after_it(dut):
    """Also in the clock in which it begins, the one after its request: two averagings, of other frames."""
    line = await begin(dut)
    for gap in range(1, 5):
        await bench.reset(dut)
        line = Line(dut)
        for clock in range(gap + 1):
            line.settings.put(average=clock in (0, gap))
            await line.tick()
        line.settings.put(average=0)
        await line.send([beat for value in (9, 9, 15, 15, 15, 15) for beat in frame(value)])
        assert await line.status() == (2, 0), gap
        assert line.out[::TAXELS] == [9, 9, 6, 6, 6, 0], gap


@bench.applies(lambda dut: dut.TareLog2.value.to_unsigned() == 8)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def the_longest_averaging_takes_256_frames(dut):
    """Of 0 .. 255, pressed or not: 127 1/2, of which 128 is taken off from the next frame on."""
    line = await begin(dut)
    line.settings.put(average=1, force=1)
    await line.tick()
    line.settings.put(average=0)
    await line.send([beat for value in [*range(256), 300] for beat in frame(value)])
    assert await line.status() == (1, 0)
    assert line.out[::TAXELS] == [*range(256), 172]


def test_tare_coincidences():
    build = {"Rows": 2, "Columns": 3, "Lanes": 1, "FractionBits": 5, "TareLog2": 1}
    bench.run("frontend", "tare", build, module="test_tare_coincidences")


def test_tare_of_the_longest_averaging():
    build = {"Rows": 2, "Columns": 3, "Lanes": 1, "TareLog2": 8}
    bench.run("frontend", "tare", build, "the_longest_averaging_takes_256_frames", "test_tare_coincidences")
