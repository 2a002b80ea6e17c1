"""tools/make/slang.py: code that violates the standard but passes Verilator and Yosys stops `make lint`;
clean files pass without output, parameters reach the top, whatever the path."""

import subprocess
import sys

import pytest

from meissner.builds import toolchain

EARLY = """module early (output logic y_o);
  assign y_o = later;
  logic later;
  assign later = 1'b1;
endmodule
"""
SIGNS = """module inner (input logic signed [3:0] a_i, output logic y_o);
  assign y_o = a_i < 0;
endmodule
module signs (input logic [3:0] a_i, output logic y_o);
  inner u_inner (.a_i, .y_o);
endmodule
"""
SHIFT = """module shift (input logic [3:0] a_i, output logic [3:0] y_o);
  assign y_o = a_i >> 4;
endmodule
"""
CLEAN = """module clean #(parameter logic [39:0] Word = 40'd0) (output logic y_o);
  if (Word[39]) begin : gen_check_word
    $fatal(1, "clean: Word = %0d", Word);
  end
  assign y_o = Word[0];
endmodule
"""


def slang(folder, name, text, *given):
    path = folder / f"{name}.sv"
    path.write_text(text)
    command = [sys.executable, "tools/make/slang.py", "-Werror", str(path), "--top", name, *given]
    done = subprocess.run(command, cwd=toolchain.ROOT, capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


@pytest.fixture
def folder(tmp_path):
    spaced = tmp_path / "a folder"
    spaced.mkdir()
    return spaced


@pytest.mark.parametrize(
    "name, text, said",
    [
        ("early", EARLY, "identifier 'later' used before its declaration"),
        ("signs", SIGNS, "connects to value of inequivalent type"),
        ("shift", SHIFT, "overflows 4-bit operand"),
        ("clean", CLEAN.replace("endmodule", ""), "expected 'endmodule'"),
    ],
    ids=["used before declared", "signed to unsigned", "warning", "syntax"],
)
def test_refuses(folder, name, text, said):
    code, out = slang(folder, name, text)
    assert code == 1 and said in out


def test_clean_sources_pass_without_output(folder):
    assert slang(folder, "clean", CLEAN) == (0, "")
    assert slang(folder, "clean", CLEAN, "-GWord=40'h7f_ffff_ffff") == (0, "")


def test_parameters_reach_the_top(folder):
    code, out = slang(folder, "clean", CLEAN, "-GWord=40'h80_0000_0007")
    assert code == 1 and "clean: Word = 549755813895" in out
