"""msn_image_store against its model, clock by clock: images with and without gaps, a reader slower and faster
than the images, a reader that pauses, `last` early, late or missing; an image being read never changes;
resets."""

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.link.images import ImageStore


def beats_of(rng, taxels, images, damage):
    """Beats of consecutive images, some of a wrong length."""
    for _ in range(images):
        length = taxels
        if rng.random() < damage:
            length = int(rng.integers(1, 2 * taxels + 2))
        for place in range(length):
            yield int(rng.integers(0, 1 << 16)), int(place == length - 1), int(rng.integers(0, 1 << 48))


async def follow(dut, twin, rng, beats, gap_rate, rest):
    """Drive writer and reader and compare each clock; return the images that were read to their end."""
    beats, images = list(beats), []
    # Reader: taxels seen, the last two addresses, the next address. dropped_o is a clock late.
    seen, old, place, resting, quiet, counted = [], [], None, 0, 0, twin.dropped
    for _ in range(40 * len(beats) + 1000):
        quiet = quiet + 1 if not beats and twin.readable is None else 0
        if quiet > 3:
            break
        beat = beats.pop(0) if beats and rng.random() >= gap_rate else None
        dut.in_valid_i.value = int(beat is not None)
        drive = beat or (0xFFFF, 1, 0)
        for name, value in zip(("data", "last", "time"), drive):
            getattr(dut, f"in_{name}_i").value = value
        resting += 1
        if place is None and twin.readable is not None and resting > rest:
            place, seen, old = 0, [], []
        begun = place is not None
        done = begun and len(seen) == twin.taxels
        dut.read_begun_i.value, dut.read_done_i.value = int(begun and not done), int(done)
        dut.read_address_i.value = min(place or 0, twin.taxels - 1)
        await bench.ReadOnly()
        assert (dut.read_valid_o.value == 1) == (twin.readable is not None)
        assert bench.read(dut.dropped_o) == counted
        counted = twin.dropped
        if twin.readable is not None:
            assert bench.read(dut.read_time_o) == twin.readable[0]
        if begun and not done:
            if len(old) == 2:
                assert bench.read(dut.read_data_o) == twin.readable[1][old[0]]
                seen.append(old[0])
            old = [*old[-1:], min(place, twin.taxels - 1)]
            place += 1
        if done:
            images.append(twin.readable)
            place, resting = None, 0
        twin.next(beat, begun and not done, done)
        await bench.RisingEdge(dut.clk_i)
    dut.in_valid_i.value = dut.read_begun_i.value = dut.read_done_i.value = 0
    return images


async def begin(dut):
    names = ("in_data_i", "in_last_i", "in_time_i", "read_begun_i", "read_done_i", "read_address_i")
    await bench.start(dut, **dict.fromkeys(names, 0))
    return ImageStore(dut.Taxels.value.to_unsigned())


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    names = ("in_data_i", "in_time_i", "read_begun_i", "read_done_i", "read_address_i")
    await bench.turn_over(dut, "dropped_o", most=3, **dict.fromkeys(names, 0))


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(gap_rate=[0.0, 0.5, 0.95], rest=[0, 50, 400])
async def matches_model(dut, gap_rate, rest):
    rng = np.random.default_rng(bench.SEED)
    twin = await begin(dut)
    count = 24 if twin.taxels < 60 else 8
    images = await follow(dut, twin, rng, beats_of(rng, twin.taxels, count, 0), gap_rate, rest)
    assert len(images) + twin.dropped == count
    assert len(images) >= (1 if rest else 2)
    if gap_rate > 0.9 and rest == 0:
        assert twin.dropped == 0  # the reader keeps up
    before = len(images) + twin.dropped
    images = await follow(dut, twin, rng, beats_of(rng, twin.taxels, count, 0.5), gap_rate, rest)
    assert len(images) + twin.dropped <= before + count  # a lost end also loses the next image


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def recovers_after_reset(dut):
    rng = np.random.default_rng(bench.SEED)
    twin = await begin(dut)
    for cut in (1, twin.taxels, twin.taxels + 1, 2 * twin.taxels, 3 * twin.taxels - 1):
        for taxel, last, time in list(beats_of(rng, twin.taxels, 3, 0))[:cut]:
            dut.in_valid_i.value, dut.in_data_i.value = 1, taxel
            dut.in_last_i.value, dut.in_time_i.value = last, time
            await bench.clocks(dut, 1)
        dut.in_valid_i.value = 0
        await bench.reset(dut)
        twin.reset()
        images = await follow(dut, twin, rng, beats_of(rng, twin.taxels, 3, 0), 0.5, 0)
        assert images and images[-1] is not None


async def write(dut, image, taxels, clocks=None):
    """Write image number ``image``, one taxel a clock: taxels 1000 image + place, time 10^12 + image."""
    for place in range(taxels):
        dut.in_valid_i.value, dut.in_last_i.value = 1, int(place == taxels - 1)
        dut.in_data_i.value, dut.in_time_i.value = 1000 * image + place, 10**12 + image - 7 * place
        await bench.clocks(dut, 1)
    dut.in_valid_i.value = 0


