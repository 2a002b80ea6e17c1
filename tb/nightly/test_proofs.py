"""The quickest proofs, at their defaults, and whether `make formal` can fail: a planted bug, a proof that
proves nothing, an unknown name."""

import subprocess
import sys

import pytest

from meissner.builds import toolchain
from verify import formal, formal_mutants

BUGS = {  # proof: file, text, and its replacement
    "skid": ("rtl/common/msn_skid.sv", "if (!held) kept", "if (out_ready_i) kept"),
    "fork": ("rtl/common/msn_fork.sv", "&& !a_has", ""),
    # When full it reads and writes one place in a clock: the order is right, but the memory's output is
    # undefined.
    "fifo": (
        "rtl/common/msn_fifo.sv",
        "in_ready_o = !full;",
        "in_ready_o = !full || out_ready_i;",
    ),
}


def quick():
    return [name for name, proof in formal.proofs().items() if proof.quick]


@pytest.fixture
def elsewhere(monkeypatch, tmp_path_factory):
    """A folder of its own, so that proofs of different tests do not interfere."""
    out = f"build/formal/{tmp_path_factory.mktemp('quick').name}"
    (toolchain.ROOT / out).mkdir(parents=True, exist_ok=True)
    monkeypatch.setattr(formal, "OUT", out)
    return out


def changed(monkeypatch, out, path, old, new):
    """Proofs read ``path`` with ``old`` replaced by ``new``."""
    text = (toolchain.ROOT / path).read_text()
    assert old in text
    copy = f"{out}/{path.split('/')[-1]}"
    (toolchain.ROOT / copy).write_text(text.replace(old, new))
    listed = formal.sources
    monkeypatch.setattr(
        formal, "sources", lambda proof: [copy if file == path else file for file in listed(proof)]
    )


@pytest.mark.parametrize("name", quick())
def test_holds(name, elsewhere):
    result = formal.prove(formal.proofs()[name], {}, ["default"])
    assert not result.wrong and set(formal.SOLVERS) <= set(result.seconds)


@pytest.mark.parametrize("name", BUGS)
def test_planted_bug_is_found(name, elsewhere, monkeypatch):
    changed(monkeypatch, elsewhere, *BUGS[name])
    assert formal.prove(formal.proofs()[name], {}, ["default"]).wrong


def test_proof_of_nothing_fails(elsewhere, monkeypatch):
    silent = "  always_comb assume (!in_valid_i);"
    changed(monkeypatch, elsewhere, "tb/formal/skid.sv", "  // Invariant.", silent)
    wrong = formal.prove(formal.proofs()["skid"], {}, ["default"]).wrong
    assert wrong and all("not reached" in text for text in wrong)


def test_unknown_name_is_one_sentence():
    command = [sys.executable, str(toolchain.ROOT / "tools/formal.py"), "nothing"]
    done = subprocess.run(command, cwd=toolchain.ROOT, capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr.startswith("formal: no proof or block is called nothing")


def test_a_block_is_broken_in_its_own_cells():
    """Not in cells of an inner block that has a proof of its own, nor in cells that make a wire free."""

    def broken(proof, cell, *sources):
        line = f"mutate -mode inv -cell {cell} -port Y -portbit 0 " + " ".join(f"-src {s}:1" for s in sources)
        return formal_mutants.broken_here(formal.proofs()[proof], line)

    plan, scan = "rtl/frontend/msn_scan_plan.sv", "rtl/frontend/msn_scan.sv"
    assert broken("scan", "$1", scan) and broken("scan", "$1", plan, scan) and broken("scan_plan", "$1", plan)
    assert broken("scan", "$1", "rtl/common/msn_constant_multiplier.sv"), "has no proof"
    assert not broken("scan", "$1", "rtl/frontend/msn_scan_buffer.sv")
    assert not broken("scan", "$1", plan) and not broken("scan", "$1", scan, plan)
    assert not broken("scan", "$auto$setundef.cc:550:execute$1", scan)
    assert not broken("scan", "$1", "tb/formal/scan.sv") and not broken("scan", "$1")


STATE = """(declare-fun |t#0| (|t_s|) (_ BitVec 10))
(define-fun |t_n mutsel| ((state |t_s|)) (_ BitVec 10) (|t#0| state))
(declare-fun |t#1| (|t_s|) (_ BitVec 1))
(declare-fun |t#5#0| (|t_s|) (Array (_ BitVec 2) (_ BitVec 1)))
(define-fun |t_t| ((state |t_s|) (next_state |t_s|)) Bool (and
  (= (|t#9| state) (|t#1| next_state)) ; a register
  (= (|t#5#1| state) (|t#5#0| next_state)) ; a memory
))
"""


def test_a_mutant_that_changes_a_memory_is_not_equivalent():
    asked = formal_mutants.question(STATE, "t", 3)
    for begin in ("|t#1|", "|t#5#0|"):
        assert f"(assert (= ({begin} a) ({begin} b)))" in asked
    for after in ("|t#9|", "|t#5#1|"):
        assert f"(not (= ({after} a) ({after} b)))" in asked


def test_a_mutant_that_changes_what_is_before_the_first_reset_is_equivalent():
    """Only if the harness has `started`; before the first reset the invariant does not hold."""
    after = "(assert (|t_n started| a))"
    assert after in formal_mutants.question(f"{STATE}; yosys-smt2-wire started 1\n", "t", 3)
    assert after not in formal_mutants.question(STATE, "t", 3)
