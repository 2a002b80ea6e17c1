"""The sweep's machinery on a toy axis: workers and their death, interrupts, files on disk, Dask."""

import json
import os
import signal
import subprocess
import sys
import time
import types
from concurrent.futures import ThreadPoolExecutor, wait

import pytest

from meissner.tradeoff import store, sweep
from meissner.tradeoff.cluster import Cluster
from meissner.tradeoff.pool import Pool, Task, _Waiting
from tradeoff import toy

CLI = """
import sys
from meissner import cli
from meissner.tradeoff import table
from tradeoff import toy
table.every = lambda: {axis.name: axis for axis in toy.AXES}
cli.main(sys.argv[1:])
"""


@pytest.fixture(autouse=True)
def told(tmp_path, monkeypatch):
    monkeypatch.setenv("TOY_FOLDER", str(tmp_path))
    return tmp_path


def swept(out, workers=2, **given):
    """The bytes of the results file."""
    sweep.run(toy.AXES, out, workers=workers, **given)
    return (out / sweep.RESULTS).read_bytes()


def by_hand():
    """(number, price, on the front) of each point: a loop over all pairs."""
    prices = [number % 7 for number in range(24)]
    errors = [1 / (1 + number) for number in range(24)]
    for a in range(24):
        beaten = any(
            prices[b] <= prices[a]
            and errors[b] <= errors[a]
            and (prices[b], errors[b]) != (prices[a], errors[a])
            for b in range(24)
        )
        yield a, prices[a], not beaten


def test_one_worker_and_two_write_the_same_bytes(tmp_path):
    one, two = swept(tmp_path / "a", 1), swept(tmp_path / "b", 2)
    assert one == two
    rows = json.loads(one)["toy"]["points"]
    expected = list(by_hand())
    assert [(row["point"]["number"], row["cost"]["price"], row["front"]) for row in rows] == expected
    assert [row["shipped"] for row in rows] == [number == 3 for number in range(24)]
    assert rows[5]["error"] == {"wrong": 0.166666667, "third": 1.66666667}, "nine digits"
    assert rows[5]["again"] == "meissner tradeoff --axis toy --point number=5"
    assert sorted(toy.log()) == sorted([*range(24)] * 2)


def test_a_worker_that_dies_loses_its_running_point_only(tmp_path):
    clean = swept(tmp_path / "a")
    (tmp_path / "log").unlink()
    (tmp_path / "die_once").write_text("11")
    assert swept(tmp_path / "b") == clean
    assert sorted(toy.log()) == sorted([*range(24), 11])


def test_a_worker_that_is_killed_from_outside(tmp_path):
    """The process of one of two workers is killed while both work."""
    os.environ["TOY_SECONDS"] = "0.02"
    try:
        pool, found, killed = Pool(2), [], None
        for task, answer in pool.run(sweep.tasks_of(toy.AXES[0])):
            found.append((task.point["number"], answer["found"]["cost"]["price"]))
            if len(found) == 6:
                killed = pool.processes[0].pid
                os.kill(killed, signal.SIGKILL)
    finally:
        del os.environ["TOY_SECONDS"]
    assert sorted(found) == [(number, number % 7) for number in range(24)]
    assert pool.died == 1 and pool.processes[0].pid != killed
    assert 24 <= len(toy.log()) <= 25


def test_a_point_that_always_ends_its_process_is_named(tmp_path):
    (tmp_path / "die_always").write_text("2")
    with pytest.raises(ValueError, match=r"3 times; .*=2$"):
        swept(tmp_path / "a")
    assert toy.log().count(2) == 3
    assert len(json.loads((tmp_path / "a/results.json").read_text())["toy"]["points"]) == 23


def test_a_point_that_fails_is_named_and_measured_again(tmp_path):
    (tmp_path / "fails").write_text("4 9")
    with pytest.raises(ValueError, match=r"no such thing; .*=4$"):
        swept(tmp_path / "a")
    (tmp_path / "fails").unlink()
    (tmp_path / "log").unlink()
    swept(tmp_path / "a")
    assert sorted(toy.log()) == [4, 9]


