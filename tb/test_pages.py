"""README and docs/: README's examples run, docs/blocks.md matches the sources, links point to existing
files."""

import io
import re
import subprocess
from contextlib import redirect_stdout

import pytest

import blocks
from meissner.builds import toolchain

ROOT = toolchain.ROOT
README = (ROOT / "README.md").read_text("utf-8")
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]


def example(language):
    """The only example of README in that language."""
    [text] = re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)
    return text


def test_readme_is_short():
    assert len(README.splitlines()) <= 150


def test_readme_leads_to_every_page():
    linked = set(re.findall(r"\((docs/\w+\.md)\)", README))
    assert linked == {str(path.relative_to(ROOT)) for path in PAGES if path.parent.name == "docs"}


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


@pytest.fixture
def source(tmp_path, monkeypatch):
    """A function that writes a source file with the given header."""
    monkeypatch.setattr(toolchain, "ROOT", tmp_path)
    (tmp_path / "tb/cop").mkdir(parents=True)
    (tmp_path / "tb/cop/test_mean.py").touch()
    (tmp_path / "rtl/cop").mkdir(parents=True)

    def write(*lines):
        path = tmp_path / "rtl/cop/msn_mean.sv"
        path.write_text(
            "\n".join(f"// {line}".rstrip() for line in ("SPDX", "", *lines)) + "\nmodule\n// No.\n"
        )
        return path

    return write


def test_a_block_s_row_is_its_header(source):
    path = source(
        "Mean of channels 0 .. 3, |x| up to",
        "1.5. Not of more:",
        "",
        "  y = x / 4",
        "",
        "A header, not its Latency table. Latency 2 clocks, a",
        "sample a clock. Model: model/meissner/twins/cop/mean.py",
    )
    assert blocks.row(path) == (
        "| [`msn_mean`](../rtl/cop/msn_mean.sv) | cop | Mean of channels 0 .. 3, \\|x\\| up to 1.5 | "
        "2 clocks, a sample a clock | [`cop/mean.py`](../model/meissner/twins/cop/mean.py) | "
        "[`cop/test_mean.py`](../tb/cop/test_mean.py) |"
    )


@pytest.mark.parametrize(
    ("lines", "purpose", "latency"),
    [
        (("Load of x:", "  y = x"), "Load of x", ""),
        (("Sum, exact:   y = x", "Combinational."), "Sum, exact", "0 clocks"),
        (("A pair. Combinational beside it.", "", "More."), "A pair", "0 clocks beside it"),
        (("Made by a tool.", "", "What it is.", "Latency: that of it."), "What it is", "that of it"),
        (("A path.", "Latency and formats are those of msn_x."), "A path", "those of msn_x"),
    ],
)
def test_sentences_of_headers(source, lines, purpose, latency):
    found = blocks.header(source(*lines))
    assert (blocks.purpose(found), blocks.latency(found)) == (purpose, latency)


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_links_lead_to_files_and_headings(path):
    text = re.sub(r"```.*?```", "", path.read_text("utf-8"), flags=re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        file, _, heading = target.partition("#")
        if "://" not in target:
            there = path.parent / file if file else path
            assert there.exists(), target
            if heading:
                heads = re.findall(r"^#+ (.+)$", there.read_text("utf-8"), re.MULTILINE)
                assert heading in [re.sub(r"[^\w -]", "", head.lower()).replace(" ", "-") for head in heads]
