"""Several parameter sets of a block side by side in one build, and one process from which each is simulated.

A build of a small block takes a second, a third of it the compiler's start on the runtime's headers; a
simulation takes another third of a second to import what every simulation imports. So the tests of a file
that build a block share a top without ports, in which each parameter set is an instance. Its simulator starts
once in each worker, imports the tests, and forks for each run: a run sees an instance in which no clock has
passed, as if it had been built and started alone. The blocks' 1,914 tests take 436 s of processor in place of
514: 6 % of `make test`.
"""

import atexit
import ctypes
import fcntl
import inspect
import json
import os
import signal
import socket
import subprocess
import sys
from functools import cache

import cocotb
from cocotb.regression import RegressionManager

from harness import applicable
from harness.compile_models import Units
from meissner.builds import toolchain

INSTANCE = "MEISSNER_INSTANCE"  # the instance that a simulation's tests take for the top
SERVE = "MEISSNER_SERVE"  # the file descriptor over which a simulator is asked to run tests
PR_SET_PDEATHSIG = 1  # of linux/prctl.h
MOST = 12  # parameter sets in a build: a build is one compiler process
LARGE = 80_000  # bytes of RTL from which a block is built alone: several take as long in one build

of_session = []  # the tests that pytest will run (conftest.py)
_asked = None  # while the calls of a test file are collected: [(block, parameters)]


def collecting(block, parameters, alone):
    """Whether this call only tells what it would build."""
    if _asked is not None and not alone:
        _asked.append((block, parameters))
    return _asked is not None


@cache
def calls_run(function):
    """Whether a test calls ``bench.run``. Reading a source takes a millisecond: only of functions that have
    both names."""
    names = getattr(function, "__code__", None) and function.__code__.co_names
    return bool(names) and {"bench", "run"} <= {*names} and "bench.run(" in inspect.getsource(function)


@cache
def _builds(file):
    """What the tests of a file ask for, in their order: {block: [parameters]}.

    Their functions run here without building. One that has fixtures, or that fails, builds alone."""
    global _asked
    found = {}
    for item in of_session:
        given = item.callspec.params if hasattr(item, "callspec") else {}
        fixtures = set(item.fixturenames) - set(given)
        if item.nodeid.split("::")[0] != file or fixtures or not calls_run(item.function):
            continue
        _asked = []
        try:
            item.function(**given)
            for block, parameters in _asked:
                if parameters not in found.setdefault(block, []):
                    found[block].append(parameters)
        except Exception:  # it fails again where it is reported
            pass
        finally:
            _asked = None
    return found


def group(block, parameters):
    """The parameter sets of the build that has these, for the test which pytest runs now; [] if they are
    built alone."""
    if sum(path.stat().st_size for path in toolchain.sources_of(f"msn_{block}")) > LARGE:
        return []
    file = os.environ.get("PYTEST_CURRENT_TEST", "").split("::")[0]
    listed = _builds(file).get(block, [])
    if parameters not in listed:
        return []
    first = listed.index(parameters) // MOST * MOST
    sizes = listed[first : first + MOST]
    return sizes if len(sizes) > 1 else []


class Side(Units):
    """cocotb's runner for the instance of ``parameters`` in a build of several ``sizes``."""

    def __init__(self, block, sizes, parameters):
        super().__init__([f"msn_{block}.*"])
        self.block, self.sizes, self.number = block, sizes, sizes.index(parameters)

    def build(self, sources, build_dir, **options):
        from nightly.benches import side_by_side  # in tools/, which is not on a simulation's path

        build_dir.mkdir(parents=True, exist_ok=True)
        with open(build_dir / "lock", "w") as lock:  # another worker may run other tests of this build
            fcntl.flock(lock, fcntl.LOCK_EX)
            top = build_dir / f"{options['hdl_toplevel']}.sv"
            top.write_text(side_by_side(self.block, top.stem, self.sizes), "utf-8")
            # All instances share one function for each domain; GCC's time grows faster than its size.
            options["build_args"] = [*options["build_args"], "--output-split-cfuncs", "50"]
            super().build(sources=[*sources, top], build_dir=build_dir, **options)

    def _execute(self, cmds, cwd):
        self.env[INSTANCE] = f"u_{self.number}"
        again = self.env.get("COCOTB_REWRITE_ASSERTION_FILES")  # a failed run, with the values it compared
        if again or len(cmds) > 1:
            return super()._execute(cmds, cwd)
        status = Server.of(cmds[0], cwd, self.env).run(self.env)
        if status:
            raise RuntimeError(f"the simulation of u_{self.number} ended with {status}")


