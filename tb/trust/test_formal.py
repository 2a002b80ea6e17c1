"""The quickest proofs, at their defaults, and whether `make formal` can fail: a planted bug, a proof that
says nothing, a name that there is not."""

import subprocess
import sys

import pytest

from meissner import toolchain
from meissner.trust import formal

BUGS = {  # proof: file, what is there, what is put in its place
    "skid": ("rtl/common/msn_skid.sv", "if (!aside) kept", "if (out_ready_i) kept"),
    "fork": ("rtl/common/msn_fork.sv", "&& !a_has", ""),
}


def quick():
    return [name for name, proof in formal.proofs().items() if proof.quick]


@pytest.fixture
def elsewhere(monkeypatch, tmp_path_factory):
    """Nothing of a test's proofs gets in the way of another's."""
    out = f"build/formal/{tmp_path_factory.mktemp('quick').name}"
    (toolchain.ROOT / out).mkdir(parents=True, exist_ok=True)
    monkeypatch.setattr(formal, "OUT", out)
    return out


def changed(monkeypatch, out, path, old, new):
    """Proofs read ``path`` with ``old`` made ``new``."""
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
