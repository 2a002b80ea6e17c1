"""The command ``meissner``. Bad input gives one sentence and exit code 2, and nothing is written.

A command imports what it needs when it runs; meissner.parser gives the reason. It is imported in ``main``,
since Ctrl-C may come meanwhile.
"""

import os
import sys
from contextlib import contextmanager, suppress
from importlib import import_module

from meissner.terminal import plain, plain_streams


def _progress(what):
    """A progress bar on a terminal, nothing in a pipe."""
    if not sys.stderr.isatty():
        return lambda jobs: jobs
    from rich.console import Console
    from rich.progress import track

    return lambda jobs: track(jobs, what, console=Console(stderr=True), transient=True)


def scenes(_):
    """``meissner scenes``."""
    from meissner.scenes import describe, names

    width = max(map(len, names()))
    for name in names():
        print(f"{name:<{width}}  {describe(name)}")


def check_scene(arguments):
    """``meissner scene check``: why the scene needs each part, or one sentence about what is wrong."""
    from meissner import run, scenes
    from meissner.scenes import features
    from meissner.scenes.sensor import sensor, used

    scene = scenes.load(arguments.scene)
    run.check(scene, arguments.engine)
    print(f"{plain(scene.name)}: {plain(scene.title)}")
    of = sensor(scene.sensor)
    for title, needed, every in (
        ("physics", {name: of.WHY[name] for name in of.modelled(scene)}, of.WHY),
        ("core", used(scene), features.FEATURES | features.BESIDES),
    ):
        print(f"{title}:")
        for name, why in needed.items():
            print(f"  {features.with_modules([name]) if title == 'core' else name}: {why}")
        print(f"  left out: {', '.join(name for name in every if name not in needed) or 'nothing'}")
    size, what = of.memory(scene)
    print(f"memory: about {size / 1e6:.0f} MB for {what}")


def run(arguments):
    """``meissner run``."""
    import json
    from pathlib import Path

    from meissner import pool

    os.environ.update(pool.ONE_THREAD | dict(os.environ))  # before NumPy reads it: as in the other processes
    from meissner import run, scenes

    jobs = pool.number(arguments.jobs)
    scene = run.with_runs(scenes.load(arguments.scene), arguments.runs)
    run.check(scene, arguments.engine, arguments.waves)
    if arguments.seed < 0:
        raise ValueError(f"seed = {arguments.seed} must not be negative")
    out = Path(arguments.out or Path("build") / "run" / scene.name)
    there = next(path for path in (out, *out.parents) if path.exists())
    if not there.is_dir():
        raise ValueError(f"{there} is a file; name a folder for the results")
    if not os.access(there, os.W_OK | os.X_OK):
        raise ValueError(f"the folder {there} cannot be written to")
    given = scene, arguments.engine, out, arguments.seed, arguments.waves
    with _shown(scene, arguments) as done:
        try:
            summary = run.run(*given, _progress(f"running {scene.name}"), jobs)
        except OSError as problem:  # a failed write does not name its file
            problem.filename = problem.filename or f"the results in {out}"
            raise
        if arguments.json:
            print(json.dumps(summary, indent=2), flush=True)
        else:
            _tell(scene, summary, out)
        done(out)
    if wrong := summary["twin_mismatches"]:
        sys.stdout.flush()
        said = f"{plain(scene.name)}: the core differs from its integer twin in {wrong} values"
        print(f"meissner: {said}", file=sys.stderr)
        sys.exit(1)


@contextmanager
def _shown(scene, arguments):
    """With --web, a page plays the scene meanwhile; the function given shows the report there, and returns
    at Ctrl-C."""
    if not arguments.web and arguments.web_port is None:
        yield lambda out: None
        return
    from meissner.host import commands

    with commands.shown(scene, arguments) as done:
        yield done


def _tell(scene, summary, out):
    """Print what a run found."""
    from meissner import run
    from meissner.scenes.features import with_modules

    runs = f"{summary['runs']} run{'s' * (summary['runs'] > 1)}"
    print(f"{plain(scene.name)}: {plain(scene.title)}")
    print(
        f"engine {summary['engine']}, {runs}, {summary['seconds_simulated']:g} s "
        f"simulated in {summary['seconds_taken']:.1f} s, "
        f"{summary['samples_per_second']:.3g} samples/s through the engine"
    )
    print(f"modelled: {', '.join(summary['modelled'])}")
    print(f"left out: {', '.join(summary['left_out']) or 'nothing'}")
    print(f"modelled of the core: {with_modules(summary['built'])}")
    print(f"left out of the core: {with_modules(summary['not_built'])}")
    if summary["twin_mismatches"] is not None:
        print(f"differences between the core and its integer twin: {summary['twin_mismatches']}")
    print(*run.tell(scene, summary), sep="\n")
    print(f"\nresults: {plain(out)}/report.html, summary.json, result.npz and pictures")


def _keep(arguments):
    """Refuse an output that would replace an input or an earlier result (files.check_kept)."""
    if getattr(arguments, "overwrite", None) is not None and arguments.out is not None:
        from meissner.files import check_kept

        inputs = [value for name, value in vars(arguments).items() if name not in ("out", "call")]
        names = (value for value in inputs if isinstance(value, str))
        check_kept(arguments.out, arguments.overwrite, names, arguments.holds)


def main(arguments=None):
    """Entry point; returns only on success."""
    plain_streams()
    try:
        from meissner.parser import parser

        arguments = parser().parse_args(arguments)
        _keep(arguments)
        module, _, name = arguments.call.partition(":")
        getattr(import_module(module), name)(arguments)
        sys.stdout.flush()
    except BrokenPipeError:
        # Discard buffered output, so that Python does not report the broken pipe at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)
    except (ValueError, OSError) as problem:
        sys.exit(_refuse(problem))
    except KeyboardInterrupt as stopped:
        print(f"meissner: {str(stopped) or 'interrupted'}", file=sys.stderr)
        sys.exit(130)  # the exit code that a shell reports after Ctrl-C


def _sentence(problem):
    """The problem as a sentence; for a full disk it names the output that did not fit."""
    from meissner.files import FULL, NoRoom

    if isinstance(problem, OSError) and problem.errno in FULL and not isinstance(problem, NoRoom):
        return f"{problem.filename or 'the output'} could not be written: {FULL[problem.errno]}"
    return problem


def _refuse(problem):
    problem = _sentence(problem)
    with suppress(OSError):  # the terminal itself may be closed
        print(f"meissner: {plain(problem)}", file=sys.stderr, flush=True)
    return 2


if __name__ == "__main__":
    main()
