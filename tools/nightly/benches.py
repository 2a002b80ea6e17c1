"""The blocks, and the parameters with which the tests build each one, taken from the tests themselves."""

import ast
import json
import os
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path

from meissner.builds import toolchain

PLUGIN = """
import functools, inspect, json, os
import bench
builds = functools.cache(lambda function: "bench.run(" in inspect.getsource(function))
def pytest_collection_modifyitems(items):
    items[:] = [i for i in items if builds(i.function)]
def _run(stage, block, parameters=None, test_filter=None, module=None, sources=None, **_):
    given = {k: str(v) for k, v in (parameters or {}).items()}
    told = {"stage": stage, "block": block, "parameters": given, "test_filter": test_filter,
            "module": module or f"test_{block}", "sources": [str(s) for s in sources or []]}
    with open(os.environ["MEISSNER_RUNS"], "a") as file:
        file.write(json.dumps(told) + chr(10))
bench.run = _run
"""


def cocotb_for_make():
    """Let cocotb's runner write its own folders into makefiles as make can read them: without this, the
    second build in a checkout whose path has a space fails."""
    import cocotb_tools.config as config

    for folder in ("libs_dir", "share_dir"):
        setattr(config, folder, toolchain.for_make(getattr(config, folder)))


def side_by_side(block, top, sizes):
    """Verilog of a ``top`` without ports that holds the block in all these sizes, as u_0, u_1, ..."""
    lines = ["// verilator lint_off PINMISSING", f"module {top};"]
    for number, size in enumerate(sizes):
        values = ", ".join(f".{name}({value})" for name, value in size.items())
        lines.append(f"  msn_{block} #({values}) u_{number} ();")
    return "\n".join([*lines, "endmodule", ""])


def blocks():
    """Names of all blocks in rtl/rtl.f, in its order, without msn_ and without packages."""
    names = [path.stem.removeprefix("msn_") for path in toolchain.sources()]
    return [name for name in names if not name.endswith("pkg")]


@cache
def stage_of(block):
    path = next((path for path in toolchain.sources() if path.stem == f"msn_{block}"), None)
    if path is None:
        raise ValueError(f"rtl/rtl.f has no block {block}")
    return "core" if path.parent.name == "rtl" else path.parent.name


def inner(block):
    """Names of the blocks, and packages, inside a block."""
    return {path.stem.removeprefix("msn_") for path in toolchain.sources_of(f"msn_{block}")} - {block}


@cache
def _imported(text):
    """Names of modules that the imports of a Python file may refer to."""
    names = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    return names


def imports(path):
    """Files of tb/ that a test imports, directly or indirectly."""
    found, waiting = set(), [path]
    while waiting:
        names = _imported(waiting.pop().read_text("utf-8"))
        files = {toolchain.ROOT / "tb" / f"{name.replace('.', '/')}.py" for name in names}
        new = {file for file in files - found if file.exists()}
        waiting += new
        found |= new
    return found - {path}


@cache
def runs(*names):
    """Every bench.run() call in these blocks' tests (default: all) as a dict of arguments; nothing runs."""
    tests = [f"tb/{stage_of(name)}/test_{name}.py" for name in names or blocks()]
    with tempfile.TemporaryDirectory() as folder:
        told = Path(folder) / "runs"
        told.touch()
        (Path(folder) / "told_runs.py").write_text(PLUGIN)
        paths = [folder, str(toolchain.ROOT / "tb"), *filter(None, [os.environ.get("PYTHONPATH")])]
        done = subprocess.run(
            [sys.executable, "-m", "pytest", "-p", "told_runs", "-q", *tests],
            cwd=toolchain.ROOT,
            env={
                **os.environ,
                "PYTHONPATH": os.pathsep.join(paths),
                "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",  # importing all plugins takes a second
                "MEISSNER_RUNS": str(told),
            },
            capture_output=True,
            text=True,
        )
        if done.returncode:
            raise RuntimeError(f"the tests did not say what they build:\n{done.stdout}{done.stderr}")
        return [json.loads(line) for line in told.read_text().splitlines()]
