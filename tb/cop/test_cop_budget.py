"""The millisecond of a frame on msn_cop for several array sizes: scan (first beat to last, with the lanes and
clock given for the size) and computation (last beat to x, y, load) are measured separately, in clocks of the
RTL, with a source and a sink that never stall. Computation may take 12 clocks. Both are printed."""

import math
import os

import cocotb
import numpy as np
import pytest

import bench
from meissner.twins.cop.cop import cop, latency

BUDGET_S = 1e-3
COMPUTE_CLOCKS = 12
FIELDS = ["x~", "y~", "load", "pressed"]

# Side: lanes, MHz, bits a clock, and the microseconds for scan and computation (README). 12 MHz is the
# iCEBreaker's crystal; 100 MHz is well below what msn_cop reaches on the ECP5; the largest array runs at what
# docs/cop.md measured there (143.4 MHz).
SIZES = {
    **{3: (1, 12, 2, 2), 8: (1, 12, 2, 7), 16: (1, 12, 2, 23), 32: (1, 12, 2, 87), 64: (1, 12, 2, 343)},
    **{256: (1, 100, 2, 656), 1024: (8, 143, 1, 917)},
}


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def frame_fits_in_a_millisecond(dut):
    rows, columns, lanes, bits = (
        getattr(dut, name).value.to_unsigned() for name in ("Rows", "Columns", "Lanes", "BitsPerClock")
    )
    clock_hz = float(os.environ["MEISSNER_CLOCK_HZ"])
    frame = np.random.default_rng(bench.SEED).integers(0, 65536, (rows, columns))
    beats = bench.force_beats(frame[None], lanes)
    await bench.start(dut, cfg_min_load_i=1, out_ready_i=1)
    dut.in_valid_i.value = 1
    scan = sent = 0
    while sent < len(beats):
        bench.offer(dut, beats[sent])
        await bench.ReadOnly()
        sent += int(dut.in_ready_o.value)
        scan += 1
        await bench.RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    compute = 1
    await bench.ReadOnly()
    while dut.out_valid_o.value != 1:
        await bench.RisingEdge(dut.clk_i)
        await bench.ReadOnly()
        compute += 1
    ports = [getattr(dut, f"out_{field.rstrip('~')}_o") for field in FIELDS]
    values = [
        bench.as_signed(bench.read(p), len(p)) if f[-1] == "~" else bench.read(p)
        for p, f in zip(ports, FIELDS)
    ]
    assert values == [int(value[0]) for value in cop(frame[None])]

    scan_s, compute_s = scan / clock_hz, compute / clock_hz
    print(
        f"{rows}x{columns}, {lanes} lane{'s' * (lanes > 1)} at {clock_hz / 1e6:g} MHz = "
        f"{lanes * clock_hz / 1e6:g} Msamples/s: scan {scan} clocks, {scan_s * 1e6:.2f} us; "
        f"compute {compute} clocks, {compute_s * 1e6:.3f} us; together {(scan_s + compute_s) * 1e6:.1f} us"
    )
    assert scan == rows * -(-columns // lanes)
    assert compute == latency(lanes, 14, bits)
    assert lanes > 1 or compute <= COMPUTE_CLOCKS
    assert scan_s + compute_s < BUDGET_S
    assert math.ceil((scan_s + compute_s) * 1e6) == SIZES[rows][3]


@pytest.mark.parametrize("side", SIZES)
def test_frame(side, monkeypatch):
    lanes, mhz, bits, _ = SIZES[side]
    monkeypatch.setenv("MEISSNER_CLOCK_HZ", str(mhz * 1e6))
    size = {"Rows": side, "Columns": side, "Lanes": lanes, "BitsPerClock": bits}
    bench.run("cop", "cop", size, module="test_cop_budget")