class Server:
    """A simulator that waits for what to run. Only the last is kept: tests of a file follow each other."""

    last = None

    def __init__(self, command, cwd, env):
        self.key = command, cwd, env["COCOTB_TEST_MODULES"]
        ours, theirs = socket.socketpair()
        with theirs:
            env = env | {SERVE: str(theirs.fileno())}
            self.process = subprocess.Popen(command, cwd=cwd, env=env, pass_fds=[theirs.fileno()])
        self.socket, self.lines = ours, ours.makefile("rw", encoding="utf-8")

    @classmethod
    def of(cls, command, cwd, env):
        if cls.last and cls.last.key != (command, cwd, env["COCOTB_TEST_MODULES"]):
            cls.stop()
        cls.last = cls.last or cls(command, cwd, env)
        return cls.last

    @classmethod
    def stop(cls, at_once=False):
        """End it, after the simulation that may be under way or ``at_once``."""
        if cls.last:
            cls.last.socket.shutdown(socket.SHUT_RDWR)
            if at_once:
                cls.last.process.kill()
            cls.last.process.wait()
            cls.last.lines.close()
            cls.last.socket.close()
            cls.last = None

    def run(self, env):
        """Run what ``env`` says; return the exit status, or "no answer" if the simulator is gone."""
        try:
            self.lines.write(json.dumps(env) + "\n")
            self.lines.flush()
            said = self.lines.readline()
        except OSError:
            said = ""
        except BaseException:  # the test's time is over, or Ctrl-C: the simulation may never end
            Server.stop(at_once=True)
            raise
        if not said:
            Server.stop()
            return "no answer"
        return int(said)


atexit.register(Server.stop)


def _end_without_threads():
    """Let a forked process end: with its parent, and though Verilator's runtime would wait for a thread that
    only its parent has."""
    library = ctypes.CDLL(None)
    library.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    library.on_exit(library._exit, None)  # with the simulator's status, before any destructor
    library.on_exit(library.fcloseall, None)  # before that: the last registered is called first


def serve(manager):
    """RegressionManager.start_regression, in a simulator that runs its tests as often as it is asked to."""
    channel = socket.socket(fileno=int(os.environ[SERVE]))
    lines = channel.makefile("rw", encoding="utf-8")
    for line in lines:
        sys.stdout.flush()
        child = os.fork()
        if not child:
            os.environ.clear()
            os.environ.update(json.loads(line))
            cocotb.top = getattr(cocotb.top, os.environ[INSTANCE])
            applicable.serving = False
            _end_without_threads()
            manager._test_queue.clear()
            manager.discover_tests(*os.environ["COCOTB_TEST_MODULES"].split(","))
            manager._filters.clear()
            if select := os.environ.get("COCOTB_TEST_FILTER"):
                manager.add_filters(select)
            return _start(manager)
        _, status = os.waitpid(child, 0)
        lines.write(f"{os.waitstatus_to_exitcode(status)}\n")
        lines.flush()
    os._exit(0)


_start = RegressionManager.start_regression


def install():
    """In a simulation: of one instance, or of all that it is asked for."""
    if SERVE in os.environ:
        applicable.serving = True
        RegressionManager.start_regression = serve
    elif INSTANCE in os.environ:
        cocotb.top = getattr(cocotb.top, os.environ[INSTANCE])
