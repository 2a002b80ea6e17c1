"""Run points in processes of this machine. A process that dies loses only the point that it was running.

A thread feeds each process, and replaces it if it dies.
"""

import json
import os
import signal
import subprocess
import sys
import threading
from collections import OrderedDict, deque
from contextlib import contextmanager
from queue import SimpleQueue
from typing import NamedTuple

ATTEMPTS = 3  # for a point that ends its process; after that, the point is at fault
# Several processes run already; threads in each would change the order of additions and compete for cores.
ALONE = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")


class Task(NamedTuple):
    """A point of the axis ``name`` in the module ``where``; tasks of one ``group`` go to one process."""

    where: str
    name: str
    point: dict
    group: tuple = ()


def cores():
    return len(os.sched_getaffinity(0))


class _Waiting:
    """The tasks not yet taken; a process gets the next task of its previous group, if one is left."""

    def __init__(self, tasks):
        self.groups, self.lock, self.tries = OrderedDict(), threading.Lock(), {}
        self.taken = set()
        for number, task in enumerate(tasks):
            self.groups.setdefault((task.name, task.group), deque()).append(number)

    def next(self, before):
        """(number of a task, its group); None if no task is left."""
        with self.lock:
            if not self.groups:
                return None
            if before not in self.groups:
                fresh = (group for group in self.groups if group not in self.taken)
                before = next(fresh, None) or max(self.groups, key=lambda group: len(self.groups[group]))
            self.taken.add(before)
            number = self.groups[before].popleft()
            if not self.groups[before]:
                del self.groups[before]
            return number, before

    def again(self, number, group):
        """Put a task back at the front of its group after its process died; False after ATTEMPTS attempts."""
        with self.lock:
            self.tries[number] = self.tries.get(number, 0) + 1
            if self.tries[number] == ATTEMPTS:
                return False
            self.groups.setdefault(group, deque()).appendleft(number)
            return True


@contextmanager
def _interrupts(answers):
    """Put each interrupt into ``answers``, too: Python drops an exception that is raised in a finalizer."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def interrupted(signum, frame):
        answers.put(KeyboardInterrupt())
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, interrupted)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


class Pool:
    """``count`` processes; ``run(tasks)`` yields (task, answer) as results arrive, in any order."""

    def __init__(self, count):
        self.count, self.processes, self.closing, self.died = count, {}, False, 0

    def _start(self, place):
        path = os.pathsep.join(entry for entry in sys.path if entry)
        process = subprocess.Popen(
            [sys.executable, "-m", "meissner.tradeoff.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=os.environ | ALONE | {"PYTHONPATH": path},
            start_new_session=True,  # Ctrl-C goes to the parent only, which then ends this process
        )
        self.processes[place] = process
        if self.closing:
            process.kill()
        return process

    def _feed(self, place, tasks, waiting, answers):
        process, group = None, None
        while not self.closing and (given := waiting.next(group)):
            number, group = given
            process = process or self._start(place)
            task = tasks[number]
            line = b""
            try:
                process.stdin.write(json.dumps([task.where, task.name, task.point]).encode() + b"\n")
                process.stdin.flush()
                line = process.stdout.readline()
            except BrokenPipeError:
                pass
            if line.endswith(b"\n"):
                answers.put((task, json.loads(line)))
                continue
            process.wait()
            process = None
            self.died += not self.closing
            if not self.closing and not waiting.again(number, group):
                answers.put((task, {"problem": f"ended its process {ATTEMPTS} times"}))
        answers.put(None)

    def run(self, tasks):
        waiting, answers = _Waiting(tasks), SimpleQueue()
        count = min(self.count, len(tasks))
        for place in range(count):
            given = (place, tasks, waiting, answers)
            threading.Thread(target=self._feed, args=given, daemon=True).start()
        left = len(tasks)
        try:
            with _interrupts(answers):
                while left:
                    found = answers.get()
                    if isinstance(found, KeyboardInterrupt):
                        raise found
                    if found is None:  # a thread has no task left; others may still run a lost point again
                        count -= 1
                        if not count:
                            break
                        continue
                    left -= 1
                    yield found
        finally:
            self.close()

    def close(self):
        self.closing = True
        for process in list(self.processes.values()):
            process.kill()
            process.wait()
