"""What the twins are compared with is not made from them: the references import nothing of the package, and
engine float imports no code of a twin."""

import ast
import re

from meissner.builds import toolchain


def test_references_read_no_twin():
    paths = sorted((toolchain.ROOT / "tb/reference").glob("*.py"))
    assert paths
    for path in paths:
        for node in ast.walk(ast.parse(path.read_text())):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module] if isinstance(node, ast.ImportFrom) else []
            assert not [name for name in names if name.split(".")[0] == "meissner"], path


def test_engine_float_takes_types_and_constants_only():
    """From the twins' files it may import only classes and constants in capitals."""
    for path in (toolchain.ROOT / "model/meissner/engines").glob("float*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and re.match(r"meissner\.twins\b", node.module):
                taken = [alias.name for alias in node.names]
                assert all(name[0].isupper() for name in taken), f"{path.name}: {taken}"
                assert not {"Slip", "SlipSerial", "CopSlip", "Health"} & set(taken)
