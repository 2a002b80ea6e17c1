"""The second simulator in a short form, and that its list of unsupported blocks is true."""

import os
import shutil
import subprocess
import sys

import pytest

from harness import icarus
from meissner.builds import toolchain
from nightly import benches

pytestmark = pytest.mark.skipif(not shutil.which("iverilog"), reason="iverilog is not installed")


def lanes_of(block):
    """Parameters with which the block is refused: with one lane it would be accepted."""
    return {"Lanes": 2} if block.startswith("cop") else {}


def accepted(block, folder, **parameters):
    paths = icarus.adapted(toolchain.sources_of(f"msn_{block}"), folder)
    command = ["iverilog", "-g2012", "-o", folder / "out.vvp", "-s", f"msn_{block}"]
    command += [*(f"-Pmsn_{block}.{name}={value}" for name, value in parameters.items()), *paths]
    return subprocess.run([*map(str, command)], capture_output=True).returncode == 0


STAGES = ("common", "frontend", "slip", "cop", "link", "actuate")  # of `make test-icarus`


def test_refused_is_refused(subtests, tmp_path):
    blocks = [block for block in benches.blocks() if benches.stage_of(block) in STAGES]
    refused = [block for block in blocks if icarus.refused(block, lanes_of(block))]
    assert refused
    for block in refused:
        with subtests.test(block=block):
            assert not accepted(block, tmp_path / block, **lanes_of(block))


def test_a_block_is_refused_for_a_block_in_it():
    """By hand: blocks that contain a converter, a packed vector of vectors, or structs as ports."""
    found = {block: icarus.refused(block, {}) for block in ("acquire", "sensor_array", "slip_path", "link")}
    assert [reason.split(":")[0] for reason in found.values()] == [
        "a parameter that a package's function makes of another package's functions",
        "ports of a package's packed struct",
        "a packed vector of vectors of which a process drives one element and an assignment another",
        "ports of a package's packed struct",
    ]
    assert icarus.refused("cop", {}) is None and icarus.refused("cop", {"Lanes": "2"})
    assert icarus.refused("slip_path", {"Serial": "1"}) is None


@pytest.mark.parametrize(
    "block, given",
    [("divide", {}), ("cop_accumulate", {"Lanes": 1}), ("slip_path", {"Serial": 1}), ("image_store", {})],
)
def test_others_are_accepted(block, given, tmp_path):
    assert accepted(block, tmp_path, **given)
    assert icarus.refused(block, given) is None


def test_a_bench_runs_on_it():
    code = "import bench; bench.run('common', 'frame_gate', {})"
    environment = {
        **toolchain.environment(),
        "MEISSNER_SIM": "icarus",
        "PYTHONPATH": os.pathsep.join(str(toolchain.ROOT / name) for name in ("tb", "tools")),
    }
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert list(toolchain.folder_for_make(toolchain.BUILD / "icarus/frame_gate").glob("*.vvp"))


def test_a_struct_of_settings_becomes_a_vector():
    """adc: bits 23:0 are the period, bit 24 is enable. With a struct of another kind the text stays
    unchanged."""
    text = "  input  msn_registers_pkg::adc_cfg_t cfg_i,\n  x = cfg_i.enable && W'(cfg_i.period);\n"
    assert icarus.of_vectors(text) == "  input  logic [24:0] cfg_i,\n  x = cfg_i[24:24] && W'(cfg_i[23:0]);\n"
    other = "  output msn_registers_pkg::adc_status_t status_o\n" + text
    assert icarus.of_vectors(other) == other


def test_a_type_that_enumerates_becomes_its_bits():
    """slip_state_e in a port becomes three bits; its values and a port of a struct stay."""
    text = "  input  msn_pkg::slip_state_e in_state_i,\n  assign gross = in_state_i == msn_pkg::Gross;\n"
    bits = "  input  logic [2:0] in_state_i,\n  assign gross = in_state_i == msn_pkg::Gross;\n"
    assert icarus.of_bits(text) == bits
    struct = "  output msn_pkg::decision_t out_o\n"
    assert icarus.of_bits(struct) == struct
    assert icarus.STRUCT.search(struct) and not icarus.STRUCT.search(text)
