"""Fault injection into a block: its tests' recording, a Verilated build of it, what each fault leads to."""

import hashlib
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from meissner.builds import toolchain
from verify import benches, revision

DRIVER = Path(__file__).with_name("faults_driver.cpp")
HERE = toolchain.ROOT / "model/meissner/engines"  # the converters' models
WORK = toolchain.BUILD / "faults"
LONG_S = 3600  # by the clock: a build on a busy machine
COLUMNS = ("injected", "masked", "recovered", "detected", "told", "late", "kept", "silent")
LEFT_OUT = {
    "compare": "no state",
    "constant_multiplier": "no state",
    "axis": "the core behind msn_axil, both done alone",
}

# Frames until what a fault left behind has gone, where that is more than the one it hits: what a window or a
# timer of the block lasts, or what lies inside it.
SETTLE = {
    **{
        "delay": 12,
        "multiply": 4,  # steps: two registers one after the other, shown before the next
        "fifo": 24,
        "spi_shift": 2,
        "burst": 2,
        "adc_single": 3,
        "haar": 8,
        "sliding_extremes": 14,
    },
    **{"peak_to_peak": 24, "slip": 40, "slip_serial": 60, "slip_flags": 20, "slip_path": 160},
    "channels": 28,
    **{
        "tare": 6,
        "time_stamp": 150,  # its recording marks ends that are no ends, too
        "health": 40,
        "calibration_grid": 2,
        "calibrate": 3,
        "cop4": 8,  # samples inside
        "cop_slip": 90,
        "image_store": 4,  # one being written, one that waits, one being read
        "uart_rx": 2,
        "scan_demod": 2,
        "array": 4,
        "core": 2,  # its image is sent while the next frame is scanned
        "am_demod": 3,
        "axil": 3,
        "bridge": 4,  # a zero before and behind each command
        "crc32": 2,  # the sum is there up to the next packet's first byte
        "packet": 8,  # events, images
        "link": 8,
        "cop_accumulate": 2,
        "cop": 3,
        "cop_array": 4,
        "electrodes": 2,
    },
}
# What the driver needs to know about a block, see there.
# Of calibrations: the tables, which of the two is in use and whether any is, until they are written again.
# Of a scan: what it took as it was switched on, until it is switched off; what counts to its next row, frame.
SCAN_TAKEN = "settle_q,period_q,slip_row_q,slip_group_q"
SCAN = ["free=40000", f"kept={SCAN_TAKEN}", "late=left_q,count_q"]
TABLES = "memory,gains,offsets,rows,bank,loaded,cfg_swapping"
# Of zeros: the words, and all on the way to them, a frame of an averaging among it.
ZEROS = "fresh,u_state.,u_round.,zero_,sum_,write,learn,place_q,cfg_loading_o,drain,frames,averaging"
ZEROS += ",commit,forced,asked,dropping,contact,nonzero,over_q,negative,mask_q,seen"
# Of what health knows of a taxel, likewise.
STATES = "state,u_row.,u_up.,u_down.,gen_lane,out_data_o,head,ahead,behind,here,write,learn,place,row_first"
STATES += ",top,bottom,u_taxel."
STATES += ",tick,asked,bank,fresh,again,drain,was_whole"


def inside(instance, names):
    """These names in this instance only."""
    return ",".join(f"{instance}.&{name}" for name in names.split(","))


