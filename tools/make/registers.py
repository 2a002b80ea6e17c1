"""Generate the RTL, Python map, C header and page of rtl/registers.rdl. ``--check`` only compares them.

rtl/link/msn_registers_pkg.sv   rtl/link/msn_registers.sv   model/meissner/twins/link/register_map.py
host/msn_registers.h            docs/registers.md                 tb/formal/registers_map.svh
"""

import argparse
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from systemrdl import RDLCompileError, RDLCompiler

ROOT = Path(__file__).resolve().parents[2]
SOURCE = "rtl/registers.rdl"
MADE = f"Made by tools/make/registers.py from {SOURCE}: change that, then `make registers`."

# The fields that a build may make narrower than in the map: names in core.widths, and the map's bits.
HELD = {"detail": 20, "timer": 16, "load": 32, "offset": 17}


OWN = ("features", "width")  # kinds of fields whose value follows from the module's parameters
KEYWORDS = {"force", "override"}  # of SystemVerilog and C++: a member with such a name gets a "_"


@dataclass(frozen=True)
class Field:
    """``kind``: setting (written by the host), status (by the core), constant, command (a pulse), or from the
    module's parameters: features (which groups exist), width (the bits that fields are saturated to)."""

    name: str
    port: str  # the names of its group, its register and itself
    member: str  # its name in the group's struct
    high: int
    low: int
    kind: str
    reset: int
    signed: bool = False
    held_to: str = ""  # a key of HELD

    @property
    def width(self):
        return self.high - self.low + 1

    @property
    def parameter(self):
        """The parameter for the bits that the build gives the field."""
        return f"{self.held_to.capitalize()}Bits" if self.held_to else str(self.width)


@dataclass(frozen=True)
class Register:
    name: str
    address: int
    text: str
    fields: tuple
    strobe: bool  # each write gives a pulse _written

    @property
    def writable(self):
        return any(field.kind in ("setting", "command") for field in self.fields)


@dataclass(frozen=True)
class Group:
    name: str
    title: str
    feature: bool
    at_frame: bool
    registers: tuple

    @property
    def parameter(self):
        return "".join(part.capitalize() for part in self.name.split("_"))


def _field(group, register, field):
    member = register if field.inst_name == "value" else f"{register}_{field.inst_name}"
    prefix, port = f"{group}.{register}", f"{group}_{member}"
    member += "_" * (member in KEYWORDS)
    writable, seen = field.is_sw_writable, field.is_hw_readable
    if field.get_property("group_bits", default=False):
        kind = "features"
    elif field.get_property("width_bits", default=False):
        kind = "width"
    elif field.get_property("singlepulse"):
        kind = "command"
    elif writable:
        kind = "setting"
    else:
        kind = "status" if field.is_hw_writable else "constant"
    reset = field.get_property("reset")
    if kind != "status" and reset is None:
        sys.exit(f"{SOURCE}: {prefix}.{field.inst_name} has no reset value")
    if kind == "command" and field.width != 1:
        sys.exit(f"{SOURCE}: {prefix}.{field.inst_name} is a pulse and must be one bit")
    assert seen or kind in ("status", "constant", *OWN), field.inst_name
    signed, held_to = (
        field.get_property("is_signed", default=False),
        field.get_property("held_to", default=""),
    )
    if held_to and (held_to not in HELD or HELD[held_to] != field.width):
        sys.exit(f"{SOURCE}: {prefix}.{field.inst_name} is held to no width of {', '.join(HELD)}")
    return Field(
        field.inst_name, port, member, field.high, field.low, kind, reset or 0, bool(signed), held_to
    )