async def read_image(dut, taxels):
    """The number of the image read from this clock on; all its taxels and its time must be of that image."""
    dut.read_begun_i.value = 1
    got = []
    for clock in range(taxels + 2):
        dut.read_address_i.value = min(clock, taxels - 1)
        await bench.ReadOnly()
        assert dut.read_valid_o.value == 1
        time = bench.read(dut.read_time_o)
        if clock >= 2:
            got.append(bench.read(dut.read_data_o))
        if clock < taxels + 1:
            await bench.RisingEdge(dut.clk_i)
    image = got[0] // 1000
    assert got == [1000 * image + place for place in range(taxels)] and time == 10**12 + image
    await bench.RisingEdge(dut.clk_i)
    dut.read_begun_i.value, dut.read_done_i.value = 0, 1
    await bench.RisingEdge(dut.clk_i)
    dut.read_done_i.value = 0
    return image


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def an_images_end_meets_the_readers_begin_and_end(dut):
    """The second image ends ``before`` clocks before the reader begins, in that clock (0), or while it reads.
    If it ended at least two clocks before, it is read first; otherwise it is read next."""
    taxels = dut.Taxels.value.to_unsigned()
    for before, expected, lost in ((3, 2, 1), (2, 2, 1), (1, 1, 0), (0, 1, 0), (-1, 1, 0)):
        await begin(dut) if before == 3 else await bench.reset(dut)
        await write(dut, 1, taxels)
        await bench.clocks(dut, 4)
        writer = cocotb.start_soon(write(dut, 2, taxels))
        await bench.clocks(dut, taxels - 1 + before)
        assert await read_image(dut, taxels) == expected, before
        await writer
        await bench.clocks(dut, 3)
        assert bench.read(dut.dropped_o) == lost, before
        assert bench.read(dut.read_valid_o) == 1 - lost
        if not lost:
            assert await read_image(dut, taxels) == 2, before
            await bench.clocks(dut, 3)
            assert bench.read(dut.read_valid_o) == 0 and bench.read(dut.dropped_o) == 0


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def an_image_begins_as_the_reader_ends(dut):
    """A complete image waits for the reader to finish. If the next image's first taxel comes in the clock of
    that end or before, it drops the waiting image; a clock later both are read."""
    taxels = dut.Taxels.value.to_unsigned()
    for after, images in ((-1, [1, 3]), (0, [1, 3]), (1, [1, 2, 3]), (2, [1, 2, 3])):
        await begin(dut) if after == -1 else await bench.reset(dut)
        await write(dut, 1, taxels)
        await bench.clocks(dut, 4)
        dut.read_begun_i.value = 1
        await write(dut, 2, taxels)
        await bench.clocks(dut, 2)
        reader = cocotb.start_soon(read_image(dut, taxels))  # it ends taxels + 2 clocks later
        await bench.clocks(dut, taxels + 2 + after)
        writer = cocotb.start_soon(write(dut, 3, taxels))
        got = [await reader]
        if images == [1, 2, 3]:
            await bench.clocks(dut, 1)
            got.append(await read_image(dut, taxels))
        await writer
        await bench.clocks(dut, 3)
        got.append(await read_image(dut, taxels))
        assert got == images, after
        assert bench.read(dut.dropped_o) == 3 - len(images)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def two_images_are_dropped_in_a_clock(dut):
    """An image of one taxel, itself dropped, drops the one that waits, or comes as the one before drops one
    that was not read."""
    taxels = dut.Taxels.value.to_unsigned()
    for begun, left in ((1, 1), (0, 2)):
        await begin(dut) if begun else await bench.reset(dut)
        await write(dut, 1, taxels)
        await bench.clocks(dut, 4)
        dut.read_begun_i.value = begun
        await write(dut, 2, taxels)
        await bench.clocks(dut, 2 * begun)
        await write(dut, 3, 1)
        await bench.clocks(dut, 3)
        assert bench.read(dut.dropped_o) == 2
        assert await read_image(dut, taxels) == left


EVIDENCE = {
    "equivalence": {"size": {"Taxels": 9}},
    "faults": {
        "size": {"Taxels": 9},
        # One image being written, one waiting, one being read.
        "settle": 4,
        "driver": {
            "frame": "in_last_i",
            "when": "in_valid_i",
            "strobe": "read_valid_o",
            # Images not yet read, and their times.
            "kept": "memory read_time_o written_time",
        },
    },
}

SPACE = lambda draw: {"Taxels": draw.randint(2, 80)}


@pytest.mark.parametrize("taxels", [2, 9, 64])
def test_image_store(taxels):
    bench.run("link", "image_store", {"Taxels": taxels})


def test_refuses_illegal_parameters():
    for taxels in (1, 65537):
        assert f"Taxels = {taxels}" in bench.refuses("image_store", {"Taxels": taxels})
        with pytest.raises(ValueError, match=f"taxels = {taxels}"):
            ImageStore(taxels)
