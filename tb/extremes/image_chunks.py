"""Extremes of rtl/link/msn_image_chunks.sv: the ends of images and chunks, numbers past 256."""

from meissner.twins.link.image_chunks import ImageChunks, cut
from verify.extremes import row


@row(
    "image_chunks",
    {"": "0"},
    ends="an image's number turns over at 256: by contract (docs/link.md)",
    rtl=["tb/link/test_image_chunks.py::test_image_chunks"],
)
def image_chunks_(see):
    for taxels in (2, 115, 116, 117, 65536 if see.long else 4096):
        for chunk in (1, 115, 116):
            parts = cut(range(taxels), chunk)
            count = -(-taxels // chunk)
            see.near(len(parts), count, (taxels, chunk))
            see.all_near([part[0] for part in parts], range(0, taxels, chunk), [(taxels, chunk)] * count)
            see.same([part[1] for part in parts], [False] * (count - 1) + [True], (taxels, chunk))
            see.same([place for part in parts for place in part[2]], list(range(taxels)), (taxels, chunk))
            see.same({len(part[2]) for part in parts[:-1]} <= {chunk}, True, (taxels, chunk))
    twin = ImageChunks(2, 2)
    for image in range(514):
        for beat in ((65535, 0, 2**48 - 1), (0, 1, 0)):
            twin.next(beat)
        twin.next()
        see.same(twin.waiting, (2**48 - 1, image % 256, 0, True), f"image {image}")
        twin.next(take=True)
        taxels = []
        for _ in range(2):
            taxels.append(twin.taxel)
            twin.next(step=True)
        twin.next()
        see.same(taxels, [65535, 0], f"image {image}")
    for taxels in (1, 65537):
        see.refused(ImageChunks, taxels)
    for chunk in (0, 117):
        see.refused(ImageChunks, 9, chunk)
        see.refused(cut, [0], chunk)