def read():
    """The groups of rtl/registers.rdl."""
    compiler = RDLCompiler()
    try:
        compiler.compile_file(str(ROOT / SOURCE))
        top = compiler.elaborate().top
    except RDLCompileError:
        sys.exit(1)  # the compiler has printed the error
    groups = []
    for group in top.children():
        registers = []
        for register in group.children():
            fields = tuple(_field(group.inst_name, register.inst_name, f) for f in register.fields())
            strobe = any(field.get_property("swmod") for field in register.fields())
            text = register.get_property("desc")
            registers.append(Register(register.inst_name, register.absolute_address, text, fields, strobe))
        groups.append(
            Group(
                group.inst_name,
                group.get_property("name"),
                bool(group.get_property("group_feature", default=False)),
                bool(group.get_property("at_frame", default=False)),
                tuple(registers),
            )
        )
    return groups


def _bits(width):
    return "" if width == 1 else f"[{width - 1}:0]"


def settings(groups):
    """Every setting as (name of its port, width, reset value), in the order of the parameter Resets."""
    fields = [(f, r, g) for g in groups for r in g.registers for f in r.fields if f.kind == "setting"]
    return [(field.port, field.width, field.reset) for field, _, _ in fields]


def _structs(groups):
    """{"cfg": [(group, [(member, bits)])], "status": ...}: the core's settings and its status outputs."""
    made = {"cfg": [], "status": []}
    for group in groups:
        cfg, status = [], []
        for register in group.registers:
            for field in register.fields:
                if field.kind not in ("constant", *OWN):
                    (status if field.kind == "status" else cfg).append((field.member, field.width))
            if register.strobe:
                cfg.append((f"{register.name}_written", 1))
        for name, members in (("cfg", cfg), ("status", status)):
            if members:
                made[name].append((group.name, members))
    return made


def package(groups):
    """The package: structs of settings and status, width and default of msn_registers' parameter Resets."""
    width, value = 0, 0
    for _, bits, reset in settings(groups):
        value |= reset << width
        width += bits
    lines = []
    for kind, listed in _structs(groups).items():
        for group, members in listed:
            lines += ["  typedef struct packed {"]
            lines += [f"    logic {_bits(bits):6} {member};" for member, bits in members]
            lines += [f"  }} {group}_{kind}_t;", ""]
        lines += ["  typedef struct packed {"]
        lines += [f"    {group}_{kind}_t {group};" for group, _ in listed]
        lines += [f"  }} {kind}_t;", ""]
    return PACKAGE.format(made=MADE, structs="\n".join(lines), width=width, value=value).lstrip("\n")


