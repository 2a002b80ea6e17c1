"""The centre of pressure from its geometry, in exact rationals: the mean place of the forces, from -1 to +1.

Columns lie evenly from -1 at the left to +1 at the right, rows from +1 at the top to -1 at the bottom. For
the complete twins, from forces (cop) and from codes (array_forces); the blocks inside have references of
their own.
"""

from fractions import Fraction
from math import floor

import numpy as np
import pytest

import bench
from meissner.twins.cop.cop import cop
from meissner.twins.sensor.array_forces import ArrayForces
from reference import exact


def place(index, count):
    """The coordinate of column ``index`` of ``count``."""
    return Fraction(0) if count == 1 else -1 + Fraction(2 * index, count - 1)


def centre(forces, fraction_bits, min_load):
    """x, y, load, pressed of one frame [row][column]."""
    rows, columns = len(forces), len(forces[0])
    load = sum(map(sum, forces))
    if load == 0 or load < min_load:
        return 0, 0, load, False
    x = sum(Fraction(f) * place(j, columns) for row in forces for j, f in enumerate(row)) / load
    y = sum(Fraction(f) * -place(i, rows) for i, row in enumerate(forces) for f in row) / load
    return exact.away(x * 2**fraction_bits), exact.away(y * 2**fraction_bits), load, True


def test_by_hand():
    """2 x 3: 1 at the top left, 3 at the bottom right: x = 1/2, y = -1/2; loads at the minimum and below."""
    forces = [[1, 0, 0], [0, 0, 3]]
    for min_load, expected in (
        (4, (8192, -8192, 4, True)),
        (5, (0, 0, 4, False)),
        (3, (8192, -8192, 4, True)),
    ):
        assert centre(forces, 14, min_load) == expected
        assert tuple(int(part[0]) for part in cop([forces], 14, min_load)) == expected
    for forces, x in (([[33, 0, 31]], -1), ([[31, 0, 33]], 1)):  # -1/32 and 1/32: ties at four fraction bits
        assert centre(forces, 4, 1)[0] == int(cop([forces], 4, 1)[0][0]) == x


@pytest.mark.parametrize("rows, columns", [(1, 1), (1, 7), (5, 1), (2, 3), (9, 4)])
@pytest.mark.parametrize("fraction_bits", [4, 14, 20])
def test_cop_is_the_centre(rows, columns, fraction_bits):
    rng = np.random.default_rng(bench.SEED)
    frames = bench.force_frames(rng, rows, columns)
    min_load = int(np.median(frames.sum(axis=(1, 2))))  # the exact load of one of the frames
    frames = np.concatenate([frames, np.where(rng.random((30, rows, columns)) < 0.3, 3, 0)])
    got = zip(*(np.asarray(part).tolist() for part in cop(frames, fraction_bits, min_load)))
    assert list(got) == [centre(frame, fraction_bits, min_load) for frame in frames.tolist()]


@pytest.mark.parametrize("rows, columns, lanes", [(1, 3, 1), (4, 3, 2), (3, 5, 1)])
def test_array_forces_are_the_centre_of_rounded_forces(rows, columns, lanes):
    rng = np.random.default_rng(bench.SEED)
    twin = ArrayForces(rows, columns, lanes, min_load=1000, gain_shift=3)
    row_beats = -(-columns // lanes)
    offset, gain = (
        rng.integers(-50, 50, (rows, row_beats * lanes)),
        rng.integers(0, 40, (rows, row_beats * lanes)),
    )
    for word, (zeros, gains) in enumerate(zip(offset.reshape(-1, lanes), gain.reshape(-1, lanes))):
        for lane in range(lanes):
            twin.calibrate.table.write(word, int(zeros[lane]), int(gains[lane]), lane)
    raw, masked = rng.integers(-200, 3000, (40, rows, columns)), rng.random((40, rows, columns)) < 0.1
    got = list(zip(*(np.asarray(part).tolist() for part in twin.cops(twin.calibrate.process(raw, masked)))))
    for frame, mask, result in zip(raw.tolist(), masked.tolist(), got):
        forces = [
            [
                0
                if mask[i][j]
                else min(
                    max(floor(Fraction((code - int(offset[i, j])) * int(gain[i, j]), 8) + Fraction(1, 2)), 0),
                    65535,
                )
                for j, code in enumerate(row)
            ]
            for i, row in enumerate(frame)
        ]
        assert result == centre(forces, 14, 1000)
