"""The package's layers: a module imports from its own layer and those below; imports form no cycle; twins
compute in integers; the package needs nothing outside itself."""

import ast
import re

import structure
from meissner.builds.toolchain import ROOT

PACKAGE = ROOT / "model/meissner"


def test_no_import_leads_up():
    for module, others in structure.imports().items():
        assert structure.layer(module) is not None, module
        up = [other for other in others if structure.layer(other) > structure.layer(module)]
        assert not up, f"{module} imports {up}"


def test_no_imports_lead_around():
    """Not within a layer either; imports inside functions count too, those for a type checker do not."""
    imports = structure.imports(types=False)

    def visit(module, path):
        assert module not in path, " -> ".join([*path[path.index(module) :], module])
        for other in imports[module] - done:
            visit(other, [*path, module])
        done.add(module)

    done = set()
    for module in imports:
        visit(module, [])


def test_the_package_includes_only_its_own_files():
    """Or Verilator's; the wheel has nothing beside the package."""
    for path in PACKAGE.rglob("*"):
        if path.suffix in (".c", ".cpp", ".h", ".hpp"):
            for name in re.findall(r'^\s*#\s*include\s*"(.+)"', path.read_text("utf-8"), re.MULTILINE):
                own = (path.parent / name).resolve()
                inside = own.is_relative_to(PACKAGE) and own.is_file()
                assert inside or re.fullmatch(r"(V|verilated)\w*\.h", name), f"{path}: {name}"


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