def begun(out, *more):
    """The command on the toy axis, started as a process."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path), "TOY_SECONDS": "0.01"}
    command = [sys.executable, "-c", CLI, "tradeoff", "--workers", "2", "--out", str(out), *more]
    return subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_an_interrupted_sweep_goes_on(tmp_path, how):
    clean = swept(tmp_path / "a")
    (tmp_path / "log").unlink()
    out = tmp_path / "b"
    (tmp_path / "hold").touch()  # so that the sweep cannot end before the interrupt
    process = begun(out)
    while len(list(out.glob("points/toy/[!.]*.json"))) < toy.HOLD and process.poll() is None:
        time.sleep(0.005)
    process.send_signal(how)
    _, problem = process.communicate(timeout=60)
    (tmp_path / "hold").unlink()
    assert process.returncode == (-9 if how == signal.SIGKILL else 130), problem
    if how == signal.SIGINT:
        end = f"meissner: interrupted; finished points are in {out}; the same command continues\n"
        assert problem.endswith(end)
    there = len(list(out.glob("points/toy/[!.]*.json")))
    assert there == toy.HOLD
    time.sleep(0.3)  # the workers end with their parent
    begun_points = len(toy.log())
    lines = []
    assert swept(out, say=lines.append) == clean
    assert lines == [f"{there} of 24 points are in {out} already"]
    assert len(toy.log()) == begun_points + 24 - there
    assert begun_points <= there + 2, "those that ran, and no more"


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_an_interrupt_in_a_finalizer_is_not_lost(monkeypatch):
    """Python drops an exception that is raised there; a later answer raises it, long before the last one.
    After the sweep the signal has its usual handler."""
    monkeypatch.setenv("TOY_SECONDS", "0.05")

    class Finalized:
        def __del__(self):
            signal.raise_signal(signal.SIGINT)

    usual = signal.getsignal(signal.SIGINT)
    answers = Pool(1).run(sweep.tasks_of(toy.AXES[0]))
    next(answers)
    one = Finalized()
    del one
    with pytest.raises(KeyboardInterrupt):
        for _ in answers:
            pass
    assert signal.getsignal(signal.SIGINT) is usual


def test_what_was_being_written_is_no_point(tmp_path):
    clean = swept(tmp_path / "a")
    folder = tmp_path / "a/points/toy"
    files = sorted(folder.glob("*.json"))
    files[0].write_text(files[0].read_text()[:30])
    files[1].unlink()
    (folder / f".{files[1].name}.abc").write_text("{")
    (tmp_path / "log").unlink()
    assert swept(tmp_path / "a") == clean
    assert len(toy.log()) == 2
    assert sorted(path.name for path in folder.iterdir()) == sorted(path.name for path in files)


def test_points_of_other_sources_are_measured_again(tmp_path, monkeypatch):
    lines = []
    swept(tmp_path / "a")
    monkeypatch.setattr(store, "revision", lambda: "01234567")
    swept(tmp_path / "a", say=lines.append)
    assert lines == [
        f"0 of 24 points are in {tmp_path / 'a'} already; 24 are measured again, "
        "because the package has changed"
    ]
    assert len(toy.log()) == 48


def test_tasks_of_a_group_stay_with_one_process():
    tasks = [Task("m", "a", {"n": n}, (n % 3,)) for n in range(9)]
    waiting = _Waiting(tasks)
    first, group = waiting.next(None)
    other, another = waiting.next(None)
    assert (first, other) == (0, 1) and group != another
    assert [waiting.next(group)[0] for _ in range(2)] == [3, 6]
    assert waiting.next(group)[0] == 2, "a group that nobody has yet"


class Client:
    """The part of Dask's client that is used: submitted work returns in any order."""

    def __init__(self, address, timeout):
        if address != "tcp://here:8786":
            raise OSError("nobody there")
        self.pool, self.out = ThreadPoolExecutor(2), []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.pool.shutdown()

    def submit(self, function, *arguments, pure):
        assert pure is False
        self.out = [future for future in self.out if not future.done()]
        self.out.append(self.pool.submit(function, *arguments))
        assert len(self.out) <= 4, "two of each thread"
        return self.out[-1]

    def ncores(self):
        return {"tcp://a:1": 1, "tcp://b:1": 1}


def test_through_a_scheduler(tmp_path, monkeypatch):
    stub = types.ModuleType("dask.distributed")
    stub.Client, stub.wait = Client, wait
    monkeypatch.setitem(sys.modules, "dask", types.ModuleType("dask"))
    monkeypatch.setitem(sys.modules, "dask.distributed", stub)
    clean = swept(tmp_path / "a")
    assert swept(tmp_path / "b", runner=Cluster("tcp://here:8786")) == clean
    with pytest.raises(ValueError, match="tcp://there"):
        Cluster("tcp://there")
    monkeypatch.setitem(sys.modules, "dask.distributed", None)
    with pytest.raises(ValueError, match=r"\[dask\]"):
        Cluster("tcp://here:8786")
