"""Bit-exact twin of rtl/link/msn_image_store.sv: the newest complete image for a slow reader."""

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
        if self._held is not None and not (self.readable and (begun or done)):
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
