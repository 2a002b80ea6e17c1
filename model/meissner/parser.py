"""The arguments of the command line. This module imports no command, so that help and usage errors need no
NumPy or SciPy; ``call`` names the function that does the work, "module:function"."""

import argparse

from meissner.names import EVERY, NAMES, PICTURE
from meissner.terminal import plain

PORT = "serial:/dev/ttyUSB0, pty:/dev/pts/7, file:capture.bin, sim:SCENE, core:CONFIG (docs/host.md)"
LOADED = "a file that `meissner calibrate` wrote, to write into the core first"
PLANTED = "a file that `meissner export-forest` wrote, to write into the core first"
CONFIG = "the core's configuration, for physical units: a name or a TOML file"


class _Version(argparse.Action):
    """--version; what reads the version is imported only then."""

    def __init__(self, *names, **more):
        super().__init__(*names, nargs=0, **more)

    def __call__(self, parser, *_):
        from meissner import __version__

        print(f"meissner {__version__}")
        parser.exit()


class _Parser(argparse.ArgumentParser):
    """``example``: a whole command line, which the tests run (tb/cli/test_examples.py)."""

    def __init__(self, *given, example=None, **more):
        more["epilog"] = f"example: meissner {example}" if example else None
        super().__init__(*given, formatter_class=argparse.RawDescriptionHelpFormatter, **more)

    def error(self, message):
        self.exit(2, f"{self.prog}: {plain(message)} (see {self.prog} --help)\n")


def _out(parser, metavar, what, required=False, holds=""):
    """--out, which replaces no earlier file without --overwrite; ``holds``: that file's name in a folder."""
    parser.add_argument("--out", required=required, metavar=metavar, help=what)
    parser.add_argument("--overwrite", action="store_true", help="replace an earlier output")
    parser.set_defaults(holds=holds)


def _web(parser, what):
    parser.add_argument("--web", action="store_true", help=f"{what} on a page of this machine, 127.0.0.1")
    parser.add_argument("--web-port", type=int, metavar="N", help="the same on this port (8642; 0: any free)")


def _jobs(parser):
    parser.add_argument("--jobs", type=int, metavar="N", help="processor cores to use (all of them)")


def _shape(text):
    """(rows, columns) of ``3x4``."""
    rows, _, columns = text.lower().replace("×", "x").partition("x")
    if not (rows.isdecimal() and columns.isdecimal() and int(rows) and int(columns)):
        raise argparse.ArgumentTypeError(f"{plain(text)} must be rows and columns such as 3x4")
    return int(rows), int(columns)


def _reading(parser, shape=False, config=False):
    """What a recording does not say, or says of several things (docs/own_recordings.md)."""
    parser.add_argument(
        "--column",
        action="append",
        metavar="NAMES",
        help="columns, arrays or the topic to read: names or numbers from 1, by commas (all but times)",
    )
    parser.add_argument("--unit", metavar="UNIT", help="of the numbers: V, mV, uV, codes, N (the file's)")
    parser.add_argument(
        "--volts-per-code", type=float, metavar="V", help="of the converter, for recordings in volts"
    )
    parser.add_argument(
        "--rate", type=float, metavar="HZ", help="samples per second of each channel (the file's)"
    )
    if config:
        parser.add_argument("--config", metavar="FILE", help="of the array: its converter and its shape")
    if shape:
        parser.add_argument(
            "--shape", type=_shape, metavar="RxC", help="taxels of an array whose columns are channels, 3x4"
        )


def _slip_settings(parser, threshold):
    """``threshold``: whether the command takes one."""
    parser.add_argument("--config", metavar="FILE", help="a configuration with [slip]: a name or a TOML file")
    if threshold:
        parser.add_argument("--threshold", type=int, help="codes of the unnormalised detail")
    parser.add_argument("--window", type=int, help="samples, a power of two from 4 (64)")
    parser.add_argument("--hop", type=int, help="samples, even, 2 to window (default: the window)")
    parser.add_argument("--level", type=int, help="Haar level, 1 to 3 (1)")


