"""msn_scan_walk against its model: the places of frames of any region, row by row and interleaved, whatever
the registers do meanwhile; a begin that nothing follows; frames one after the other; reset in a frame."""

import random

import cocotb
import pytest
from cocotb.triggers import ReadOnly, RisingEdge

import bench
from meissner.twins.frontend.scan_walk import Region, places

ENDS = ("first_row", "last_row", "first_column", "last_column")


def number(dut, name):
    return getattr(dut, name).value.to_unsigned()


def size_of(dut):
    return tuple(number(dut, name) for name in ("Rows", "Columns", "Lanes", "Channels"))


def put(dut, region, interleave):
    for name in ENDS:
        getattr(dut, f"cfg_{name}_i").value = getattr(region, name)
    dut.cfg_interleave_i.value = interleave


def any_region(draw, dut):
    """Also past the array and with its ends the wrong way round."""
    return Region(*(draw.randrange(1 << len(getattr(dut, f"cfg_{name}_i"))) for name in ENDS))


async def place_is(dut, place, active):
    await ReadOnly()
    assert (bench.read(dut.row_o), bench.read(dut.group_o), bench.read(dut.active_o)) == (*place, active)
    await RisingEdge(dut.clk_i)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def walks_as_the_model(dut):
    draw, size = random.Random(bench.SEED), size_of(dut)
    await bench.start(dut, begin_i=0, step_i=0, cfg_interleave_i=0, **{f"cfg_{name}_i": 0 for name in ENDS})
    for turn in range(60):
        region, interleave = any_region(draw, dut), draw.getrandbits(1)
        put(dut, region, interleave)
        await bench.clocks(dut, 3)
        way = places(*size, region, bool(interleave))
        if turn % 3 == 0:  # nothing begins by this
            dut.begin_i.value = 1
            await place_is(dut, way[0], 0)
            dut.begin_i.value = 0
            await bench.clocks(dut, 2)
        cut = draw.randrange(len(way)) if turn % 7 == 6 else None
        for at, place in enumerate(way):
            dut.begin_i.value, dut.step_i.value = int(at == 0 or draw.random() < 0.5), 1
            await place_is(dut, place, int(at > 0))
            dut.begin_i.value = dut.step_i.value = 0
            put(dut, any_region(draw, dut), draw.getrandbits(1))
            await place_is(dut, place, 1)
            await place_is(dut, place, 1)
            last = at == len(way) - 1
            if at == cut:
                await bench.reset(dut)
                break
            if not last:
                for _ in range(draw.randrange(3)):
                    await place_is(dut, way[at + 1], 1)
            limits = region.cut(*size[:2])
            ends = [bench.read(getattr(dut, f"{name}_o")) for name in ("first_row", "last_row")]
            ends += [bench.read(getattr(dut, f"{name}_beat_o")) for name in ("first", "last")]
            assert ends == [limits.first_row, limits.last_row, *region.beats(*size[:3])]
            assert bench.read(dut.interleave_o) == interleave
        await ReadOnly()
        assert bench.read(dut.active_o) == 0
        await RisingEdge(dut.clk_i)


EVIDENCE = {
    "reference": {
        "against": "places `by_hand`",
        "test": "tb/frontend/test_scan_walk.py::test_places_by_hand",
    },
}

SPACE = lambda draw: {
    "Rows": draw.randint(1, 9),
    "Columns": draw.randint(1, 40),
    "Lanes": draw.choice([1, 2, 4]),
}


@pytest.mark.parametrize(
    "rows, columns, lanes, channels",
    [(1, 1, 1, 8), (5, 24, 2, 4), (8, 17, 1, 1), (3, 5, 8, 3), (7, 64, 4, 8)],
)
def test_scan_walk(rows, columns, lanes, channels):
    size = {"Rows": rows, "Columns": columns, "Lanes": lanes, "Channels": channels}
    bench.run("frontend", "scan_walk", size)


def test_places_by_hand():
    by_hand = [(1, 0), (1, 1), (3, 0), (3, 1), (5, 0), (5, 1), (2, 0), (2, 1), (4, 0), (4, 1)]
    region = Region(1, 5, 3, 16)  # of beats of two columns, four a group: beats 1 .. 8
    assert places(9, 24, 2, 4, Region(1, 5, 3, 15), True) == by_hand
    assert places(9, 24, 2, 4, region)[:4] == [(1, 0), (1, 1), (1, 2), (2, 0)]
    assert places(4, 24, 2, 4, Region(7, 2, 30, 8)) == [(2, 1)]  # upside down: the last of both
    assert places(2, 3, 1, 8) == [(0, 0), (1, 0)]
    assert Region(0, 9, 5, 40).beats(4, 20, 8) == (0, 2)


def test_refuses_illegal_parameters():
    for name, value in {"Rows": 0, "Columns": 1025, "Lanes": 3, "Channels": 9}.items():
        assert f"msn_scan_walk: {name} = {value}" in bench.refuses("scan_walk", {name: value})
    assert "Channels = 3" in bench.refuses("scan_walk", {"Channels": 3, "Columns": 24})
