"""Place and route single blocks: the worst and the median Fmax of three seeds, the area, and the latency.

    python tools/make/fmax.py                    every entry of TABLE on each of its targets
    python tools/make/fmax.py 'divide*'          only these entries
    python tools/make/fmax.py --list             list the entries
    python tools/make/fmax.py --record 'slip*'   also record them in constraints/fmax.json
    python tools/make/fmax.py haar-1 --seeds 1 2 3 4 5
    python tools/make/fmax.py --sources DIR --top NAME [--set P=2] [--tie PORT=0] [--clock clk] FILE...
                                                 your own module, of Verilog files in DIR, on the ECP5

A generated Verilog harness shifts every input of the block in through one pin and folds every output into
one pin, with registers on both sides, so that neither the pin count nor pin timing matters. The harness's own
cells are subtracted from the area. Ports that an entry ties (an input to a number, an output left open with
None) are not in the harness, so synthesis optimises them away. The logs are in build/fmax.
"""

import argparse
import json
import shutil
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from fnmatch import fnmatch
from pathlib import Path
from statistics import median
from threading import Lock
from typing import NamedTuple

from meissner.builds.yowasp import ROOT, ToolError, chparam, read_rtl, synthesis, tool, warm_up, yosys
from meissner.tradeoff.area import BLOCKS
from meissner.twins.link.registers import RESET_BITS, members, reset_word, struct_word
from version import record

OUT = Path("build/fmax")  # relative to ROOT: YoWASP sees only files below its working directory
SEEDS = (1, 2, 3)

# Target: synthesis command, place and route command, requested MHz, names of the resources in the report.
TARGETS = {
    "ecp5": {
        "synth": "synth_ecp5",
        "pnr": "nextpnr-ecp5 --25k --package CABGA381 --speed 6 --lpf-allow-unconstrained",
        "freq": 200,
        "area": {"lut": "TRELLIS_COMB", "ff": "TRELLIS_FF", "ram": "DP16KD", "dsp": "MULT18X18D"},
    },
    "up5k": {
        "synth": "synth_ice40 -dsp -device u",
        "pnr": "nextpnr-ice40 --up5k --package sg48 --pcf-allow-unconstrained",
        "freq": 60,
        "area": {"lut": "ICESTORM_LC", "ram": "ICESTORM_RAM", "dsp": "ICESTORM_DSP"},
    },
}


def demod_entries():
    """Entries of msn_am_demod, 12-bit converter and up to 64 periods, by form and samples per period."""
    size = {"SampleBits": 13}
    for name, form, samples, clocks in (
        ("rectifier-4", 0, 4, 12),
        ("rectifier-16", 0, 16, 12),
        ("iq-4", 1, 4, 73),
        ("iq-16", 1, 16, 88),
        ("iq-fast-4", 2, 4, 15),
        ("iq-fast-16", 2, 16, 15),
    ):
        setting = size | {"Form": form, "SamplesPerPeriod": samples}
        yield f"am_demod-{name}", ("msn_am_demod", setting, clocks, "ecp5 up5k")
    yield "am_demod-iq-4x8", ("msn_am_demod", size | {"Lanes": 8}, 500, "ecp5")


def cop_entries():
    """Entries of msn_cop by fraction bits and quotient bits per clock."""
    for bits in (4, 14, 20):
        for per_clock in (1, 2):
            digits = bits + 1 if per_clock == 1 else (bits + 3) // 2
            size = {"Rows": 64, "Columns": 64, "FractionBits": bits, "BitsPerClock": per_clock}
            yield f"cop-64x64-q{bits}-turn{per_clock}", ("msn_cop", size, 3 + digits, "ecp5 up5k")


