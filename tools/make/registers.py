"""Generate the RTL, Python map, C header and page of rtl/registers.rdl. ``--check`` only compares them.

rtl/link/msn_registers_pkg.sv   model/meissner/twins/link/register_map.py   host/msn_registers.h
docs/registers.md               tb/formal/registers_map.svh
"""

import argparse
import sys
import textwrap
from pathlib import Path

from systemrdl import RDLCompileError, RDLCompiler

from meissner.twins.link import register

ROOT = Path(__file__).resolve().parents[2]
SOURCE = "rtl/registers.rdl"
MADE = f"Made by tools/make/registers.py from {SOURCE}: change that, then `make registers`."

# The fields that a build may make narrower than in the map: names in core.widths, and the map's bits.
HELD = {"detail": 20, "timer": 16, "load": 32, "offset": 17}
APPLIES = {
    "at_once": "at once",
    "at_frame": "at a frame's start",
    "at_scan": "at the scan's next frame",
    "while_off": "while off",
    "at_reset": "at reset",
}
OWN = {"features": "Features", "width": "Widths"}  # kinds of fields that follow from the module's parameters
KEYWORDS = {"force", "override"}  # of SystemVerilog and C++: a member with such a name gets a "_"


def _fail(text):
    sys.exit(f"{SOURCE}: {text}")


def _kind(field, name):
    """Of meissner.twins.link.register.Field."""
    if field.get_property("group_bits", default=False):
        return "features"
    if field.get_property("width_bits", default=False):
        return "width"
    if field.get_property("singlepulse"):
        if field.width != 1:
            _fail(f"{name} is a pulse and must be one bit")
        return "command"
    if field.is_sw_writable:
        return "setting"
    return "status" if field.is_hw_writable else "constant"


def _line(group, register_, field):
    """A field's line in the table that meissner.twins.link.register.read takes."""
    name = f"{group.inst_name}.{register_.inst_name}.{field.inst_name}"
    kind, reset = _kind(field, name), field.get_property("reset")
    if kind != "status" and reset is None:
        _fail(f"{name} has no reset value")
    held_to = field.get_property("held_to", default="")
    if held_to and HELD.get(held_to) != field.width:
        _fail(f"{name} is held to no width of {', '.join(HELD)}")
    default = group.get_property("applies", default="")
    applies = register_.get_property("applies", default=default) if kind in ("setting", "command") else "-"
    if applies not in (*APPLIES, "-"):
        _fail(f"{name} applies {applies!r}, which is none of {', '.join(APPLIES)}")
    more = [
        *["signed"] * bool(field.get_property("is_signed", default=False)),
        *["written"] * bool(field.get_property("swmod")),
        *[held_to] * bool(held_to),
    ]
    own = register_.inst_name + f".{field.inst_name}" * (field.inst_name != "value")
    bits = f"{field.high}:{field.low}"
    columns = f"  {register_.absolute_address:03x} {own:20} {bits:5} {kind:8} {reset or 0:<8x} {applies:9}"
    return " ".join([columns, *more]).rstrip()


def read():
    """The table of rtl/registers.rdl, and {(group, register): its text}."""
    compiler = RDLCompiler()
    try:
        compiler.compile_file(str(ROOT / SOURCE))
        top = compiler.elaborate().top
    except RDLCompileError:
        sys.exit(1)  # the compiler has printed the error
    lines, texts = [], {}
    for group in top.children():
        feature = "feature" if group.get_property("group_feature", default=False) else "always"
        lines.append(f"{group.inst_name} {feature} {group.get_property('name')}")
        for found in group.children():
            lines += [_line(group, found, field) for field in found.fields()]
            texts[group.inst_name, found.inst_name] = found.get_property("desc")
    return "\n".join(lines), texts


def parameter(group):
    return "".join(part.capitalize() for part in group.name.split("_"))


def _member(register_, field):
    """The field's name in its group's struct."""
    name = register_.name if field.name == "value" else f"{register_.name}_{field.name}"
    return name + "_" * (name in KEYWORDS)


def _fields(groups):
    return [(group, reg, field) for group in groups for reg in group.registers for field in reg.fields]