def rtl(groups):
    """The module: decoder, a process per group (settings, in two registers if a change waits), read word."""
    parameters, body, words, hits, writable, waiting = [], [], [], [], [], []
    places, at = {}, 0
    for port, width, _ in settings(groups):
        places[port] = f"Resets[{at}+:{width}]" if width > 1 else f"Resets[{at}]"
        at += width
    for group in groups:
        enable = f"{group.parameter} && " if group.feature else ""
        if group.feature:
            parameters.append(f"parameter bit {group.parameter} = 1'b1")
        process = Process(group, places)
        body += ["", f"  // {group.name}"]
        for register in group.registers:
            base = f"{group.name}_{register.name}"
            names = f"{base}_hit, {base}_write" if register.writable else f"{base}_hit"
            body.append(f"  logic {names};")
            body.append(f"  assign {base}_hit = {enable}word == 10'h{register.address >> 2:03x};")
            hits.append(f"{base}_hit")
            if register.writable:
                body.append(f"  assign {base}_write = {base}_hit && write;")
                writable.append(f"{base}_hit")
            if register.strobe:
                process.pulse(f"cfg_o.{group.name}.{register.name}_written", f"{base}_write")
            parts, at = [], 32
            for field in sorted(register.fields, key=lambda f: -f.high):
                if at > field.high + 1:
                    parts.append(f"{at - field.high - 1}'d0")
                parts.append(process.field(field, base))
                at = field.low
            if at:
                parts.append(f"{at}'d0")
            joined = parts[0] if len(parts) == 1 else "{" + ", ".join(parts) + "}"
            words.append((f"{base}_hit", joined))
        body += process.lines()
        if group.at_frame:
            waiting.append(f"{group.name}_pending")
    lines = [*HEADER.strip("\n").split("\n"), ""]
    lines.append("module msn_registers #(")
    parameters.append("parameter logic [msn_registers_pkg::ResetBits-1:0] Resets = msn_registers_pkg::Reset")
    parameters += [f"parameter int unsigned {name.capitalize()}Bits = {bits}" for name, bits in HELD.items()]
    lines.append(",\n".join(f"  {p}" for p in parameters))
    lines.append(") (")
    lines += PORTS.strip("\n").split("\n")
    lines += [");", ""]
    for name, bits in HELD.items():
        width = f"{name.capitalize()}Bits"
        lines += [
            f"  if ({width} < 1 || {width} > {bits}) begin : gen_check_{name}_bits",
            f'    $fatal(1, "msn_registers: {width} = %0d must lie in 1 .. {bits}", {width});',
            "  end",
        ]
    lines += ["", *_features(groups), *DECODE.strip("\n").split("\n"), *body, ""]
    lines += [f"  assign pending_o = {' || '.join(waiting)};", ""]
    lines += ["  // Which register, a clock after the address: decoding takes one clock, the word another."]
    lines += ["  logic " + ", ".join(f"{hit}_q" for hit in hits) + ";"]
    lines += ["  always_ff @(posedge clk_i) begin"]
    lines += [f"    {hit}_q <= {hit};" for hit in hits]
    lines += ["  end", "", "  logic hit, writable;"]
    lines += ["  assign hit      = " + "\n      || ".join(f"{hit}_q" for hit in hits) + ";"]
    lines += ["  assign writable = " + "\n      || ".join(f"{hit}_q" for hit in writable) + ";"]
    lines += ["", "  logic [31:0] read_word;"]
    terms = [f"({{32{{{hit}_q}}}} & {word})" for hit, word in words]
    lines += ["  assign read_word = " + "\n      | ".join(terms) + ";", ""]
    lines += ANSWER.strip("\n").split("\n")
    return "\n".join(lines) + "\n"


def _own(field):
    """The module's parameter that a field returns when read."""
    return "Features" if field.kind == "features" else f"{field.name.capitalize()}Bits"


def _features(groups):
    """One bit for each group that may be absent."""
    names = [group.parameter for group in groups if group.feature]
    return [f"  localparam logic [{len(names) - 1}:0] Features = {{{', '.join(reversed(names))}}};", ""]


