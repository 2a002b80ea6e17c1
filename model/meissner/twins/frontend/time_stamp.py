"""Bit-exact twin of rtl/frontend/msn_time_stamp.sv: the convert start of each frame that is taken."""


def time_stamps(clocks):
    """Of every frame in ``clocks``, (convert, valid, ready, last) of each, the clock of its convert start.

    A frame's convert start is the last one before its first sample was offered.
    """
    converted, frame, found = None, None, []
    for now, (convert, valid, ready, last) in enumerate(clocks):
        if valid:
            if frame is None:
                frame = converted
                found.append(frame)
            if ready and last:
                frame = None
        if convert:
            converted = now
    return found
