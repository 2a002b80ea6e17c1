"""The display at a core, rtl/actuate/msn_display.sv: its settings, and the words of a host's frame. What it
shows are the twins of its parts, render.py and pin_display.py."""

from dataclasses import dataclass, field

import numpy as np

from meissner.twins.actuate.pin_display import DisplaySettings, DisplaySize
from meissner.twins.actuate.render import Render, RenderSettings
from meissner.twins.shared import within

LANES = 3  # levels of a word of a host


def words(levels):
    """What a host writes to the register display.levels for a frame [rows, columns], in order."""
    levels = np.asarray(levels)
    if levels.dtype.kind not in "iub":
        raise ValueError(f"levels must be whole numbers, not {levels.dtype}")
    within(**{"levels": (int(levels.min()), 0, 255), "level": (int(levels.max()), 0, 255)})
    found = []
    for row in levels.tolist():
        row = [*row, *[0] * (-len(row) % LANES)]
        found += [row[k] | row[k + 1] << 8 | row[k + 2] << 16 for k in range(0, len(row), LANES)]
    found[-1] |= 1 << 24
    return found


@dataclass(frozen=True)
class DisplayConfig:
    """A display of ``grid`` rows and columns; ``octant``: where a slip's cue moves if the sensor does not
    know it; ``health``: whether a taxel that cannot be trusted is a fault."""

    grid: tuple[int, int] = (5, 20)
    size: DisplaySize = field(default_factory=DisplaySize)
    pins: DisplaySettings = field(default_factory=DisplaySettings)
    render: RenderSettings = field(default_factory=RenderSettings)
    octant: int = 0
    health: bool = True
    host: bool = False

    def __post_init__(self):
        within(octant=(self.octant, 0, 7), rows=(self.grid[0], 1, 128), columns=(self.grid[1], 1, 128))
        if self.grid[0] * self.grid[1] != self.size.pins:
            raise ValueError(f"a grid of {self.grid[0]} x {self.grid[1]} must have {self.size.pins} pins")

    @property
    def settings(self):
        """{register of the group display: value}, with the display enabled."""
        found = {"enable": 1, "source": int(self.host), "octant": self.octant, "health": int(self.health)}
        return found | self.pins.settings | self.render.settings

    def render_of(self, shape):
        """What makes its frames of a sensor with images of that ``shape``, None: without."""
        return Render(shape, self.grid, self.size.amplitude_bits, self.render)

    @property
    def parameters(self):
        """Parameters of rtl/msn_core.sv."""
        rows, columns = self.grid
        size = {"PinChains": self.size.chains, "AmplitudeBits": self.size.amplitude_bits}
        return {"PinRows": rows, "PinColumns": columns} | size
