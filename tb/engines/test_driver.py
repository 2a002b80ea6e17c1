"""engines/driver.hpp: every word is sent, every result kept, and the clock counts are those in the blocks'
headers.

The engine checks a driver's return value where it reads it. Words are counted here; latencies are from the
headers.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from meissner.engines import Carrier, rtl_cop, rtl_cop4, rtl_frontend, rtl_slip, verilated
from meissner.twins.cop.cop4 import Cop4Registers
from meissner.twins.cop.cop_slip import CopSlipRegisters
from meissner.twins.frontend.am_demod import AmDemod
from meissner.twins.slip.config import SlipConfig

PLAIN = Cop4Registers(120_000, 70_001, 3, 80_003, 2, 90_007, 7, 65_000, 65_001, 64_000, 5000, 3)


@pytest.fixture
def returned(monkeypatch):
    """The return values of the drivers, call by call: clocks, or a negative number."""
    found, check = [], verilated.check_room
    monkeypatch.setattr(verilated, "check_room", lambda count: (found.append(count), check(count)))
    return found


def test_drivers_count_clocks_to_the_last_result(returned):
    """As in the blocks' headers, the clock that takes the last word is the first of the latency."""
    rtl_cop.cop(np.full((7, 3, 5), 9))  # 105 beats, 11 clocks
    rtl_cop.cop(np.full((5, 3, 18), 9))  # three beats of eight columns per row, 3 + 3 + 8 clocks
    assert returned == [105 + 11 - 1, 45 + 14 - 1]
    returned.clear()
    codes = np.random.default_rng(5).integers(-65_536, 65_536, (31, 4))
    config = SimpleNamespace(sample_bits=17, terms=None, registers=PLAIN)
    for count in (1, 2, 23):
        rtl_cop4.cop4(codes[:count], config)
    assert returned == [17, 17 + 10, 17 + 22 * 10]  # S = 9: 17 clocks, one result every 10
    returned.clear()
    rtl_cop4.cop_slip(codes, config, 4, CopSlipRegisters(20, 0, 1, 2, 1))
    assert returned[1:] == [31 + 5 - 1]
    returned.clear()
    samples = np.tile([300, 0, -300, 0], 20)
    for skip, shift in ((12, 3), (19, 3), (12, 8)):
        carrier = Carrier(AmDemod(), 4, skip, shift)
        rtl_frontend.demodulate(samples[: carrier.samples], carrier)
    assert returned[1] - returned[0] == 7 and returned[2] - returned[0] == 5  # 7 samples; 5 more shifts
    returned.clear()
    for frames in (1, 12):
        plain = {"offset": np.zeros((1, 3)), "gain": np.full((1, 3), 4096), "dead": np.zeros((1, 3), bool)}
        rtl_frontend.calibrate(np.full((frames, 1, 3), 77), SimpleNamespace(**plain, gain_shift=12))
    assert returned[1] - returned[0] == 11 * 3


def test_results_that_are_missing_or_too_many_are_seen(returned):
    """A carrier that is one sample short has no amplitude; 20 decisions do not fit into room for 19."""
    short = SimpleNamespace(block=AmDemod(), periods=4, skip=0, shift=3, samples=15)
    with pytest.raises(RuntimeError, match="one amplitude per carrier"):
        rtl_frontend.demodulate(np.zeros((2, 15)), short)
    assert returned == [-1]
    config, frames = SlipConfig(4, 4, 1), 40
    with rtl_slip.Core(rtl_slip._parameters(1, config), config) as core:
        samples = np.arange(frames, dtype=np.int32)
        p2p, flags = np.full(frames, 7, np.uint32), np.full(frames, 255, np.uint8)
        for room, count in ((20, 20), (19, -1)):
            p2p[:] = 12_345
            given = (core._core, samples.ctypes.data, frames, 1, 17, None, p2p.ctypes.data, flags.ctypes.data)
            assert core._lib.core_slip(*given, room) == count
            assert (p2p[:room] != 12_345).all() and (p2p[room:] == 12_345).all()


def test_motion_belongs_to_the_frames_it_is_given_for():
    """Details 0, 0, 0, 0, 500, -500, 500, -500 twice, in windows of two: only those without motion are
    flagged."""
    x = np.array([([0] * 8 + [500, 0, 0, 500] * 2) * 2])
    contact = {"contact_level": -(1 << 17), "release_level": -(1 << 17), "hold": 0, "blank": 0}
    config = SlipConfig(4, 4, 1, threshold=900, gross_threshold=262_143, **contact)
    swings = [1, 1, 1, 1, 1, 2, 1, 2]  # contact; slip at the end of a window
    still = [1] * 8
    for moving, expected in (([1, 0], still + swings), ([0, 1], swings + still)):
        found = rtl_slip.watch(x, config, np.repeat(moving, 16))
        assert found.state.tolist() == [expected] and found.blanked == 2
