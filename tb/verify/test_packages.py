"""The part of a package that a block uses, by hand; an unknown package counts completely."""

import re

import pytest

from meissner.builds import toolchain
from verify import packages, revision

LINES = """package some_pkg; typedef enum logic [1:0] { Red = 2'd0, Blue = 2'd1 } colour_e;
typedef struct packed { colour_e hue; logic [Bits-1:0] depth; } paint_t;
typedef struct packed { logic [7:0] x; } place_t;
localparam int unsigned Bits = 5; localparam logic [3:0] Table = {1'b1, 3'd2};
function automatic int unsigned twice(int unsigned n); twice = n + n; endfunction
function automatic int unsigned four(int unsigned n); four = twice(twice(n)); endfunction
endpackage"""
TEXT = LINES.replace("\n", " ")
COLOUR = "typedef enum logic [1:0] { Red = 2'd0, Blue = 2'd1 } colour_e;"
PAINT = "typedef struct packed { colour_e hue; logic [Bits-1:0] depth; } paint_t;"
BITS = "localparam int unsigned Bits = 5;"
TWICE = "function automatic int unsigned twice(int unsigned n); twice = n + n; endfunction"
FOUR = "function automatic int unsigned four(int unsigned n); four = twice(twice(n)); endfunction"


@pytest.mark.parametrize(
    "users, wanted",
    [
        (["logic a;"], []),
        (["some_pkg::Blue"], [COLOUR]),
        (["x = some_pkg::twice(2);"], [TWICE]),
        (["x = some_pkg::four(2);"], [TWICE, FOUR]),
        (["some_pkg::paint_t p;", "other_pkg::place_t q;"], [COLOUR, PAINT, BITS]),
        (["some_pkg::Table"], ["localparam logic [3:0] Table = {1'b1, 3'd2};"]),
    ],
)
def test_only_what_is_named_and_what_that_needs(users, wanted):
    assert packages.used("some_pkg", TEXT, users) == "\n".join(wanted)


@pytest.mark.parametrize(
    "text, users",
    [
        (TEXT, ["import some_pkg::*;"]),
        (TEXT.replace("endpackage", "class c; endclass endpackage"), ["some_pkg::Blue"]),
        (TEXT.replace("package some_pkg;", ""), ["some_pkg::Blue"]),
    ],
)
def test_what_is_unknown_counts_whole(text, users):
    assert packages.used("some_pkg", text, users) == text


def test_every_package_here_is_known():
    found = [path for path in toolchain.sources() if path.stem.endswith("_pkg")]
    assert len(found) == 5
    for path in found:
        text = revision._plain(path)
        count = len(re.findall(r"\bendfunction\b|\btypedef\b|\blocalparam\b(?=[^;]*=[^;]*;)", text))
        assert len(set(packages.declarations(text).values())) == count
