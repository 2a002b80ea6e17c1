"""A rule of tools/make/lint.py: an operator right before a sized cast, which Yosys takes into the size."""

import pytest

import lint

MODULE = """module cast #(parameter int unsigned Bits = 5) (output logic [Bits-1:0] y_o);
  assign y_o = {};
endmodule
"""


@pytest.mark.parametrize("cast", ["~Bits'(1)", "3 + ~5'(1)", "-Bits'(1)", "(!Bits'(1))"])
def test_finds_the_cast(cast):
    assert lint.casts(MODULE.format(cast)) == [2]


@pytest.mark.parametrize(
    "fine", ["~(Bits'(1))", "3 - Bits'(1)", "~signed'(3)", "-unsigned'(3)", "Bits'(~1)", "'1;  // ~Bits'(1)"]
)
def test_leaves_the_rest(fine):
    assert lint.casts(MODULE.format(fine)) == []
