"""The second simulator in a short form, and that its list of what it cannot run is true."""

import shutil
import subprocess
import sys

import pytest

import icarus
from meissner.builds import toolchain

pytestmark = pytest.mark.skipif(not shutil.which("iverilog"), reason="iverilog is not installed")


def accepted(block, folder, **parameters):
    paths = icarus.adapted(toolchain.sources_of(f"msn_{block}"), folder)
    command = ["iverilog", "-g2012", "-o", folder / "out.vvp", "-s", f"msn_{block}"]
    command += [*(f"-Pmsn_{block}.{name}={value}" for name, value in parameters.items()), *paths]
    return subprocess.run([*map(str, command)], capture_output=True).returncode == 0


@pytest.mark.parametrize("block", icarus.REFUSED)
def test_refused_is_refused(block, tmp_path):
    lanes = {"Lanes": 2} if block.startswith("cop") else {}
    assert not accepted(block, tmp_path, **lanes)
    assert icarus.refused(block, lanes)


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
        "PYTHONPATH": str(toolchain.ROOT / "tb"),
    }
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert list((toolchain.BUILD / "icarus").glob("frame_gate*/*.vvp"))
