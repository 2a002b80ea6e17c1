"""Twin of rtl/common/msn_frame_gate.sv: which frame is the first to use new settings."""

from meissner.twins.shared import within


def first_frame(beat, frame_beats):
    """Index of the first frame with settings that became pending when ``beat`` beats had been offered.

    ``beat`` includes a beat offered in that clock, even if it is not taken yet.

    A frame that has begun keeps the old settings; between two frames, the next frame has the new ones.
    """
    within(frame_beats=(frame_beats, 1, None))
    return -(-beat // frame_beats)