# The slip chain of a core. One rubber sensor at 12 MHz: thresholds and times tied, the counters left open.
SLIP_TIED = {"cop_valid_i": 0, "cop_i": 0}
SLIP1 = {"Channels": 1, "SampleBits": 13, "TimerBits": 10}
SLIP1_SETTINGS = {name: 0 for name in members("slip")} | {
    **{"threshold": 23, "gross_threshold": 200, "keep_threshold": 11, "contact_level": 7000},
    **{"release_level": 7400, "hold": 100, "refractory": 50, "blank": 250},
}
SLIP1_TIED = SLIP_TIED | {
    "cfg_i": struct_word("slip", SLIP1_SETTINGS, {"detail": 14, "timer": 10}),
    **dict.fromkeys(("actuator_moving_i", "in_id_i", "in_mask_i"), 0),
    "in_last_i": 1,
    "status_o": None,
}
# The whole core of slip1: from the converter's pins to packets on the line.
SLIP1_RESETS = {"adc.enable": 1, "adc.period": 1200} | {f"slip.{n}": v for n, v in SLIP1_SETTINGS.items()}
SLIP1_CORE = SLIP1 | {
    **{"Adc": 1, "ClkKhz": 12000, "SclkKhz": 2000, "BaudHz": 1000000, "SlipOnly": 1, "Registers": 0},
    "Resets": f"{RESET_BITS}'h{reset_word(SLIP1_RESETS):x}",
}
CORE_TIED = {
    **dict.fromkeys(
        ("adc_busy_i", "actuator_moving_i", "in_valid_i", "in_data_i", "in_id_i", "in_last_i"), 0
    ),
    **dict.fromkeys(("bus_valid_i", "bus_write_i", "bus_address_i", "bus_wdata_i", "bus_strobe_i"), 0),
    **{"rx_i": 1, "out_ready_i": 1, "verdict_o": None, "decision_o": None, "in_ready_o": None},
}

AD7606 = {"Part": 2, "Lanes": 2, "ClkKhz": 100000}
UNCOUNTED = dict.fromkeys(("dropped_o", "overrun_o", "timeout_o", "mistagged_o", "over_range_o"))

# Nine features, two classes, 4096 nodes in all.
FOREST = {"Features": 9, "Trees": 64}
FOREST_TIED = {
    **dict.fromkeys(("req_ready_i", "rsp_valid_i", "rsp_tag_i", "rsp_data_i"), 0),
    **dict.fromkeys(("req_valid_o", "req_bank_o", "req_address_o", "req_tag_o")),
}

