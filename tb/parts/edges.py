"""Run a part model without a simulator: edges come at given times, to the picosecond, and its outputs are
recorded.

``Edges(monkeypatch, *modules)`` replaces the simulator; then create pins and the model, and call ``at`` and
``run``.
"""

import heapq
from itertools import count

import cocotb

from parts import timing


class Wait:
    """What a model's task waits for: a pin's change or a time."""

    def __init__(self, what):
        self.what = what

    def __await__(self):
        return (yield self.what)


class Pin:
    """A pin with a history: [(ns, level)]."""

    def __init__(self, edges, level=0, width=1):
        self.edges, self.level, self.width, self.waiting, self.history = edges, level, width, [], []

    def __len__(self):
        return self.width

    @property
    def value(self):
        return self.level

    @value.setter
    def value(self, level):
        if level != self.level:
            self.level = level
            self.history.append((self.edges.time / 1000, level))
            waiting, self.waiting = self.waiting, []
            for task in waiting:
                self.edges.step(task)

    def was(self, ns):
        """The level at that time; a change at exactly that time is included."""
        return [level for when, level in [(-1, 0), *self.history] if when <= ns + 1e-6][-1]


class Edges:
    def __init__(self, monkeypatch, *modules):
        self.time, self.due, self.order, self.reports = 0, [], count(), []
        fakes = {"now": lambda: self.time / 1000, "changed": Wait, "Timer": lambda ps, unit: Wait(ps)}
        for where in (*modules, timing):
            for name, fake in fakes.items():
                if hasattr(where, name):
                    monkeypatch.setattr(where, name, fake)
        monkeypatch.setattr(cocotb, "start_soon", self.step)

    def step(self, task):
        """Run a task until it waits."""
        try:
            what = task.send(None)
        except StopIteration:
            return
        if isinstance(what, Pin):
            what.waiting.append(task)
        else:
            self.later(self.time + what, 0, lambda: self.step(task))

    def later(self, ps, rank, action):
        heapq.heappush(self.due, (ps, rank, next(self.order), action))

    def at(self, ns, pin, level):
        """An edge of the master; the part's own edges at the same time come first."""
        self.later(round(ns * 1000), 1, lambda: setattr(pin, "value", level))

    def run(self):
        while self.due:
            self.time, _, _, action = heapq.heappop(self.due)
            action()

    def names(self):
        """The names of the limits and rules that were reported."""
        return {str(report).split(":")[0] for report in self.reports}
