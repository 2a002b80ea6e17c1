"""`make nightly`: what a change selects; a broken limit, a check that cannot run or does not end, and a run
of nothing end non-zero; the page names what was not reached."""

import os
import signal
import subprocess
import sys
import tomllib

import pytest

from harness import command
from meissner.builds import toolchain
from nightly import __main__ as nightly
from nightly import limits, page, since

WITHIN = {"text": "fine", "broken": []}


def concerned(*paths):
    return since.concerned(paths, "HEAD")


def test_a_block_selects_all_of_itself_and_three_kinds_of_what_contains_it():
    """By hand: msn_round_sat is in msn_tare and msn_calibrate, and so in msn_core; msn_uart_tx has none."""
    found, shared = concerned("rtl/common/msn_round_sat.sv")
    assert [kind for kind, block in found if block == "round_sat"] == list(since.KINDS)
    assert all(found[kind, "round_sat"] for kind in since.KINDS)
    for around in ("tare", "calibrate", "core"):
        assert {kind for kind, block in found if block == around} == {"proofs", "netlists", "faults"}
        assert not found["faults", around]
    assert ("faults", "uart_tx") not in found and shared == []


@pytest.mark.parametrize(
    "path, kinds, block",
    [
        ("tb/link/test_registers_ends.py", {"netlists", "faults", "mutants", "coverage"}, "registers"),
        ("tb/frontend/test_scan_coincidences.py", {"netlists", "faults", "mutants", "coverage"}, "scan"),
        ("model/meissner/twins/slip/haar.py", {"mutants", "coverage"}, "haar"),
        ("tb/formal/owed_divide.sv", {"proofs"}, "divide"),
        ("tb/coverage/cover_scan.sv", {"coverage"}, "scan"),
    ],
)
def test_other_files_select_the_kinds_that_read_them(path, kinds, block):
    found, _ = concerned(path)
    assert {kind for kind, name in found if name == block} == kinds
    assert not [name for _, name in found if name == "uart_tx"]


def test_what_all_blocks_share_selects_none_and_is_named():
    assert concerned("tb/bench.py", "tools/nightly/faults.py", "README.md") == (
        {},
        ["tb/bench.py", "tools/nightly/faults.py"],
    )
    assert "tb/bench.py" in page.untouched(["tb/bench.py"])


def test_a_row_of_a_table_selects_its_block(monkeypatch):
    """Of the file as it is, and as it was with another depth of one proof and without a waiver."""
    there = {
        path: (toolchain.ROOT / path).read_text("utf-8")
        for path in ("tb/formal/proofs.toml", "tb/coverage/waivers.toml")
    }
    begin = there["tb/formal/proofs.toml"].index("[skid]")
    entry = there["tb/formal/proofs.toml"][begin:]
    there["tb/formal/proofs.toml"] = there["tb/formal/proofs.toml"][:begin] + entry.replace("depth", "#", 1)
    there["tb/coverage/waivers.toml"] += '[[waiver]]\nblock = "fork"\npoints = ["line x"]\nreason = "none"\n'

    def shown(command, **_):
        return subprocess.CompletedProcess(command, 0, there[command[-1].partition(":")[2]], "")

    monkeypatch.setattr(since.subprocess, "run", shown)
    assert [*since.rows_changed("tb/formal/proofs.toml", "HEAD")] == [("proofs", ["skid"])] * 2
    assert list(since.rows_changed("tb/coverage/waivers.toml", "HEAD")) == [("coverage", ["fork"])]


def checks(*facts):
    return [nightly.Check("proofs", f"b{n}", facts=one) for n, one in enumerate(facts)]


def test_exit_codes():
    broken = {"text": "", "broken": ["one"]}
    assert nightly.verdict(checks(WITHIN, WITHIN))[0] == 0
    assert nightly.verdict(checks(WITHIN, broken, None))[0] == 1
    assert nightly.verdict(checks())[0] == nightly.verdict(checks(None))[0] == 2
    assert nightly.verdict(checks(WITHIN, None))[0] == 3


# A check that starts a tool, which says "x" and does not end, and then waits for it or ends itself. Both hold
# the same end of a pipe: its other end is at the end of file when none of them is left.
TOOL = "import os, time; os.write({0}, b'x'); time.sleep(3600)"
CHECK = """
import os, subprocess, sys
tool = subprocess.Popen([sys.executable, "-c", {1!r}], pass_fds=[{0}], stdout=-3, stderr=-3)
{2}
"""
NIGHTLY = """
import subprocess, sys
from nightly import __main__ as nightly
kept = subprocess.Popen
slow = lambda command, **given: kept([sys.executable, "-c", {1!r}], pass_fds=[{0}], **given)
nightly.subprocess.Popen = slow
from pathlib import Path
nightly.FOLDER = Path({2!r})
nightly.run([nightly.Check("proofs", "b0")], 1, None, print)
"""


