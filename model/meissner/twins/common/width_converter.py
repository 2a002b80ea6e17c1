"""Bit-exact twin of rtl/common/msn_width_converter.sv: beats of parallel lanes to a sequence of taxels."""

from meissner.twins.shared import LANES, one_of, within


def width_converter(beats, columns, lanes):
    """(data, id, last) of every taxel; ``beats``: (lane values, last of the row, last of the frame) each."""
    one_of(LANES, lanes=lanes)
    within(columns=(columns, 1, 1024))
    found, channel = [], 0
    for values, row_last, last in beats:
        kept = list(values)[: (columns - 1) % lanes + 1 if row_last else lanes]
        for place, value in enumerate(kept):
            final = bool(last) and place == len(kept) - 1
            found.append((value, channel, final))
            channel = 0 if final else channel + 1
    return found
