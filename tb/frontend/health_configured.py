"""msn_health with the registers of configurations: cells at rest, one pressed, one at a rail that is a fault.

Run by test_configured_health.py; ``registers`` is shared with its model tests.
"""

import cocotb
import numpy as np

import bench
import members
from meissner.builds import config, toolchain

CASES = toolchain.ROOT / "tb/cases"
# Configuration; what its cells read at rest, without the noise of one code; whether it may go below 0.
RESTS = {CASES / "h1_health.toml": 1000, CASES / "h2_fsr_health.toml": 0, "full": 0}


def registers(build):
    """Members of health_cfg after reset, by the names that `meissner config show` prints."""
    names = {name.removeprefix("health."): name for name in build.settings if name.startswith("health.")}
    return {short.replace(".", "_"): build.settings[name] for short, name in names.items()}


async def frames(dut, codes):
    """Send frames [frames, 3, 3]; returns the masks [frames, 3, 3]."""
    beats = bench.lane_beats(codes, 1, 17, user=(codes == 0) | (codes >= 4095))
    got = await bench.stream(dut, beats, ["mask"], drain=12)
    return np.array([beat["mask"] for beat in got]).reshape(codes.shape)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def healthy_cells_stay_and_a_railed_one_does_not(dut):
    settings = members.Settings(dut, "health_cfg")
    await bench.start(dut, event_ready_i=1)
    for name, rest in RESTS.items():
        build = config.load(name)
        settings.put(**registers(build))
        await bench.reset(dut)
        rng = np.random.default_rng(3)
        codes = rest + rng.integers(-1, 2, (220, 3, 3))
        codes = np.maximum(codes, 0) if build.input.min_code == 0 else codes
        codes[200:, 1, 1] += 1500
        masks = await frames(dut, codes)
        counts = members.of("health_status", bench.read(dut.status_o))
        assert not masks.any() and counts == {"dead": 0, "railed": 0, "blinking": 0}, name
        codes[:, 2, 0] = build.input.max_code  # shorted to the supply: seen in the last of 8 looks
        masks = await frames(dut, codes)
        counts = members.of("health_status", bench.read(dut.status_o))
        assert counts == {"dead": 0, "railed": 1, "blinking": 0}, name
        assert masks[-1].tolist() == [[0, 0, 0], [0, 0, 0], [1, 0, 0]], name