RECORDING = "a recording: CSV, npy, npz, wav, mat, sr, mcap, h5, tdms, bag (docs/own_recordings.md)"


def parser():
    """The parser of every command."""
    top = _Parser(prog="meissner", description="Slip, pressure and grip from a tactile sensor's ADC pins.")
    top.add_argument("--version", action=_Version, help="print the version and exit")
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND")
    _run(commands)
    _process(commands)
    _host(commands)
    _budget(commands)
    _tradeoff(commands)
    _choose(commands)
    _calibrate(commands)
    _fit_rubber(commands)
    _threshold(commands)
    _forest(commands)
    _config(commands)
    _bench(commands)
    return top


def _run(commands):
    listing = commands.add_parser("scenes", help="list the scenes, one line each", example="scenes")
    listing.set_defaults(call="meissner.cli:scenes")

    run = commands.add_parser(
        "run",
        help="run a scene: physics, converter, core, report",
        example="run walk_25x5 --out results/walk",
    )
    run.add_argument("scene", metavar="SCENE", help="a name that `meissner scenes` lists, or a TOML file")
    run.add_argument("--engine", default="fixed", metavar="E", help=f"{', '.join(EVERY)} (fixed)")
    _out(run, "DIR", "folder for the results (build/run/SCENE)", holds="summary.json")
    run.add_argument(
        "--seed", type=int, default=1, help="first seed; the scene determines how many follow (1)"
    )
    run.add_argument("--runs", type=int, metavar="N", help="seeds of each condition (the scene's number)")
    _jobs(run)
    run.add_argument("--waves", action="store_true", help="also write waves.vcd (rtl engine)")
    run.add_argument("--json", action="store_true", help="print summary.json on standard output instead")
    _web(run, "while it runs, play its first condition")
    run.set_defaults(call="meissner.cli:run")

    scene = commands.add_parser("scene", help="check a scene and explain why it needs each part")
    actions = scene.add_subparsers(dest="action", required=True, metavar="ACTION")
    check = actions.add_parser(
        "check",
        help="report what is wrong with a scene, or why it needs each part",
        example="scene check cop_slip",
    )
    check.add_argument("scene", metavar="SCENE", help="a name, or a TOML file")
    check.add_argument("--engine", default="fixed", metavar="E", help=f"{', '.join(EVERY)} (fixed)")
    check.set_defaults(call="meissner.cli:check_scene")


