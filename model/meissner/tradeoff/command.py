"""``meissner tradeoff`` and ``meissner choose``."""

import json
import os
import sys
from contextlib import contextmanager
from pathlib import Path

from meissner import pool
from meissner.files import check_out, written
from meissner.tables import toml
from meissner.terminal import plain
from meissner.tradeoff import sweep, table, worker
from meissner.tradeoff.area import recorded
from meissner.tradeoff.points import point_of

NEEDED = ("error", "board", "channels", "window", "rows", "columns", "lut", "settle_share")
RECORD = Path(__file__).with_name("measured.json")


@contextmanager
def _bar(total):
    """Yield a function to call after each point: a bar with the time left on a terminal, silent in a pipe."""
    if not sys.stderr.isatty() or not total:
        yield lambda: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("measuring"), BarColumn(), MofNCompleteColumn(), TextColumn("left"))
    with Progress(*columns, TimeRemainingColumn(), console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("", total=total)
        yield lambda: bar.advance(task)


def _folder(out):
    """``out`` as the path of a writable folder; ValueError if it is not one."""
    out = Path(out)
    there = next(path for path in (out, *out.parents) if path.exists())
    if not there.is_dir():
        raise ValueError(f"{there} is a file; name a folder for the results")
    if not os.access(there, os.W_OK | os.X_OK):
        raise ValueError(f"the folder {there} cannot be written to")
    return out


def _point(arguments):
    """Measure and print one point; no file is written."""
    if not arguments.axis or len(arguments.axis) != 1:
        raise ValueError("--point needs exactly one --axis")
    axis = table.named(arguments.axis[0])
    point = point_of(axis, arguments.point)
    found = worker.measured(axis, point)
    print(json.dumps({"axis": axis.name, "point": point} | found, indent=2))


def tradeoff(arguments):
    """``meissner tradeoff``."""
    if arguments.list:
        for axis in table.every().values():
            count, few = len(axis.points()), len(axis.points(True))
            print(f"{axis.name:10} {count:5} points, quick {few:3}  {axis.title}")
        return
    if arguments.point is not None:
        _point(arguments)
        return
    axes = [table.named(name) for name in dict.fromkeys(arguments.axis or table.every())]
    workers, out = pool.number(arguments.workers, "workers"), _folder(arguments.out or "build/tradeoff")
    out.mkdir(parents=True, exist_ok=True)
    executor = worker.cluster(arguments.scheduler) if arguments.scheduler else None
    try:
        rows = sweep.run(axes, out, arguments.quick, executor, workers, _bar)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(
            f"interrupted; finished points are in {plain(out)}; the same command continues"
        ) from None
    _tell(axes, rows, out, arguments.quick)


def _tell(axes, rows, out, quick):
    from meissner.tradeoff import page

    facts = {"points": sum(map(len, rows.values())), "axes": len(axes), "quick": "yes" if quick else "no"}
    page.write(out, axes, rows, facts)
    for axis in axes:
        print(f"{axis.name}: {page.verdict(axis, rows[axis.name])}")
    files = f"report.html, {sweep.RESULTS}, {sweep.TIMES} (measured times) and pictures"
    print(f"\nresults: {plain(out)}/{files}")


def _results(sweep_folder):
    """The results in a folder, or those shipped with the package."""
    if sweep_folder:
        return sweep.read(sweep_folder)
    return recorded(RECORD, 'make figures FIGURES="tradeoff"')


def choose(arguments):
    """``meissner choose``."""
    from meissner.tradeoff import choose
    from meissner.tradeoff.candidates import board_of, part_of, tables
    from meissner.tradeoff.needs import Needs

    given = {key: getattr(arguments, key) for key in NEEDED}
    needs = Needs(
        arguments.sensor,
        latency_ms=arguments.latency,
        adc=part_of(arguments.adc),
        r_ohm=arguments.r,
        **given,
    )
    board_of(needs.board)
    if arguments.out:
        check_out(arguments.out)
    row, _, lines = choose.chosen(needs, _results(arguments.sweep))
    text = toml(tables(needs, row))
    if arguments.out:
        with written(arguments.out) as file:
            file.write(text.encode())
        print(*lines, sep="\n")
        print(f"\nwritten: {plain(arguments.out)}")
        return
    print(text)
    print(*(f"# {line}" for line in lines), sep="\n")
