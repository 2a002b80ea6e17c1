"""Which cocotb tests apply to which build, and whether each ran in one.

``@bench.applies(lambda dut, ...: ...)``, above ``@cocotb.test``, states the condition under which a test
belongs to a build. In a build that does not meet it the test is absent. Every test must run in at least one
build of its own file; ``Watch`` collects over all builds, and over the workers of pytest-xdist, what ran, and
fails the session if a test ran in none.
"""

import inspect
from pathlib import Path

import cocotb
import pytest
from cocotb.regression import TestGenerator

# What a selection by marks must run: tests of any build, or those whose builds are all in `make test-long`.
SELECTIONS = {"": (False, True), "not long and not big": (False,), "long or big": (True,)}
RAN = set()  # "stage.test_block.test" of every test that ran, by this process


def applies(condition, long=False):
    """Declare that a cocotb test applies to builds for which ``condition(dut, ...)`` is true.

    The further parameters of ``condition`` are parameters of the test, by name. ``long``: all builds that it
    applies to are left to `make test-long`; or a function of parameters of the test, which says so.
    """

    def given(test, function, first):
        return {name: test.kwargs[name] for name in list(inspect.signature(function).parameters)[first:]}

    def declare(generator):
        generate = generator.generate_tests

        def those_that_apply():
            for test in generate():
                test.long = long(**given(test, long, 0)) if callable(long) else long
                if not cocotb.is_simulation or condition(cocotb.top, **given(test, condition, 1)):
                    yield test

        generator.generate_tests = those_that_apply
        return generator

    return declare


def whole(dut):
    """Whether the build is of the sources: in a netlist of mutants (verify.mutate) blocks inside can be seen,
    but not given values."""
    return not hasattr(dut, "mutsel")


def of(module):
    """{name: whether only `make test-long` has its builds} of the cocotb tests that a module defines."""
    found = [value for value in vars(module).values() if isinstance(value, TestGenerator)]
    own = [generator for generator in found if generator.module == module.__name__]
    return {test.name: getattr(test, "long", False) for each in own for test in each.generate_tests()}


def missing(declared, ran, marks):
    """Tests of ``declared`` {module: {name: long}} that a selection by ``marks`` must run and did not."""
    kinds = SELECTIONS.get(marks, ())
    named = ((f"{module}.{name}", long) for module, tests in declared.items() for name, long in tests.items())
    return sorted(name for name, long in named if long in kinds and name not in ran)


class Watch:
    """A pytest plugin: fails a session that ran whole files if one of their cocotb tests ran in no build."""

    def __init__(self, config, folder, judges):
        self.config, self.folder = config, folder
        self.declared, self.ran, self.spoilt, self.gone = {}, set(), set(), []
        options = config.option
        narrowed = options.keyword or getattr(options, "deselect", None) or getattr(options, "lf", False)
        self.judges = judges and not narrowed and not options.collectonly
        # A file of which single tests were asked for is no whole file.
        self.partial = {self.module_of(Path(arg.split("::")[0])) for arg in config.args if "::" in arg}

    def module_of(self, path):
        """stage.test_block, as the simulator calls the module."""
        path = self.config.invocation_params.dir / path
        inside = path.resolve().is_relative_to(self.folder)
        return ".".join(path.resolve().relative_to(self.folder).with_suffix("").parts) if inside else ""

    @pytest.hookimpl(tryfirst=True)
    def pytest_collection_modifyitems(self, items):
        """Before any are deselected."""
        for module in {item.module for item in items if getattr(item, "module", None)}:
            self.declared[self.module_of(Path(module.__file__))] = of(module)

    def pytest_runtest_logreport(self, report):
        if report.outcome != "passed":  # failed, or a build that this machine cannot make
            self.spoilt.add(self.module_of(self.config.rootpath / report.nodeid.split("::")[0]))

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node):
        """A worker of pytest-xdist ended; one that crashed says nothing."""
        said = getattr(node, "workeroutput", {}).get("bodies")
        self.judges = self.judges and said is not None
        if said:
            self.declared |= said["declared"]
            self.ran |= set(said["ran"])

    def pytest_sessionfinish(self, session, exitstatus):
        if hasattr(self.config, "workerinput"):  # a worker: who started it judges
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
