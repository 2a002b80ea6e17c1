"""The boards: a bitstream is built from the current sources; a wrong, slow or grown netlist is refused; bad
input is answered with one sentence."""

import subprocess
import sys

import pytest

import synth
from meissner.builds import bitstream, boards, config
from meissner.builds.yowasp import ROOT, ToolError, yosys
from meissner.tradeoff import area

RECORDED = area.recorded(area.BOARDS, "make resources")


def run(*arguments):
    command = [sys.executable, "tools/make/synth.py", *arguments]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True)


@pytest.mark.parametrize(
    "arguments, said",
    [
        (
            ["nexys"],
            "nexys",
        ),
        (
            ["icebreaker", "array64"],
            "array64",
        ),
        (
            ["icebreaker", "none"],
            "'none'",
        ),
        (
            ["icebreaker", "slip1", "--device", "85F"],
            "--device",
        ),
        (["ulx3s", "slip1", "--device", "13F"], "--device"),
        (["ulx3s", "--device", "85F", "--check"], "--device"),
        ([], "BOARD"),
    ],
)
def test_bad_names_are_answered_by_a_sentence(arguments, said):
    done = run(*arguments)
    assert done.returncode == 2 and said in done.stderr and done.stderr.count("\n") == 1
    assert not done.stdout


def test_the_smallest_board_synthesises_as_recorded():
    """From sources to a bitstream with one seed, compared with constraints/resources.json."""
    bitstream = ROOT / "build/synth/icebreaker-slip1/icebreaker_top.bin"
    bitstream.unlink(missing_ok=True)
    done = run("--check", "icebreaker", "slip1", "--seeds", "1")
    assert done.returncode == 0, done.stdout + done.stderr
    assert bitstream.stat().st_size == 104090  # every UP5K bitstream has this length


def test_every_pair_is_recorded_and_meets_its_clock():
    recorded = RECORDED
    assert synth.missing(recorded) == []
    for name, result in recorded.items():
        if "left_out" in result:
            continue
        assert len(result["mhz"]) == 3 and result["mhz_worst"] == min(result["mhz"]), name
        assert max(result["mhz"]) >= result["clk_mhz"], name  # one seed that meets it is enough


def test_every_board_has_every_configuration_or_says_why_not():
    """The reasons are in resources.json too, in the same words, so a missing pair is always noticed."""
    recorded = RECORDED
    for board in boards.BOARDS.values():
        assert not set(board.configs) & set(board.left_out)
        assert {*board.configs, *board.left_out} == set(config.names())
        for name, reason in board.left_out.items():
            assert recorded[f"{board.name}-{name}"] == {"left_out": reason}
            silent = {key: value for key, value in recorded.items() if key != f"{board.name}-{name}"}
            assert synth.missing(silent) == [
                f"constraints/resources.json does not say why {board.name}-{name} is left out"
            ]


def test_a_pair_is_on_the_smallest_device_that_will_do():
    """The next smaller device has too few block RAMs, or there is none; the 12F does not count."""
    rams = {"25F": 56, "45F": 108, "85F": 208}
    recorded = RECORDED
    for name in boards.BOARDS["ulx3s"].configs:
        result = recorded[f"ulx3s-{name}"]
        if "left_out" in result:
            continue
        smaller = [device for device in rams if rams[device] < rams[result["device"]]]
        assert result["bram"] <= rams[result["device"]]
        assert not smaller or result["bram"] > rams[smaller[-1]], name


@pytest.mark.parametrize(
    "change, said",
    [
        ({}, []),
        ({"lut": 103, "ff": 206, "mhz_worst": 58.2}, []),
        ({"lut": 104}, ["x: 104 LUT, 100 before"]),
        ({"bram": 1}, ["x: 1 BRAM, 0 before"]),
        ({"mhz_worst": 58.1}, ["x: 58.1 MHz with its worst seed, 58.2 or more before"]),
    ],
)
def test_growth_over_three_percent_is_reported(change, said):
    before = {"clk_mhz": 12, "lut": 100, "ff": 200, "bram": 0, "dsp": 0, "mhz_worst": 60}
    assert synth.compare("x", before, before | change) == said


def test_a_conflict_of_drivers_fails_the_build():
    """Yosys makes a wrong netlist of a product followed by two registers, and reports it only in passing."""
    folder = ROOT / "build/tb/conflict"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "product.v").write_text(
        "module product(input clk, input [7:0] a, b, output reg [15:0] y);\n"
        "  reg [15:0] p;\n  always @(posedge clk) begin p <= a * b; y <= p; end\nendmodule\n"
    )
    with pytest.raises(ToolError, match="driver-driver conflict"):
        yosys(
            "read_verilog build/tb/conflict/product.v; synth_ice40 -dsp -top product", "build/tb/conflict/log"
        )


def test_the_log_is_read_to_its_end():
    """Yosys prints nothing to standard output after its first call of ABC, so the log is read instead."""
    folder = ROOT / "build/tb/whole"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "sum.v").write_text(
        "module sum(input [7:0] a, b, output [7:0] y); assign y = a + b; endmodule\n"
    )
    said = yosys("read_verilog build/tb/whole/sum.v; synth_ecp5 -top sum", "build/tb/whole/log")
    assert said.index("Executing ABC9_EXE") < said.index("End of script")


def test_what_is_too_large_is_reported():
    folder = ROOT / "build/tb/large"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "pnr.log").write_text(
        "Info: \t  ICESTORM_LC:    6100/   5280   115%\nInfo: \t  ICESTORM_RAM:      4/     30    13%\n"
    )
    assert bitstream.too_large("build/tb/large/pnr.log") == "6100 of 5280 ICESTORM_LC"
