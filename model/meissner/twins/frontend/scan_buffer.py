"""Twin of rtl/frontend/msn_scan_buffer.sv: frames in scan order to frames row-major, whole or not at all."""

from dataclasses import dataclass

LATENCY = 3  # clocks from in_valid_i to out_valid_o


@dataclass(frozen=True)
class ScanBuffer:
    """The parameters of msn_scan_buffer; illegal ones raise ValueError."""

    rows: int = 16
    beats: int = 16
    burst: int = 8
    width: int = 18
    depth: int | None = None  # None: a whole frame

    def __post_init__(self):
        if self.rows < 1 or self.beats < 1:
            raise ValueError(f"rows = {self.rows} and beats = {self.beats} must be at least 1")
        if self.width < 1:
            raise ValueError(f"width = {self.width} must be at least 1")
        if self.depth is None:
            object.__setattr__(self, "depth", self.rows * self.beats)
        if not self.sorts and (self.depth < 4 * self.burst or self.depth & self.depth - 1):
            raise ValueError(
                f"depth = {self.depth} must hold a frame, or be a power of two of 4 bursts or more"
            )

    @property
    def sorts(self):
        """A frame may come with every second row first."""
        return self.depth >= self.rows * self.beats

    def row_order(self, rows, interleave):
        """The rows of a frame in the order in which they come in."""
        order = range(rows)
        return [*order[::2], *order[1::2]] if interleave and self.sorts else list(order)

    def frame(self, data, rows, beats, first_id, skip, interleave=False):
        """Beats (data, id, last) that leave for the ``rows * beats`` words of ``data`` as they came in."""
        if len(data) != rows * beats:
            raise ValueError(f"a frame of {rows} rows of {beats} beats has not {len(data)} words")
        order = self.row_order(rows, interleave)
        out = []
        for row in range(rows):
            begin = order.index(row) * beats
            for beat, word in enumerate(data[begin : begin + beats]):
                index = first_id + row * (beats - 1 + skip) + beat
                out.append((word, index, (row, beat) == (rows - 1, beats - 1)))
        return out

    def begun(self, data, rows, beats, first_id, skip, interleave=False):
        """Beats that leave of a frame of which ``data`` comes and no more."""
        missing = rows * beats - len(data)
        out = self.frame([*data, *[None] * missing], rows, beats, first_id, skip, interleave)
        return out[: next((n for n, (word, _, _) in enumerate(out) if word is None), len(out))]
