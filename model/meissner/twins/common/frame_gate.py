"""Twin of rtl/common/msn_frame_gate.sv: which frame is the first with new settings."""


def first_frame(beat, frame_beats):
    """Index of the first frame with settings that were pending first when ``beat`` beats had been offered.

    Beats are counted up to and with that clock; one that was offered is in, though it may not be taken yet.

    A frame that has begun keeps the old ones; between two frames the next one has the new.
    """
    if frame_beats < 1:
        raise ValueError(f"frame_beats = {frame_beats} must be 1 or more")
    return -(-beat // frame_beats)