def _process(commands):
    process = commands.add_parser("process", help="run one part of the core over recorded samples")
    parts = process.add_subparsers(dest="part", required=True, metavar="PART")
    slip = parts.add_parser(
        "slip",
        help="slip per window from samples [samples] or [channels, samples]",
        example="process slip IN.npy --rate 10000 --threshold 40 --out SLIP.npz",
    )
    slip.add_argument("input", metavar="IN", help=RECORDING)
    _slip_settings(slip, threshold=True)
    _reading(slip, shape=True)
    slip.add_argument(
        "--calibration", metavar="CAL.npz", help="turns an array's codes into forces, with --config"
    )
    slip.add_argument("--engine", default="fixed", metavar="E", help=f"{', '.join(EVERY)} (fixed)")
    _jobs(slip)
    _out(slip, "OUT.npz", "output file, .npz or .csv", required=True)
    slip.set_defaults(call="meissner.process:slip")

    cop = parts.add_parser(
        "cop",
        help="centre of pressure and load from forces [frames, rows, columns]",
        example="process cop FRAMES.npy --out COP.npz",
    )
    cop.add_argument("input", metavar="IN", help="forces, 0 to 65535; codes with --calibration; " + RECORDING)
    _reading(cop, shape=True, config=True)
    cop.add_argument("--min-load", type=int, default=1, help="minimum sum of forces for a position (1)")
    cop.add_argument("--calibration", metavar="CAL.npz", help="a file that `meissner calibrate` wrote")
    cop.add_argument("--engine", default="fixed", metavar="E", help=f"{', '.join(EVERY)} (fixed)")
    _jobs(cop)
    _out(cop, "OUT.npz", "output file, .npz or .csv", required=True)
    cop.set_defaults(call="meissner.process:cop")

    cop4 = parts.add_parser(
        "cop4",
        help="centre of pressure and load from four electrodes [samples, 4]",
        example="process cop4 E1_E4.npy --config cop4 --out COP4.npz",
    )
    cop4.add_argument("input", metavar="IN", help="codes or volts of E1 to E4, a column each; " + RECORDING)
    _reading(cop4)
    cop4.add_argument(
        "--config", required=True, metavar="C.toml", help="docs/cop4.md, or a build's (docs/config.md)"
    )
    cop4.add_argument("--engine", default="fixed", metavar="E", help=f"{', '.join(EVERY)} (fixed)")
    _jobs(cop4)
    _out(cop4, "OUT.npz", "output file, .npz or .csv", required=True)
    cop4.set_defaults(call="meissner.process:cop4")

    rope = parts.add_parser(
        "rope",
        help="slip of each frame by a forest, from samples [samples, channels]",
        example="process rope ROPE.npy --forest F.json --out ROPE.npz",
    )
    rope.add_argument("input", metavar="IN", help="codes, a column for each channel; " + RECORDING)
    _reading(rope)
    rope.set_defaults(call="meissner.rope.process:rope")
    forest = parts.add_parser(
        "forest",
        help="class of each row of features [rows, features] by a forest",
        example="process forest X.csv --forest F.json --out CLASSES.npz",
    )
    forest.add_argument("input", metavar="X.npy", help="numbers; or .csv, columns by name if it has a header")
    forest.add_argument(
        "--single", action="store_true", help="also count the clocks of each row alone (rtl, gate)"
    )
    forest.set_defaults(call="meissner.forest.process:forest")
    for part in (rope, forest):
        part.add_argument(
            "--forest", required=True, metavar="F.json", help="docs/forest.md; or the .skops or .onnx model"
        )
        part.add_argument("--trust", action="store_true", help="also a .joblib model, which runs its code")
        part.add_argument("--engine", default="fixed", metavar="E", help=f"{', '.join(EVERY)} (fixed)")
        part.add_argument("--engines", type=int, default=1, metavar="N", help="tree engines, 1 to 64 (1)")
        _out(part, "OUT.npz", "output file, .npz or .csv", required=True)


