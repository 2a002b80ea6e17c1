"""Which cocotb tests apply to which build, and whether each test ran in at least one build.

``@bench.applies(lambda dut, ...: ...)``, above ``@cocotb.test``, states the condition under which a test
applies to a build. In a build that does not meet it the test is left out. Every test must run in at least one
build of its own file; ``Watch`` collects the tests that ran, over all builds and all workers of pytest-xdist,
and fails the session if a test ran in none.
"""

import inspect
from pathlib import Path

import cocotb
import pytest
from cocotb.regression import TestGenerator

# For each selection by marks: ``long`` of the tests that it must run (True: `make test-long` has all builds).
SELECTIONS = {"": (False, True), "not long and not big": (False,), "long or big": (True,)}
serving = False  # a simulator of several builds: which tests apply is known when it runs one (together.py)
RAN = set()  # "stage.test_block.test" of every test that ran in this process


def applies(condition, long=False):
    """Declare that a cocotb test applies to builds for which ``condition(dut, ...)`` is true.

    The other parameters of ``condition`` are parameters of the test, by name. ``long``: whether `make
    test-long` has all builds that the test applies to, or a function of test parameters that returns this.
    """

    def given(test, function, first):
        return {name: test.kwargs[name] for name in list(inspect.signature(function).parameters)[first:]}

    def declare(generator):
        generate = generator.generate_tests

        def those_that_apply():
            for test in generate():
                test.long = long(**given(test, long, 0)) if callable(long) else long
                if serving or not cocotb.is_simulation or condition(cocotb.top, **given(test, condition, 1)):
                    yield test

        generator.generate_tests = those_that_apply
        return generator

    return declare


def whole(dut):
    """Whether the sources themselves were built: in a netlist of mutants (verify.mutate) the inner blocks can
    be read, but not driven."""
    return not hasattr(dut, "mutsel")


def of(module):
    """{name: long} of the cocotb tests that a module defines."""
    found = [value for value in vars(module).values() if isinstance(value, TestGenerator)]
    own = [generator for generator in found if generator.module == module.__name__]
    return {test.name: getattr(test, "long", False) for each in own for test in each.generate_tests()}


def missing(declared, ran, marks):
    """Tests of ``declared`` {module: {name: long}} that a selection by ``marks`` must run but did not."""
    kinds = SELECTIONS.get(marks, ())
    named = ((f"{module}.{name}", long) for module, tests in declared.items() for name, long in tests.items())
    return sorted(name for name, long in named if long in kinds and name not in ran)


class Watch:
    """A pytest plugin: fails a session that ran complete files if one of their cocotb tests ran in no
    build."""

    def __init__(self, config, folder, judges):
        self.config, self.folder = config, folder
        self.declared, self.ran, self.spoilt, self.gone = {}, set(), set(), []
        options = config.option
        narrowed = options.keyword or getattr(options, "deselect", None) or getattr(options, "lf", False)
        self.judges = judges and not narrowed and not options.collectonly
        # A file is not judged if only some of its tests were selected.
        self.partial = {self.module_of(Path(arg.split("::")[0])) for arg in config.args if "::" in arg}

    def module_of(self, path):
        """stage.test_block, the name by which the simulator knows the module."""
        path = self.config.invocation_params.dir / path
        inside = path.resolve().is_relative_to(self.folder)
        return ".".join(path.resolve().relative_to(self.folder).with_suffix("").parts) if inside else ""

    @pytest.hookimpl(tryfirst=True)
    def pytest_collection_modifyitems(self, items):
        """Collect the declared tests before any item is deselected."""
        for module in {item.module for item in items if getattr(item, "module", None)}:
            self.declared[self.module_of(Path(module.__file__))] = of(module)

    def pytest_runtest_logreport(self, report):
        if report.outcome != "passed":  # failed, or a build that this machine cannot make
            self.spoilt.add(self.module_of(self.config.rootpath / report.nodeid.split("::")[0]))

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node):
        """A worker of pytest-xdist ended; one that crashed has no output, so then nothing is judged."""
        said = getattr(node, "workeroutput", {}).get("bodies")
        self.judges = self.judges and said is not None
        if said:
            self.declared |= said["declared"]
            self.ran |= set(said["ran"])

    def pytest_sessionfinish(self, session, exitstatus):
        if hasattr(self.config, "workerinput"):  # a worker: the session that started it judges
            self.config.workeroutput["bodies"] = {"declared": self.declared, "ran": sorted(RAN)}
            return
        ended = exitstatus in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED)
        if not ended or not self.judges or session.shouldstop or session.shouldfail:
            return
        judged = {k: v for k, v in self.declared.items() if k not in self.spoilt | self.partial}
        self.gone = missing(judged, self.ran | RAN, self.config.option.markexpr)
        if self.gone:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def pytest_terminal_summary(self, terminalreporter):
        for name in self.gone:
            terminalreporter.write_line(f"FAILED {name}: it ran in no build", red=True)
