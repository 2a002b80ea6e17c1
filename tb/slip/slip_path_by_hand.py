"""msn_slip_path and msn_slip_serial against the plain loop of tb/reference/slip.py, sample by sample.

Codes vary by a few steps, so that every limit is met exactly. Run by test_slip_path.py and
test_slip_serial.py.
"""

from types import SimpleNamespace

import cocotb
import numpy as np

import bench
import members
from reference.slip import NUMBERS, SlipPathReference

FIELDS = ["state", "raised", "over", "p2p", "end"]
SETTINGS = {"threshold": 5, "gross_threshold": 8, "hold": 2, "refractory": 5, "blank": 3}
SETTINGS |= {"keep_threshold": 2}


@cocotb.test(timeout_time=40, timeout_unit="ms")
@cocotb.parametrize(rises=[True, False])
async def decides_as_the_loop(dut, rises):
    value = lambda name: getattr(dut, name).value.to_unsigned() if hasattr(dut, name) else None
    channels, level, window = value("Channels") or 1, value("Level"), value("Window")
    group, sign = 1 << level, 1 if rises else -1
    settings = SETTINGS | {"contact_level": sign * 6 * group, "release_level": sign * 5 * group}
    settings["contact_rises"] = rises
    given = {port._name: 0 for port in dut if port._name.startswith("cfg_")}
    await bench.start(dut, **given, actuator_moving_i=0)
    numbers = {name: int(number) for name, number in settings.items()}
    if hasattr(dut, "cfg_i"):
        dut.cfg_i.value = members.word("slip_cfg", numbers)
    else:
        for name, number in numbers.items():
            port = getattr(dut, f"cfg_{name}_i")
            port.value = number & ((1 << len(port)) - 1)
    rng, samples = np.random.default_rng(bench.SEED), 40 * window
    pressed = np.repeat(rng.random((channels, samples // 40)) < 0.7, 40, axis=1)
    tremor = np.repeat(rng.choice([0, 1, 3], (channels, samples // 10)), 10, axis=1)
    x = sign * (pressed * 6 + rng.integers(-tremor, tremor + 1))
    masked = (rng.random(x.shape) < 0.01) & bool(value("Mask"))
    build = SimpleNamespace(level=level, window=window, hop=value("Hop") or window, **settings)
    loops = [SlipPathReference(build) for _ in range(channels)]
    beats, expected = [], []
    for n in range(samples):
        for channel, loop in enumerate(loops):
            beat = {"data": x[channel, n], "id": channel, "last": channel == channels - 1}
            beats.append(beat | ({"mask": masked[channel, n]} if hasattr(dut, "in_mask_i") else {}))
            row = loop.sample(int(x[channel, n]), False, bool(masked[channel, n]))
            if row:
                expected.append(dict(zip(FIELDS, (NUMBERS[row[0]], *map(int, row[1:])))))
    assert {row["state"] for row in expected} == set(range(5))
    got = await bench.stream(dut, beats, FIELDS, drain=80, hold=True)
    for number, (is_, should) in enumerate(zip(got, expected)):
        assert is_ == should, f"detail {number // channels} of channel {number % channels}"
    assert len(got) == len(expected)
    assert bench.read(dut.blanked_o) == sum(loop.slip.blanked for loop in loops) > 0
