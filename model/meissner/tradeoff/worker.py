"""What a process measures: points of an axis; and the executors whose processes do that."""

import json
import multiprocessing
import os
import signal
import threading
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from importlib import import_module

# Several processes run already; threads in each would change the order of additions and compete for cores.
ALONE = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def rounded(value):
    """Figures rounded to nine digits: further digits depend on the order in which a library adds."""
    if isinstance(value, dict):
        return {key: rounded(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [rounded(each) for each in value]
    if hasattr(value, "item"):
        value = value.item()
    return float(f"{value:.9g}") if isinstance(value, float) else value


def measured(axis, point):
    """{"cost", "error"} of a point of ``axis``."""
    return rounded({"cost": axis.cost(point), "error": axis.error(point)})


def answers(where, name, points):
    """For each point {"found": ``measured`` for the axis ``name`` in AXES of module ``where``}, or
    {"problem": why}."""
    axis, found = next(axis for axis in import_module(where).AXES if axis.name == name), []
    for point in points:
        try:
            found.append({"found": json.loads(json.dumps(measured(axis, point), allow_nan=False))})
        except Exception as problem:
            found.append({"problem": f"{type(problem).__name__}: {problem}"})
    return found


def cores():
    return len(os.sched_getaffinity(0))


def _begin():
    """In a new process: interrupts are its parent's, output of a library goes to standard error, and it ends
    with its parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.dup2(2, 1)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent():
    multiprocessing.parent_process().join()
    os._exit(1)


@contextmanager
def processes(count):
    """An executor with ``count`` processes of this machine, which end at once if its user is interrupted."""
    before = dict(os.environ)
    os.environ.update(ALONE)
    pool = ProcessPoolExecutor(count, multiprocessing.get_context("spawn"), _begin)
    try:
        yield pool
    except BaseException:
        for process in multiprocessing.active_children():
            process.kill()
        raise
    finally:
        pool.shutdown(cancel_futures=True)
        os.environ.clear()
        os.environ.update(before)


@contextmanager
def cluster(address):
    """An executor with the workers of a Dask scheduler, which need this package, too."""
    try:
        from dask.distributed import Client
    except ImportError:
        raise ValueError("--scheduler needs Dask: pip install 'meissner[dask]'") from None
    try:
        client = Client(address, timeout="20s")
    except (OSError, ValueError) as problem:
        raise ValueError(f"no scheduler answers at {address}: {problem}") from None
    with client:
        yield client.get_executor(pure=False)