ARRAY = ",".join([inside("u_calibrate", TABLES), inside("u_tare", ZEROS), inside("u_health", STATES)])
AXIL_INPUTS = "awvalid awaddr awprot wvalid wdata wstrb bready arvalid araddr arprot rready"
# An image that waits, and its time.
PACKETS = ["packets=1", "frame=cop_valid_i", "when=cop_valid_i", "kept=memory,read_time_o,written_time"]
OPTIONS = {
    "delay": ["frame=step_i"],
    "multiply": ["frame=enable_i"],
    "spi_shift": ["frame=start_i", "strobe=word_o", "repeat=4"],
    "burst": ["frame=start_i"],
    "time_stamp": ["frame=last_i"],
    "slip_flags": ["frame=in_valid_i"],
    "calibration_preset": ["kept=all"],  # runs once after a reset: what it spoils is a table
    "calibration_grid": ["frame=last_i", f"kept={TABLES}"],
    "calibrate": [f"kept={TABLES}"],
    "cop_array": [f"kept={TABLES}"],
    "cobs": ["end=0"],
    "crc32": ["frame=clear_i", "join=1", "repeat=4"],
    "packet": [*PACKETS, "slow=40", "rows=700"],
    "packet_slip": ["packets=1", "join=1", "rows=20000"],
    "link": [*PACKETS, "slow=24", "rows=1000"],
    # The zeros, the way to them, and a frame that is missing in them.
    "tare": [f"kept={ZEROS}", "skip=gone"],
    "health": [
        "skip=gone",  # it counts frames, and frames that are missing whole are not seen here
        "ready=event_",  # an event that is not taken at once comes with the next frame
        f"kept={STATES}",
    ],
    # What is not read yet; its time.
    "image_store": [
        "frame=in_last_i",
        "when=in_valid_i",
        "strobe=read_valid_o",
        "kept=memory,read_time_o,written_time",
    ],
    "uart_rx": ["strobe=out_valid_o", "idle=rx_i:38", "repeat=6"],
    "bridge": ["frame=in_data_i:0", "when=in_valid_i", "bus=1"],
    "am_demod": ["frame=in_start_i"],
    "axil": ["bus=1", "inputs=" + ",".join(f"s_axil_{name}" for name in AXIL_INPUTS.split())],
    "haar": ["phases=8"],
    "peak_to_peak": ["phases=8"],
    "slip_serial": ["phases=8"],
    "slip_path": ["phases=16"],
    # Some channels are in contact, some not.
    "channels": [
        "free=60000",
        "part=1",
        "late=left_q",
        "set=cfg_adc_period_i:160,cfg_contact_level_i:d0,cfg_release_level_i:c0",
    ],
    "acquire": ["free=16000", "part=1", "late=left_q"],
    "adc_single": ["free=12000", "part=1"],
    "adc_spi": ["free=16000", "part=1", "late=left_q"],
    "scan_adc": [*SCAN, "part=1"],
    "scan_demod": [*SCAN, "free=60000", "part=5", "carrier=2"],
    # Gains of the recording; no tare, so that what the converter gives is what presses. No taxel fails.
    "array": [
        *SCAN,
        "part=1",
        "lead=16",
        "set=cfg_tare_i:0",
        "quiet=event_",
        f"kept={ARRAY},{SCAN_TAKEN}",
    ],
    "core": [*SCAN, "part=1", "packets=1", "writes=25"],
}
# Writes to registers while it measures, each at 25 clocks of a frame (docs/registers.md).
GAINS = [f"504:{beat:x},508:{3 * beat:x},50c:{0x900 + 0x123 * beat:x},510:1" for beat in range(9)]
WRITES = {
    "core": [
        [f"before={','.join(GAINS)}", "write=514:1"],  # calibration: the other table
        ["write=600:7fffffff"],  # least load
        ["write=30c:1", "same=1"],  # scan: even rows first, the same frame
        ["write=304:40", "same=1"],  # scan: longer to settle
        ["before=900:0", "write=900:1", "same=1"],  # images
        ["write=14:12345678", "same=1"],  # of no meaning
    ]
}
# Parameters of no test: timers that end while a recording lasts.
SHORT = {
    "cop_slip": {"TimerBits": "6"},
    "slip_path": {"TimerBits": "5"},
    "channels": {"Channels": "2", "Window": "4", "Hop": "4", "TimerBits": "3"},
}
# Of the program, not of the recording: packets leave as bytes, and the bus is there.
OTHER = {
    "core": {"Uart": "0"},
    "array": {"Tap": "1", "ClkKhz": "16000"},
    "scan_demod": {"ClkKhz": "32000", "SamplePeriod": "100"},
}
# Blocks that others wait for or that wait for a converter run inside another: that block, the instance.
INSIDE = {
    "adc_store": ("adc_spi", "u_store."),
    "frame_table": ("calibrate", "u_beats."),
    "calibration_table": ("calibrate", "u_table."),
    "scan_plan": ("scan_adc", "u_plan."),
    "scan_buffer": ("scan_adc", "u_buffer."),
    "scan": ("scan_adc", "u_scan."),
}
# Which of the tests' sizes; else the first.
SIZES = {
    "tare": {"Rows": 3, "Columns": 3},
    "health": {"Rows": 3, "Columns": 3},
    "condition": {"Health": 1, "Tare": 1},
    "array_source": {"Part": 1},
    "calibrate": {"Rows": 3, "RowColumn": 0},
    "calibration_table": {"Rows": 3},
    "calibration_grid": {"Rows": 6},
    "haar": {"Level": 2, "Mask": 0},
    "sliding_extremes": {"Channels": 3},
    "peak_to_peak": {"Channels": 3, "Hop": 4, "Mask": 0},
    "slip": {"TimerBits": 4},
    "slip_path": {"Channels": 3, "Window": 16},
    "cop": {"Rows": 3},
    "cop_array": {"Rows": 5},
    "cop_accumulate": {"Rows": 3},
    "array": {"Rows": 2, "Part": 1},
    "acquire": {"Adc": 1, "Channels": 3},
    "channels": {"Adc": 1, "Channels": 8},
    "link": {"Uart": 0},
    "image_store": {"Taxels": 9},
    "slip_serial": {"Window": 8, "TimerBits": 3},
    "scan_adc": {"Rows": 3, "Columns": 3},
}


