"""A board's top and its constraints, generated from a plan of its pins (meissner.builds.pins).

top(plan)                 SystemVerilog: the ports, the clock, rtl/boards/msn_board.sv, the LEDs
constraints(plan, ".lpf") for nextpnr (.pcf, .lpf, .cst) or Vivado (.xdc)
"""

from collections.abc import Iterator

from meissner.builds.pins import Plan

# Ports of msn_board by the roles of the plan.
OUTPUTS = {
    "row": "row_o",
    "group": "group_o",
    "cs_n": "adc_cs_n_o",
    "sclk": "adc_sclk_o",
    "mosi": "adc_mosi_o",
    "convst": "adc_convst_o",
    "reset": "adc_reset_o",
    "pwm": "pwm_o",
}
INPUTS = {"miso": "adc_miso_i", "busy": "adc_busy_i", "moving": "moving_i", "rx": "rx_i"}
DIRECTIONS = {"in": "input  logic", "out": "output logic", "inout": "inout  wire"}
DISPLAY = (
    "hv_data",
    "hv_clk",
    "hv_le",
    "hv_bl",
    "hv_pol",
    "hv_dir",
)  # outputs of a core with a display alone
FLAGS = ("slip", "gross", "touched", "pressed")


def top(plan: Plan) -> str:
    """The board's top as SystemVerilog."""
    board, roles = plan.board, plan.roles
    name, clock = board.name, board.clock["port"]
    ports = ",\n".join(
        f"  {DIRECTIONS[port.direction]} "
        + (f"[{len(port.pins) - 1}:0] " if len(port.pins) > 1 else "")
        + port.port
        for port in plan.ports
    )
    wires = {"clk_i": "clk", "good_i": "good"}
    wires |= {of: roles[role].port if role in roles else f"unused_{role}" for role, of in OUTPUTS.items()}
    wires |= {of: roles[role].port if role in roles else "'0" for role, of in INPUTS.items()}
    wires |= {INPUTS[role]: f"!{roles[role].port}" for role in board.inverted}
    wires |= {roles[role].port: roles[role].port for role in ("slip_each", *DISPLAY) if role in roles}
    wires |= {"tx_o": roles["tx"].port} | {f"{flag}_o": flag for flag in FLAGS}
    sdram = "sdram_dq" in roles
    wires |= {"sdram_o": "sdram", "sdram_dq_i": "sdram_dq_io"} if sdram else {}
    wired = ",\n".join(f"    .{port:<12}({wire})" for port, wire in wires.items())
    idle = [wire for wire in wires.values() if wire.startswith("unused_")]  # of one bit each
    named = [["clk", "good", *FLAGS], idle] if idle else [["clk", "good", *FLAGS]]
    declared = "\n".join(f"  logic {', '.join(names)};" for names in named)
    rest = [(port.port, f"1'b{port.idle}") for port in plan.ports if port.idle is not None]
    rest += [(led, told["shows"]) for led, told in board.leds.items()]
    rest += [(roles[flag].port, flag) for flag in FLAGS if flag in roles]
    rest += [(f"sdram_{line}_o", f"sdram.{line}") for line in SDRAM if sdram]
    rest += [("sdram_dq_io", "sdram.dq_enable ? sdram.dq : 16'bz")] if sdram else []
    assigned = "\n".join(f"  assign {port} = {level};" for port, level in rest)
    return f"""// SPDX-License-Identifier: Apache-2.0
//
// Written by tools/make/synth.py: the {name} with {plan.config}, its pins and nothing else. docs/boards.md.

`include "msn_build.svh"  // the configuration

module {name}_top (
{ports}
);

{declared}
{_sdram_clock() if sdram else ""}  {name}_clock u_clock (
    .{clock},
    .clk_o (clk),
    .good_o(good)
  );

  msn_board u_board (
{wired}
  );

{assigned}

endmodule
"""


SDRAM = ("cke", "cs_n", "ras_n", "cas_n", "we_n", "ba", "a", "dqm")  # lines from the controller


def _sdram_clock() -> str:
    """The SDRAM's clock, inverted, from an output register of an ECP5 with two edges (docs/sdram.md)."""
    ports = ".SCLK(clk), .RST(1'b0), .D0(1'b0), .D1(1'b1), .Q(sdram_clk_o)"
    return f"  msn_pkg::sdram_t sdram;\n  ODDRX1F u_sdram_clk ({ports});\n\n"


def _pcf(plan: Plan) -> Iterator[str]:
    yield f"set_frequency {plan.board.clock['port']} {plan.board.clock['mhz']:g}"
    for port in plan.ports:
        if port.pull == "down":
            raise ValueError(
                f"constraints/{plan.board.name}.toml: an iCE40 has no pull-down, which {port.port} needs"
            )
        pull = "-pullup yes " if port.pull == "up" else ""
        for bit, pin in port.bits:
            yield f"set_io {pull}{bit} {pin}"


def _lpf(plan: Plan) -> Iterator[str]:
    yield f'FREQUENCY PORT "{plan.board.clock["port"]}" {plan.board.clock["mhz"]:.1f} MHZ;'
    for port in plan.ports:
        pull = f"PULLMODE={port.pull.upper()} " if port.pull else ""
        drive = "" if port.is_input else " DRIVE=4"
        for bit, pin in port.bits:
            yield f'LOCATE COMP "{bit}" SITE "{pin}";'
            yield f'IOBUF PORT "{bit}" {pull}IO_TYPE=LVCMOS33{drive};'


def _cst(plan: Plan) -> Iterator[str]:
    for port in plan.ports:
        pull = f" PULL_MODE={port.pull.upper()}" if port.pull else ""
        for bit, pin in port.bits:
            yield f'IO_LOC "{bit}" {pin};'
            yield f'IO_PORT "{bit}" IO_TYPE=LVCMOS33{pull};'


def _xdc(plan: Plan) -> Iterator[str]:
    pulls = {"up": " PULLUP TRUE", "down": " PULLDOWN TRUE"}
    clock = plan.board.clock["port"]
    for port in plan.ports:
        for bit, pin in port.bits:
            pull = pulls.get(port.pull or "", "")
            yield f"set_property -dict {{PACKAGE_PIN {pin} IOSTANDARD LVCMOS33{pull}}} [get_ports {{{bit}}}]"
    period = 1000 / plan.board.clock["mhz"]
    yield f"create_clock -period {period:.3f} -name {clock} [get_ports {clock}]"
    # Inputs and outputs are synchronised, or slower than 20 MHz with half a period of slack.
    ways: dict[str, list[str]] = {"from": [], "to": []}
    for port in plan.ports:
        if port.role != "clock":
            bits = port.port if len(port.pins) == 1 else f"{port.port}[*]"
            ways["from" if port.is_input else "to"].append(bits)
    for way, ports in ways.items():
        yield f"set_false_path -{way} [get_ports {{{' '.join(ports)}}}]"
    yield "set_property CFGBVS VCCO [current_design]"
    yield "set_property CONFIG_VOLTAGE 3.3 [current_design]"


FORMATS = {".pcf": _pcf, ".lpf": _lpf, ".cst": _cst, ".xdc": _xdc}


def constraints(plan: Plan, suffix: str) -> str:
    """The pins in the format of files with this ``suffix``."""
    remark = "//" if suffix == ".cst" else "#"
    head = f"{remark} Written by tools/make/synth.py: the {plan.board.name} with {plan.config}"
    return "\n".join([head, f"{remark} Pins: {plan.board.source}", *FORMATS[suffix](plan)]) + "\n"
