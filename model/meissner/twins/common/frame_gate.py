"""Twin of rtl/common/msn_frame_gate.sv: which frame is the first to use new settings."""


def first_frame(beat, frame_beats):
    """Index of the first frame with settings that became pending when ``beat`` beats had been offered.

    ``beat`` includes a beat offered in that clock, even if it is not taken yet.

    A frame that has begun keeps the old settings; between two frames, the next frame has the new ones.
    """
    if frame_beats < 1:
        raise ValueError(f"frame_beats = {frame_beats} must be 1 or more")
    return -(-beat // frame_beats)
