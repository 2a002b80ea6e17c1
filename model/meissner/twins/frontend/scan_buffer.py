"""Twin of rtl/frontend/msn_scan_buffer.sv: frames from scan order to row-major order."""

from dataclasses import dataclass

from meissner.twins.shared import fits

LATENCY = 3  # clocks from in_valid_i to out_valid_o


@dataclass(frozen=True)
class ScanBuffer:
    """The parameters of msn_scan_buffer; illegal ones raise ValueError."""

    rows: int = 16
    beats: int = 16
    burst: int = 8
    width: int = 18
    depth: int | None = None  # None: a complete frame

    def __post_init__(self):
        fits(self, rows=(1, None), beats=(1, None), width=(1, None))
        if self.depth is None:
            object.__setattr__(self, "depth", self.rows * self.beats)
        if not self.sorts and (self.depth < 4 * self.burst or self.depth & self.depth - 1):
            raise ValueError(
                f"depth = {self.depth} must hold a frame, or be a power of two of 4 bursts or more"
            )

    @property
    def sorts(self):
        """Whether it can sort interleaved frames (every second row first)."""
        return self.depth >= self.rows * self.beats

    def frame(self, data, interleave=False):
        """Beats (data, id, last) sent for ``data``, the words of a frame in their order of arrival."""
        if len(data) != self.rows * self.beats:
            raise ValueError(
                f"a frame of {self.rows} rows of {self.beats} beats has {self.rows * self.beats} words, "
                f"not {len(data)}"
            )
        rows = list(range(self.rows))
        order = [*rows[::2], *rows[1::2]] if interleave and self.sorts else rows
        words = [data[order.index(row) * self.beats + beat] for row in rows for beat in range(self.beats)]
        return [(word, index, index == len(words) - 1) for index, word in enumerate(words)]

    def begun(self, data, interleave=False):
        """Beats sent of a frame of which only ``data`` arrives."""
        missing = self.rows * self.beats - len(data)
        out = self.frame([*data, *[None] * missing], interleave)
        return out[: next((n for n, (word, _, _) in enumerate(out) if word is None), len(out))]
