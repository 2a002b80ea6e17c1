"""Runs inside the simulator: repeats the regression for every mutant, each in a fork of the process.

It is listed as the first cocotb test module and replaces the start of the regression manager. The simulation
is loaded once; a child sets `mutsel` and continues with the ordinary regression up to the first failing test.
The environment variable MEISSNER_MUTANTS has the settings, which name the file for the verdicts.
"""

import json
import logging
import os
import resource
import signal
import sys
from pathlib import Path

import cocotb
from cocotb.handle import Immediate
from cocotb.regression import RegressionManager

SETTINGS = json.loads(os.environ["MEISSNER_MUTANTS"])
PASSED, FAILED = 0, 10
_start, _score, _tear_down = (
    RegressionManager.start_regression,
    RegressionManager._score_test,
    RegressionManager._tear_down,
)


def _fork(manager, number, cpu_s, report):
    """Start the child for mutant ``number``; returns its process id, and None in the child."""
    child = os.fork()
    if child:
        return child
    signal.setitimer(signal.ITIMER_PROF, cpu_s)  # CPU time, since the machine may be busy
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    os.dup2(null, 2)
    logging.disable(logging.CRITICAL)

    def score(self, *arguments):
        _score(self, *arguments)
        if self.failures:
            os.write(report, f"{number} {self._test.name}\n".encode())
            os._exit(FAILED)

    def tear_down(self):
        os._exit(PASSED if self.passed else FAILED)

    RegressionManager._score_test, RegressionManager._tear_down = score, tear_down
    cocotb.top.mutsel.value = Immediate(number)
    _start(manager)
    return None


def _verdict(status):
    if os.WIFSIGNALED(status):
        return "time" if os.WTERMSIG(status) == signal.SIGPROF else "stopped"
    return {PASSED: "survived", FAILED: "failed"}.get(os.WEXITSTATUS(status), "stopped")


def start_regression(manager):
    """The parent: the unchanged block first, then the mutants, ``jobs`` at a time."""
    out = Path(SETTINGS["out"])
    report = os.open(out.with_suffix(".by"), os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_APPEND)
    child = _fork(manager, 0, SETTINGS["baseline_s"], report)
    if child is None:
        return
    _, status, used = os.wait4(child, 0)
    seconds = used.ru_utime + used.ru_stime
    verdicts = {0: _verdict(status)}
    limit = 2 * seconds + 0.2
    waiting = SETTINGS["numbers"][::-1] if verdicts[0] == "survived" else []
    running = {}
    while waiting or running:
        while waiting and len(running) < SETTINGS["jobs"]:
            number = waiting.pop()
            child = _fork(manager, number, limit, report)
            if child is None:
                return
            running[child] = number
        child, status, _ = os.wait4(-1, 0)
        verdicts[running.pop(child)] = _verdict(status)
    by = dict(line.split(" ", 1) for line in out.with_suffix(".by").read_text().splitlines())
    out.write_text(json.dumps({"seconds": seconds, "verdicts": verdicts, "by": by}))
    sys.stdout.flush()
    os._exit(0)


RegressionManager.start_regression = start_regression