class Process:
    """The flip-flops of a group, written by one process; ``places``: positions of the reset values."""

    def __init__(self, group, places):
        self.group, self.places = group, places
        self.declared, self.each, self.committed, self.resets, self.writes = [], [], [], [], []

    def pulse(self, name, value):
        self.each.append(f"{name} <= {value};")
        self.resets.append(f"{name} <= 1'b0;")

    def field(self, field, base):
        """Add the flip-flops of one field; return the expression that a read returns."""
        member, width = f"{self.group.name}.{field.member}", field.width
        slice_ = f"[{field.high}:{field.low}]" if width > 1 else f"[{field.low}]"
        if field.kind == "constant":
            return f"{width}'h{field.reset:x}"
        if field.kind in OWN:
            return f"{width}'({_own(field)})"
        if field.kind == "status":
            return f"status_i.{member}"
        shown = f"cfg_o.{member}"
        if field.kind == "command":
            self.pulse(shown, f"{base}_write && mask[{field.low}] && bus_wdata_i{slice_}")
            return "1'b0"
        waits = self.group.at_frame
        held = f"{field.port}_q" if waits or field.held_to else shown
        if held != shown:
            self.declared.append(f"logic {_bits(width)}{' ' if width > 1 else ''}{held};")
        self.writes.append(f"{base}_write")
        merged = f"({held} & ~mask{slice_}) | (bus_wdata_i{slice_} & mask{slice_})"
        self.each.append(f"if ({base}_write) {held} <= {merged};")
        constant = self.places[field.port]
        self.resets.append(f"{held} <= {constant};")
        if not field.held_to:
            if waits:
                self.committed.append(f"{shown} <= {held};")
                self.resets.append(f"{shown} <= {constant};")
            return held
        fit, name = f"{field.port}_fit", "".join(part.capitalize() for part in field.port.split("_"))
        self.declared += [f"logic [{width - 1}:0] {fit};", f"assign {fit} = {_fit(field, held)};"]
        if waits:
            self.declared.append(f"localparam logic {_bits(width)} {name}Reset = {constant};")
            self.committed.append(f"{shown} <= {fit};")
            self.resets.append(f"{shown} <= {_fit(field, f'{name}Reset')};")
        else:
            self.declared.append(f"always_comb {shown} = {fit};")
        return fit

    def lines(self):
        if not self.each:
            return []
        each, resets, pending = self.each, self.resets, f"{self.group.name}_pending"
        if self.group.at_frame:
            self.declared.append(f"logic {pending};")
            any_write = " || ".join(dict.fromkeys(self.writes))
            each = [*each, "if (commit_i) begin", *(f"  {line}" for line in self.committed)]
            each += [f"  {pending} <= 1'b0;", "end", f"if ({any_write}) {pending} <= 1'b1;"]
            resets = [*resets, f"{pending} <= 1'b0;"]
        return [
            *(f"  {line}" for line in self.declared),
            "  always_ff @(posedge clk_i) begin",
            *(f"    {line}" for line in each),
            "    if (rst_i) begin",
            *(f"      {line}" for line in resets),
            "    end",
            "  end",
        ]


def _fit(field, value):
    """``value`` saturated to the bits that the build has for the field."""
    bits, width, top = field.parameter, field.width, field.width - 1
    if not field.signed:
        # One bit more: a shift by the full width would be out of range in a build with all bits.
        return f"({{1'b0, {value}}} >> {bits}) == '0 ? {value} : {width}'({{{bits}{{1'b1}}}})"
    beyond, sign = f"{value}[{top}:{bits}-1]", f"{value}[{top}]"
    ends = f"{{{{({width + 1}-{bits}){{{sign}}}}}, {{({bits}-1){{!{sign}}}}}}}"
    return f"(&{beyond} || !(|{beyond})) ? {value} : {ends}"


HEADER = f"""
// SPDX-License-Identifier: Apache-2.0
//
// {MADE}
//
// The registers of the core. bus_valid_i for one clock asks; bus_done_o answers two clocks later, once; an
// access is an error, and changes nothing, at an address without a register in this build, at one that is no
// multiple of four, and for a write where all is read-only. bus_strobe_i: the bytes that a write changes. A
// group that waits for a frame's boundary, commit_i, keeps two copies: a read sees what was written, the core
// what was committed.
// Resets: the reset value of every setting, in the page's order, the first lowest. Without a bus: constants.
// Some settings are wider than the build has bits for. What was written is kept byte by byte; what a read and
// the core get is held at the ends of DetailBits, TimerBits, LoadBits or OffsetBits: the lowest bits say all.
// Model: model/meissner/twins/link/registers.py

// verilog_lint: waive-start line-length
"""

PACKAGE = """
// SPDX-License-Identifier: Apache-2.0
//
// {made}
//
// A struct per group of registers: what the core gets of it, what it gives. Members have no sign: `signed'()`
// where docs/registers.md has one. And the settings' reset values as one number, the first setting lowest.

// verilog_lint: waive-start line-length

package msn_registers_pkg;

{structs}
  localparam int unsigned ResetBits = {width};
  // A default: builds that give their own values do not use it.
  // verilator lint_off UNUSEDPARAM
  localparam logic [ResetBits-1:0] Reset = {width}'h{value:x};
  // verilator lint_on UNUSEDPARAM

endpackage
"""

