"""Which cocotb tests apply to which build, and that each ran in at least one.

``@bench.applies(lambda dut, ...: ...)``, above ``@cocotb.test``, states the condition under which a test
applies to a build; elsewhere it is left out. ``Watch`` collects what ran, over all builds and all workers of
pytest-xdist, and fails a session of whole files if one of their cocotb tests ran in no build: a condition
that no build meets would otherwise pass for ever.
"""

import inspect
from pathlib import Path

import cocotb
import pytest
from cocotb.regression import TestGenerator

# For each selection by marks: ``long`` of the tests that it must run (True: `make test-long` has all builds).
SELECTIONS = {"": (False, True), "not long and not big": (False,), "long or big": (True,)}
serving = (
    False  # a simulator of several builds: which tests apply is known when it runs one (shared_builds.py)
)
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
    """Whether the sources themselves were built: in a netlist of mutants (nightly.mutate) the inner blocks
    can be read, but not driven."""
    return not hasattr(dut, "mutsel")


def is_top(dut):
    """Whether the block is built alone, not beside other sizes: a port of the top cannot be put."""
    return "." not in dut._path


def declared(module):
    """{name: long} of the cocotb tests that a module defines."""
    found = [value for value in vars(module).values() if isinstance(value, TestGenerator)]
    own = [generator for generator in found if generator.module == module.__name__]
    return {test.name: getattr(test, "long", False) for each in own for test in each.generate_tests()}


class Watch:
    """A pytest plugin that judges a session as described above, unless its user chose single tests."""

    def __init__(self, config, folder, judges):
        self.config, self.folder = config, folder
        self.declared, self.spoilt, self.gone = {}, set(), []
        options = config.option
        chosen = options.keyword or getattr(options, "deselect", None) or getattr(options, "lf", False)
        chosen = chosen or options.collectonly or any("::" in arg for arg in config.args)
        self.judges = judges and not chosen

    def module_of(self, path):
        """stage.test_block, the name by which the simulator knows the module."""
        inside = path.is_relative_to(self.folder)
        return ".".join(path.relative_to(self.folder).with_suffix("").parts) if inside else ""

    @pytest.hookimpl(tryfirst=True)
    def pytest_collection_modifyitems(self, items):
        """Collect the declared tests before any item is deselected."""
        for module in {item.module for item in items if getattr(item, "module", None)}:
            self.declared[self.module_of(Path(module.__file__))] = declared(module)

    def pytest_runtest_logreport(self, report):
        if report.outcome != "passed":  # failed, or a build that this machine cannot make
            self.spoilt.add(self.module_of(self.config.rootpath / report.nodeid.split("::")[0]))

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node):
        """A worker of pytest-xdist ended; one that crashed has no output, so then nothing is judged."""
        said = getattr(node, "workeroutput", {}).get("applicable")
        self.judges = self.judges and said is not None
        if said:
            self.declared |= said[0]
            RAN.update(said[1])

    def pytest_sessionfinish(self, session, exitstatus):
        if hasattr(self.config, "workerinput"):  # a worker: the session that started it judges
            self.config.workeroutput["applicable"] = self.declared, sorted(RAN)
            return
        ended = exitstatus in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED)
        if not ended or not self.judges or session.shouldstop or session.shouldfail:
            return
        kinds = SELECTIONS.get(self.config.option.markexpr, ())
        judged = {module: tests for module, tests in self.declared.items() if module not in self.spoilt}
        named = {f"{module}.{name}": long for module, tests in judged.items() for name, long in tests.items()}
        self.gone = sorted(name for name, long in named.items() if long in kinds and name not in RAN)
        if self.gone:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def pytest_terminal_summary(self, terminalreporter):
        for name in self.gone:
            terminalreporter.write_line(f"FAILED {name}: it ran in no build", red=True)
