"""Twin of rtl/frontend/msn_scan_walk.sv: the places of a frame in their order."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Region:
    """First and last row and column, all included; cut to the array as the block does."""

    first_row: int = 0
    last_row: int = 1023
    first_column: int = 0
    last_column: int = 1023

    def cut(self, rows, columns):
        last_row, last_column = min(self.last_row, rows - 1), min(self.last_column, columns - 1)
        return Region(
            min(self.first_row, last_row), last_row, min(self.first_column, last_column), last_column
        )

    def beats(self, rows, columns, lanes):
        """First and last beat of each row."""
        region = self.cut(rows, columns)
        return region.first_column // lanes, region.last_column // lanes


WHOLE = Region()


def places(rows, columns, lanes, channels, region=WHOLE, interleave=False):
    """(row, group) of a frame's conversions, in their order."""
    first, last = (beat // channels for beat in region.beats(rows, columns, lanes))
    region = region.cut(rows, columns)
    found = range(region.first_row, region.last_row + 1)
    found = [*found[::2], *found[1::2]] if interleave else found
    return [(row, group) for row in found for group in range(first, last + 1)]
