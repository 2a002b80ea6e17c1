"""Verilator reads each block with every pair of the ends of its parameters.

parameters.toml lists the ends; a block that it does not list is read with the least and greatest values of
its own tests. A set of parameters must be read without a warning, except for unused bits, or be refused by a
check of the RTL (``$fatal``), and each end must be read in some set.
"""

import re
import subprocess
import tomllib
from contextlib import nullcontext
from random import Random

import pytest

from extremes.pairs import covering
from meissner.builds import toolchain
from nightly import benches

ENDS = tomllib.loads((toolchain.ROOT / "tb/extremes/parameters.toml").read_text("utf-8"))
SHORT = ("delay", "fifo", "round_sat")  # a quarter of a second per set
REFUSAL = re.compile(r"%Warning-USERFATAL: [^\n]*\bmsn_\w+: ")


def read(files, top, values):
    """Whether Verilator reads ``top`` with these parameters; False if a check refuses them."""
    command = ["verilator", "--lint-only", "--quiet", "-Wall", "-Wno-UNUSED", "--top-module", top]
    command += [toolchain.ROOT / "rtl/verilator.vlt", *files]
    command += [f"-G{name}={value}" for name, value in values.items()]
    done = subprocess.run(command, env=toolchain.environment(), capture_output=True, text=True)
    said = (done.stdout + done.stderr).strip()
    assert not said or (done.returncode and REFUSAL.search(said)), f"{values}: {said[:600]}"
    return not said


def check(files, top, ends, built=()):
    """``built``: sets that the block's own tests build, whose values fit each other."""
    draw, taken = Random(1), set()
    for values in covering(ends, tries=10):
        taken |= set(values.items()) if read(files, top, values) else set()
    for end in [(name, value) for name in ends for value in ends[name] if (name, value) not in taken]:
        drawn = [{name: draw.choice(ends[name]) for name in ends} for _ in range(60)]
        found = any(read(files, top, one | dict([end])) for one in [{}, *built, *drawn])
        assert found, f"never read: {end[0]} = {end[1]}"


def sets(block):
    """Those of the block's own tests, without words such as Resets."""
    own = [run["parameters"] for run in benches.runs(block) if run["block"] == block]
    return [{name: int(value) for name, value in one.items() if "'" not in str(value)} for one in own]


def test_the_list_names_blocks():
    assert not {*ENDS} - {*benches.blocks()}


@pytest.mark.parametrize("block", SHORT)
def test_the_ends_are_read(block):
    check(toolchain.sources_of(f"msn_{block}"), f"msn_{block}", ENDS[block])


@pytest.mark.long
@pytest.mark.parametrize("block", [block for block in benches.blocks() if block not in SHORT])
def test_the_ends_of_every_block_are_read(block):
    built = sets(block)
    values = {name: {one[name] for one in built if name in one} for one in built for name in one}
    ends = {name: sorted({min(some), max(some)}) for name, some in values.items()}
    check(toolchain.sources_of(f"msn_{block}"), f"msn_{block}", ENDS.get(block, ends), built)


WIDTHS = """module msn_x #(
  parameter int unsigned A = 4,
  parameter int unsigned B = 4
) (input logic [7:0] in_i, output logic [7:0] out_o);
  if (A > 8 CHECK) begin : gen_check_a
    $fatal(1, "msn_x: A = %0d must fit", A);
  end
  assign out_o = 8'(in_i[A-1:0]) + 8'(in_i[B-1:0]);
endmodule
"""


@pytest.mark.parametrize(
    "more, end, finds", [("|| B > 8", 8, ""), ("|| B > 8", 9, "never read: B = 9"), ("", 9, "SELRANGE")]
)
def test_a_set_that_is_neither_read_nor_refused_is_found(tmp_path, more, end, finds):
    source = tmp_path / "msn_x.sv"
    source.write_text(WIDTHS.replace("CHECK", more))
    ends = {"A": [1, 8], "B": [1, end]}
    with pytest.raises(AssertionError, match=finds) if finds else nullcontext():
        check([source], "msn_x", ends)
