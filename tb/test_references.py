"""docs/references.md: it lists each twin once; the references it names exist and do not use the twin."""

import ast
import re
from functools import cache

import pytest
import references

from meissner.builds import toolchain

PAGE = (toolchain.ROOT / "docs/references.md").read_text()
PACKAGE = toolchain.ROOT / "model/meissner"
MODEL = PACKAGE / "twins"
STAGES = ("actuate", "common", "cop", "frontend", "link", "sensor", "slip")
ROWS = [[cell.strip() for cell in row.split("|")[1:-1]] for row in PAGE.splitlines() if row.startswith("| `")]
COMPUTES = [row for row in ROWS if len(row) == 3]


def test_the_page_is_what_the_tests_state():
    assert references.page(PAGE) == PAGE, "`make blocks`"


def test_a_table_follows_its_statement(monkeypatch):
    monkeypatch.setattr(
        references,
        "stated",
        lambda: {"a/b.py": {"moves": "bytes"}, "c.py": {"against": "`x`", "test": "t::u"}},
    )
    before = "|---|\n| `old` | x |\n\n## M\n\n|---|\n| `old` | y |\n\nend\n"
    after = "|---|\n| `c.py` | `x` | `t::u` |\n\n## M\n\n|---|\n| `a/b.py` | bytes |\n\nend\n"
    assert references.page(before) == after


def test_refuses_a_block_whose_tests_name_no_reference(monkeypatch):
    monkeypatch.setattr(references.evidence, "of", lambda block, kind: {"against": "`x`"})
    with pytest.raises(ValueError, match="needs against and test"):
        references.stated()


def test_every_twin_stands_in_one_table():
    twins = [path for stage in STAGES for path in (MODEL / stage).glob("*.py") if path.stem != "__init__"]
    names = sorted([str(path.relative_to(MODEL)) for path in twins] + ["core.py"])
    assert sorted(row[0].strip("`") for row in ROWS) == names


@cache
def functions(file):
    """Source of each function and table at the top level of a test file, by name."""
    text = (toolchain.ROOT / file).read_text()
    found = {}
    for node in ast.parse(text).body:
        names = [node.name] if isinstance(node, ast.FunctionDef) else []
        if isinstance(node, ast.Assign):
            names = [target.id for target in node.targets if isinstance(target, ast.Name)]
        if names:
            first = node.decorator_list[0].lineno if getattr(node, "decorator_list", None) else node.lineno
            found |= dict.fromkeys(names, "\n".join(text.splitlines()[first - 1 : node.end_lineno]))
    return found


def reached(file, name):
    """The source of a test and of everything it uses from the top level of its file."""
    seen, ahead = {}, [name]
    while ahead:
        one = ahead.pop()
        if one not in seen and one in functions(file):
            seen[one] = functions(file)[one]
            ahead += re.findall(r"\w+", seen[one])
    return "\n".join(seen.values())


@pytest.mark.parametrize("twin, reference, used_by", COMPUTES, ids=[row[0].strip("`") for row in COMPUTES])
def test_the_reference_is_used(twin, reference, used_by):
    file, name = used_by.strip("`").split("::")
    source = reached(file, name)
    assert source, f"{file} has no {name}"
    words = re.findall(r"`(\w+)`", reference)
    assert words
    for word in words:
        assert word in source, f"{name} does not use {word}"
    module = twin.strip("`").removesuffix(".py").replace("/", ".")
    package, _, block = module.rpartition(".")
    text = (toolchain.ROOT / file).read_text()
    wanted = (
        rf"from meissner\.twins\.{module} import|from meissner\.twins\.{package} import .*\b{block}\b"
        rf"|from meissner\.twins import .*\b{module}\b"
    )
    assert re.search(wanted, text), f"{file} does not import the twin"


@pytest.mark.parametrize(
    "path", sorted((toolchain.ROOT / "tb/reference").glob("*.py")), ids=lambda path: path.stem
)
def test_references_read_no_twin(path):
    for node in ast.walk(ast.parse(path.read_text())):
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        names += [node.module] if isinstance(node, ast.ImportFrom) else []
        assert not [name for name in names if name.split(".")[0] == "meissner"]


def test_engine_float_takes_types_and_constants_only():
    """From the twins' files it may import only classes and constants in capitals."""
    for path in (PACKAGE / "engines").glob("float*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and re.match(r"meissner\.twins\b", node.module):
                taken = [alias.name for alias in node.names]
                assert all(name[0].isupper() for name in taken), f"{path.name}: {taken}"
                assert not {"Slip", "SlipSerial", "CopSlip", "Health"} & set(taken)