def _host(commands):
    regs = commands.add_parser(
        "regs",
        help="registers of a core: all, the named ones, or write NAME=VALUE",
        example="regs /dev/ttyUSB1 slip.threshold=40 slip.hold",
    )
    regs.add_argument("port", metavar="PORT", help=PORT)
    regs.add_argument(
        "names", metavar="NAME[=VALUE]", nargs="*", help="docs/registers.md; VALUE 40, 0x28, 20mV, 0.5N, 5ms"
    )
    regs.add_argument("--config", metavar="FILE", help=CONFIG)
    regs.add_argument("--calibration", metavar="CAL.npz", help=LOADED)
    regs.add_argument("--forest", metavar="F.json", help=PLANTED)
    regs.set_defaults(call="meissner.host.commands:regs")

    live = commands.add_parser(
        "live",
        help="show a core's packets as they arrive: slip, centre of pressure, image",
        example="live /dev/ttyUSB1 --seconds 2",
    )
    _line_arguments(live)
    _web(live, "show them, and set thresholds,")
    live.set_defaults(call="meissner.host.commands:live")

    log = commands.add_parser(
        "log",
        help="write a core's packets to MCAP (ROS 2) or npz: log PORT --out FILE.mcap",
        example="log /dev/ttyUSB1 --seconds 2 --out touch.mcap",
    )
    _line_arguments(log)
    _out(log, "FILE", "a .mcap or a .npz file", required=True)
    log.set_defaults(call="meissner.host.commands:log")

    bridge = commands.add_parser("bridge", help="a core's packets as ROS 2 messages, live, without ROS")
    to = bridge.add_subparsers(dest="to", required=True, metavar="TO")
    dds = to.add_parser(
        "dds",
        help="to DDS topics that ROS 2 nodes see; experimental (docs/ros2.md)",
        example="bridge dds /dev/ttyUSB1 --seconds 2",
    )
    _line_arguments(dds)
    dds.add_argument("--domain", type=int, default=0, metavar="N", help="DDS domain, as ROS_DOMAIN_ID (0)")
    dds.set_defaults(call="meissner.host.commands:bridge_dds")
    foxglove = to.add_parser(
        "foxglove",
        help="to Foxglove or Lichtblick, thresholds as parameters (docs/ros2.md)",
        example="bridge foxglove /dev/ttyUSB1 --seconds 2 --listen-on 127.0.0.1:8795",
    )
    _line_arguments(foxglove)
    foxglove.add_argument(
        "--listen-on", default="127.0.0.1:8765", metavar="HOST:PORT", help="of the server (127.0.0.1:8765)"
    )
    foxglove.set_defaults(call="meissner.host.commands:bridge_foxglove")

    replay = commands.add_parser(
        "replay",
        help="compare an engine's results for a log's images with the core's own: replay LOG --out OUT.npz",
        example="replay touch.mcap --out compared.npz",
    )
    replay.add_argument("log", metavar="LOG", help="a file that `meissner log` wrote")
    replay.add_argument("--min-load", type=int, help="minimum sum of forces for a position (the log's, or 1)")
    replay.add_argument("--engine", default="fixed", metavar="E", help=f"{', '.join(NAMES)} (fixed)")
    _out(replay, "OUT.npz", "output file, .npz or .csv; or .mcap: an unfinished log, finished")
    _web(replay, "play the log")
    replay.set_defaults(call="meissner.host.commands:replay")


def _line_arguments(parser):
    parser.add_argument("port", metavar="PORT", help=PORT)
    parser.add_argument(
        "--seconds",
        type=float,
        metavar="S",
        help="stop after S seconds (default: at Ctrl-C or the file's end)",
    )
    parser.add_argument(
        "--listen", action="store_true", help="do not read registers (for a core without them)"
    )
    parser.add_argument("--config", metavar="FILE", help=CONFIG)
    parser.add_argument("--calibration", metavar="CAL.npz", help=LOADED)
    parser.add_argument("--forest", metavar="F.json", help=PLANTED)
    parser.add_argument(
        "--clk-khz", type=int, metavar="KHZ", help="the core's clock, if its registers are not read"
    )


