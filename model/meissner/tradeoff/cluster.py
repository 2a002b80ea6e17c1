"""The same points on the workers of a Dask scheduler, which need this package too."""

from meissner.tradeoff import worker


class Cluster:
    """``run(tasks)`` yields (task, answer) as they come, in any order."""

    def __init__(self, address):
        try:
            from dask.distributed import Client, as_completed
        except ImportError:
            raise ValueError("--scheduler needs Dask: pip install distributed") from None
        try:
            self.client = Client(address, timeout="20s")
        except (OSError, ValueError) as problem:
            raise ValueError(f"no scheduler answers at {address}: {problem}") from None
        self.completed, self.died = as_completed, 0

    def run(self, tasks):
        with self.client as client:
            waiting = {}
            for task in tasks:
                given = (task.where, task.name, task.point)
                waiting[client.submit(worker.answer, *given, pure=False)] = task
            for future in self.completed(list(waiting)):
                try:
                    found = future.result()
                except Exception as problem:  # Dask's own: a point whose workers ended again and again
                    found = {"problem": f"{type(problem).__name__}: {problem}"}
                yield waiting.pop(future), found
                if hasattr(future, "release"):
                    future.release()  # its worker need not keep it
