"""The helpers that test files share, under one name: some 1,700 uses in 108 files begin with `bench.`, which
shows that the name is not the test file's own. Build and run: runner.py. Drive and watch: streams.py. Numbers
and beats: stimulus.py."""
# ruff: noqa: F401

from cocotb.clock import Clock
from cocotb.triggers import ReadOnly, RisingEdge, Timer

from harness.applicable import applies, is_top, whole
from harness.runner import COVERAGE_FLAGS, ONES, passed, refuses, run
from harness.stimulus import (
    SEED,
    as_signed,
    column,
    damage,
    extremes_then_random,
    force_beats,
    force_frames,
    frames,
    gaps_and_stalls,
    lane_beats,
    lane_values,
    lane_word,
    marks,
    pauses,
    placed,
    rounds,
    time,
    unnumbered,
    width,
)
from harness.streams import (
    carries,
    clocks,
    counts_on,
    force_frame,
    high,
    inputs_in_reset,
    offer,
    putter,
    read,
    reset,
    start,
    starts_known,
    stream,
    taken,
    turn_over,
    unbroken,
)
