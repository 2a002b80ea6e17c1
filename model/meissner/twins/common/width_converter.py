"""Bit-exact twin of rtl/common/msn_width_converter.sv: beats of parallel lanes to a sequence of taxels."""


def width_converter(beats, columns, lanes):
    """(data, id, last) of every taxel; ``beats``: (lane values, last of the row, last of the frame) each."""
    if lanes not in (1, 2, 4, 8):
        raise ValueError(f"lanes = {lanes} must be 1, 2, 4 or 8")
    if not 1 <= columns <= 1024:
        raise ValueError(f"columns = {columns} must lie in 1 .. 1024")
    found, channel = [], 0
    for values, row_last, last in beats:
        kept = list(values)[: (columns - 1) % lanes + 1 if row_last else lanes]
        for place, value in enumerate(kept):
            final = bool(last) and place == len(kept) - 1
            found.append((value, channel, final))
            channel = 0 if final else channel + 1
    return found
