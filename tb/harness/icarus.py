"""Icarus Verilog as a second simulator: MEISSNER_SIM=icarus. Only this file lists its limits.

Icarus 11, the version in Debian, does not support typed parameters in a module header, `signed'(x)` or $fatal
at elaboration. ``adapted`` replaces these by text substitution; statements stay as they are. The parameter
checks are removed: bench.refuses uses Verilator. Memory words start at random values, not X: 0 times a factor
that was never written is 0, but Icarus gives X. Registers start as X.
"""

import re

import members
from meissner.builds import toolchain

REPLACED = (
    (r"^ *(?:end else )?if \([^;]*?begin : gen_check_\w+\s+\$fatal\([^;]*;\s+end\n", ""),
    (r"\b(parameter|localparam)(\s+)int unsigned\b", r"\1\2[31:0]"),
    (r"\b(parameter|localparam)(\s+)int\b", r"\1\2integer"),
    (r"\b(parameter|localparam)(\s+)bit\b", r"\1\2"),
    (r"\blongint unsigned\b", "[63:0]"),
    (r"\bint unsigned\b", "reg [31:0]"),  # in functions of packages
    (r"\bint (?=\w+ = )", "integer "),
    (r"\b(un)?signed'\(", r"$\1signed("),
    (r"\b32'\((\w+)\)", r"\1"),
    (r"; (\w+) \+= (\w+)\)", r"; \1 = \1 + \2)"),
    (
        r"^(\s*\(\* no_rw_check.* (\w+) \[(.+)\];)$",
        r"\1 integer \2_i; initial for (\2_i = 0; \2_i < \3; \2_i = \2_i + 1) \2[\2_i] = {8{$random}};",
    ),
)

RESET = 2  # clocks of the first reset: msn_taxel_table's reads use a bank that the first clock makes known
# Struct ports of a block: its group's settings, which become a vector, and all others.
SETTINGS = re.compile(r"\bmsn_registers_pkg::(\w+)_cfg_t(\s+cfg_i\b)")
STRUCT = re.compile(r"^\s*(?:input|output)\s+msn_\w*pkg::(?!\w+_cfg_t\s+cfg_i\b)\w+_t\b", re.M)
STRUCTS = "ports of a package's packed struct: Icarus 11 crashes on `package::type` there"


def default(block, name):
    """The default value of a block's parameter."""
    text = next(path for path in toolchain.sources() if path.stem == f"msn_{block}").read_text("utf-8")
    return re.search(rf"^\s*parameter\s[^=]*?\b{name}\s*=\s*(?:\d+'\w)?(\d+)", text, re.M)[1]


def refused(block, parameters):
    """Why Icarus cannot run this size of a block; None if it can.

    The reason may be the block's own or that of a block inside it: a struct port, or what its tests state.
    """
    from nightly import evidence  # in tools/, which is not on the path of every user of this file

    runs = evidence.of(block, "icarus").get("runs", {})
    given = {name: str(parameters.get(name, default(block, name))) for name in runs}
    if runs and evidence.fits(runs, given):
        return None
    for path in sorted(toolchain.sources_of(f"msn_{block}"), key=lambda path: path.stem != f"msn_{block}"):
        inner = path.stem.removeprefix("msn_")
        if not inner.endswith("pkg"):
            if STRUCT.search(path.read_text("utf-8")):
                return STRUCTS
            if reason := evidence.of(inner, "icarus").get("refused"):
                return reason
    return None


def named(found):
    """An enumeration as constants and a vector type: in a port expression Icarus reads its names as X."""
    width, listed, name = found.groups()
    names = re.sub(r"//.*|\s", "", listed).split(",")
    values = ", ".join(f"{each} = {value}" for value, each in enumerate(names))
    return f"localparam [{width}] {values}; typedef logic [{width}] {name};"


def of_bits(text):
    """The source with every enumerated type of msn_pkg as a vector: Icarus does not accept
    `package::type`."""
    package = next(path for path in toolchain.sources() if path.stem == "msn_pkg").read_text("utf-8")
    for width, name in re.findall(r"typedef enum logic \[(\d+:0)\] \{[^}]*\} (\w+_e);", package):
        text = re.sub(rf"\bmsn_pkg::{name}\b", f"logic [{width}]", text)
    return text


def of_vectors(text):
    """The source with its struct of settings as a vector and each member as a slice of it."""
    found = SETTINGS.search(text)
    if not found or STRUCT.search(text):
        return text
    places = members.PLACES[f"{found[1]}_cfg"]
    bits = {name: f"cfg_i[{low + width - 1}:{low}]" for name, (low, width) in places.items()}
    top = max(low + width for low, width in places.values()) - 1
    text = re.sub(r"\bcfg_i\.(\w+)", lambda used: bits[used[1]], text)
    return SETTINGS.sub(rf"logic [{top}:0]\2", text)


def adapted(sources, folder):
    """Write copies of the sources that Icarus can read to ``folder``."""
    folder.mkdir(parents=True, exist_ok=True)
    copies = []
    for path in sources:
        text = of_vectors(of_bits(path.read_text()))
        for pattern, put in REPLACED:
            text = re.sub(pattern, put, text, flags=re.M)
        text = re.sub(r"typedef enum logic \[(\d+:0)\] \{([^}=]*)\} (\w+);", named, text)
        copies.append(folder / path.name)
        copies[-1].write_text(text)
    return copies
