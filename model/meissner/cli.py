"""The command ``meissner``. Bad input is answered by one sentence and exit code 2, with nothing written."""

import argparse
import json
import os
import sys
import time
from pathlib import Path

import numpy as np

from meissner import budget, calibration, config, engines, files
from meissner.host import commands as host_commands


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")


def _progress(what):
    """A progress bar on a terminal, nothing in a pipe."""
    if not sys.stderr.isatty():
        return lambda jobs: jobs
    from rich.console import Console
    from rich.progress import track

    return lambda jobs: track(jobs, what, console=Console(stderr=True), transient=True)


def _scenes(_):
    from meissner import scenes

    width = max(map(len, scenes.names()))
    for name in scenes.names():
        print(f"{name:<{width}}  {scenes.describe(name)}")


def _run(arguments):
    from meissner import run, scenes

    scene = scenes.load(arguments.scene)
    run.check(scene, arguments.engine, arguments.waves)
    if arguments.seed < 0:
        raise ValueError(f"seed = {arguments.seed} must not be negative")
    out = Path(arguments.out or Path("build") / "run" / scene.name)
    there = next(path for path in (out, *out.parents) if path.exists())
    if not there.is_dir():
        raise ValueError(f"{there} is a file; name a folder for the results")
    if not os.access(there, os.W_OK | os.X_OK):
        raise ValueError(f"the folder {there} cannot be written to")
    summary = run.run(
        scene, arguments.engine, out, arguments.seed, arguments.waves, _progress(f"running {scene.name}")
    )
    if arguments.json:
        print(json.dumps(summary, indent=2))
        return
    runs = f"{summary['runs']} run{'s' * (summary['runs'] > 1)}"
    print(f"{scene.name}: {scene.title}")
    print(
        f"engine {summary['engine']}, {runs}, {summary['seconds_simulated']:g} s "
        f"simulated in {summary['seconds_taken']:.1f} s, "
        f"{summary['samples_per_second']:.3g} samples/s through the engine"
    )
    print(f"modelled: {', '.join(summary['modelled'])}")
    print(f"left out: {', '.join(summary['left_out']) or 'nothing'}")
    if summary["twin_mismatches"] is not None:
        print(f"differences between the core and its integer twin: {summary['twin_mismatches']}")
    print(*run.tell(scene, summary), sep="\n")
    print(f"\nresults: {out}/report.html, summary.json, result.npz and pictures")


def _process_slip(arguments):
    from meissner.slip.config import SlipConfig

    if not 0 < arguments.rate < float("inf"):
        raise ValueError(f"rate = {arguments.rate:g} must be a number of samples per second above 0")
    config = SlipConfig(
        window=arguments.window,
        hop=arguments.window if arguments.hop is None else arguments.hop,
        level=arguments.level,
        threshold=arguments.threshold,
    )
    x = engines.check_samples(files.read_array(arguments.input))
    with files.written(arguments.out) as file:
        engines.load(arguments.engine)
        engines.process_slip(x[:, : config.window], config, arguments.engine)  # built and warm
        began = time.perf_counter()
        result = engines.process_slip(x, config, arguments.engine)
        taken = time.perf_counter() - began
        np.savez(file, **result)
    channels, windows = result["slip"].shape
    fired = result["fired_at"][result["slip"]]
    first = f"first at {int(fired.min()) / arguments.rate:.4f} s" if len(fired) else "none"
    print(
        f"{channels} channel{'s' * (channels > 1)}, {windows} windows, {int(result['slip'].sum())} slips "
        f"({first}); {x.size / taken:.3g} samples/s on engine {arguments.engine}; {arguments.out}"
    )


def _process_cop(arguments):
    if arguments.min_load < 0:
        raise ValueError(f"min-load = {arguments.min_load} must not be negative")
    lines = None
    if arguments.calibration is not None:
        lines = calibration.load(arguments.calibration)
        engines.load(arguments.engine)
        forces = calibration.check_codes(files.read_array(arguments.input), lines.offset.shape)
    else:
        forces = engines.check_forces(files.read_array(arguments.input))
    with files.written(arguments.out) as file:
        engines.process_cop(forces[:1], arguments.engine, arguments.min_load, lines)  # built and warm
        began = time.perf_counter()
        result = engines.process_cop(forces, arguments.engine, arguments.min_load, lines)
        taken = time.perf_counter() - began
        np.savez(file, **result)
    frames, rows, columns = forces.shape
    print(
        f"{frames} frame{'s' * (frames > 1)} of {rows}×{columns}, {int(result['valid'].sum())} with a load; "
        f"{'' if lines is None else f'1 of sum is {lines.force_lsb_n:g} N; '}"
        f"{forces.size / taken:.3g} samples/s on engine {arguments.engine}; {arguments.out}"
    )


