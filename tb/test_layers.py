"""The package's layers: a module imports from its own layer and those below; imports form no cycle."""

import ast
import re

import pytest

import structure
from meissner.builds.toolchain import ROOT

PACKAGE = ROOT / "model/meissner"
CPP = sorted(path for path in PACKAGE.rglob("*") if path.suffix in (".c", ".cpp", ".h", ".hpp"))


def test_every_module_has_a_layer():
    assert sorted(structure.LAYERS, key=structure.LAYERS.index) == structure.LAYERS
    for module in structure.modules():
        assert structure.layer(module) is not None, module


def test_no_import_leads_up():
    up = [
        f"{module} imports {other}"
        for module, others in structure.imports().items()
        for other in others
        if structure.layer(other) > structure.layer(module)
    ]
    assert not up


def test_no_imports_lead_around():
    """Not within a layer either; imports inside functions count too."""
    imports = structure.imports()

    def visit(module, path):
        assert module not in path, " -> ".join([*path[path.index(module) :], module])
        for other in imports[module] - done:
            visit(other, [*path, module])
        done.add(module)

    done = set()
    for module in imports:
        visit(module, [])


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda path: path.stem)
def test_the_package_reads_nothing_of_tests_or_tools(path):
    tree = ast.parse(path.read_text("utf-8"))
    words = [node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)]
    docstrings = {
        ast.get_docstring(node, clean=False)
        for node in ast.walk(tree)
        if hasattr(node, "body") and isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
    }
    for word in words:
        if isinstance(word, str) and word not in docstrings:
            assert not word.startswith(("tb/", "tools/")), word


@pytest.mark.parametrize("path", CPP, ids=lambda path: path.name)
def test_the_package_includes_only_its_own_files(path):
    """Or Verilator's; the wheel has nothing beside the package."""
    for name in re.findall(r'^\s*#\s*include\s*"(.+)"', path.read_text("utf-8"), re.MULTILINE):
        if not re.fullmatch(r"(V|verilated)\w*\.h", name):
            own = (path.parent / name).resolve()
            assert own.is_relative_to(PACKAGE) and own.is_file(), name


def test_twins_compute_in_integers():
    """No twin imports physics, engines or anything else from a layer above, and no package but NumPy."""
    known = {"dataclasses", "enum", "functools", "itertools", "math", "numbers", "numpy", "struct"}
    known |= {"typing", "zlib"}
    for path in (PACKAGE / "twins").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module] if isinstance(node, ast.ImportFrom) else []
            for name in names:
                top = name.split(".")[0]
                assert top in known or name.startswith("meissner.twins"), f"{path.name}: {name}"
