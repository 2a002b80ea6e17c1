"""``--jobs``: any number of processes gives the same results; a fault and Ctrl-C end the command with one
sentence and leave no process; and ``--runs``.
"""

import json
import os
import signal
import subprocess
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness import command
from meissner import cli, pool, scenes
from meissner.pool import Spread
from meissner.run import run, with_runs

TIMES = ("seconds_taken", "samples_per_second")


def few(name, count):
    """The scene with its first ``count`` conditions or cases and two seeds."""
    scene = with_runs(scenes.load(name), 2)
    field = "cases" if hasattr(scene, "cases") else "conditions"
    return replace(scene, **{field: getattr(scene, field)[:count]})


def short_hold():
    """A second of three conditions of a hand."""
    scene = few("grip_disturb", 3)
    return replace(scene, world=scene.world | {"duration_s": 1.0, "hold_from_s": 0.5})


def results(folder):
    """(summary without its times, other files, {array: content}) of a run's folder."""
    summary = json.loads((folder / "summary.json").read_text())
    with np.load(folder / "result.npz") as arrays:
        found = {name: (array.dtype, array.shape, array.tobytes()) for name, array in arrays.items()}
    rest = {path.name: path.read_bytes() for path in folder.glob("*.csv")}
    return {key: value for key, value in summary.items() if key not in TIMES}, rest, found


@pytest.mark.parametrize(
    "scene, engine, most",
    [
        (few("slip_materials", 2), "fixed", 2),
        (with_runs(scenes.load("shear_speed"), 1), "float", 2),
        (few("cop_slip", 2), "rtl", 2),
        (short_hold(), "fixed", 2),  # three tasks
    ],
    ids=["rubber", "shear", "grip", "hand"],
)
def test_any_number_of_processes_gives_the_same(tmp_path, undrawn, scene, engine, most):
    found = []
    for jobs in range(1, most + 1):
        shown = []
        progress = lambda tasks, shown=shown: (shown.append(task) or task for task in tasks)
        run(scene, engine, tmp_path / str(jobs), seed=3, progress=progress, jobs=jobs)
        found.append((results(tmp_path / str(jobs)), len(shown)))
    assert found == [found[0]] * most


@pytest.mark.parametrize("form", ["npz", "csv"])
@pytest.mark.parametrize("engine", ["fixed", "float", "rtl"])
@pytest.mark.parametrize("part", ["slip", "cop", "cop4"])
def test_recorded_samples_give_the_same_bytes(tmp_path, capsys, monkeypatch, part, engine, form):
    """Of one thread, two and three; and of a single piece."""
    from meissner import process

    rng = np.random.default_rng(5)
    shape, more = {
        "slip": ((3, 700), ["--rate", "1000", "--threshold", "900"]),
        "cop": ((90, 5, 3), ["--min-load", "400"]),
        "cop4": ((101, 4), ["--config", "cop4"]),
    }[part]
    np.save(tmp_path / "in.npy", rng.integers(0, 900, shape))
    names = []
    for jobs, piece in ((1, 400), (2, 400), (3, 400), (1, 1 << 19)):
        monkeypatch.setattr(process, "PIECE", piece)
        names.append(tmp_path / f"{len(names)}.{form}")
        given = ["process", part, str(tmp_path / "in.npy"), *more, "--engine", engine, "--jobs", str(jobs)]
        cli.main([*given, "--out", str(names[-1])])
    assert len({name.read_bytes() for name in names}) == 1
    said = capsys.readouterr().out.splitlines()
    read, done = set(said[::2]), {line.split(";")[0] for line in said[1::2]}
    assert len(read) == len(done) == 1 and done.pop().startswith(str(shape[0]))


def test_results_come_in_the_order_of_the_tasks():
    assert Spread(jobs=2).map(abs, [-7, 4, -1, 0, -9]) == [7, 4, 1, 0, 9]
    assert Spread(jobs=2).map(os.getenv, [pool.JOBS, *pool.ONE_THREAD]) == ["1"] * 4, "no pool in a pool"
    # A single task or job needs no process.
    assert Spread(jobs=9).map(os.getenv, ["PATH"]) == [os.environ["PATH"]]
    assert Spread(jobs=1).map(lambda x: x + 1, [1, 2]) == [2, 3]


def test_a_fault_in_a_process_is_the_run_s():
    with pytest.raises(ValueError, match=r"invalid literal .*'x'"):
        Spread(jobs=2).map(int, ["3", "x", "4"])
    with pytest.raises(ValueError, match="a process ended before its work was done"):
        Spread(jobs=2).map(os._exit, [3, 3, 3])


@pytest.mark.parametrize("given, text, expected", [(None, "3", 3), (5, "3", 5), (None, "", pool.cores())])
def test_the_number_of_processes(monkeypatch, given, text, expected):
    monkeypatch.setenv(pool.JOBS, text)
    assert pool.number(given) == expected


@pytest.mark.parametrize(
    "given, word",
    [
        (["cop_slip", "--jobs", "0"], "jobs = 0"),
        (["cop_slip", "--jobs", "1025"], "jobs = 1025"),
        (["cop_slip", "--runs", "0"], "runs = 0"),
        (["walk_25x5", "--runs", "2"], "runs = 2"),
    ],
)
def test_a_number_that_means_nothing_is_refused(tmp_path, capsys, given, word):
    with pytest.raises(SystemExit, match="2"):
        cli.main(["run", *given, "--out", str(tmp_path / "out")])
    said = capsys.readouterr().err
    assert said.startswith(f"meissner: {word}") and said.count("\n") == 1
    assert not (tmp_path / "out").exists()


def children(process):
    """Process ids of a process's children."""
    tasks = Path(f"/proc/{process.pid}/task").glob("*/children")
    return [int(child) for task in tasks for child in task.read_text().split()]


def runs(child):
    """Whether this process has not ended."""
    try:
        return " Z " not in Path(f"/proc/{child}/stat").read_text()
    except OSError:
        return False


@pytest.mark.parametrize("number", [1, 2, 3])  # multiprocessing's own, then a process each
def test_ctrl_c_ends_every_process(tmp_path, number):
    """Also while the others start. The pipe ends only when all that write to it have ended."""
    given = "run", "slip_materials", "--jobs", 2, "--out", tmp_path / "out"
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    process = command.started(*given, start_new_session=True, **streams)
    while len(began := children(process)) < number and process.poll() is None:
        time.sleep(0.001)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does
    assert process.communicate() == ("", "meissner: interrupted\n")
    assert process.returncode == 130 and len(began) >= number
    while any(map(runs, began)):  # the last one, which tracks the others' resources, ends after them
        time.sleep(0.01)
    assert list((tmp_path / "out").iterdir()) == []


@pytest.mark.parametrize("before", [signal.SIG_IGN, signal.default_int_handler], ids=["ignored", "raises"])
def test_an_interrupt_while_a_process_starts_does_what_it_did_before(before):
    """But later; a shell's background job ignores it."""
    kept, steps = signal.signal(signal.SIGINT, before), []
    try:
        with pool._started_whole():
            os.kill(os.getpid(), signal.SIGINT)
            steps.append("started")
        steps.append("goes on")
    except KeyboardInterrupt:
        steps.append("interrupted")
    finally:
        signal.signal(signal.SIGINT, kept)
    assert steps == ["started", "goes on" if before == signal.SIG_IGN else "interrupted"]
