"""The quickest proofs hold at their defaults; a planted bug and a proof that proves nothing fail."""

import tempfile
from pathlib import Path

import pytest

from meissner.builds import toolchain
from nightly import proofs

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
    return [name for name, proof in proofs.proofs().items() if proof.quick]


@pytest.fixture
def elsewhere(monkeypatch):
    """A folder of its own, so that proofs of different tests, workers and runs do not interfere."""
    (toolchain.ROOT / "build/formal").mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="quick", dir=toolchain.ROOT / "build/formal") as folder:
        out = str(Path(folder).relative_to(toolchain.ROOT))
        monkeypatch.setattr(proofs, "OUT", out)
        yield out


def changed(monkeypatch, out, path, old, new):
    """Proofs read ``path`` with ``old`` replaced by ``new``."""
    text = (toolchain.ROOT / path).read_text()
    assert old in text
    copy = f"{out}/{path.split('/')[-1]}"
    (toolchain.ROOT / copy).write_text(text.replace(old, new))
    listed = proofs.sources
    monkeypatch.setattr(
        proofs, "sources", lambda proof: [copy if file == path else file for file in listed(proof)]
    )


@pytest.mark.parametrize("name", quick())
def test_holds(name, elsewhere):
    result = proofs.prove(proofs.proofs()[name], {}, ["default"])
    assert not result.wrong and set(proofs.SOLVERS) <= set(result.seconds)


@pytest.mark.parametrize("name", BUGS)
def test_planted_bug_is_found(name, elsewhere, monkeypatch):
    changed(monkeypatch, elsewhere, *BUGS[name])
    assert proofs.prove(proofs.proofs()[name], {}, ["default"]).wrong


def test_proof_of_nothing_fails(elsewhere, monkeypatch):
    silent = "  always_comb assume (!in_valid_i);"
    changed(monkeypatch, elsewhere, "tb/formal/skid.sv", "  // Invariant.", silent)
    wrong = proofs.prove(proofs.proofs()["skid"], {}, ["default"]).wrong
    assert wrong and all("not reached" in text for text in wrong)
