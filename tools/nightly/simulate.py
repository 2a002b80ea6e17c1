"""Build the netlist of a block's mutants with Verilator and run the block's tests against each mutant."""

import json
import os

from cocotb_tools.runner import Verilator

from meissner.builds import toolchain
from meissner.builds.yowasp import ROOT
from nightly import benches

# Yosys's Verilog does not follow the style rules, and a mutant may close a combinational loop. If Verilator
# inlined the block, output registers with a mutated net would start at zero regardless of the option.
# Verilator 5.048 adds the amounts of two shifts in a row in the width of one (its issue 7955): a netlist in
# which mutsel chooses an amount shifted wrongly.
FLAGS = ("-fno-inline", "-fno-dfg-peephole", "-Wno-lint", "-Wno-style")
FLAGS += ("-Wno-UNOPTFLAT", "-Wno-MULTIDRIVEN", "-Wno-ALWCOMBORDER")
PUBLIC = """`verilator_config
public_flat_rw -module "{top}" -var "*"
"""


class BuildError(RuntimeError):
    """Verilator or the compiler refused the netlist, or the tests fail on the unchanged one."""


class TooSlow(RuntimeError):
    """The tests of the unchanged block take too long."""


class _Runner(Verilator):
    """Makes only the wrapper's ports and parameters public, since cocotb's own option slows down the rest."""

    def _build_command(self):
        return [
            [word for word in command if word != "--public-flat-rw"] for command in super()._build_command()
        ]


def build(run, folder):
    """Compile folder/mutated.v behind its wrapper into folder/sim."""
    top = f"msn_{run['block']}"
    os.environ.update(toolchain.environment())
    os.environ["MAKEFLAGS"] = "-- CFG_CXXFLAGS_PCH_I=-include"
    benches.cocotb_for_make()
    (ROOT / folder / "public.vlt").write_text(PUBLIC.format(top=top))
    package = ROOT / "rtl/msn_pkg.sv"
    packages = [path for path in toolchain.sources_of(top) if path.stem.endswith("_pkg") and path != package]
    names = ("public.vlt", "mutated.v", "wrapper.sv")
    _Runner().build(
        sources=[
            toolchain.for_make(path)
            for path in (package, *packages, *(ROOT / folder / name for name in names))
        ],
        hdl_toplevel=top,
        parameters=run["parameters"],
        build_args=[*FLAGS],
        build_dir=toolchain.folder_for_make(ROOT / folder / "sim"),
        timescale=("1ns", "1ps"),
        log_file=ROOT / folder / "build.log",
    )


def judge(run, mutants, folder, jobs, powerup=0, limit=5):
    """Run the tests of ``run`` against ``mutants`` and set their verdicts.

    ``powerup``: registers start with random values of this seed instead of ones; ``limit``: CPU seconds that
    the tests may take on the unchanged block. Returns the seconds that they take.
    """
    out = ROOT / folder / "verdicts.json"
    out.unlink(missing_ok=True)
    settings = {
        "out": str(out),
        "baseline_s": limit,
        "numbers": [mutant.number for mutant in mutants],
        "jobs": jobs,
    }
    start = ["+verilator+rand+reset+1"]
    if powerup:
        start = ["+verilator+rand+reset+2", f"+verilator+seed+{powerup}"]
    top = f"msn_{run['block']}"
    os.environ.pop("PYTEST_CURRENT_TEST", None)  # else the runner looks for its own results
    _Runner().test(
        hdl_toplevel=top,
        hdl_toplevel_lang="verilog",
        test_module=["nightly.forked", f"{run['stage']}.{run['module']}"],
        build_dir=toolchain.folder_for_make(ROOT / folder / "sim"),
        test_dir=toolchain.folder_for_make(ROOT / folder / "sim"),
        test_filter=run["test_filter"],
        plusargs=start,
        seed=os.environ.get("MEISSNER_SEED", "1"),
        # The reason of a mutant's failure is not used, and pytest's comparison of long lists takes seconds.
        extra_env={"MEISSNER_MUTANTS": json.dumps(settings), "COCOTB_REWRITE_ASSERTION_FILES": ""},
        log_file=ROOT / folder / "test.log",
    )
    if not out.exists():
        raise BuildError(f"the tests did not start; see {folder}/test.log")
    told = json.loads(out.read_text())
    if told["verdicts"]["0"] == "time":
        raise TooSlow
    if told["verdicts"]["0"] != "survived":
        raise BuildError(f"the unchanged block fails: {told['verdicts']['0']} {told['by'].get('0', '')}")
    for mutant in mutants:
        mutant.verdict = told["verdicts"][str(mutant.number)]
        mutant.by = told["by"].get(str(mutant.number), "")
    return told["seconds"]