def _budget(commands):
    parser = commands.add_parser(
        "budget",
        help="latency of a scanned array, term by term; --config: of a build; --cop4: resolution of a "
        "four-wire sensor",
        example="budget --rows 16 --cols 16 --adc mcp3208",
    )
    parser.add_argument("--cop4", action="store_true", help="position and load resolution of four electrodes")
    parser.add_argument(
        "--config",
        metavar="NAME",
        help="latency of a build (a name or a TOML file): its [grip] and [shear_speed], else its sensor",
    )
    parser.add_argument("--rows", type=int, metavar="M", help="rows (64; --cop4: 41)")
    parser.add_argument("--columns", "--cols", type=int, metavar="N", help="columns (64; --cop4: 41)")
    parser.add_argument("--json", action="store_true", help="print the numbers as JSON instead")
    parser.set_defaults(call="meissner.budget:command")
    array = parser.add_argument_group("a scanned array")
    array.add_argument("--clock", type=float, default=100e6, metavar="HZ", help="the core's clock (100e6)")
    array.add_argument("--adc", default="ad7606", metavar="PART", help="converter, or all (ad7606)")
    array.add_argument(
        "--converters", type=int, metavar="N", help="1 to 8 (default: the fewest that reach 1 ms)"
    )
    array.add_argument(
        "--channels", type=int, metavar="N", help="inputs used per converter (default: the fastest number)"
    )
    array.add_argument(
        "--adc-lanes",
        type=int,
        metavar="N",
        help="data lines of a converter (2 of an AD7606 or AD7606C, or 1)",
    )
    array.add_argument(
        "--sclk-khz", type=int, metavar="KHZ", help="maximum serial clock (default: the part's usual one)"
    )
    array.add_argument(
        "--read",
        choices=("after", "during"),
        default="after",
        help="read a conversion after it, or during the next one (after)",
    )
    array.add_argument(
        "--settle-us",
        type=float,
        metavar="US",
        help="from selecting the lines to convert start (default: what the converter's front needs)",
    )
    array.add_argument(
        "--settle-share",
        type=float,
        metavar="S",
        help="share of the old row that may remain, such as 0.005 (default: half a code)",
    )
    array.add_argument(
        "--volts", type=float, metavar="V", help="full scale of the converters (default: the slowest range)"
    )
    array.add_argument(
        "--source-ohm",
        type=float,
        default=100.0,
        metavar="R",
        help="resistance that drives a multiplexed converter's inputs (100)",
    )
    array.add_argument("--demod", action="store_true", help="read taxels as amplitudes of a carrier")
    array.add_argument(
        "--sample-period",
        type=int,
        default=500,
        metavar="CLOCKS",
        help="between two samples, with --demod (500)",
    )
    array.add_argument(
        "--periods", type=int, default=4, metavar="N", help="periods of 4 samples, with --demod (4)"
    )
    array.add_argument("--skip", type=int, default=4, metavar="N", help="samples to settle, with --demod (4)")
    array.add_argument("--no-health", action="store_true", help="without the mask of faulty taxels")
    array.add_argument("--no-tare", action="store_true", help="without subtracting each taxel's zero")
    array.add_argument(
        "--bits-per-clock",
        type=int,
        default=2,
        metavar="N",
        help="quotient bits per clock in the division, 1 or 2 (2)",
    )
    parser = parser.add_argument_group("a four-wire sensor")
    parser.add_argument("--r", type=float, default=10.0, help="resistor between taxels, ohms (10)")
    parser.add_argument("--R0", type=float, default=10e3, help="resistor to the supply, ohms (10000)")
    parser.add_argument("--V0", type=float, default=15.0, help="supply, plus and minus, volts (15)")
    parser.add_argument("--k", type=float, default=4320.0, help="a taxel has k / force, newton ohms (4320)")
    parser.add_argument(
        "--adc-bits", type=int, default=16, metavar="B", help="bits of the converter, 8 to 24 (16)"
    )
    parser.add_argument(
        "--gain", type=float, default=1.0, help="gain of the difference amplifiers, 1: none (1)"
    )
    parser.add_argument("--load", type=float, default=5.0, metavar="F", help="load on one point, newtons (5)")
    _out(parser, "PATH", f"a picture: a .png file, or a folder for {PICTURE}", holds=PICTURE)


def _tradeoff(commands):
    parser = commands.add_parser(
        "tradeoff",
        help="measure the cost of accuracy: sweeps, Pareto fronts, a report",
        example="tradeoff --axis divider --quick --out results/tradeoff",
    )
    parser.add_argument("--list", action="store_true", help="the axes, one line each")
    parser.add_argument("--axis", action="append", metavar="NAME", help="only this axis; repeatable (all)")
    parser.add_argument("--quick", action="store_true", help="few points and runs: minutes, not half an hour")
    parser.add_argument("--point", nargs="+", metavar="NAME=VALUE", help="measure and print one point")
    parser.add_argument("--out", metavar="DIR", help="folder for the results (build/tradeoff)")
    parser.add_argument(
        "--workers", type=int, metavar="N", help="processes on this machine (default: one per core)"
    )
    parser.add_argument(
        "--scheduler", metavar="ADDRESS", help="use the workers of a Dask scheduler, tcp://HOST:8786"
    )
    parser.set_defaults(call="meissner.tradeoff.command:tradeoff")