@dataclass(frozen=True)
class Result:
    kind: str
    where: str
    at: int
    outcome: str
    what: str


def blocks():
    return [name for name in benches.blocks() if name not in LEFT_OUT]


def _header(source, block):
    found = re.search(rf"^module msn_{block}\b(.*?^\);)", source, re.S | re.M)
    return found[1], re.findall(r"^\s*parameter\s[^=]*?(\w+)\s*=", found[1], re.M)


def wrapper(block, source):
    """A top around the block, for a register that is a port of the top cannot be upset."""
    header, names = _header(source, block)
    given = ", ".join(f".{name}({name})" for name in names)
    given = f"#({given}) " if given else ""
    return f"module faults_top{header}\n  msn_{block} {given}u_block (.*);\nendmodule\n"


def run_of(block):
    """The arguments of the bench that is recorded: the first of the block's own that is not refused."""
    told = [run for run in benches.runs(block) if run["block"] == block and run["module"] == f"test_{block}"]
    wanted = SIZES.get(block)
    if wanted:
        told = [r for r in told if all(str(r["parameters"].get(k)) == str(v) for k, v in wanted.items())]
    return told[0] | {"parameters": told[0]["parameters"] | SHORT.get(block, {})}


def recording(block):
    """Path of what the block's tests drive; made now if there is none of these sources."""
    run = run_of(block)
    test = toolchain.ROOT / f"tb/{run['stage']}/test_{block}.py"
    inputs = [test, *sorted(revision.imports(test))]
    inputs += toolchain.sources_of(f"msn_{block}")
    digest = hashlib.sha256(repr(run).encode() + b"".join(path.read_bytes() for path in inputs)).hexdigest()[
        :12
    ]
    path = WORK / f"{block}-{digest}.rec"
    if not path.exists():
        WORK.mkdir(parents=True, exist_ok=True)
        fresh = path.with_suffix(f".{os.getpid()}")
        call = "import bench; bench.run({stage!r}, {block!r}, {parameters!r}, {test_filter!r}, "
        call += "sources={sources!r})"
        text = call.format(**{**run, "sources": [*map(str, run["sources"])] or None})
        paths = os.pathsep.join([str(toolchain.ROOT / "tb"), *filter(None, [os.environ.get("PYTHONPATH")])])
        source = next(path for path in toolchain.sources() if path.stem == f"msn_{block}").read_text()
        ports = re.findall(
            r"^\s*(?:input|output)\s[^/]*?(\w+)\s*,?\s*(?://.*)?$", _header(source, block)[0], re.M
        )
        env = {**os.environ, "MEISSNER_RECORD": str(fresh), "PYTHONPATH": paths}
        env["MEISSNER_RECORD_PORTS"] = ",".join(ports)
        done = subprocess.run(
            [sys.executable, "-c", text], env=env, capture_output=True, text=True, timeout=LONG_S
        )
        if not fresh.exists():
            raise RuntimeError(f"{block}: nothing was recorded:\n{done.stdout}{done.stderr}")
        fresh.replace(path)
    return path


SHIM = """#include "Vfaults_top.h"
struct Block : Vfaults_top { using Vfaults_top::Vfaults_top; };
Block *block_new(VerilatedContext *context) { return new Block{context, "TOP"}; }
void block_delete(Block *block) { delete block; }
void block_eval(Block *block) { block->eval(); }
uint8_t &block_clock(Block *block) { return block->clk_i; }
"""


def _do(what, command, cwd=None):
    done = subprocess.run(
        [*map(str, command)],
        cwd=cwd,
        env=toolchain.environment(),
        capture_output=True,
        text=True,
        timeout=LONG_S,
    )
    if done.returncode:
        raise RuntimeError(f"{what} did not build:\n{done.stdout}{done.stderr}")


# Without assertions: what an upset brings about is judged by what comes out.
VERILATE = (
    "--cc",
    "--build",
    "--no-assert",
    "--vpi",
    "--public-flat-rw",
    "-Wno-fatal",
    "-Wno-lint",
    "-Wno-style",
)


def _digest(*parts):
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part.read_bytes() if isinstance(part, Path) else repr(part).encode())
    return digest.hexdigest()[:12]