PORTS = """
  input  logic        clk_i,
  input  logic        rst_i,

  input  logic        bus_valid_i,
  input  logic        bus_write_i,
  input  logic [11:0] bus_address_i,
  input  logic [31:0] bus_wdata_i,
  input  logic [3:0]  bus_strobe_i,
  output logic        bus_done_o,
  output logic        bus_error_o,
  output logic [31:0] bus_rdata_o,

  input  logic        commit_i,   // between two frames: what groups that wait were given takes effect
  output logic        pending_o,  // some wait for it
  output msn_registers_pkg::cfg_t    cfg_o,
  input  msn_registers_pkg::status_t status_i
"""

DECODE = """
  logic        write;
  logic [9:0]  word;
  logic [31:0] mask;
  assign write = bus_valid_i && bus_write_i && bus_address_i[1:0] == 2'd0;
  assign word  = bus_address_i[11:2];
  assign mask  = {{8{bus_strobe_i[3]}}, {8{bus_strobe_i[2]}}, {8{bus_strobe_i[1]}}, {8{bus_strobe_i[0]}}};
"""

ANSWER = """
  logic asked, wrote, odd;
  always_ff @(posedge clk_i) begin
    asked       <= bus_valid_i;
    wrote       <= bus_write_i;
    odd         <= bus_address_i[1:0] != 2'd0;
    bus_done_o  <= asked;
    bus_error_o <= !hit || odd || (wrote && !writable);
    bus_rdata_o  <= (wrote || odd) ? 32'd0 : read_word;
    if (rst_i) begin
      asked      <= 1'b0;
      bus_done_o <= 1'b0;
    end
  end

endmodule
"""


def python(groups):
    lines = [
        "# ruff: noqa: E501 - the texts are as long as their source's",
        f'"""The register map. {MADE}"""',
        "",
        "from meissner.twins.link.register import Field, Group, Register",
        "",
    ]
    lines.append("GROUPS = (")
    for group in groups:
        lines.append(
            f"    Group({group.name!r}, {group.title!r}, {group.feature}, {group.at_frame}, (".replace(
                "'", '"'
            )
        )
        for register in group.registers:
            fields = ", ".join(
                f'Field("{f.name}", {f.high}, {f.low}, "{f.kind}", {f.reset:#x}'
                + (f', {f.signed}, "{f.held_to}")' if f.signed or f.held_to else ")")
                for f in register.fields
            )
            lines.append(
                f'Register("{register.name}", {register.address:#05x}, {register.text!r}, ({fields},)'
                + (", True)," if register.strobe else "),")
            )
        lines.append("    )),")
    lines.append(")")
    ruff = [str(Path(sys.executable).parent / "ruff"), "format", "--quiet", "-"]
    text = "\n".join(lines)
    return subprocess.run(ruff, cwd=ROOT, input=text, capture_output=True, text=True, check=True).stdout


def c_header(groups):
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
        for register in group.registers:
            base = f"MSN_{group.name}_{register.name}".upper()
            lines.append(f"#define {base} 0x{register.address:03x}u")
            for field in register.fields:
                if field.name != "value":
                    lines.append(f"#define {base}_{field.name.upper()}_SHIFT {field.low}")
                    lines.append(f"#define {base}_{field.name.upper()}_BITS {field.width}")
    return "\n".join([*lines, "", "#endif"]) + "\n"