def _structs(groups):
    """{"cfg": {group: {member: bits}}, "status": ...}: the core's settings and its status outputs."""
    made = {"cfg": {}, "status": {}}
    for group in groups:
        cfg, status = {}, {}
        for reg in group.registers:
            for field in reg.fields:
                if field.kind in ("setting", "command", "status"):
                    (status if field.kind == "status" else cfg)[_member(reg, field)] = field.width
            if reg.strobe:
                cfg[f"{reg.name}_written"] = 1
        for kind, members in (("cfg", cfg), ("status", status)):
            if members:
                made[kind][group.name] = members
    return made


def _places(groups):
    """{(kind of struct, group, member): its lowest bit}, and the bits of each struct."""
    places, sizes = {}, {}
    for kind, listed in _structs(groups).items():
        low = 0
        for name, members in reversed(listed.items()):
            for member, bits in reversed(members.items()):
                places[kind, name, member] = low
                low += bits
        sizes[kind] = low
    return places, sizes


def _wrapped(words):
    return "\n    ".join(textwrap.wrap(", ".join(words), 104))


def _rows(groups):
    """The lines of the package's table: a row for each field and each strobe."""
    places, _ = _places(groups)
    rows, at = [], 0

    def row(group, reg, low, width, kind, held, signed, place, value, name):
        applies = "AtOnce" if reg.applies == "-" else reg.applies.title().replace("_", "")
        columns = f"{parameter(group) + ',':11}10'h{reg.address >> 2:03x}, "
        columns += " ".join(f"{number:6}" for number in (f"5'd{low},", f"6'd{width},"))
        columns += f" {kind + ',':9} {applies + ',':9} {held.capitalize() + ',':7} 1'b{int(signed)}, "
        columns += f"12'd{place}, 32'h{value:x}"
        rows.append((columns, name))

    for group in groups:
        for reg in group.registers:
            for field in reg.fields:
                member, value = _member(reg, field), field.reset
                place = places.get(("status" if field.kind == "status" else "cfg", group.name, member), 0)
                if field.kind == "setting":
                    value, at = at, at + field.width
                held = field.held_to or (field.name if field.kind == "width" else "whole")
                kind = OWN.get(field.kind, field.kind.capitalize())
                row(group, reg, field.low, field.width, kind, held, field.signed, place, value, member)
            if reg.strobe:
                name = f"{reg.name}_written"
                low = next(field.low for field in reg.fields if field.acts)
                row(group, reg, low, 1, "Strobe", "whole", False, places["cfg", group.name, name], 0, name)
    return [f"  {{{columns}}}{',' * (n < len(rows))}  // {name}" for n, (columns, name) in enumerate(rows, 1)]


def package(groups, _):
    """The package: structs of settings and status, the table of fields, the default of Resets."""
    structs, resets, width = [], [], 0
    for kind, listed in _structs(groups).items():
        for name, members in listed.items():
            structs += ["  typedef struct packed {"]
            for member, bits in members.items():
                range_ = "" if bits == 1 else f"[{bits - 1}:0]"
                structs.append(f"    logic {range_:6} {member};")
            structs += [f"  }} {name}_{kind}_t;", ""]
        structs += [
            "  typedef struct packed {",
            *(f"    {n}_{kind}_t {n};" for n in listed),
            f"  }} {kind}_t;",
            "",
        ]
    for group in groups:
        value = bits = 0
        for field in (f for g, _, f in _fields(groups) if g is group and f.kind == "setting"):
            value |= field.reset << bits
            bits += field.width
        width += bits
        if bits:
            resets.insert(0, (f"{bits}'h{value:x}", group.name))
    places, sizes = _places(groups)
    switches = [places.get(("cfg", group.name, "enable"), 0) for group in reversed(groups)]
    rows = _rows(groups)
    return PACKAGE.format(
        made=MADE,
        structs="\n".join(structs),
        groups=_wrapped(parameter(group) for group in groups),
        group_count=len(groups),
        rows="\n".join(rows),
        count=len(rows),
        switches=_wrapped(f"12'd{place}" for place in switches),
        cfg=sizes["cfg"],
        status=sizes["status"],
        width=width,
        resets="\n".join(
            f"    {value}{',' * (n < len(resets))}  // {name}" for n, (value, name) in enumerate(resets, 1)
        ),
    ).lstrip("\n")


