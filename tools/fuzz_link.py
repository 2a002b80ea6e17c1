"""Feed the host random and mutated byte strings; print how many, how long, and what came of them.

Each string goes to the decoder of packets and, over a line of its own, to meissner.host.Core with images put
together and packets in their types.

    python tools/fuzz_link.py [STRINGS]     default 1,000,000

Stops with an error if either crashes, needs more than a second for a string, or gives a packet, an event or
an image that was not sent.
"""

import sys
import time

import numpy as np

from meissner import host
from meissner.host.line import Pipe
from meissner.link import packet as p
from meissner.link.cobs import encode
from meissner.link.decoder import Decoder


class Feed:
    """A line that says one string and then nothing."""

    data = b""

    def read(self, _):
        data, self.data = self.data, b""
        return data


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    rng = np.random.default_rng(1)
    packets = [p.packet(p.SLIP, n, n << 30, p.slip_event(n, n * n, 2)) for n in range(20)]
    taxels = rng.integers(0, 1 << 16, 200)
    for number, payload in enumerate(p.image_chunks(3, taxels.tolist()), 20):
        packets.append(p.packet(p.IMAGE, number, 5, payload))
    sent, line = set(packets), b"".join(map(encode, packets))
    feed = Feed()
    core, events, images = host.Core(Pipe(feed), registers=False, say=lambda _: None), 0, 0
    told = {(n << 30, n, n * n) for n in range(20)}
    decoder, found, longest, begin = Decoder(), 0, 0.0, time.monotonic()
    for index in range(count):
        if index % 2:
            data = bytearray(rng.bytes(int(rng.integers(0, 80))))
        else:
            length = 60 if index % 8 else len(line)  # a part, or all with a whole image
            start = int(rng.integers(0, len(line) - length + 1))
            data = bytearray(line[start : start + length])
            for _ in range(int(rng.integers(0, 4))):
                kind, at = int(rng.integers(0, 4)), int(rng.integers(0, len(data)))
                if kind == 0:
                    data[at] ^= 1 << int(rng.integers(0, 8))
                elif kind == 1:
                    data.insert(at, int(rng.integers(0, 256)))
                elif kind == 2:
                    del data[at]
                else:
                    data[at] = 0
        before = time.monotonic()
        got = decoder.next(bytes(data))
        feed.data = bytes(data)
        items = list(core.packets(0))
        longest = max(longest, time.monotonic() - before)
        for item in items:
            if isinstance(item, host.Image):
                images += 1
                good = item.taxels.ravel().tolist() == taxels.tolist()
            else:
                events += 1
                good = (item.time, item.channel, item.p2p) in told
            if not good:
                sys.exit(f"string {index}: the host tells what was not sent: {item}")
        for q in got:
            found += 1
            if p.packet(q.kind, q.number, q.time, q.payload) not in sent:
                sys.exit(f"string {index}: a packet that was not sent: {q}")
        if longest > 1:
            sys.exit(f"string {index} took {longest:.1f} s")
    took = time.monotonic() - begin
    print(
        f"{count} strings in {took:.0f} s, the slowest {1e3 * longest:.1f} ms: {found} packets, all as sent,"
    )
    print(
        f"{decoder.damaged} frames dropped; the host told of {events} events and {images} images, all as sent"
    )


if __name__ == "__main__":
    main()
