"""The sweep's machinery on a toy axis: processes, interrupts, files on disk, Dask."""

import json
import os
import signal
import subprocess
import sys
import time
import types
from concurrent.futures import Future
from contextlib import nullcontext

import pytest

from harness import command
from meissner.tradeoff import store, sweep, worker
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


def test_a_process_that_dies_is_reported_and_loses_no_finished_point(tmp_path):
    (tmp_path / "die_once").write_text("11")
    with pytest.raises(ValueError, match=r"points failed; the first: BrokenProcessPool"):
        swept(tmp_path / "a", 1)
    assert len(list((tmp_path / "a/points/toy").glob("*.json"))) == 11
    swept(tmp_path / "a")
    assert sorted(toy.log()) == sorted([*range(24), 11])


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
    given = "-c", CLI, "tradeoff", "--workers", 2, "--out", out, *more
    return command.python(*given, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


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
    _, problem = process.communicate()  # until its workers, who write there too, have ended with it
    (tmp_path / "hold").unlink()
    assert process.returncode == (-9 if how == signal.SIGKILL else 130), problem
    if how == signal.SIGINT:
        end = f"meissner: interrupted; finished points are in {out}; the same command continues\n"
        assert problem.endswith(end)
    there = len(list(out.glob("points/toy/[!.]*.json")))
    assert there == toy.HOLD
    begun_points = len(toy.log())
    lines = []
    assert swept(out, say=lines.append) == clean
    assert lines == [f"{there} of 24 points are in {out} already"]
    assert len(toy.log()) == begun_points + 24 - there
    assert begun_points <= there + 2, "those that ran, and no more"


def test_what_was_being_written_is_no_point(tmp_path):
    clean = swept(tmp_path / "a")
    folder = tmp_path / "a/points/toy"
    files = sorted(folder.glob("*.json"))
    files[0].write_text(files[0].read_text()[:30])
    files[1].unlink()
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


def test_points_of_a_group_go_to_one_process():
    """Numbers with one remainder are one job."""
    submitted = []

    class Here:
        def submit(self, function, where, name, points):
            submitted.append([point["number"] for point in points])
            done = Future()
            done.set_result(function(where, name, points))
            return done

    tasks = [sweep.Task("tradeoff.toy", "toy", {"number": n}, (n % 3,)) for n in range(7)]
    found = list(sweep.measured(tasks, nullcontext(Here())))
    assert submitted == [[0, 3, 6], [1, 4], [2, 5]]
    found = {task.point["number"]: answer["found"]["cost"]["price"] for task, answer in found}
    assert found == {n: n for n in range(7)}


def test_without_a_scheduler_or_dask_it_says_so(monkeypatch):
    stub = types.ModuleType("dask.distributed")
    monkeypatch.setitem(sys.modules, "dask", types.ModuleType("dask"))
    monkeypatch.setitem(sys.modules, "dask.distributed", stub)

    def nobody(address, timeout):
        raise OSError("nobody there")

    stub.Client = nobody
    with pytest.raises(ValueError, match="tcp://there"), worker.cluster("tcp://there"):
        pass
    monkeypatch.setitem(sys.modules, "dask.distributed", None)
    with pytest.raises(ValueError, match=r"\[dask\]"), worker.cluster("tcp://here:8786"):
        pass


@pytest.mark.long
def test_through_a_scheduler(tmp_path):
    """Two workers of Dask, which the tests' requirements do not include: pip install distributed."""
    distributed = pytest.importorskip("distributed", reason="pip install distributed")
    clean = swept(tmp_path / "a")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        found = swept(tmp_path / "b", executor=worker.cluster(cluster.scheduler_address))
    assert found == clean