PACKAGE = """
// SPDX-License-Identifier: Apache-2.0
//
// {made}
//
// A struct per group of registers: what the core gets of it, what it gives. Members have no sign:
// `signed'()` where docs/registers.md has one. Then the table of all fields, and the settings' reset values
// as one number, the first setting lowest.

// Most blocks use the structs only.
// verilator lint_off UNUSEDPARAM
package msn_registers_pkg;

{structs}
  typedef enum logic [3:0] {{
    {groups}
  }} group_e;
  localparam int unsigned Groups = {group_count};

  typedef enum logic [2:0] {{
    Setting,   // what the host writes is kept, for the core
    Command,   // a 1 that the host writes is a pulse for the core
    Strobe,    // a write of the byte with bit `low` is one
    Status,    // the core's
    Constant,
    Features,  // a bit for each group that a build may leave out
    Widths     // the bits that a build has for fields that are held to them
  }} kind_e;

  // When a written setting takes effect. AtScan: as AtOnce for the registers; the scan waits for a frame.
  typedef enum logic [2:0] {{AtOnce, AtFrame, AtScan, WhileOff, AtReset}} applies_e;

  // The bits that a build has for a field: all, or its parameter DetailBits ...
  typedef enum logic [2:0] {{Whole, Detail, Timer, Load, Offset}} held_e;

  localparam int unsigned RowBits = 79;
  typedef struct packed {{
    group_e      group;
    logic [9:0]  word;       // the address, in words
    logic [4:0]  low;        // its lowest bit in the word
    logic [5:0]  width;
    kind_e       kind;
    applies_e    applies;
    held_e       held;
    logic        is_signed;
    logic [11:0] place;      // its lowest bit in cfg_t or status_t
    logic [31:0] value;      // the constant; of a setting its lowest bit in the reset values
  }} row_t;

  localparam int unsigned Rows       = {count};
  localparam int unsigned CfgBits    = {cfg};
  localparam int unsigned StatusBits = {status};
  // The first row highest.
  localparam logic [Rows*RowBits-1:0] Table = {{
{rows}
  }};

  // Of each group: the bit of cfg_t that is 1 while its block is on, for settings that apply while it is off.
  localparam logic [12*Groups-1:0] Switches = {{
    {switches}
  }};

  localparam int unsigned ResetBits = {width};
  localparam logic [ResetBits-1:0] Reset = {{
{resets}
  }};

endpackage
// verilator lint_on UNUSEDPARAM
"""


def python(groups, texts):
    return f'''"""The register map.

{MADE}
"""

from meissner.twins.link.register import read

TABLE = """
{texts["table"]}
"""
GROUPS = read(TABLE)
'''


def c_header(groups, _):
    lines = [
        "/* SPDX-License-Identifier: Apache-2.0",
        f" * {MADE} */",
        "#ifndef MSN_REGISTERS_H",
        "#define MSN_REGISTERS_H",
        "",
    ]
    for index, group in enumerate(group for group in groups if group.feature):
        lines.append(f"#define MSN_FEATURE_{group.name.upper()} (1u << {index})")
    for group in groups:
        lines += ["", f"/* {group.title} */"]
        for reg in group.registers:
            base = f"MSN_{group.name}_{reg.name}".upper()
            lines.append(f"#define {base} 0x{reg.address:03x}u")
            for field in reg.fields:
                if field.name != "value":
                    lines.append(f"#define {base}_{field.name.upper()}_SHIFT {field.low}")
                    lines.append(f"#define {base}_{field.name.upper()}_BITS {field.width}")
    return "\n".join([*lines, "", "#endif"]) + "\n"


