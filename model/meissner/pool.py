"""Processes of this machine, and a run's tasks spread over them."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import resource_tracker
from typing import Any

# Threads of a library would change the order of additions and compete for the cores.
ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
MOST = 1024
JOBS = (
    "MEISSNER_JOBS"  # the number of processes where none is given, for callers that use all cores themselves
)


def cores() -> int:
    return len(os.sched_getaffinity(0))


def number(given: int | None, name: str = "jobs") -> int:
    """``given``, or by default that of the environment, or all cores; ValueError outside 1 .. MOST."""
    if given is None:
        text = os.environ.get(JOBS, "")
        given = int(text) if text.isdecimal() else cores()
    if not 1 <= given <= MOST:
        raise ValueError(f"{name} = {given} must lie in 1 .. {MOST}")
    return given


def _begin() -> None:
    """In a new process: interrupts are its parent's, output of a library goes to standard error, and it ends
    with its parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.dup2(2, 1)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
    os._exit(1)


@contextmanager
def _started_whole() -> Iterator[None]:
    """An interrupt waits until what is started here has started, in its parent and in itself: half a process
    ends with a traceback, or never."""
    if threading.current_thread() is not threading.main_thread():  # interrupts reach the main thread alone
        yield
        return
    waiting: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _frame: waiting.append(number))
    resource_tracker.ensure_running()  # its start would let interrupts through again
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # new processes inherit it
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        signal.signal(signal.SIGINT, before)
        if waiting:
            signal.raise_signal(signal.SIGINT)  # what `before` makes of it: nothing, in a background job


class _Pool(ProcessPoolExecutor):
    def submit(self, *task: Any, **settings: Any) -> Future[Any]:
        """As of Executor; it may start a process."""
        with _started_whole():
            return super().submit(*task, **settings)


@contextmanager
def processes(count: int) -> Iterator[Executor]:
    """An executor with ``count`` processes of this machine, which end at once if its user is interrupted."""
    before = dict(os.environ)
    os.environ.update(ONE_THREAD | {JOBS: "1"})
    pool = _Pool(count, multiprocessing.get_context("spawn"), _begin)
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


@dataclass(frozen=True)
class Spread:
    """The tasks of a run on ``jobs`` processes; ``progress`` goes through a list while each task ends."""

    progress: Callable[[Sequence[Any]], Iterable[Any]] = iter
    jobs: int = 1

    def map(self, work: Callable[..., Any], tasks: Sequence[Any]) -> list[Any]:
        """``work`` of each of ``tasks``, in their order; with several jobs both must be importable."""
        if self.jobs == 1 or len(tasks) < 2:
            return [work(task) for task in self.progress(tasks)]
        with processes(min(self.jobs, len(tasks))) as pool:
            waiting = [pool.submit(work, task) for task in tasks]
            ended = as_completed(waiting)
            try:
                for _ in self.progress(waiting):
                    next(ended).result()
            except BrokenProcessPool:
                raise ValueError(
                    "a process ended before its work was done, for lack of memory perhaps; try --jobs 1"
                ) from None
            return [one.result() for one in waiting]
