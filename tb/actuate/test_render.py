"""msn_render against its model, and both against areas in fractions and cues written out: images larger and
smaller than the grid, of one row, all zero and full scale; a damaged image; images faster than it; every
octant; a marker at each corner. Its clocks by count."""

import random

import cocotb
import numpy as np
import pytest

import bench
from harness import recorder
from meissner.twins.actuate import render
from meissner.twins.actuate.render import OCTANTS, Render, RenderSettings
from reference.pin_display import averages, level_of, stripes

LARGER = [((16, 9), (7, 5), 3)]
SIZES = [  # image, grid, bits
    ((4, 6), (5, 20), 4),
    ((1, 17), (2, 20), 1),
    ((3, 3), (3, 3), 6),
    (None, (5, 20), 4),
]
REST = {"in_valid_i": 0, "in_data_i": 0, "in_last_i": 0, "cop_valid_i": 0, "cop_x_i": 0, "cop_y_i": 0}
REST |= {"cop_pressed_i": 0, "slip_i": 0, "octant_i": 0}


def parameters_of(shape, grid, bits):
    rows, columns = shape or (1, 2)
    given = {"Image": int(shape is not None), "Rows": rows, "Columns": columns}
    return given | {"PinRows": grid[0], "PinColumns": grid[1], "AmplitudeBits": bits}


def sizes(dut):
    read = lambda name: getattr(dut, name).value.to_unsigned()
    shape = (read("Rows"), read("Columns")) if read("Image") else None
    return shape, (read("PinRows"), read("PinColumns")), read("AmplitudeBits")


with_image = bench.applies(lambda dut: dut.Image.value.to_unsigned() == 1)


async def image_in(dut, taxels, cut=None):
    """An image; ``cut``: the number of taxels that come."""
    taxels = np.ravel(taxels)[:cut]
    for place, taxel in enumerate(taxels):
        dut.in_valid_i.value, dut.in_data_i.value = 1, int(taxel)
        dut.in_last_i.value = place == len(taxels) - 1
        await bench.RisingEdge(dut.clk_i)
    dut.in_valid_i.value = dut.in_last_i.value = 0


async def cop_in(dut, cop):
    x, y = cop or (0, 0)
    dut.cop_valid_i.value, dut.cop_pressed_i.value = 1, cop is not None
    dut.cop_x_i.value, dut.cop_y_i.value = x & 0xFFFF, y & 0xFFFF
    await bench.RisingEdge(dut.clk_i)
    dut.cop_valid_i.value = 0


async def frame_out(dut, grid, most=100_000):
    """(levels [rows, columns], clocks until the last one)."""
    got = []
    for clock in range(most):
        await bench.ReadOnly()
        if bench.high(dut.out_valid_o):
            got.append(bench.read(dut.out_data_o))
            assert bench.high(dut.out_last_o) == (len(got) == grid[0] * grid[1])
        await bench.RisingEdge(dut.clk_i)
        if len(got) == grid[0] * grid[1]:
            return np.reshape(got, grid), clock
    return None, most


async def two_frames(dut, grid):
    return [(await frame_out(dut, grid))[0] for _ in range(2)]


def settings_in(dut, settings):
    for name, value in settings.settings.items():
        getattr(dut, f"cfg_{name}_i").value = value


def overlapped(taxels, pins):
    """By how many taxels of a row each of its pins is touched."""
    meet = lambda i, r: r * pins < (i + 1) * taxels and (r + 1) * pins > i * taxels
    return np.array([sum(meet(i, r) for r in range(taxels)) for i in range(pins)])


