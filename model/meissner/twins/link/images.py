"""Bit-exact twins of rtl/link/msn_image_store.sv, the newest complete image for a slow reader, and
msn_image_chunks.sv, which cuts it into chunks."""

from meissner.twins.shared import within


class ImageStore:
    """``next`` is one clock. ``readable``: the image that a reader may read, (time, taxels), or None."""

    def __init__(self, taxels=4096):
        within(taxels=(taxels, 2, 65536))
        self.taxels = taxels
        self.reset()

    def reset(self):
        self._beats, self._dropping, self._time = [], False, None
        self._held = self.readable = None
        self.dropped = 0

    def next(self, beat=None, begun=False, done=False):
        """A clock; ``beat``: (taxel, last, time) or None; ``begun``, ``done``: signals of the reader."""
        if self._held is not None and not (begun or done):
            self.dropped += self.readable is not None
            self.readable, self._held = self._held, None
        elif done:
            self.readable = None
        if beat is None:
            return
        taxel, last, time = beat
        if self._dropping:
            self._dropping = not last
            return
        if not self._beats:
            self._time = time
            self.dropped += self._held is not None
            self._held = None
        self._beats.append(taxel)
        final = len(self._beats) == self.taxels
        self.dropped += bool(last) != final
        self._dropping = final and not last
        if last and final:
            self._held = (self._time, self._beats)
        if last or final:
            self._beats = []


MAX_CHUNK = 116  # taxels: a packet has 253 bytes at most


def cut(taxels, chunk=64):
    """Chunks of an image, each (index of its first taxel, whether it is the final one, its taxels).

    first = 0, chunk, 2 chunk, ..    final = first + chunk >= taxels
    """
    check_chunk(chunk)
    count = len(taxels)
    return [
        (first, first + chunk >= count, taxels[first : first + chunk]) for first in range(0, count, chunk)
    ]


def check_chunk(chunk):
    within(chunk=(chunk, 1, MAX_CHUNK))


class ImageChunks:
    """``next`` is one clock. ``waiting``: of the next chunk, before its first step, (time, image number mod
    256, index of its first taxel, whether it is the final one), or None. Within a chunk: ``taxel``, the
    present one, and ``end``, whether it is the last."""

    def __init__(self, taxels=4096, chunk=64):
        check_chunk(chunk)
        self.store, self.chunk = ImageStore(taxels), chunk
        self.reset()

    def reset(self):
        self.store.reset()
        self._place = self._left = self._number = 0
        self._begun = self._done = False

    @property
    def dropped(self):
        return self.store.dropped

    @property
    def waiting(self):
        if self.store.readable is None:
            return None
        final = self._place + self.chunk >= self.store.taxels
        return self.store.readable[0], self._number, self._place, final

    @property
    def taxel(self):
        return self.store.readable[1][self._place]

    @property
    def end(self):
        return self._left == 0 or self._place == self.store.taxels - 1

    def next(self, beat=None, take=False, step=False):
        """A clock; ``beat``: (taxel, last, time) or None; ``take``: begin the chunk; ``step``: to the next
        taxel."""
        self.store.next(beat, self._begun or take, self._done)
        self._done = step and self._place == self.store.taxels - 1
        if take:
            self._begun, self._left = True, self.chunk - 1
        if step:
            self._place, self._left = self._place + 1, self._left - 1
        if self._done:
            self._begun, self._place, self._number = False, 0, (self._number + 1) % 256