def _choose(commands):
    parser = commands.add_parser(
        "choose",
        help="choose the cheapest configuration that meets the requirements, as TOML",
        example="choose array --rows 8 --cols 8 --latency 5 --board ulx3s --out chosen.toml",
    )
    parser.add_argument("sensor", metavar="SENSOR", help="channels (rubber), electrodes (four wires), array")
    parser.add_argument("--error", type=float, metavar="PCT", help="largest error in %% (docs/tradeoff.md)")
    parser.add_argument(
        "--latency", type=float, metavar="MS", help="largest latency in milliseconds (docs/tradeoff.md)"
    )
    parser.add_argument("--board", metavar="BOARD", help="a board of docs/boards.md: its clock and pins")
    parser.add_argument("--adc", metavar="PART", help="only this converter")
    parser.add_argument("--channels", type=int, metavar="N", help="channels: their number (1)")
    parser.add_argument("--window", type=int, metavar="N", help="channels: only windows of N samples")
    parser.add_argument("--rows", type=int, metavar="M", help="electrodes, array: rows of taxels (7, 64)")
    parser.add_argument(
        "--columns", "--cols", type=int, metavar="N", help="electrodes, array: columns of taxels (7, 64)"
    )
    parser.add_argument("--r", type=float, metavar="OHM", help="electrodes: resistor between taxels (100)")
    parser.add_argument(
        "--settle-share",
        type=float,
        metavar="S",
        help="array: share of the old row that may remain, such as 0.005 (default: half a code)",
    )
    parser.add_argument("--lut", type=int, metavar="N", help="largest number of LUTs, on the board's chip")
    parser.add_argument(
        "--sweep", metavar="DIR", help="results of `meissner tradeoff` (default: those of the package)"
    )
    _out(parser, "FILE.toml", "write the configuration to this file (default: print it)")
    parser.set_defaults(call="meissner.tradeoff.command:choose")


def _calibrate(commands):
    parser = commands.add_parser(
        "calibrate",
        help="a straight line per cell from a press recording",
        example="calibrate PRESS.npz --out CAL.npz",
    )
    parser.add_argument(
        "recording", metavar="RECORDING", help="arrays codes and force_n; or codes, or columns with one in N"
    )
    parser.add_argument("--force", metavar="FORCE", help="newtons [frames] or [frames, rows, columns]")
    _reading(parser, shape=True, config=True)
    parser.add_argument(
        "--lsb", type=float, metavar="N", help="newtons per code of force (default: the finest)"
    )
    parser.add_argument(
        "--adc-bits", type=int, metavar="B", help="of the converter (default: from codes at its ends)"
    )
    _out(parser, "CAL.npz", "output file of offsets and gains", required=True)
    parser.set_defaults(call="meissner.process:calibrate")


def _fit_rubber(commands):
    parser = commands.add_parser(
        "fit-rubber",
        help="k0, k1 and n of a lot of rubber from its shear steps",
        example="fit-rubber SHEAR.csv",
    )
    parser.add_argument(
        "recording", metavar="RECORDING", help="columns time_s, volts, speed_mm_s (docs/shear.md)"
    )
    parser.add_argument(
        "--column", action="append", metavar="NAMES", help="which those three are: names or numbers from 1"
    )
    parser.add_argument(
        "--codes-per-v",
        type=float,
        default=819.2,
        metavar="N",
        help="converter codes per volt, for the register values (819.2)",
    )
    parser.set_defaults(call="meissner.fit_rubber:command")


def _threshold(commands):
    parser = commands.add_parser(
        "threshold",
        help="thresholds from a quiet hold, and from slips, with the rate of false alarms they promise",
        example="threshold QUIET.csv SLIP.csv --config slip1 --per-hour 9 --out THRESHOLD.png",
    )
    parser.add_argument("input", metavar="QUIET", help="a hold in which nothing slips; " + RECORDING)
    parser.add_argument("slips", metavar="SLIP", nargs="?", help="a recording with slips, of the same form")
    _slip_settings(parser, threshold=False)
    parser.add_argument(
        "--per-hour", type=float, default=1.0, metavar="N", help="false alarms per hour to promise (1)"
    )
    _reading(parser, shape=True)
    _out(parser, "PICTURE", "the picture, a .png or a .svg file (threshold.png)")
    call = "meissner.threshold:command"
    parser.set_defaults(call=call, engine="fixed", calibration=None, out="threshold.png")