def page(groups):
    lines = ["# Registers", "", f"{MADE}", ""]
    lines += [
        "Addresses count bytes; every register is a word of 32 bits. The core answers with an error if an",
        "address has no register in this build, or if a write goes to a register that can only be read. A",
        "group marked *at a frame's boundary* changes as a whole between two frames.",
        "",
        "A build without registers (`registers = false`: `slip1`, and every build for the iCEBreaker)",
        "answers no access. Its settings are those of its configuration, and a host can only receive its",
        "packets.",
    ]
    for group in groups:
        when = ", settings take effect at a frame's boundary" if group.at_frame else ""
        lines += [
            "",
            f"## `{group.name}`: {group.title}{when}",
            "",
            "| address | name | bits | access | reset | |",
            "|---|---|---|---|---|---|",
        ]
        for register in group.registers:
            for index, field in enumerate(sorted(register.fields, key=lambda f: f.low)):
                name = register.name if field.name == "value" else f"{register.name}.{field.name}"
                bits = f"{field.high}:{field.low}" if field.width > 1 else f"{field.low}"
                access = {
                    "setting": "read, write",
                    "command": "write 1",
                    "status": "read",
                    "constant": "read",
                    **dict.fromkeys(OWN, "read"),
                }[field.kind]
                reset = "" if field.kind in ("status", *OWN) else f"{field.reset:#x}"
                text = register.text if index == 0 else ""
                lines.append(
                    f"| 0x{register.address:03x} | `{name}` | {bits} | {access} | {reset} | {text} |"
                )
    return "\n".join(lines) + "\n"


def proof(groups):
    """The map for tb/formal/registers.sv: each field with its word, its bits and its member."""
    lines, index, place, waiting = [], 0, 0, []
    for group in groups:
        on = group.parameter if group.feature else "1'b1"
        first, waits = index, int(group.at_frame)
        for register in group.registers:
            word = f"10'h{register.address >> 2:03x}"
            for field in register.fields:
                begin = f"{index}, {on}, {word}, {field.low}"
                name = f"{field.port}, {group.name}.{field.member}"
                if field.kind == "setting":
                    inner = (
                        f"dut.{field.port}_q"
                        if waits or field.held_to
                        else f"cfg_o.{group.name}.{field.member}"
                    )
                    ends = f"{field.parameter}, {int(field.signed)}"
                    lines.append(
                        f"`SETTING({begin}, {field.width}, {place}, {name}, {waits}, {inner}, {ends})"
                    )
                    place += field.width
                elif field.kind == "status":
                    lines.append(f"`STATUS({begin}, {field.width}, {name})")
                elif field.kind in ("constant", *OWN):
                    value = _own(field) if field.kind in OWN else field.reset
                    lines.append(f"`CONSTANT({begin}, {field.width}, {value})")
                else:
                    lines.append(f"`COMMAND({begin}, {name})")
                index += 1
            if register.strobe:
                name = f"{group.name}_{register.name}, {group.name}.{register.name}_written"
                lines.append(f"`WRITTEN({on}, {word}, {name})")
        if group.at_frame:
            lines.append(f"`PENDING({group.name}, {first}, {index - first})")
            waiting.append(f"{group.name}_waits")
    head = [
        "// SPDX-License-Identifier: Apache-2.0",
        f"// {MADE}",
        "",
        f"localparam int unsigned Fields = {index};",
        "logic [Fields-1:0]    there, writable, written;",
        "logic [32*Fields-1:0] bits;",
        *(line.strip() for line in _features(groups)[:1]),
    ]
    last = f"always_comb if (started) assert (pending_o == ({' || '.join(waiting)}));"
    return "\n".join([*head, *lines, last]) + "\n"


OUTPUTS = {
    "rtl/link/msn_registers_pkg.sv": package,
    "rtl/link/msn_registers.sv": rtl,
    "model/meissner/twins/link/register_map.py": python,
    "host/msn_registers.h": c_header,
    "docs/registers.md": page,
    "tb/formal/registers_map.svh": proof,
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="write nothing; fail where a file differs")
    check = parser.parse_args().check
    groups = read()
    stale = []
    for name, make in OUTPUTS.items():
        path, text = ROOT / name, make(groups)
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
