"""msn_image_chunks against its model, clock by clock: images faster and slower than their chunks are read,
chunks that divide an image evenly, do not, or hold all of it; damaged images; resets within and between
chunks. By hand: an image is kept from its first chunk to its final taxel, when the next one follows, and
numbers past 256. The model against a plain loop over single taxels, and literals."""

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.link.images import ImageChunks, cut


def sizes(dut):
    return dut.Taxels.value.to_unsigned(), dut.Chunk.value.to_unsigned()


async def begin(dut):
    await bench.start(dut, **dict.fromkeys(("in_data_i", "in_last_i", "in_time_i", "take_i", "step_i"), 0))
    return ImageChunks(*sizes(dut))


def offer(dut, beat):
    dut.in_valid_i.value = int(beat is not None)
    for name, value in zip(("data", "last", "time"), beat or ()):
        getattr(dut, f"in_{name}_i").value = value


def waiting(dut):
    """(time, number, first, final) of the chunk that waits, or None."""
    if dut.chunk_valid_o.value == 0:
        return None
    return tuple(bench.read(getattr(dut, f"chunk_{name}_o")) for name in ("time", "number", "first", "final"))


def image_of(rng, taxels):
    """Beats of an image: (taxel, last, time). Its time is that of the first one."""
    return [
        (int(rng.integers(0, 1 << 16)), int(place == taxels - 1), int(rng.integers(0, 1 << 48)))
        for place in range(taxels)
    ]


