"""README and docs/: README's examples and the Python of the other pages run, names of the package exist,
docs/blocks.md matches the sources, links point to existing files."""

import ast
import importlib
import io
import re
import subprocess
import textwrap
from contextlib import redirect_stdout

import numpy as np

import blocks
from meissner.builds import toolchain

ROOT = toolchain.ROOT
README = (ROOT / "README.md").read_text("utf-8")
PAGES = [*ROOT.glob("*.md"), *sorted((ROOT / "docs").rglob("*.md"))]
FENCED = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)
INDENTED = re.compile(r"(?:^    .*\n|^\n(?=    ))+", re.MULTILINE)
NOT_PINNED = {"dask_jobqueue"}  # a page says how to install it


def example(language):
    """The only example of README in that language."""
    [text] = re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)
    return text


def test_the_verilog_of_readme_is_clean(tmp_path):
    """With the flags of `make lint`; the example may waive nothing."""
    source = tmp_path / "pad.sv"
    source.write_text(example("systemverilog"))
    command = ["verilator", "--lint-only", "--quiet", "-Wall", str(ROOT / "rtl/verilator.vlt")]
    command += [
        *map(str, toolchain.sources_of("msn_cop")),
        str(ROOT / "rtl/common/msn_frame_marker.sv"),
        str(source),
        "--top-module",
        "pad",
    ]
    done = subprocess.run(command, env=toolchain.environment(), capture_output=True, text=True)
    assert (done.returncode, done.stdout + done.stderr) == (0, "")


def test_the_python_of_readme_prints_what_it_says():
    """By hand: column 6 of 8 lies 5/7 to the right, row 1 of 4 lies 1/3 up; times 16384, rounded."""
    text = example("python")
    assert "# [11703] [5461]: " in text
    with redirect_stdout(io.StringIO()) as printed:
        exec(compile(text, "README.md", "exec"), {})
    assert printed.getvalue() == "[11703] [5461]\n"


def test_the_page_of_blocks_is_that_of_the_sources():
    assert blocks.PAGE.read_text("utf-8") == blocks.page(), "`make blocks`"


def test_links_lead_to_files_and_headings():
    for path in PAGES:
        text = re.sub(r"```.*?```", "", path.read_text("utf-8"), flags=re.DOTALL)
        for target in re.findall(r"\]\(([^)\s]+)\)", text):
            file, _, heading = target.partition("#")
            if "://" not in target:
                there = path.parent / file if file else path
                assert there.exists(), f"{path.name}: {target}"
                if heading:
                    heads = re.findall(r"^#+ (.+)$", there.read_text("utf-8"), re.MULTILINE)
                    slugs = [re.sub(r"[^\w -]", "", head.lower()).replace(" ", "-") for head in heads]
                    assert heading in slugs, f"{path.name}: {target}"


def examples(text):
    """The page's blocks of Python: those fenced as such, and indented ones that import something.

    The files and changes of docs/adding.md have other fences: tb/verify/test_adding.py runs them.
    """
    plain = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    indented = [textwrap.dedent(block) for block in INDENTED.findall(plain)]
    imports = re.compile(r"^(?:from \S+ )?import ", re.MULTILINE)
    return FENCED.findall(text) + [block for block in indented if imports.search(block)]


def named(dotted):
    """What a dotted name such as meissner.host.connect stands for; ImportError or AttributeError."""
    parts = dotted.split(".")
    for count in range(len(parts), 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:count]))
        except ModuleNotFoundError as error:
            if count == 1 or not dotted.startswith(error.name):
                raise
            continue
        for part in parts[count:]:
            found = getattr(found, part)
        return found


def names_of(tree):
    """The dotted names of imported things that a block uses."""
    imported = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            imported |= {alias.asname or alias.name.split(".")[0]: alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            imported |= {alias.asname or alias.name: f"{node.module}.{alias.name}" for alias in node.names}
    used = set(imported.values())
    for node in ast.walk(tree):
        attributes = []
        while isinstance(node, ast.Attribute):
            attributes, node = [node.attr, *attributes], node.value
        if attributes and isinstance(node, ast.Name) and node.id in imported:
            used.add(".".join([imported[node.id], *attributes]))
    return sorted(name for name in used if name.split(".")[0] not in NOT_PINNED)


def test_names_in_examples_exist():
    """Every block of Python compiles, and what it imports, or reaches from an import, exists."""
    for path in PAGES:
        for block in examples(path.read_text("utf-8")):
            for name in names_of(ast.parse(block)):
                named(name)


def test_names_of_the_package_in_the_text_exist():
    """In docs/host.md `host` stands for meissner.host."""
    files = {"meissner.core"}  # FuseSoC's
    for path in PAGES:
        roots = {"meissner": "meissner"} | ({"host": "meissner.host"} if path.name == "host.md" else {})
        for root, rest in re.findall(rf"`({'|'.join(roots)})((?:\.\w+)+)[`(]", path.read_text("utf-8")):
            if root + rest not in files and not rest.endswith((".c", ".h", ".md")):
                named(roots[root] + rest)


def replaced(text, *pairs):
    """``text`` with each first string, which it has exactly once, replaced by the second."""
    for one, other in pairs:
        assert text.count(one) == 1, one
        text = text.replace(one, other)
    return text


def test_the_examples_of_the_host_run():
    """With the simulated core in place of the serial port, and packets until the line is empty."""
    of_line, of_pty = FENCED.findall((ROOT / "docs/host.md").read_text("utf-8"))
    here = {}
    text = replaced(
        of_line, ('"serial:/dev/ttyUSB0?baud=3000000"', '"sim:"'), ("core.packets()", "core.packets(0.1)")
    )
    with redirect_stdout(io.StringIO()) as printed:
        exec(compile(text, "host.md", "exec"), here)
    assert "CopFrame(" in printed.getvalue()
    exec(compile(of_pty, "host.md", "exec"), here)


def test_the_examples_of_the_mesh_run():
    """A load per example: of the published mesh, and of the one with a cut."""
    text = (ROOT / "docs/mesh.md").read_text("utf-8")
    here = {}
    for block, shape in zip(FENCED.findall(text), ((41, 41), (1, 3, 3)), strict=True):
        here["load"] = np.full(shape, 0.1)
        exec(compile(block, "mesh.md", "exec"), here)