def _compiled(source, folder, *flags):
    """Path of an object file of this C++ source, which sees Verilator's headers."""
    include = Path(toolchain.environment()["VERILATOR_ROOT"]) / "include"
    target = folder / f"{source.stem}-{_digest(source, flags, *sorted(HERE.glob('*.hpp')))}.o"
    if not target.exists():
        folder.mkdir(parents=True, exist_ok=True)
        see = [
            f"-I{include}",
            f"-I{include}/vltstd",
            f"-I{folder}",
            "-DVERILATOR=1",
            "-DVM_TRACE=0",
            "-DVM_SC=0",
        ]
        fresh = target.with_suffix(f".{os.getpid()}")
        _do(source.name, ["g++", "-std=gnu++20", *flags, *see, "-c", source, "-o", fresh])
        fresh.replace(target)
    return target


def program(block):
    """Path of the block behind the driver; built now if there is none of these sources."""
    parameters = run_of(block)["parameters"] | OTHER.get(block, {})
    sources = toolchain.sources_of(f"msn_{block}")
    own = next(path for path in sources if path.stem == f"msn_{block}").read_text()
    given = [f"-G{name}={value}" for name, value in parameters.items()]
    folder = toolchain.folder_for_make(WORK / f"{block}-{_digest(given, SHIM, VERILATE, *sources)}")
    sources = [toolchain.for_make(path) for path in sources]
    driver = _compiled(DRIVER, WORK, "-O1")
    built = folder / f"{driver.stem}.run"
    if not built.exists():
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "faults_top.sv").write_text(wrapper(block, own))
        (folder / "shim.cpp").write_text(SHIM)
        if not (folder / "libverilated.a").exists():
            command = ["verilator", *VERILATE, "--top-module", "faults_top", "-Mdir", folder, *given]
            command += ["-MAKEFLAGS"]
            command += ["OPT_FAST=-O1 OPT_SLOW=-O0 OPT_GLOBAL=-O1 CFG_CXXFLAGS_PCH_I=-include"]
            _do(block, [*command, *sources, folder / "faults_top.sv"])
        shim = _compiled(folder / "shim.cpp", folder, "-O1")
        libraries = [folder / "libVfaults_top.a", folder / "libverilated.a"]
        _do(block, ["g++", driver, shim, *libraries, "-pthread", "-o", built])
    return built


def settings():
    """The settings among the state of msn_registers: its output, what waits, and that it does."""
    source = next(path for path in toolchain.sources() if path.stem == "msn_registers").read_text()
    return ["cfg_o", *re.findall(r"^\s*logic (?:\[\d+:0\] )?(\w+_(?:q|pending));$", source, re.M)]


def inject(block, count, seed):
    """``count`` upsets and a share of every other fault; a Result for each."""
    around, instance = INSIDE.get(block, (block, ""))
    options = [*OPTIONS.get(around, []), *([f"only={instance}"] if instance else [])]
    if around == "registers":
        options.append("kept=" + ",".join(settings()))
    if around == "core":
        options.append(",".join([f"kept={ARRAY}", SCAN_TAKEN, *settings()]))
    told = _run(around, count, seed, options)
    for writes in WRITES.get(block, []):
        told += _run(around, count, seed, [*options, *writes, "alone=1"])
    return [result for result in told if result.outcome != "constant"]  # no state, see the driver


def _run(block, count, seed, options):
    command = [program(block), recording(block), count, seed, SETTLE.get(block, 0), *options]
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, timeout=LONG_S)
    if done.returncode:
        raise RuntimeError(f"{block}: {done.stderr}{done.stdout[-300:]} exit {done.returncode}")
    lines = done.stdout.splitlines()
    print("\n".join(f"    {line}" for line in lines if line.startswith("#")))
    found = [line.split() for line in lines if not line.startswith("#")]
    return [Result(k, w, int(a), o, " ".join(rest)) for k, w, a, o, *rest in found]


def summary(facts):
    """A block's cell in docs/trust.md."""
    return f"{facts['injected']}, {facts['recovered']} wrong until recovery, {facts['silent']} after it"


def total(blocks):
    keys = "injected", "recovered", "silent"
    injected, until, after = (sum(facts[key] for facts in blocks) for key in keys)
    return (
        f"{injected:,} faults injected into {len(blocks)} blocks: {until:,} gave wrong data until recovery, "
        f"unreported, {after} undetected after it"
    )


def table(blocks):
    """The recorded facts of all blocks {name: facts}, as the table of docs/faults.md."""
    named = {"told": "reported", "silent": "undetected"}
    rows = [["block", *(named.get(key, key) for key in COLUMNS)], ["---"] * (1 + len(COLUMNS))]
    rows += [[f"`{name}`", *(str(facts.get(key, 0)) for key in COLUMNS)] for name, facts in blocks.items()]
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)