class Reader:
    """Takes chunks and goes through their taxels; compares every clock with the model. ``slow``: the share of
    clocks in which it waits."""

    def __init__(self, dut, twin, rng, slow):
        self.dut, self.twin, self.rng, self.slow = dut, twin, rng, slow
        self.at, self.due, self.inside = 0, 2, False  # due: the clock from which it may take or step
        self.counted = twin.dropped  # dropped_o is a clock late
        self.chunks = []  # (time, number, first, final, taxels)

    async def clock(self, beat=None):
        dut, twin = self.dut, self.twin
        free = self.at >= self.due
        goes = free and self.rng.random() >= self.slow
        take, step = goes and not self.inside and twin.waiting is not None, goes and self.inside
        offer(dut, beat)
        dut.take_i.value, dut.step_i.value = int(take), int(step)
        await bench.ReadOnly()
        assert waiting(dut) == twin.waiting
        assert bench.read(dut.dropped_o) == self.counted
        self.counted = twin.dropped
        if self.inside:
            assert bench.read(dut.end_o) == twin.end
            assert not free or bench.read(dut.taxel_o) == twin.taxel
        if take:
            self.chunks.append((*waiting(dut), []))
            self.inside, self.due = True, self.at + 2
        if step:
            self.chunks[-1][-1].append(bench.read(dut.taxel_o))
            self.inside, self.due = not twin.end, self.at + (2 if twin.end else 3)
        self.at += 1
        twin.next(beat, take, step)
        await bench.RisingEdge(dut.clk_i)

    async def follow(self, beats, gap):
        """Offer all beats, then read until nothing is left."""
        for beat in beats:
            while self.rng.random() < gap:
                await self.clock()
            await self.clock(beat)
        quiet = 0
        while quiet < 6:
            await self.clock()
            quiet = quiet + 1 if self.twin.waiting is None else 0

    def images(self):
        """(time, taxels) of each image, its chunks checked against the plain loop."""
        taxels, chunk = sizes(self.dut)
        parts = -(-taxels // chunk)
        assert len(self.chunks) % parts == 0
        found = []
        for number in range(len(self.chunks) // parts):
            of = self.chunks[parts * number : parts * (number + 1)]
            values = [taxel for part in of for taxel in part[4]]
            assert [part[2:] for part in of] == taxel_by_taxel(values, chunk)
            assert {part[:2] for part in of} == {(of[0][0], number % 256)} and len(values) == taxels
            found.append((of[0][0], values))
        return found


@bench.starts_known
@cocotb.test(timeout_time=1, timeout_unit="ms", stage=-1)
async def counts_over_the_whole_width(dut):
    names = ("in_data_i", "in_time_i", "take_i", "step_i")
    await bench.turn_over(dut, "dropped_o", most=3, **dict.fromkeys(names, 0))


@cocotb.test(timeout_time=50, timeout_unit="ms")
@cocotb.parametrize(gap=[0.0, 0.5, 0.97], slow=[0.0, 0.3, 0.9])
async def matches_model(dut, gap, slow):
    rng = np.random.default_rng(bench.SEED)
    twin = await begin(dut)
    taxels, _ = sizes(dut)
    count = bench.rounds(24 if taxels < 20 else 6)
    reader = Reader(dut, twin, rng, slow)
    sent = [image_of(rng, taxels) for _ in range(count)]
    await reader.follow([beat for image in sent for beat in image], gap)
    whole = [(image[0][2], [beat[0] for beat in image]) for image in sent]
    images = reader.images()
    rest = iter(whole)
    assert all(image in rest for image in images) and images[-1] == whole[-1]
    assert len(images) + bench.read(dut.dropped_o) == count
    if gap > 0.9 and slow < 0.5:
        assert images == whole  # the reader keeps up
    for length in (1, taxels - 1, taxels + 1, taxels, 2 * taxels, taxels, taxels, 2, taxels, taxels):
        await reader.follow(image_of(rng, max(1, length)), gap)
    assert len(reader.images()) > len(images)


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def recovers_after_reset(dut):
    """While images arrive, in each clock of the first chunks and between them: then the next image has
    number 0 and begins with taxel 0. As nothing is being read, a newer one replaces it."""
    rng = np.random.default_rng(bench.SEED)
    twin = await begin(dut)
    taxels, _ = sizes(dut)
    for clocks in (*range(24), 3 * taxels, 5 * taxels):
        reader = Reader(dut, twin, rng, 0.0)
        for beat in [beat for _ in range(30) for beat in image_of(rng, taxels)][: taxels + clocks]:
            await reader.clock(beat)
        offer(dut, None)
        dut.take_i.value = dut.step_i.value = 0
        await bench.reset(dut)
        twin.reset()
        await newest_of_two(dut, 0)
        await bench.reset(dut)


async def write(dut, image, taxels):
    """Image ``image``, a taxel a clock: taxels 200 image + place, time 10^12 + image."""
    for place in range(taxels):
        offer(dut, (200 * image + place, int(place == taxels - 1), 10**12 + image - 7 * place))
        await bench.RisingEdge(dut.clk_i)
    offer(dut, None)


async def read_chunk(dut):
    """(time, number, first, final, taxels) of the chunk that is taken in this clock, as fast as the header
    allows. Ends in the first clock in which the next one may be taken."""
    dut.take_i.value = 1
    await bench.ReadOnly()
    head, taxels, end = waiting(dut), [], False
    await bench.RisingEdge(dut.clk_i)
    dut.take_i.value = 0
    await bench.clocks(dut, 1)
    while not end:
        dut.step_i.value = 1
        await bench.ReadOnly()
        taxels.append(bench.read(dut.taxel_o))
        end = dut.end_o.value == 1
        await bench.RisingEdge(dut.clk_i)
        dut.step_i.value = 0
        await bench.ReadOnly()
        assert dut.chunk_valid_o.value == 1
        await bench.clocks(dut, 1 if end else 2)
    return *head, taxels


async def read_image(dut, image, number):
    """Read all chunks of an image of ``write`` and compare them with those of the plain loop."""
    taxels, chunk = sizes(dut)
    for part in taxel_by_taxel([200 * image + place for place in range(taxels)], chunk):
        assert await read_chunk(dut) == (10**12 + image, number, *part)


async def newest_of_two(dut, number):
    """While nothing is being read, two images: the second replaces the first and is read."""
    taxels, _ = sizes(dut)
    await write(dut, 1, taxels)
    before = bench.read(dut.dropped_o)
    await write(dut, 2, taxels)
    await bench.clocks(dut, 4)
    assert bench.read(dut.dropped_o) == before + 1
    await read_image(dut, 2, number)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def an_image_is_kept_from_its_first_chunk_to_its_final_taxel(dut):
    """Image 2 replaces 1, which waits. Images 3 and 4 arrive from the clock on in which the first chunk of 2
    is taken; 3 is dropped, and 4 is next."""
    taxels, _ = sizes(dut)

    async def two():
        await write(dut, 3, taxels)
        await write(dut, 4, taxels)

    await begin(dut)
    await write(dut, 1, taxels)
    await write(dut, 2, taxels)
    await bench.clocks(dut, 4)
    assert bench.read(dut.dropped_o) == 1
    writer = cocotb.start_soon(two())
    await read_image(dut, 2, 0)
    await writer
    await bench.clocks(dut, 4)
    assert bench.read(dut.dropped_o) == 2
    await read_image(dut, 4, 1)
    await newest_of_two(dut, 2)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def an_image_that_waits_follows_the_one_that_ends(dut):
    """Two clocks after an image's final step_i chunk_valid_o is 0, three clocks after it 1, for the image
    that waited."""
    taxels, _ = sizes(dut)
    await begin(dut)
    await write(dut, 1, taxels)
    await bench.clocks(dut, 3)
    writer = cocotb.start_soon(write(dut, 2, taxels))
    await read_image(dut, 1, 0)
    await writer
    for level in (0, 1):
        await bench.ReadOnly()
        assert dut.chunk_valid_o.value == level
        await bench.RisingEdge(dut.clk_i)
    await read_image(dut, 2, 1)
    assert bench.read(dut.dropped_o) == 0


@bench.applies(lambda dut: sizes(dut)[0] <= 8)
@cocotb.test(timeout_time=5, timeout_unit="ms")
async def images_are_numbered_modulo_256(dut):
    taxels, _ = sizes(dut)
    await begin(dut)
    for image in range(258):
        await write(dut, image, taxels)
        await bench.clocks(dut, 3)
        await read_image(dut, image, image % 256)


EVIDENCE = {
    "equivalence": {"size": {"Taxels": 9}, "boxes": True},
    "faults": {"inside": ["packet", "u_chunks."]},
    # Not the sizes with an image shorter than a chunk: there the count of a chunk's taxels decides nothing.
    "mutants": {"sets": [2, 4]},
}

SPACE = lambda draw: {"Taxels": draw.randint(2, 80), "Chunk": draw.randint(1, 116)}


@pytest.mark.parametrize("taxels, chunk", [(2, 1), (8, 3), (9, 3), (36, 64), (64, 8), (128, 116)])
def test_image_chunks(taxels, chunk):
    bench.run("link", "image_chunks", {"Taxels": taxels, "Chunk": chunk})


def taxel_by_taxel(taxels, chunk):
    """(first, final, taxels) of an image's chunks."""
    found = []
    for place, taxel in enumerate(taxels):
        if place % chunk == 0:
            found.append((place, len(taxels) - place <= chunk, []))
        found[-1][2].append(taxel)
    return found


BY_HAND = [
    (2, [(0, False, [10, 11]), (2, True, [12])]),
    (3, [(0, True, [10, 11, 12])]),
    (4, [(0, True, [10, 11, 12])]),
    (1, [(0, False, [10]), (1, False, [11]), (2, True, [12])]),
]


def read_model(twin):
    """[time, number, first, final, taxels] of every chunk of the image that waits."""
    found = []
    while twin.waiting is not None:
        found.append([*twin.waiting, []])
        twin.next(take=True)
        end = False
        while not end:
            found[-1][4].append(twin.taxel)
            end = twin.end
            twin.next(step=True)
        twin.next()
    return found


@pytest.mark.parametrize(
    "taxels, chunk", [(2, 1), (9, 3), (10, 3), (64, 8), (64, 64), (115, 116), (117, 116)]
)
def test_model_against_a_plain_loop(taxels, chunk):
    """In both forms: of an image as a whole, and clock by clock, for image after image."""
    for size, expected in BY_HAND:
        assert cut([10, 11, 12], size) == taxel_by_taxel([10, 11, 12], size) == expected
    twin = ImageChunks(taxels, chunk)
    for number in range(258):
        values = [(number * 251 + 9973 * place) % 65536 for place in range(taxels)]
        for place, value in enumerate(values):
            twin.next((value, place == taxels - 1, 10**12 + number - 7 * place))
        twin.next()
        expected = taxel_by_taxel(values, chunk)
        assert cut(values, chunk) == expected
        assert read_model(twin) == [[10**12 + number, number % 256, *part] for part in expected]
    assert twin.dropped == 0


def test_refuses_illegal_parameters():
    for taxels in (1, 65537):
        assert f"Taxels = {taxels}" in bench.refuses("image_chunks", {"Taxels": taxels})
        with pytest.raises(ValueError, match=f"taxels = {taxels}"):
            ImageChunks(taxels)
    for chunk in (0, 117):
        assert f"Chunk = {chunk}" in bench.refuses("image_chunks", {"Chunk": chunk})
        for refused in (lambda chunk: ImageChunks(9, chunk), lambda chunk: cut([1, 2], chunk)):
            with pytest.raises(ValueError, match=f"chunk = {chunk}"):
                refused(chunk)
