"""What benches drive into a block: numbers, frames of numbers, beats of a stream and its stall patterns."""

import os
import random

import numpy as np

from meissner.twins.common.frames import FrameMarker

SEED = int(os.environ.get("MEISSNER_SEED", "1"))
SHARE = int(os.environ.get("MEISSNER_SHARE", "1"))  # `make test` draws a third of the random rounds


def rounds(count):
    """How many of ``count`` random rounds a test draws: the first ones."""
    return -(-count // SHARE)


def pauses(rate, role):
    """A stall pattern: true with probability ``rate``; each ``role`` of a test has its own sequence.

    With equal sequences at both ends, a block would be paused at both ends in the same clocks: it would never
    wait with a beat offered, nor be ready without one. ``run`` prints the seed when a test fails.
    """
    draw = random.Random(f"{SEED} {role}")
    return lambda: draw.random() < rate


def gaps_and_stalls(gap_rate, stall_rate=None):
    """The two patterns of ``stream``, both with the same rate if only one is given."""
    stall_rate = gap_rate if stall_rate is None else stall_rate
    return pauses(gap_rate, "gaps"), pauses(stall_rate, "stalls")


def as_signed(value, bits):
    """Two's complement reading of an unsigned port value."""
    return value - (1 << bits) if value >> (bits - 1) & 1 else value


def time(clock):
    """A time for each clock: 48 bits, none of which stays constant for long."""
    return (clock * 0x9E37_79B9_7F4A_7C15 >> 8) % (1 << 48)


def frames(restart=True, **payload):
    """Interleave payload arrays [channels, n] into beats: n frames, channels in order, ``last`` on the final.

    ``restart`` marks the first frame, as msn_frame_filter does after reset.
    """
    arrays = {name: np.atleast_2d(values) for name, values in payload.items()}
    channels, length = next(iter(arrays.values())).shape
    return [
        {name: int(a[channel, frame]) for name, a in arrays.items()}
        | {"id": channel, "last": channel == channels - 1, "restart": restart and frame == 0}
        for frame in range(length)
        for channel in range(channels)
    ]


def column(beats, field, channels):
    """The values of one output field as an array [channels, frames]."""
    return np.array([beat[field] for beat in beats], dtype=np.int64).reshape(-1, channels).T


def width(bits):
    """Smallest and largest signed integer of ``bits`` bits."""
    return -(1 << (bits - 1)), (1 << (bits - 1)) - 1


def extremes_then_random(rng, channels, length, bits):
    """Integers [channels, length] that begin with full-scale steps of both signs, then are random."""
    low, high = width(bits)
    x = rng.integers(low, high + 1, (channels, length))
    corners = np.array([high, low, low, high, high, high, low, low, 0, -1, -1, 0, 1, 0])
    x[:, : len(corners)] = corners[:length]
    return x


def force_frames(rng, rows, columns):
    """Forces [frames, rows, columns]: the corner cases of an array of this size, then random frames."""
    i, j = np.indices((rows, columns))
    corner = np.full((rows, columns), 65535)
    corner[0, 0] = 1
    frames = [
        np.zeros((rows, columns)),
        np.full((rows, columns), 65535),
        np.ones((rows, columns)),
        corner,
        corner[::-1, ::-1],
        65535 * ((i + j) % 2),
        65535 * (j % 2),
        65535 * (i % 2),
        np.minimum(i, rows - 1 - i) + np.minimum(j, columns - 1 - j) + 1,  # symmetric both ways
    ]
    for row, column in {
        (0, 0),
        (0, columns - 1),
        (rows - 1, 0),
        (rows - 1, columns - 1),
        (rows // 2, columns // 3),
    }:
        for force in (1, 65535):
            single = np.zeros((rows, columns))
            single[row, column] = force
            frames.append(single)
    for _ in range(4):
        frames.append(rng.integers(0, 65536, (rows, columns)))
        frames.append(rng.integers(0, 65536, (rows, columns)) * (rng.random((rows, columns)) < 0.1))
    return np.array(frames).astype(np.int64)


def marks(place, rows, row_beats):
    """The marks of the beat at ``place`` of a complete frame (docs/frames.md)."""
    row, column = divmod(place, row_beats)
    return {
        "fits": True,
        "row_last": column == row_beats - 1,
        "last": column == row_beats - 1 and row == rows - 1,
    }


def force_beats(forces, lanes=1, surplus=0xA5A5):
    """Beats of frames [frames, rows, columns], with marks; the unused lanes of a row's last beat hold
    ``surplus``."""
    count, rows, columns = forces.shape
    row_beats = -(-columns // lanes)
    padded = np.full((count, rows, row_beats * lanes), surplus, dtype="<u2")
    padded[:, :, :columns] = forces
    words = padded.reshape(count, rows * row_beats, lanes)
    return [
        {"data": int.from_bytes(word.tobytes(), "little")} | marks(index, rows, row_beats)
        for frame in words
        for index, word in enumerate(frame)
    ]


def lane_word(values, bits):
    """Integers of ``bits`` bits side by side in one word, the first lowest."""
    return sum((int(value) & ((1 << bits) - 1)) << (bits * lane) for lane, value in enumerate(values))


def lane_values(word, lanes, bits, signed=False):
    """The integers that ``lane_word`` packed into ``word``."""
    values = [word >> (bits * lane) & ((1 << bits) - 1) for lane in range(lanes)]
    return [as_signed(value, bits) for value in values] if signed else values


def lane_beats(frames, lanes, bits, surplus=0, **flags):
    """Beats of an array's frames [frames, rows, columns]: data, id, marks, and one bit per lane of each of
    ``flags`` (arrays of the same shape); the unused lanes of a row's last beat hold ``surplus``."""
    count, rows, columns = np.shape(frames)
    row_beats = -(-columns // lanes)

    def words(array, fill):
        padded = np.full((count, rows, row_beats * lanes), fill, dtype=np.int64)
        padded[:, :, :columns] = array
        return padded.reshape(count, rows * row_beats, lanes)

    data = words(frames, surplus)
    flags = {name: words(array, 0) for name, array in flags.items()}
    return [
        {"data": lane_word(data[frame, beat], bits), "id": beat}
        | marks(beat, rows, row_beats)
        | {name: lane_word(array[frame, beat], 1) for name, array in flags.items()}
        for frame in range(count)
        for beat in range(rows * row_beats)
    ]


def damage(beats, length, draw):
    """Beats of frames of ``length`` beats, with about every third frame damaged in a random way."""
    sent = []
    for at in range(0, len(beats), length):
        part = [dict(beat) for beat in beats[at : at + length]]
        where = draw.randrange(length)
        kind = draw.choice(["whole"] * 9 + ["missing", "doubled", "id", "early", "lost", "late"])
        if kind == "missing":
            del part[where]
        elif kind == "doubled":
            part.insert(where, dict(part[where]))
        elif kind == "id":
            part[where]["id"] = (part[where]["id"] + 1) % length
        elif kind == "early":
            part = part[: where + 1]
            part[-1]["last"] = True
        elif kind == "lost":
            part[-1]["last"] = False
        elif kind == "late":
            part += [dict(part[-1])]
            part[-2]["last"] = False
        sent += part
    return sent


def placed(beats, rows, row_beats):
    """The beats that msn_frame_marker passes, with its marks; beats without an id are counted."""
    check, passed, number = FrameMarker(rows, row_beats), [], 0
    for beat in beats:
        place = check.next(beat.get("id", number), beat["last"])
        number = 0 if beat["last"] else number + 1
        if place:
            marked = place._asdict()
            passed.append(beat | {name: value for name, value in marked.items() if name in beat})
    return passed


def unnumbered(beats):
    """``beats`` without their ids, for blocks that need no places."""
    return [{name: value for name, value in beat.items() if name != "id"} for beat in beats]