def _process_cop4(arguments):
    from meissner.cop.cop4 import faults
    from meissner.scenes import four_wires

    engines.load(arguments.engine)
    config = four_wires.load(arguments.config)
    codes = files.read_array(arguments.input)
    if arguments.input.lower().endswith(".csv"):
        codes = codes.T  # a column per electrode
    codes = engines.check_electrodes(codes, config.adc.bits)
    with files.written(arguments.out) as file:
        engines.process_cop4(codes[:1], config, arguments.engine)  # built and warm
        began = time.perf_counter()
        result = engines.process_cop4(codes, config, arguments.engine)
        taken = time.perf_counter() - began
        np.savez(file, **result)
    saturated, imbalance, opened = (int((flag > 0).sum()) for flag in faults(codes, config.registers))
    print(
        f"{len(codes)} sample{'s' * (len(codes) > 1)}, {int(result['valid'].sum())} with a load; faults: "
        f"{saturated} saturated, {opened} open, {imbalance} out of balance; load in {config.load_lsb_n:g} N; "
        f"{len(codes) / taken:.3g} samples/s on engine {arguments.engine}; {arguments.out}"
    )


def _parser():
    parser = _Parser(prog="meissner", description="Slip, pressure and grip from a tactile sensor's ADC pins.")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    listing = commands.add_parser("scenes", help="list the scenes, one line each")
    listing.set_defaults(call=_scenes)

    run = commands.add_parser("run", help="run a scene: physics, converter, core, report")
    run.add_argument("scene", metavar="SCENE", help="a name that `meissner scenes` lists")
    run.add_argument("--engine", default="fixed", metavar="E", help=f"{', '.join(engines.EVERY)} (fixed)")
    run.add_argument("--out", metavar="DIR", help="folder for the results (build/run/SCENE)")
    run.add_argument("--seed", type=int, default=1, help="first seed; the scene says how many follow (1)")
    run.add_argument("--waves", action="store_true", help="also write waves.vcd (rtl engine)")
    run.add_argument("--json", action="store_true", help="print summary.json on standard output instead")
    run.set_defaults(call=_run)

    process = commands.add_parser("process", help="run one part of the core over recorded samples")
    parts = process.add_subparsers(dest="part", required=True, metavar="PART")
    slip = parts.add_parser("slip", help="slip per window from samples [samples] or [channels, samples]")
    slip.add_argument("input", metavar="IN.npy", help="integer codes; or .csv with one column per channel")
    slip.add_argument("--rate", type=float, required=True, help="samples per second of each channel")
    slip.add_argument("--threshold", type=int, required=True, help="codes of the unnormalised detail")
    slip.add_argument("--window", type=int, default=64, help="samples, a power of two from 4 (64)")
    slip.add_argument("--hop", type=int, help="samples, even, 2 to window (the window)")
    slip.add_argument("--level", type=int, default=1, help="Haar level, 1 to 3 (1)")
    slip.add_argument("--engine", default="fixed", metavar="E", help=f"{', '.join(engines.EVERY)} (fixed)")
    slip.add_argument("--out", required=True, metavar="OUT.npz", help="where the arrays go")
    slip.set_defaults(call=_process_slip)

    cop = parts.add_parser("cop", help="centre of pressure and load from forces [frames, rows, columns]")
    cop.add_argument("input", metavar="IN.npy", help="integers, 0 to 65535; codes with --calibration")
    cop.add_argument("--min-load", type=int, default=1, help="least sum of forces with a position (1)")
    cop.add_argument("--calibration", metavar="CAL.npz", help="what `meissner calibrate` wrote")
    cop.add_argument("--engine", default="fixed", metavar="E", help=f"{', '.join(engines.EVERY)} (fixed)")
    cop.add_argument("--out", required=True, metavar="OUT.npz", help="where the arrays go")
    cop.set_defaults(call=_process_cop)

    cop4 = parts.add_parser("cop4", help="centre of pressure and load from four electrodes [samples, 4]")
    cop4.add_argument("input", metavar="IN.npy", help="codes of E1 to E4; or .csv with a column each")
    cop4.add_argument(
        "--config", required=True, metavar="C.toml", help="docs/cop4.md, or a build's (docs/config.md)"
    )
    cop4.add_argument("--engine", default="fixed", metavar="E", help=f"{', '.join(engines.EVERY)} (fixed)")
    cop4.add_argument("--out", required=True, metavar="OUT.npz", help="where the arrays go")
    cop4.set_defaults(call=_process_cop4)

    host_commands.add_commands(commands)
    budget.add_command(commands)
    calibration.add_command(commands)
    config.add_command(commands)
    return parser


def main(arguments=None):
    """Entry point; returns only on success."""
    arguments = _parser().parse_args(arguments)
    try:
        arguments.call(arguments)
    except BrokenPipeError:
        sys.exit(0)
    except (ValueError, OSError) as problem:
        sys.exit(_refuse(problem))
    except KeyboardInterrupt:
        sys.exit(130)  # as a shell reports a program that Ctrl-C ended


def _refuse(problem):
    print(f"meissner: {problem}", file=sys.stderr)
    return 2


if __name__ == "__main__":
    main()
