"""Bit-exact twin of rtl/cop/msn_electrodes.sv: complete frames of four samples; counts damaged ones."""

from meissner.twins.shared import within


def electrodes(beats, sample_bits=17):
    """([(e1, e2, e3, e4)] of complete frames, number of damaged ones) of ``beats``: (data, id, last)."""
    within(sample_bits=(sample_bits, 2, None))
    found, frame, lost = [], [], 0
    for data, channel, last in beats:
        frame.append((channel, data))
        if last:
            whole = [channel for channel, _ in frame] == [0, 1, 2, 3]
            found += [tuple(data for _, data in frame)] if whole else []
            lost += not whole
            frame = []
    whole_so_far = [channel for channel, _ in frame] == list(range(len(frame))) and len(frame) < 4
    return found, lost + (not whole_so_far)