def by_the_page(image, shape, grid, bits, settings, cop):
    """(levels, clocks of the frame): a taxel a clock, 6 and one a level for each pin; without an image one a
    pin."""
    highest = (1 << bits) - 1
    levels, clocks = np.zeros(grid, dtype=int), 1 + grid[0] * grid[1]
    if shape is not None:
        means = averages(image.tolist(), *grid)
        levels = np.array(
            [[level_of(m, settings.floor, settings.step, highest) for m in row] for row in means]
        )
        high, wide = (overlapped(*each) for each in zip(shape, grid))
        clocks = 2 + int((np.outer(high, wide) + 6 + levels).sum())
    if settings.marker and cop is not None:
        right, down = (16384 + cop[0]) / 32768, (16384 - cop[1]) / 32768
        levels[min(int(down * grid[0]), grid[0] - 1), min(int(right * grid[1]), grid[1] - 1)] = highest
    return levels, clocks


def images(draw, shape, settings, top):
    """One of a random kind; half of them have taxels of all levels, and some below."""
    least, most = settings.floor - settings.step - 2, settings.floor + settings.step * (top + 1)
    ends = [(0, 0), (65535, 65535), (0, 65535), (900, 1100), (1000, 1000)]
    ends = draw.choice(ends + 5 * [(max(0, least), min(65535, most))])
    return np.reshape([draw.randint(*ends) for _ in range(shape[0] * shape[1])], shape)


CORNERS = [(-16384, 16384), (16384, 16384), (-16384, -16384), (16384, -16384), (0, 0), (16383, -16383), None]
CORNERS += [(12345, -6789), (-4097, 4321), (8191, 8190)]


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def shows_images_and_markers(dut):
    shape, grid, bits = sizes(dut)
    draw = random.Random(bench.SEED)
    await bench.start(dut, **REST, cfg_floor_i=0, cfg_step_i=0, cfg_marker_i=0, cfg_cue_i=0)
    cases = [(0, 0), (1, 1), (1000, 0), (1000, 10), (65535, 0), (1, 65535)]
    more = 4 if grid[0] * grid[1] > 9 else 60
    cases += [
        (draw.getrandbits(draw.randint(1, 16)), draw.getrandbits(draw.randint(1, 13))) for _ in range(more)
    ]
    places = [*CORNERS, *((draw.randint(-16384, 16384), draw.randint(-16384, 16384)) for _ in range(more))]
    for n, (floor, step) in enumerate(cases):
        settings = RenderSettings(floor, step, n % 2 if shape else 1)
        settings_in(dut, settings)
        cop = places[n % len(places)]
        image = images(draw, shape, settings, (1 << bits) - 1) if shape else None
        if shape:
            await cop_in(dut, cop)
            await image_in(dut, image)
        else:
            await cop_in(dut, cop)
        got, clocks = await frame_out(dut, grid)
        expected, spent = by_the_page(image, shape, grid, bits, settings, cop)
        assert got.tolist() == expected.tolist(), settings
        assert clocks == spent, settings
        twin = Render(shape, grid, bits, settings)
        assert got.tolist() == twin.next(image, cop=cop).tolist()
        assert clocks <= twin.clocks
        if shape:
            pieces = (shape[0] + grid[0]) * (shape[1] + grid[1])
            assert twin.clocks <= pieces + grid[0] * grid[1] * (8 + (1 << bits)) + 8