def _forest(commands):
    parser = commands.add_parser(
        "export-forest",
        help="a trained forest as F.json: scikit-learn's or ONNX's",
        example="export-forest MODEL.joblib --trust --integer all --out F.json",
    )
    parser.add_argument("model", metavar="MODEL", help="a .skops, .onnx or .joblib file (docs/forest.md)")
    parser.add_argument(
        "--trust", action="store_true", help="load a .joblib or pickle file, which runs the code it holds"
    )
    parser.add_argument(
        "--integer", metavar="NAMES", help="features that are integers below 2^24: all, or x0,x3 (none)"
    )
    _out(parser, "F.json", "output file", required=True)
    parser.set_defaults(call="meissner.forest.command:export")

    parser = commands.add_parser(
        "train-rope",
        help="train a forest on simulated ropes as published, its tables beside the published",
        example="train-rope --trees 20 --out ROPE.json",
    )
    parser.add_argument("--seed", type=int, default=1, help="of the fingertip, the pulls and the forest (1)")
    parser.add_argument("--trees", type=int, default=400, metavar="N", help="of the forest (400)")
    _out(parser, "F.json", "also write the forest to this file")
    parser.set_defaults(call="meissner.scenes.rope.command:command")

    parser = commands.add_parser(
        "forest-budget",
        help="block RAMs and clocks of a forest on each board, what a smaller one costs, the best that fits",
        example="forest-budget F.json",
    )
    parser.add_argument("forest", metavar="F.json", help="a forest (docs/forest.md), or a trained one's file")
    parser.add_argument(
        "--trust", action="store_true", help="load a .joblib or pickle file, which runs the code it holds"
    )
    parser.add_argument(
        "--data", metavar="FILE", help="labelled rows, .npz or .csv: walks, accuracy, smaller forests"
    )
    parser.add_argument(
        "--training", metavar="FILE", help="rows that say which nodes matter (every second one of --data)"
    )
    parser.add_argument("--fit", metavar="BOARD", help="find the best that fits: icebreaker, ulx3s:25F, ...")
    parser.add_argument("--engines", type=int, default=1, metavar="N", help="1 to 64, with a memory each (1)")
    parser.add_argument("--banks", type=int, default=1, metavar="N", help="2: reloadable while it runs (1)")
    parser.add_argument("--json", action="store_true", help="print the numbers as JSON instead")
    _out(parser, "F.json", "write the forest that --fit finds")
    parser.add_argument("--toml", metavar="FILE", help="also write a configuration for it, for make synth")
    parser.set_defaults(call="meissner.budget.forest:command")


