"""Ten thousand points through a scheduler and two Dask workers, one of them killed midway: the same file.

The tests' requirements do not include Dask: `pip install distributed`, then `pytest -m long tb/tradeoff`.
"""

import contextlib
import os
import subprocess
import sys
import time

import pytest

COUNT = 10_000
ONE = """
import sys
from pathlib import Path
from meissner.tradeoff import sweep
from tradeoff import toy
sweep.run(toy.AXES, Path(sys.argv[1]), workers=1)
"""
THROUGH = """
import sys
from pathlib import Path
from meissner.tradeoff import sweep
from meissner.tradeoff.cluster import Cluster
from tradeoff import toy
sweep.run(toy.AXES, Path(sys.argv[1]), runner=Cluster(sys.argv[2]))
"""


@contextlib.contextmanager
def started(environment, *command):
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.mark.long
def test_ten_thousand_points_with_a_worker_killed(tmp_path):
    pytest.importorskip("distributed", reason="pip install distributed")
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    environment |= {"TOY_FOLDER": str(tmp_path), "TOY_COUNT": str(COUNT)}
    subprocess.run([sys.executable, "-c", ONE, str(tmp_path / "a")], env=environment, check=True)
    address = "tcp://127.0.0.1:18786"
    dask = (sys.executable, "-m", "dask")
    log, out = tmp_path / "log", tmp_path / "b"
    log.unlink()
    worker = (*dask, "worker", address, "--no-nanny", "--nthreads", "1", "--no-dashboard")
    with (
        started(environment, *dask, "scheduler", "--port", "18786", "--no-dashboard", "--host", "127.0.0.1"),
        started(environment, *worker) as first,
        started(environment, *worker),
        started(environment, sys.executable, "-c", THROUGH, str(out), address) as sweep,
    ):
        points = out / "points/toy"
        while not points.is_dir() or len(os.listdir(points)) < COUNT // 4:
            assert sweep.poll() is None
            time.sleep(0.05)
        first.kill()
        assert len(os.listdir(points)) < COUNT - 1000, "killed while much was left"
        assert sweep.wait(timeout=500) == 0
    assert (out / "results.json").read_bytes() == (tmp_path / "a/results.json").read_bytes()
    begun = log.read_text().split()
    assert {*begun} == {*map(str, range(COUNT))}
    assert COUNT <= len(begun) <= COUNT + 2, "those that the killed worker had"
