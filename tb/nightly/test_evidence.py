"""What tests state beside their SPACE is read without an import, and what is wrong is refused."""

import pytest

from nightly import benches, evidence


def test_every_block_states_something_sound():
    assert all(isinstance(evidence.of(block, "faults"), dict) for block in benches.blocks())
    assert evidence.of("delay", "equivalence")["size"] == {"Depth": 7}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("SPACE = 1\n", "has no EVIDENCE"),
        ("x = 1\nEVIDENCE = {'faults': {'settle': x}}\n", "not a literal, line 2"),
        ("EVIDENCE = {'fault': {}}\n", "'fault'"),
        ("EVIDENCE = {'icarus': {'run': {}}}\n", "'run'"),
        ("EVIDENCE = {'faults': {'settle': True}}\n", "'settle'"),
    ],
)
def test_what_cannot_be_read_is_refused(text, said):
    with pytest.raises(ValueError, match=said):
        evidence._read(text, "t.py")


def test_it_is_read_without_an_import():
    text = "import nothing_of_this_name\nEVIDENCE = {'faults': {'settle': 7}}\n"
    assert evidence._read(text, "t.py") == {"faults": {"settle": 7}}