# Name: module, parameters, latency in clocks for the ns figure (or None), targets, tied ports (or nothing).
ALONE = {"Health": 0, "Tare": 0, "Tap": 0}  # calibration and centre of pressure
LARGE = {"Rows": 1024, "Columns": 1024, "Lanes": 8}
TABLE = {
    "slip-1024": ("msn_slip_chain", {"Channels": 1024}, 6, "ecp5 up5k", SLIP_TIED),
    "slip-64": ("msn_slip_chain", {"Channels": 64}, 6, "ecp5 up5k", SLIP_TIED),
    "slip-1": ("msn_slip_chain", {"Channels": 1}, 6, "ecp5 up5k", SLIP_TIED),
    "slip-64-half": ("msn_slip_chain", {"Channels": 64, "Hop": 32}, 7, "ecp5", SLIP_TIED),
    "slip-64-sliding": ("msn_slip_chain", {"Channels": 64, "Hop": 2}, 8, "ecp5", SLIP_TIED),
    "slip1-path": ("msn_slip_chain", SLIP1 | {"Serial": 1}, 18, "up5k", SLIP1_TIED),
    "slip1-path-parallel": ("msn_slip_chain", SLIP1, 6, "up5k", SLIP1_TIED),
    "slip1": ("msn_core", SLIP1_CORE | {"Serial": 1, "AdcPeriod": 1200}, None, "up5k", CORE_TIED),
    "slip1-adc_spi": ("msn_core", SLIP1_CORE | {"Serial": 1}, None, "up5k", CORE_TIED),
    "slip1-parallel": ("msn_core", SLIP1_CORE, None, "up5k", CORE_TIED),
    **dict(demod_entries()),
    "haar-1": ("msn_haar", {"Channels": 1, "SampleBits": 16, "Level": 2}, 2, "ecp5"),
    "haar-1-level3": ("msn_haar", {"Channels": 1, "SampleBits": 16, "Level": 3}, 3, "ecp5"),
    "haar-8": ("msn_haar", {"Channels": 8, "SampleBits": 16, "Level": 2}, 2, "ecp5"),
    "divide-34": ("msn_divide", {}, 9, "ecp5"),
    "divide-34-turn1": ("msn_divide", {"BitsPerClock": 1}, 16, "ecp5"),
    "adc_spi-ad7606": ("msn_adc_spi", AD7606, None, "ecp5"),
    "adc_spi-ad7606-uncounted": ("msn_adc_spi", AD7606, None, "ecp5", UNCOUNTED),
    "adc_spi-ad7606c-16": ("msn_adc_spi", AD7606 | {"Part": 6, "Lanes": 8}, None, "ecp5"),
    "adc_spi-max11123": (
        "msn_adc_spi",
        {"Part": 3, "ClkKhz": 25000, "SclkKhz": 16000, "Trigger": 1, "SampleBits": 13},
        None,
        "ecp5 up5k",
    ),
    "scan-64x64": ("msn_scan", {"Rows": 64, "Columns": 64, "SampleBits": 13}, 5, "ecp5 up5k"),
    "scan-64x64x8": ("msn_scan", {"Rows": 64, "Columns": 64, "Lanes": 8, "SampleBits": 17}, 5, "ecp5"),
    "cop_accumulate-64x64": ("msn_cop_accumulate", {"Rows": 64, "Columns": 64}, 2, "ecp5 up5k"),
    "cop_accumulate-1024x1024x8": ("msn_cop_accumulate", LARGE, 5, "ecp5"),
    "cop-1024x1024x8-q14-turn1": ("msn_cop", LARGE | {"BitsPerClock": 1}, 21, "ecp5"),
    "cop-1024x1024x8-q14-turn2": ("msn_cop", LARGE, 14, "ecp5"),
    "cop-1024x1024x16-q14-turn1": ("msn_cop", LARGE | {"Lanes": 16, "BitsPerClock": 1}, 22, "ecp5"),
    **dict(cop_entries()),
    "array_forces-64x64": ("msn_array_forces", {"Rows": 64, "Columns": 64} | ALONE, 14, "ecp5"),
    "array_forces-32x32": ("msn_array_forces", {"Rows": 32, "Columns": 32} | ALONE, 14, "ecp5 up5k"),
    "array_forces-1024x1024x8": (
        "msn_array_forces",
        LARGE | ALONE | {"RowColumn": 1, "GainShift": 24, "BitsPerClock": 1},
        36,
        "ecp5",
    ),
    # The UP5K's eight multipliers have 16 bits: samples of 17 bits would need twelve of them.
    "cop4": ("msn_cop4", {}, 17, "ecp5"),
    "cop4-13": ("msn_cop4", {"SampleBits": 13}, 17, "ecp5 up5k"),
    "cop_slip": ("msn_cop_slip", {}, 5, "ecp5 up5k"),
    "cop4-turn1": ("msn_cop4", {"BitsPerClock": 1}, 25, "ecp5"),
    "cop4-13-turn1": ("msn_cop4", {"SampleBits": 13, "BitsPerClock": 1}, 25, "up5k"),
    "cop4-correct": ("msn_cop4", {"Correct": 1}, 37, "ecp5"),
    "cop4_correct": ("msn_cop4_correct", {}, 8, "ecp5"),
    "shear_speed": ("msn_shear_speed", {}, 58, "ecp5"),
    "log2": ("msn_log2", {}, 7, "ecp5 up5k"),
    "exp2": ("msn_exp2", {}, 6, "ecp5 up5k"),
    **{
        f"forest-{engines}": (
            "msn_forest",
            FOREST | {"Engines": engines, "Nodes": 4096 // engines},
            None,
            "ecp5",
            FOREST_TIED,
        )
        for engines in (1, 8)
    },
    "pin_display": ("msn_pin_display", {"ClkKhz": 12_000}, None, "up5k"),
    "pin_display-1000": ("msn_pin_display", {"Pins": 1000, "Chains": 4, "ClkKhz": 48_000}, None, "ecp5"),
    "render": ("msn_render", {}, None, "ecp5 up5k"),
    "grip": ("msn_grip", {}, 4, "ecp5 up5k"),
    "finger_health": ("msn_finger_health", {}, 3, "ecp5 up5k"),
    "packet_slip": ("msn_packet_slip", {"P2pBits": 14}, None, "ecp5 up5k"),
    "cobs-18": ("msn_cobs", {"MaxBytes": 18}, None, "ecp5 up5k"),
    "cobs": ("msn_cobs", {}, None, "ecp5 up5k"),
    "sdram": ("msn_sdram", {}, 16, "ecp5"),
    "uart_tx-1M": ("msn_uart_tx", {}, None, "ecp5 up5k"),
    "uart_tx-3M": ("msn_uart_tx", {"ClkHz": 25000000, "BaudHz": 3000000}, None, "ecp5 up5k"),
    "uart_rx-3M": ("msn_uart_rx", {"ClkHz": 25000000, "BaudHz": 3000000}, None, "ecp5 up5k"),
    "packet-64x64": ("msn_packet", {}, None, "ecp5"),
    "packet-fingertip": ("msn_packet", {"SlipDepth": 16, "Taxels": 0}, None, "ecp5 up5k"),
    "bridge": ("msn_bridge", {}, None, "ecp5 up5k"),
    "link-64x64": ("msn_link", {}, None, "ecp5"),
}


class Block(NamedTuple):
    """An entry of TABLE, or a module of the files ``sources`` in place of rtl/."""

    module: str
    parameters: dict
    clocks: int | None = None
    targets: str = "ecp5"
    tied: dict | tuple = ()
    sources: tuple = ()
    clock: str = "clk_i"

    def read(self, target=None):
        """Yosys's command that reads it."""
        return f"read_verilog -sv {' '.join(self.sources)}" if self.sources else read_rtl(target)


def ports(block, stem):
    """The block's ports with its parameters, without constant outputs: [(name, direction, bits)]."""
    netlist = f"{stem}.ports.json"
    script = f"{block.read()}; {chparam(block.module, block.parameters)}hierarchy -top {block.module}; proc; "
    script += f"write_json {netlist}"
    yosys(script, f"{stem}.ports.log")
    modules = json.loads((ROOT / netlist).read_text())["modules"].values()
    top = next(m for m in modules if int(m["attributes"].get("top", "0"), 2))
    return [
        (name, port["direction"], len(port["bits"]))
        for name, port in top["ports"].items()
        if not all(isinstance(bit, str) for bit in port["bits"])  # a wire has a number, a constant "0" or "1"
    ]


def harness(block, found):
    """Verilog text of the harness."""
    tied = dict(block.tied)
    # A port that no connection names is left open.
    free = [(n, direction, bits) for n, direction, bits in found if n not in (block.clock, *tied)]
    inputs = [(n, bits) for n, direction, bits in free if direction == "input"]
    outputs = [(n, bits) for n, direction, bits in free if direction == "output"]
    ins, outs = sum(bits for _, bits in inputs), sum(bits for _, bits in outputs)
    pins = [f"    .{block.clock}(clk)"]
    for name, _, bits in found:
        if tied.get(name) is not None:
            pins.append(f"    .{name}({bits}'d{tied[name] % (1 << bits)})")
    for vector, group in (("in_q", inputs), ("out_d", outputs)):
        at = 0
        for name, bits in group:
            pins.append(f"    .{name}({vector}[{at + bits - 1}:{at}])")
            at += bits
    setting = ", ".join(f".{name}({value})" for name, value in block.parameters.items())
    connections = ",\n".join(pins)
    text = f"""// Generated by tools/make/fmax.py around {block.module}.
module harness (input wire clk, input wire sdi, output wire sdo);
  reg  [{ins - 1}:0] in_q;
  wire [{outs - 1}:0] out_d;
  reg  [{outs - 1}:0] out_q, fold;
  always @(posedge clk) begin
    in_q  <= {{in_q, sdi}};
    out_q <= out_d;
    fold  <= {{fold, 1'b0}} ^ out_q;
  end
  assign sdo = fold[{outs - 1}];
  {block.module} #({setting}) u_block (
{connections}
  );
endmodule
"""
    return text


def own_area(netlist, target, source):
    """The part of a netlist's area that belongs to the harness in the file ``source``.

    It is counted, not computed from the ports: synthesis removes registers of outputs that turn out constant
    after flattening, and of inputs that the block does not read.
    """
    cells = netlist["modules"]["harness"]["cells"].values()
    own = [c for c in cells if "Q" in c["connections"] and source in c["attributes"].get("src", "")]
    if target == "up5k":  # a cell holds one table and one register
        return {"lut": len(own)}
    held = {c["connections"]["Q"][0] for c in own}
    next_of = {c["connections"]["DI"][0] for c in own}
    folds = 0  # LUTs that combine an output's register with the previous fold's
    for c in cells:
        pins = c["connections"]
        inputs = [pins[pin][0] for pin in "ABCD"] if c["type"] == "LUT4" else []
        read = [bit for bit in inputs if not isinstance(bit, str)]
        folds += bool(read) and pins["Z"][0] in next_of and len(read) == 2 and set(read) <= held
    return {"lut": folds, "ff": len(own)}


def synthesise(name, block, target):
    """Synthesise a block; returns the netlist's stem and the harness's own area."""
    stem = f"{OUT}/{name}-{target}"
    (ROOT / f"{stem}.v").write_text(harness(block, ports(block, stem)))
    script = f"{block.read(target)} {stem}.v; {synthesis(TARGETS[target]['synth'], 'harness')}; "
    script += f"write_json {stem}.json"
    yosys(script, f"{stem}.yosys.log")
    return stem, own_area(json.loads((ROOT / f"{stem}.json").read_text()), target, f"{stem}.v")


def place(stem, target, seed):
    """Place and route with one seed; returns (MHz, resources used)."""
    spec = TARGETS[target]
    pnr, *options = spec["pnr"].split()
    report = f"{stem}-{seed}.report.json"
    options += ["--json", f"{stem}.json", "--freq", str(spec["freq"]), "--timing-allow-fail"]
    options += ["--seed", str(seed), "--report", report]
    tool(f"yowasp-{pnr}", options, f"{stem}-{seed}.pnr.log")
    result = json.loads((ROOT / report).read_text())
    (mhz,) = (clock["achieved"] for clock in result["fmax"].values())
    return mhz, {short: result["utilization"][cell]["used"] for short, cell in spec["area"].items()}


def measure(name, block, target, seeds=SEEDS):
    stem, own = synthesise(name, block, target)
    runs = [place(stem, target, seed) for seed in seeds]
    mhz = [round(m, 2) for m, _ in runs]
    area = {short: used - own.get(short, 0) for short, used in runs[0][1].items()}
    clocks = block.clocks
    return {
        "name": name,
        "target": target,
        "module": block.module,
        "parameters": block.parameters,
        "seeds": list(seeds),
        "mhz": mhz,
        "mhz_worst": min(mhz),
        "clocks": clocks,
        "ns": None if clocks is None else round(1000 * clocks / min(mhz), 1),
        "area": area,
    }


def table(results):
    lines = [
        f"{'block':28} {'target':6} {'MHz':>6} {'median':>6} {'all seeds':>20} {'LUT/LC':>7} {'FF':>6} "
        f"{'RAM':>4} {'DSP':>4} {'clocks':>6} {'ns':>7}"
    ]
    for r in results:
        area = r["area"]
        seeds = " ".join(f"{m:6.1f}" for m in r["mhz"])
        clocks, ns = ("", "") if r["clocks"] is None else (r["clocks"], r["ns"])
        lines.append(
            f"{r['name']:28} {r['target']:6} {r['mhz_worst']:6.1f} {median(r['mhz']):6.1f} {seeds:>20} "
            f"{area['lut']:7} {area.get('ff', ''):>6} {area['ram']:4} {area['dsp']:4} {clocks:>6} {ns:>7}"
        )
    return "\n".join(lines)


def foreign(options):
    """The Block that --sources describes; its files are copied to build/, which YoWASP can see."""
    folder = OUT / options.top
    (ROOT / folder).mkdir(parents=True, exist_ok=True)
    for file in options.names:
        shutil.copyfile(options.sources / file, ROOT / folder / Path(file).name)
    sources = tuple(f"{folder}/{Path(file).name}" for file in options.names)
    pairs = [dict(one.split("=", 1) for one in given) for given in (options.set, options.tie)]
    tied = {port: int(value, 0) if value else None for port, value in pairs[1].items()}
    return Block(options.top, pairs[0], tied=tied, sources=sources, clock=options.clock)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", default=["*"], help="entries, shell patterns; or files of DIR")
    parser.add_argument("-j", "--jobs", type=int, default=1)
    parser.add_argument("--record", action="store_true", help="into constraints/fmax.json too")
    parser.add_argument("--list", action="store_true", help="print the entries and stop")
    parser.add_argument("--seeds", type=int, nargs="+", default=SEEDS)
    parser.add_argument("--sources", type=Path, metavar="DIR", help="measure a module of the files in DIR")
    parser.add_argument("--top", help="its name")
    parser.add_argument("--clock", default="clk", help="its clock's port (%(default)s)")
    parser.add_argument("--set", nargs="*", default=[], metavar="P=VALUE", help="its parameters")
    parser.add_argument(
        "--tie", nargs="*", default=[], metavar="PORT=VALUE", help="inputs; without value: open"
    )
    options = parser.parse_args()
    if options.record and (options.sources or options.seeds != SEEDS):
        parser.error(f"--record is for entries of TABLE, with seeds {SEEDS}")
    if bool(options.sources) != bool(options.top):
        parser.error("--sources and --top go together")
    blocks = {name: Block(*entry) for name, entry in TABLE.items()}
    if options.sources:
        blocks, options.names = {options.top: foreign(options)}, ["*"]
    unknown = [n for n in options.names if not any(fnmatch(entry, n) for entry in blocks)]
    if unknown:
        parser.error(f"no entry matches {unknown[0]}; try --list")
    work = [
        (name, target)
        for name, block in blocks.items()
        for target in block.targets.split()
        if any(fnmatch(name, n) for n in options.names)
    ]
    if options.list:
        for name, target in work:
            print(f"{name:28} {target:6} {blocks[name].module} {blocks[name].parameters}")
        return
    (ROOT / OUT).mkdir(parents=True, exist_ok=True)
    warm_up()

    recording = Lock()

    def job(pair):
        begin = time.monotonic()
        result = measure(pair[0], blocks[pair[0]], pair[1], options.seeds)
        took = time.monotonic() - begin
        print(f"{pair[0]} {pair[1]}: {result['mhz_worst']} MHz, {took:.0f} s", file=sys.stderr, flush=True)
        if options.record:
            with recording:
                record(BLOCKS, {" ".join(pair): result})
        return result

    with ThreadPoolExecutor(options.jobs) as pool:
        results = list(pool.map(job, work))
    print(table(results))


if __name__ == "__main__":
    try:
        main()
    except ToolError as error:
        sys.exit(f"{error}\n{error.tail}")
