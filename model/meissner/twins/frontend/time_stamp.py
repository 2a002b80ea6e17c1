"""Bit-exact twin of rtl/frontend/msn_time_stamp.sv: the convert start of each frame that is taken."""


def time_stamps(clocks):
    """The clock of each frame's convert start; ``clocks``: (convert, valid, ready, last) of every clock.

    A frame's convert start is the last one before its first sample is offered.
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
