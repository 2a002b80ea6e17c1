"""From axes to results: plan the points, run those that are not on disk, join all in the planned order."""

import json
from concurrent.futures import as_completed
from contextlib import closing, nullcontext
from pathlib import Path
from typing import NamedTuple

from meissner import pool
from meissner.files import written
from meissner.tradeoff import area, pareto, worker
from meissner.tradeoff.points import command_of
from meissner.tradeoff.store import Store

RESULTS, TIMES = "results.json", "times.json"


class Task(NamedTuple):
    """A point of the axis ``name`` in the module ``where``; tasks of one ``group`` go to one process."""

    where: str
    name: str
    point: dict
    group: tuple


def tasks_of(axis, quick=False):
    """A Task for each point; its group is its values of the axis's ``group``, or the point itself."""
    where, keys = axis.error.__module__, axis.group or axis.values
    points = axis.points(quick)
    return [Task(where, axis.name, point, tuple(point[key] for key in keys)) for point in points]


def measured(tasks, executor):
    """Yield (task, answer) as results arrive from the context ``executor``, in any order."""
    groups = {}
    for task in tasks:
        groups.setdefault((task.name, task.group), []).append(task)
    with executor as workers:
        jobs = {}
        for group in groups.values():
            points = [task.point for task in group]
            jobs[workers.submit(worker.answers, group[0].where, group[0].name, points)] = group
        for job in as_completed(jobs):
            try:
                found = job.result()
            except Exception as problem:  # its process died, or the module of the axis is missing there
                found = [{"problem": f"{type(problem).__name__}: {problem}"}] * len(jobs[job])
            yield from zip(jobs[job], found)


def run(axes, out, quick=False, executor=None, workers=1, progress=None, say=print):
    """Measure what is not in ``out`` yet and write the results there; returns {name: rows}.

    ``executor``: a context of worker.py for all axes except timed ones; ``workers``: processes without it;
    ``progress``: takes a number of points and returns a context whose value is called after each
    point. ValueError at the end if points failed.
    """
    out = Path(out)
    store = Store(out)
    wanted = {axis.name: tasks_of(axis, quick) for axis in axes}
    found, todo, stale = {}, {True: [], False: []}, 0
    for axis in axes:
        for task in wanted[axis.name]:
            if axis.placed:
                _placed(axis, task.point)  # refused now, not after hours, if it was never placed
            kept, current = store.read(task)
            if current:
                found[_key(task)] = kept
            else:
                todo[bool(axis.timed)].append(task)
                stale += kept is not None
    count = sum(map(len, wanted.values()))
    if found or stale:
        again = f"; {stale} are measured again, because the package has changed" if stale else ""
        say(f"{len(found)} of {count} points are in {out} already{again}")
    problems = []
    with progress(sum(map(len, todo.values()))) if progress else nullcontext(lambda: None) as report:
        several = executor or pool.processes(workers)
        for tasks, one in ((todo[False], several), (todo[True], pool.processes(1))):
            if not tasks:
                continue
            with closing(measured(tasks, one)) as answers:
                for task, answer in answers:
                    if "found" in answer:
                        store.write(task, answer["found"])
                        found[_key(task)] = answer["found"]
                    else:
                        problems.append((task, answer["problem"]))
                    report()
    rows = {axis.name: _rows(axis, wanted[axis.name], found) for axis in axes}
    _write(out, axes, rows, quick)
    if problems:
        problems.sort(key=lambda each: _key(each[0]))
        task, why = problems[0]
        axis = next(axis for axis in axes if axis.name == task.name)
        again = command_of(axis, task.point)
        raise ValueError(f"{len(problems)} of {count} points failed; the first: {why}; again: {again}")
    return rows


def _key(task):
    return task.name, json.dumps(task.point, sort_keys=True)


def _placed(axis, point):
    entry = axis.placed(point)
    return area.placed(*entry) if entry else area.NOTHING


def _rows(axis, tasks, found):
    """Rows {"point", "cost", "error", "front", "shipped"} of the measured points, in the order of tasks."""
    rows = []
    for task in tasks:
        if (kept := found.get(_key(task))) is not None:
            cost = kept["cost"]
            if axis.placed:
                cost = cost | _placed(axis, task.point)
            rows.append({"point": task.point, "cost": cost, "error": kept["error"]})
    for row in rows:
        row |= {"front": False, "shipped": axis.is_shipped(row["point"])}
    for kind in {axis.kind(row["point"]) for row in rows} if axis.judged else ():
        same = [row for row in rows if axis.kind(row["point"]) == kind]
        judged = [[figure_of(row, key) for key in axis.judged] for row in same]
        for row, on in zip(same, pareto.front(judged)):
            row["front"] = on
    return rows


def figure_of(row, key):
    """A figure from a row's cost or error; None if it was not measured."""
    return row["error"].get(key, row["cost"].get(key))


def _write(out, axes, rows, quick):
    """Write the results that repeat to the digit, and in a file of their own those that a clock decides."""
    files = {RESULTS: {}, TIMES: {}}
    for axis in axes:
        name = TIMES if axis.timed else RESULTS
        commanded = [row | {"again": command_of(axis, row["point"])} for row in rows[axis.name]]
        files[name][axis.name] = {"title": axis.title, "quick": quick, "points": commanded}
    for name, fresh in files.items():
        if fresh:  # other axes of an earlier sweep are kept
            whole = dict(sorted((_entries(out / name) | fresh).items()))
            with written(out / name) as file:
                file.write(json.dumps(whole, indent=1).encode() + b"\n")


def _entries(path):
    """The entries of a file of results; empty if it is missing or damaged."""
    try:
        found = json.loads(path.read_text("utf-8"))
        return found if isinstance(found, dict) else {}
    except (OSError, ValueError):
        return {}


def read(out):
    """{axis: its entry} of the results in a folder; ValueError if there are none."""
    found = {}
    for name in (RESULTS, TIMES):
        path = Path(out) / name
        if path.is_file():
            try:
                found |= json.loads(path.read_text("utf-8"))
            except ValueError:
                raise ValueError(f"{path} is damaged; `meissner tradeoff --out {out}` writes it") from None
    if not found:
        raise ValueError(f"{out} has no results of a sweep; `meissner tradeoff --out {out}` makes them")
    return found
