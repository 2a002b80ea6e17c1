"""Points on the workers of a Dask scheduler, which need this package, too.

A worker keeps its results until they are fetched, so a lost worker would lose a long list of them. Each of
its threads therefore gets one point to run and one in reserve, and the next when a result has arrived.
"""

import time

from meissner.tradeoff import worker

AHEAD = 2  # points per thread of a worker, including the running one
COUNTED_S = 1.0  # between two counts of the threads


class Cluster:
    """``run(tasks)`` yields (task, answer) as results arrive, in any order."""

    def __init__(self, address):
        try:
            from dask.distributed import Client, wait
        except ImportError:
            raise ValueError("--scheduler needs Dask: pip install 'meissner[dask]'") from None
        try:
            self.client = Client(address, timeout="20s")
        except (OSError, ValueError) as problem:
            raise ValueError(f"no scheduler answers at {address}: {problem}") from None
        self.wait, self.room, self.counted = wait, 0, None

    def _room(self):
        """The number of points that may be submitted at the same time."""
        now = time.monotonic()
        if self.counted is None or now - self.counted >= COUNTED_S:
            self.room, self.counted = AHEAD * max(1, sum(self.client.ncores().values())), now
        return self.room

    def run(self, tasks):
        with self.client as client:
            waiting, left = {}, iter(tasks)
            while True:
                room = self._room() - len(waiting)
                for _, task in zip(range(room), left):
                    given = (task.where, task.name, task.point)
                    waiting[client.submit(worker.answer, *given, pure=False)] = task
                if not waiting:
                    return
                for future in self.wait(list(waiting), return_when="FIRST_COMPLETED").done:
                    try:
                        found = future.result()
                    except Exception as problem:  # Dask's own: a point that ended its workers repeatedly
                        found = {"problem": f"{type(problem).__name__}: {problem}"}
                    yield waiting.pop(future), found