@pytest.fixture
def held(monkeypatch, tmp_path):
    """(the check's source for how it goes on, its pipe's end for reading, for writing)."""
    monkeypatch.setattr(nightly, "FOLDER", tmp_path)
    ours, theirs = os.pipe()
    yield lambda then: CHECK.format(theirs, TOOL.format(theirs), then), ours, theirs
    os.close(ours)


def run_slowly(monkeypatch, given, code, theirs, seconds):
    kept = subprocess.Popen

    def slow(command, **more):
        return kept([sys.executable, "-c", code], pass_fds=[theirs], **more)

    with monkeypatch.context() as patch:
        patch.setattr(nightly.subprocess, "Popen", slow)
        nightly.run(given, 1, seconds, lambda check: None)
    os.close(theirs)


def test_a_check_that_does_not_end_is_stopped_and_named(monkeypatch, tmp_path, held):
    """Also what it has started, and a check that was not begun."""
    source, ours, theirs = held
    given = checks(None, None)
    run_slowly(monkeypatch, given, source("tool.wait()"), theirs, 2)
    assert os.read(ours, 9) in (b"x", b"") and os.read(ours, 9) == b"", "it waits for what is left"
    assert [check.facts for check in given] == [None, None] and nightly.verdict(given)[0] == 2
    nightly.write(given, page.heading(["proofs"], [], None, []))
    text = (tmp_path / "index.html").read_text()
    assert "2 not reached" in text and "proofs of b1" in text


def test_what_a_check_leaves_behind_ends_with_it(monkeypatch, held):
    source, ours, theirs = held
    run_slowly(monkeypatch, checks(None), source(""), theirs, None)
    assert os.read(ours, 9) in (b"x", b"") and os.read(ours, 9) == b""


@pytest.mark.parametrize("which", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_run_that_is_stopped_takes_its_checks_along(tmp_path, held, which):
    source, ours, theirs = held
    code = NIGHTLY.format(theirs, source("tool.wait()"), str(tmp_path))
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    process = command.python("-c", code, pass_fds=[theirs], env=environment, stderr=subprocess.DEVNULL)
    os.close(theirs)
    assert os.read(ours, 9) == b"x"
    process.send_signal(which)
    assert os.read(ours, 9) == b""
    assert process.wait() == (-signal.SIGINT if which == signal.SIGINT else 128 + which)


def test_what_cannot_run_or_ends_without_a_word_breaks_the_limit(monkeypatch, tmp_path):
    monkeypatch.setattr(nightly, "FOLDER", tmp_path)

    def fails(*_):
        raise RuntimeError("no such tool")

    monkeypatch.setattr(nightly.proofs, "run", fails)
    nightly.one("proofs", "skid", tmp_path / "out", 1)
    assert "no such tool" in (tmp_path / "out").read_text()
    kept = subprocess.Popen
    monkeypatch.setattr(
        nightly.subprocess, "Popen", lambda command, **given: kept([sys.executable, "-c", ""], **given)
    )
    given = checks(None)
    nightly.run(given, 1, None, lambda check: None)
    assert given[0].facts["broken"] and nightly.verdict(given)[0] == 1


def test_an_exception_needs_a_reason():
    row = {"block": "skid", "register": "held", "bit": 0}
    with pytest.raises(ValueError, match="no reason"):
        limits.Limits({"faults": {"undetected": [row]}})
    limits.Limits({"faults": {"undetected": [row | {"reason": "by design"}]}})


def test_exceptions_are_of_blocks_that_are_there():
    """Those of the limits, and the waivers of coverage."""
    table = limits.Limits().table
    rows = [
        row for entry in table.values() for rows in entry.values() if isinstance(rows, list) for row in rows
    ]
    rows += tomllib.loads(nightly.cover.WAIVERS.read_text("utf-8"))["waiver"]
    named = {name for row in rows for name in row.get("blocks") or row["block"].split()}
    assert named | {*table["coverage"]["waived"]} <= {*nightly.cover.blocks(), "*"}


@pytest.mark.parametrize("given", [["nosuch"], ["--kinds", "nosuch"], ["--since", "nosuch"]])
def test_a_wrong_argument_is_refused_in_a_sentence(given):
    command = [sys.executable, "-m", "nightly", *given]
    done = subprocess.run(command, cwd=toolchain.ROOT / "tools", capture_output=True, text=True)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1) and "nosuch" in done.stderr