def page(groups, texts):
    lines = ["# Registers", "", f"{MADE}", ""]
    lines += [
        "Addresses count bytes; every register is a word of 32 bits. The core answers with an error if an",
        "address has no register in this build, or if a write goes to a register that can only be read.",
        "Such an access changes nothing. A write without any of a register's bytes (WSTRB) changes nothing",
        "either, and has no effect.",
        "",
        "The column *applies* says when a written value takes effect: *at once*; *at a frame's",
        "start*, with all others that were written before it, between two frames; *at the scan's next",
        "frame*, with the first conversion of the next one to begin ([scan.md](scan.md)); *while off*: at",
        "once, but only while its block is off (`enable` is 0): otherwise the write is an error; *at",
        "reset*: never, the build says what it is, and a write is an error. So what is read is in force,",
        "at the latest from the next frame on.",
        "Settings that belong together take effect with the same frame if `core.hold` is 1 while they are",
        "written: `with core.together():` in Python. Those of the scan do not wait for `core.hold`.",
        "",
        "A build without registers (`registers = false`: `slip1`, and every named build for the iCEBreaker)",
        "answers no access. Its settings are those of its configuration, and a host can only receive its",
        "packets.",
    ]
    access = {"setting": "read, write", "command": "write 1"}
    for group in groups:
        lines += ["", f"## `{group.name}`: {group.title}", ""]
        lines += ["| address | name | bits | access | applies | reset | |", "|---|---|---|---|---|---|---|"]
        for reg in group.registers:
            for index, field in enumerate(sorted(reg.fields, key=lambda f: f.low)):
                name = reg.name if field.name == "value" else f"{reg.name}.{field.name}"
                bits = f"{field.high}:{field.low}" if field.width > 1 else f"{field.low}"
                reset = "" if field.kind in ("status", *OWN) else f"{field.reset:#x}"
                when = APPLIES[reg.applies] if field.kind == "setting" else ""
                known = access.get(field.kind, "read") if reg.applies != "at_reset" else "read"
                text = texts[group.name, reg.name] if index == 0 else ""
                lines.append(
                    f"| 0x{reg.address:03x} | `{name}` | {bits} | {known} | {when} | {reset} | {text} |"
                )
    return "\n".join(lines) + "\n"


def proof(groups, _):
    """The map for tb/formal/registers.sv: each field with its word, its bits and its member."""
    lines, place, waiting = [], 0, []
    for index, (group, reg, field) in enumerate(_fields(groups)):
        on = parameter(group) if group.feature else "1'b1"
        member = _member(reg, field)
        begin = f"{index}, {on}, 10'h{reg.address >> 2:03x}, {field.low}"
        name = f"{group.name}_{member}, {group.name}.{member}"
        own = f"{(field.held_to or field.name).capitalize()}Bits"
        if field.kind == "setting":
            waits = reg.applies == "at_frame"
            ends = f"{own if field.held_to else field.width}, {int(field.signed)}"
            able = {"at_reset": "1'b0", "while_off": f"!cfg_o.{group.name}.enable"}.get(reg.applies, "1'b1")
            lines.append(f"`SETTING({begin}, {field.width}, {place}, {name}, {int(waits)}, {ends}, {able})")
            waiting += [index] * waits
            place += field.width
        elif field.kind == "status":
            lines.append(f"`STATUS({begin}, {field.width}, {name})")
        elif field.kind == "command":
            lines.append(f"`COMMAND({begin}, {name})")
        else:
            value = {"features": "Features", "width": own}.get(field.kind, field.reset)
            lines.append(f"`CONSTANT({begin}, {field.width}, {value})")
        if reg.strobe and field is reg.fields[-1]:
            name = f"{group.name}_{reg.name}, {group.name}.{reg.name}_written"
            low = next(f.low for f in reg.fields if f.acts)
            lines.append(f"`WRITTEN({on}, 10'h{reg.address >> 2:03x}, {low}, {name})")
    names = [parameter(group) for group in groups if group.feature]
    count = len(_fields(groups))
    head = [
        "// SPDX-License-Identifier: Apache-2.0",
        f"// {MADE}",
        "",
        f"localparam int unsigned Fields = {count};",
        "logic [Fields-1:0]    there, writable, written;",
        "logic [32*Fields-1:0] bits;",
        f"localparam logic [{len(names) - 1}:0] Features = {{{', '.join(reversed(names))}}};",
        f"localparam logic [Fields-1:0] Waiting = {count}'h{sum(1 << n for n in waiting):x};",
    ]
    return "\n".join([*head, *lines]) + "\n"


OUTPUTS = {
    "rtl/link/msn_registers_pkg.sv": package,
    "model/meissner/twins/link/register_map.py": python,
    "host/msn_registers.h": c_header,
    "docs/registers.md": page,
    "tb/formal/registers_map.svh": proof,
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="write nothing; fail where a file differs")
    check = parser.parse_args().check
    table, texts = read()
    groups, texts["table"] = register.read(table), table
    stale = []
    for name, make in OUTPUTS.items():
        path, text = ROOT / name, make(groups, texts)
        if path.exists() and path.read_text() == text:
            continue
        stale.append(name)
        if not check:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
    if check and stale:
        sys.exit(f"{', '.join(stale)}: not what {SOURCE} gives; run `make registers`")
    print(
        f"registers: {sum(len(g.registers) for g in groups)} in {len(groups)} groups"
        + (f"; wrote {', '.join(stale)}" if stale else "")
    )


if __name__ == "__main__":
    main()
