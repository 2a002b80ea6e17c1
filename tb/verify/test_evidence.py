"""The statements of tests beside their SPACE are read without an import, each error is one sentence, and a
record of a kind depends only on the statements about that kind."""

import subprocess
import sys

import pytest

from meissner.builds import toolchain
from verify import benches, evidence, revision


def test_every_block_states_its_evidence():
    assert evidence.refusal([]) == ""
    assert evidence.of("delay", "equivalence")["size"] == {"Depth": 7}
    assert evidence.of("fork", "faults") == {}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("SPACE = 1\n", "t.py has no EVIDENCE: a literal dict, {} if the tools' defaults will do"),
        ("x = 1\nEVIDENCE = {'faults': {'settle': x}}\n", "t.py: EVIDENCE is not a literal, line 2"),
        ("EVIDENCE = []\n", "t.py: EVIDENCE is not a dict"),
        (
            "EVIDENCE = {'fault': {}}\n",
            "t.py: EVIDENCE has no kind 'fault'; there are reference, equivalence, mutants, faults, icarus",
        ),
        ("EVIDENCE = {'faults': 3}\n", "t.py: EVIDENCE['faults'] is not a dict"),
        (
            "EVIDENCE = {'icarus': {'run': {}}}\n",
            "t.py: EVIDENCE['icarus'] has no key 'run'; there are refused, runs",
        ),
        (
            "EVIDENCE = {'faults': {'settle': True}}\n",
            "t.py: EVIDENCE['faults']['settle'] is True, not a int",
        ),
    ],
)
def test_what_cannot_be_read_is_refused_in_a_sentence(text, said):
    with pytest.raises(ValueError) as refused:
        evidence._read(text, "t.py")
    assert str(refused.value) == said


def test_it_is_read_without_an_import():
    assert evidence._read("import nothing_of_this_name\nEVIDENCE = {'faults': {'settle': 7}}\n", "t.py") == {
        "faults": {"settle": 7}
    }


@pytest.mark.parametrize("tool", ["equivalence", "mutants", "faults", "cover", "trust"])
def test_a_tool_refuses_what_a_block_states_wrongly(tool, change, monkeypatch, capsys):
    change("tb/common/test_fork.py", '"reference": {"moves": "a word to two"}', '"mutant": {}')
    module = __import__(tool)
    monkeypatch.setattr(sys, "argv", [tool])
    with pytest.raises(SystemExit) as stopped:
        module.main()
    assert stopped.value.code == 2
    assert capsys.readouterr().err == (
        f"{tool}: tb/common/test_fork.py: EVIDENCE has no kind 'mutant'; there are reference, "
        "equivalence, mutants, faults, icarus\n"
    )


def test_no_faults_are_injected_into_what_has_no_state():
    command = [sys.executable, "tools/faults.py", "compare"]
    done = subprocess.run(command, cwd=toolchain.ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (2, "faults: no faults are injected into compare: no state\n")


def stale(before):
    return {
        (name, kind)
        for name, kinds in before.items()
        for kind, digest in kinds.items()
        if revision.digest(name, kind) != digest
    }


def test_a_record_rests_on_what_is_stated_of_its_kind(change):
    """Also on the blocks that it names: array keeps what calibrate_taxels keeps, frame_table runs inside
    it."""
    names = ("calibrate_taxels", "array", "frame_table", "cop_array", "calibration_table")
    before = {name: {kind: revision.digest(name, kind) for kind in revision.TOOLS} for name in names}
    assert stale(before) == set()
    change("tb/frontend/test_calibrate_taxels.py", '"settle": 3', '"settle": 4')
    inside = {"calibrate_taxels", "array", "frame_table", "calibration_table"}
    assert stale(before) == {(name, "faults") for name in inside}
    change("tb/frontend/test_calibrate_taxels.py", '"settle": 4', '"settle": 3')
    assert stale(before) == set()
    change("tb/frontend/test_calibrate_taxels.py", '"sets": [1]', '"sets": [2]')
    assert stale(before) == {("calibrate_taxels", "mutants")}


def test_the_names_of_blocks_are_blocks():
    for block in benches.blocks():
        for kind in evidence.KEYS:
            assert set(evidence.resting(block, kind)) <= set(benches.blocks())