def _config(commands):
    """``meissner config list | check FILE | show FILE | new``."""
    config = commands.add_parser("config", help="write a configuration, check it, or show its parameters")
    actions = config.add_subparsers(dest="action", required=True, metavar="ACTION")
    listing = actions.add_parser(
        "list", help="the named configurations, one line each", example="config list"
    )
    listing.set_defaults(call="meissner.builds.config:command_list")
    check = actions.add_parser(
        "check", help="report what is wrong with a file, or that nothing is", example="config check fingertip"
    )
    check.add_argument("file", metavar="FILE", help="a TOML file (docs/config.md), or a name")
    check.set_defaults(call="meissner.builds.config:command_check")
    show = actions.add_parser(
        "show", help="its RTL parameters and register values", example="config show fingertip"
    )
    show.add_argument("file", metavar="FILE", help="a TOML file, or a name")
    show.set_defaults(call="meissner.builds.config:command_show")

    new = actions.add_parser(
        "new",
        help="write a configuration with comments; asks on a terminal for what no option says",
        example="config new --sensor channels --channels 2 --adc MCP3208 --board icebreaker --out mine.toml",
    )
    new.add_argument(
        "--sensor",
        metavar="KIND",
        help="channels (rubber), array (a matrix), electrodes (four wires), none (a forest alone)",
    )
    new.add_argument("--channels", type=int, metavar="N", help="channels: their number (1)")
    new.add_argument("--rows", type=int, metavar="M", help="array, electrodes: rows of taxels (3, 7)")
    new.add_argument("--columns", "--cols", type=int, metavar="N", help="the same: columns of taxels (3, 7)")
    new.add_argument("--adc", metavar="PART", help="converter (MCP3208, for electrodes AD7606)")
    new.add_argument("--converters", type=int, metavar="N", help="array: converters side by side (1)")
    new.add_argument(
        "--volts", type=float, metavar="V", help="full scale of the converter (3.3, or 5 of an AD7606)"
    )
    new.add_argument(
        "--features", metavar="NAMES", help="with commas: grip, forest, display, shear_speed (none)"
    )
    new.add_argument("--forest", metavar="F.json", help="forest: of export-forest; without it, room for one")
    new.add_argument("--pins", metavar="MxN", help="display: rows x columns of pins (5x20)")
    new.add_argument("--rate", metavar="HZ", help="frames a second, or max (10000, of an array max)")
    new.add_argument(
        "--board", metavar="BOARD", help="its clock and pins; docs/boards.md (icebreaker, ulx3s; or none)"
    )
    _out(new, "FILE.toml", "the file to write", required=True)
    new.set_defaults(call="meissner.builds.new_config:command")


def _bench(commands):
    """From a bitstream to a core that answers."""
    wiring = commands.add_parser(
        "wiring",
        help="draw how a configuration is wired: sensor, converters with pin numbers, board",
        example="wiring fingertip --board icebreaker --out wiring.svg",
    )
    wiring.add_argument("config", metavar="CONFIG", help="a name or a TOML file")
    wiring.add_argument("--board", default="ulx3s", metavar="BOARD", help="a board of docs/boards.md (ulx3s)")
    wiring.add_argument(
        "--volts",
        type=float,
        metavar="V",
        help="supply of a converter that has one (3.3, as the board's pins)",
    )
    wiring.add_argument(
        "--columns-in",
        default="amplifier",
        metavar="W",
        help="array: each column ends in an amplifier or a resistor",
    )
    _out(wiring, "FILE.svg", "the drawing", required=True)
    wiring.set_defaults(call="meissner.builds.wiring.command:command")

    flash = commands.add_parser(
        "flash",
        help="load a bitstream into a board, by openFPGALoader",
        example="flash icebreaker build/synth/icebreaker-slip1/icebreaker_top.bin",
    )
    flash.add_argument("board", metavar="BOARD", help="a board of docs/boards.md")
    flash.add_argument(
        "file", metavar="FILE", help="what `make synth` wrote: build/synth/<board>-<config>/..."
    )
    flash.add_argument(
        "--keep",
        action="store_true",
        help="into the board's flash, to stay without power (iCEBreaker: always)",
    )
    flash.set_defaults(call="meissner.builds.flash:command")

    ports = commands.add_parser(
        "ports",
        help="list the serial ports, and the core that answers on each; it only reads",
        description="A port of a known board is opened, listened to, and a core's description is read: 14 "
        "bytes for each register, nothing is written. Other ports are asked only if they are named.",
        example="ports /dev/ttyUSB1",
    )
    ports.add_argument("ports", nargs="*", metavar="PORT", help="ask these; also pty:... (default: list all)")
    ports.add_argument("--baud", type=int, metavar="N", help="only at this rate (3000000, then 1000000)")
    ports.set_defaults(call="meissner.host.ports:command")

    completion = commands.add_parser(
        "completion",
        help="print a script with which a shell completes these commands",
        description='bash: eval "$(meissner completion bash)" in ~/.bashrc\nzsh: meissner completion zsh > '
        "_meissner, in a folder of fpath\nfish: meissner completion fish > "
        "~/.config/fish/completions/meissner.fish",
        example="completion bash",
    )
    completion.add_argument("shell", choices=("bash", "zsh", "fish"), help="bash, zsh or fish")
    completion.set_defaults(call="meissner.completion:command")