@cocotb.test(timeout_time=100, timeout_unit="ms")
@cocotb.parametrize(cue=[1, 3])
async def shows_slip_by_stripes(dut, cue):
    """They begin anew with each slip, and move a pin every ``cue`` frames."""
    shape, grid, bits = sizes(dut)
    settings = RenderSettings(65535, 0, 0, cue)
    await bench.start(dut, **REST, **{f"cfg_{name}_i": v for name, v in settings.settings.items()})
    twin = Render(shape, grid, bits, settings)
    image = np.zeros(shape or (1, 2), dtype=int)
    for octant in (*range(8), None, 3, None):
        dut.slip_i.value, dut.octant_i.value = octant is not None, octant or 0
        if octant in (2, 5):  # a pause between two slips
            dut.slip_i.value, octant = 0, None
        for n in range(9 if octant is None or octant < 2 else 2):
            await (image_in(dut, image) if shape else cop_in(dut, None))
            got, _ = await frame_out(dut, grid)
            expected = twin.next(image, octant is not None, octant or 0)
            assert got.tolist() == expected.tolist(), (octant, n)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def a_pin_begins_where_the_one_before_ends(dut):
    """The marker of the first place on each pin, and of the last one before it, in a row and a column at
    once."""
    shape, grid, _ = sizes(dut)
    await bench.start(dut, **REST, cfg_floor_i=65535, cfg_step_i=0, cfg_marker_i=1, cfg_cue_i=0)
    for pin in range(1, max(grid)):
        pins = [min(pin, side - 1) for side in grid]
        first = [-(-at * 32768 // side) for at, side in zip(pins, grid)]
        for before in (0, 1):
            down, right = (max(at - before, 0) for at in first)
            await cop_in(dut, (right - 16384, 16384 - down))
            if shape:
                await image_in(dut, np.zeros(shape, dtype=int))
            got, _ = await frame_out(dut, grid)
            lit = [max(at - before, 0) for at in pins]
            assert np.argwhere(got).tolist() == [lit], (pin, before)


@bench.applies(lambda dut: dut.Image.value.to_unsigned() == 0 or dut.Rows.value.to_unsigned() == 3)
@cocotb.test(timeout_time=100, timeout_unit="ms")
async def stripes_stay_as_many_frames_as_set(dut):
    """Each bit of the setting; with 0 a slip is not shown."""
    shape, grid, bits = sizes(dut)
    await bench.start(dut, **REST, cfg_floor_i=65535, cfg_step_i=0, cfg_marker_i=0, cfg_cue_i=0)
    recorder.end()  # the settings change
    for cue in (0, 1, 2, 4, 8, 16, 32, 64, 128):
        dut.cfg_cue_i.value, dut.octant_i.value = cue, 1
        for n in (-1, *range(cue + 2)):
            dut.slip_i.value = n >= 0
            await (image_in(dut, np.zeros(shape, dtype=int)) if shape else cop_in(dut, None))
            got, _ = await frame_out(dut, grid)
            lit = stripes(1, n // cue, *grid) if cue and n >= 0 else set()
            assert {tuple(pin) for pin in np.argwhere(got == (1 << bits) - 1).tolist()} == lit, (cue, n)
            assert np.count_nonzero(got) == len(lit)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def a_centre_that_comes_meanwhile_is_for_the_next_frame(dut):
    """From one corner to the opposite one and back, or nothing presses any more, in many clocks of a frame:
    each frame has the one marker of its beginning."""
    shape, grid, bits = sizes(dut)
    await bench.start(dut, **REST, cfg_floor_i=65535, cfg_step_i=0, cfg_marker_i=1, cfg_cue_i=0)
    recorder.end()  # too few frames for faults
    ends = {(-16384, 16384): (0, 0), (16384, -16384): (grid[0] - 1, grid[1] - 1)}
    for turn, wait in enumerate((0, 1, 2, 5, 9, 30, 66, 67)):
        (one, at), (other, there) = sorted(ends.items(), reverse=turn % 2)
        other = None if turn % 3 == 1 else other
        got = cocotb.start_soon(two_frames(dut, grid))
        await cop_in(dut, one)
        if shape:
            await image_in(dut, np.zeros(shape, dtype=int))
            await bench.clocks(dut, 3)  # until it begins
        await bench.clocks(dut, wait)
        await cop_in(dut, other)
        if shape:
            await image_in(dut, np.zeros(shape, dtype=int))
        top = (1 << bits) - 1
        for frame, pin, on in zip(await got, (at, there), (top, top * (other is not None))):
            assert frame[pin] == on == frame.sum(), (wait, pin)


@with_image
@cocotb.test(timeout_time=100, timeout_unit="ms")
async def keeps_to_whole_images(dut):
    """A cut image shows nothing; of those that come while it works the newest is next."""
    shape, grid, bits = sizes(dut)
    await bench.start(dut, **REST, cfg_floor_i=1, cfg_step_i=0, cfg_marker_i=0, cfg_cue_i=0)
    one = np.ones(shape, dtype=int)
    await image_in(dut, one, cut=shape[0] * shape[1] - 1)
    assert (await frame_out(dut, grid, 3000))[0] is None
    got = cocotb.start_soon(frame_out(dut, grid))
    await image_in(dut, one)
    await image_in(dut, one * 0)
    await image_in(dut, one)
    top = (1 << bits) - 1
    assert (await got)[0].tolist() == (one[:1, :1] * np.full(grid, top)).tolist()
    assert (await frame_out(dut, grid))[0] is not None


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rests_in_reset(dut):
    await bench.inputs_in_reset(dut, "out_valid_o", "busy_o")


EVIDENCE = {
    "equivalence": {"boxes": True, "reset_size": {"Image": 0}},
    "mutants": {"sets": [0, 1]},  # in the third a pin has one taxel, so much of the block has nothing to do
    "faults": {
        "size": {"Image": 1, "Rows": 3, "Columns": 3},
        # Until a slip ends, 18 frames, stripes stay where they are, or a step behind by a lost frame.
        "settle": 20,
        "driver": {
            "frame": "in_last_i",
            "when": "in_valid_i",
            "strobe": "out_valid_o",
            "rows": 12000,
            "join": 1,
        },
    },
}

SPACE = lambda draw: parameters_of(
    (draw.randint(1, 12), draw.randint(2, 12)), (draw.randint(1, 9), draw.randint(2, 9)), draw.randint(1, 6)
)


@pytest.mark.parametrize(
    "shape, grid, bits", [*SIZES, *(pytest.param(*size, marks=pytest.mark.long) for size in LARGER)]
)
def test_render(shape, grid, bits):
    bench.run("actuate", "render", parameters_of(shape, grid, bits))


def test_refuses_illegal_parameters():
    for wrong in ({"Rows": 1025}, {"PinRows": 129}, {"AmplitudeBits": 7}):
        ((name, number),) = wrong.items()
        assert f"{name} = {number}" in bench.refuses("render", wrong)
    for wrong in ({"floor": 65536}, {"step": -1}, {"cue": 256}, {"marker": 2}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            RenderSettings(**wrong)
    with pytest.raises(ValueError, match=r"shape \(3, 2\), which must be \(2, 3\)"):
        Render((2, 3)).next(np.zeros((3, 2)))


@pytest.mark.parametrize("shape", [(16, 24), (1, 3), (5, 20), (7, 2)])
@pytest.mark.parametrize("grid", [(5, 20), (7, 5)])
def test_averages_are_those_of_the_areas(shape, grid):
    image = np.random.default_rng(bench.SEED).integers(0, 65536, shape)
    means = [[mean * image.size for mean in row] for row in averages(image.tolist(), *grid)]
    assert render.averages(image, *grid).tolist() == means
    assert set(render.averages(np.full(shape, 65535), *grid).ravel()) == {65535 * image.size}


def test_stripes_by_hand():
    """To the right they move to the next column; upwards to the row above."""
    twin = Render(None, (5, 20), 4, RenderSettings(cue=1))
    columns = [np.flatnonzero(twin.next(slip=True, octant=0)[0]).tolist() for _ in range(2)]
    assert columns == [[0, 4, 8, 12, 16], [1, 5, 9, 13, 17]]
    twin.reset()
    rows = [np.flatnonzero(twin.next(slip=True, octant=2)[:, 7]).tolist() for _ in range(2)]
    assert rows == [[0, 4], [3]]
    for octant in range(8):
        twin.reset()
        for phase in range(5):
            found = np.argwhere(twin.next(slip=True, octant=octant)).tolist()
            assert {tuple(pin) for pin in found} == stripes(octant, phase, 5, 20)
    assert len(set(OCTANTS)) == 8
