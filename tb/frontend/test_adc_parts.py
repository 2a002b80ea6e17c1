"""engines/adc_parts.hpp: the batch driver's parts give msn_adc_spi, Verilated, the codes set for them."""

import subprocess

import pytest

from meissner.builds import toolchain
from meissner.twins.frontend.adc_spi import AD7606, AD7606C, MAX11123, MAX11125, MAX11131, MCP3208, AdcSpi

FRAMES = 200
HERE = toolchain.ROOT / "tb/frontend"


def code(frame, channel):
    if frame < 2:
        return 0xFFFF if frame else 0
    return ((frame * 8 + channel) * 2654435761 & 0xFFFFFFFF) >> 13 & 0xFFFF


@pytest.mark.parametrize(
    ("struct", "twin"),
    [
        ("Mcp3208", AdcSpi(MCP3208, channels=8, clk_khz=8_000, sclk_khz=2_000)),
        ("Ad7606", AdcSpi(AD7606, channels=3, clk_khz=25_000)),
        ("Ad7606", AdcSpi(AD7606, channels=7, lanes=2, clk_khz=25_000)),
        ("Ad7606c", AdcSpi(AD7606C, channels=7, lanes=4, clk_khz=25_000)),
        ("Ad7606c", AdcSpi(AD7606C, channels=3, clk_khz=25_000)),
        ("Max11123", AdcSpi(MAX11123, channels=8, clk_khz=25_000)),
        ("Max11131", AdcSpi(MAX11131, channels=8, clk_khz=100_000)),
        ("Max11125", AdcSpi(MAX11125, channels=3, clk_khz=25_000, sclk_khz=3_000)),
    ],
    ids=["mcp3208", "ad7606", "ad7606-2", "ad7606c-4", "ad7606c", "max11123", "max11131", "max11125"],
)
def test_adc_parts(struct, twin):
    build = toolchain.folder_for_make(toolchain.BUILD / f"tb/adc_parts-{struct}-{twin.channels}-{twin.lanes}")
    parameters = {
        "Part": twin.part.number,
        "Channels": twin.channels,
        "Lanes": twin.lanes,
        "ClkKhz": twin.clk_khz,
        "SclkKhz": twin.sclk_khz,
    }
    main = toolchain.for_make(HERE / "adc_parts_main.cpp")
    source = build.with_suffix(".cpp")
    source.write_text(
        f'#define PART meissner::{struct}\n#define LANES {twin.lanes}\n#include "{main}"\n', "utf-8"
    )
    # The same flags as engines/verilated.py, so that both share one compiled runtime.
    include = toolchain.for_make(toolchain.ROOT) / "model/meissner/engines"
    command = [
        "verilator", "--cc", "--exe", "--build", "-Mdir", str(build), "--prefix", "Vtop", "-o", "adc_parts",
        "--top-module", "msn_adc_spi", *toolchain.VERILATOR_FLAGS,
        "-CFLAGS", f"-fPIC {toolchain.OPTIMISE} -I{include}",
        *(f"-G{name}={value}" for name, value in parameters.items()),
        *(str(toolchain.for_make(path)) for path in [*toolchain.sources_of("msn_adc_spi"), source]),
    ]  # fmt: skip
    subprocess.run(command, env=toolchain.environment(), check=True, capture_output=True, text=True)
    run = [build / "adc_parts", str(FRAMES), str(twin.safe_period())]
    out = subprocess.run(run, check=True, capture_output=True, text=True).stdout
    got = [[int(field) for field in line.split()] for line in out.splitlines()]
    mask = (1 << twin.part.data_bits) - 1
    expected = []
    for frame in range(FRAMES):
        data, over = twin.samples([code(frame, channel) & mask for channel in range(twin.channels)])
        last = twin.channels - 1
        expected += [[c, int(data[c]), int(over[c]), int(c == last)] for c in range(twin.channels)]
    assert got == expected
