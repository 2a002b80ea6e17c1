"""docs/trust.md and README's line say what docs/trust/ has recorded, of blocks that are there; what was
recorded before a block's RTL changed is told so."""

import json
import re

import pytest

import trust
from meissner import toolchain
from meissner.trust import benches, record


def without_marks(text):
    """Which of it is of an earlier revision changes with every change of the RTL; the pages may be behind."""
    return re.sub(rf" \((\d+ blocks? )?{trust.EARLIER}\)", "", text)


def test_the_pages_say_what_is_recorded():
    recorded = trust.records()
    page, readme = (without_marks(path.read_text()) for path in (trust.PAGE, trust.README))
    assert recorded and page == without_marks(trust.page(recorded)), "`python tools/trust.py --page`"
    assert without_marks(trust.summary(recorded)) in readme.splitlines(), "`python tools/trust.py --page`"


@pytest.fixture
def kept(tmp_path, monkeypatch):
    """Records facts of blocks of a kind, joined; returns all that is recorded."""
    monkeypatch.setattr(record, "FOLDER", tmp_path)

    def keep(**blocks):
        summary, total = (lambda facts: "known"), (lambda blocks: f"{len(blocks)} known")
        return json.loads(record.merge("kind", "make", blocks, summary, total, dict.__or__).read_text())

    return keep


def test_what_is_of_an_earlier_revision_is_told(kept):
    told = kept(skid={"rtl": "before", "a": [1, 2.5, 3]}, fork={"a": 1}, calibration={"a": 1})
    assert "rtl" not in told["blocks"]["calibration"], "no block, so of no RTL"
    assert record.earlier(told) == ["skid"]
    assert trust.cell(told, "skid") == "known (of an earlier revision)"
    assert (trust.cell(told, "fork"), trust.cell(told, "sync")) == ("known", "")
    assert trust.total(told) == "3 known (1 block of an earlier revision)"
    assert record.earlier({"blocks": {"skid": {"a": 1}}}) == ["skid"], "without a digest"


def test_facts_of_an_earlier_revision_are_not_joined(kept):
    kept(skid={"rtl": "before", "a": 1}, fork={"a": 1}, calibration={"a": 1})
    blocks = kept(skid={"b": 2}, fork={"b": 2}, calibration={"b": 2})["blocks"]
    told = [{key: facts.get(key) for key in "ab"} for facts in blocks.values()]
    assert told == [{"a": 1, "b": 2}, {"a": 1, "b": 2}, {"a": None, "b": 2}], blocks


def test_what_is_missing_or_of_an_earlier_revision_is_due(kept, monkeypatch):
    monkeypatch.setattr(trust, "KINDS", {"kind": None})
    kept(skid={"rtl": "before", "a": 1}, fork={"a": 1}, sync={})
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
    step = trust.Step("kind", "kind.py RUNS", lambda: ["skid", "fork", "fifo"])
    assert trust.run(step, ["skid", "fork"], 2) == []
    assert (tmp_path / "asked").read_text() == "100 skid fork --record --jobs 2"
    assert trust.run(step._replace(jobs=False), ["fifo"], 2) == ["kind.py 50 failed"]
    assert (tmp_path / "asked").read_text() == "50 fifo --record"
    assert trust.run(step, [], 1) == [] and (tmp_path / "asked").read_text() == "150 --record --jobs 1"


def test_every_step_is_of_a_kind_and_every_kind_has_one():
    assert {step.kind for step in trust.STEPS} == set(trust.KINDS)
    for step in trust.STEPS:
        assert (toolchain.ROOT / "tools" / step.command.split()[0]).exists() and step.blocks()


def test_a_digest_is_of_all_that_a_block_is_made_of(tmp_path, monkeypatch):
    def digests(change):
        for path in sources:
            text = path.read_text()
            (tmp_path / path.name).write_text(change(text) if path.stem == "msn_crc32" else text)
        forget()
        return {block: record.digest(block) for block in ("crc32", "packet", "link", "cobs", "skid")}

    def forget():
        record.digest.cache_clear()
        toolchain.sources_of.cache_clear()

    sources = toolchain.sources()
    with monkeypatch.context() as patch:
        patch.setattr(toolchain, "sources", lambda: [tmp_path / path.name for path in sources])
        before = digests(lambda text: text)
        assert digests(lambda text: text.replace("\n", "  // said\n\n")) == before
        after = digests(lambda text: text.replace("<=", "<= ~"))
    forget()
    assert {block for block in before if before[block] != after[block]} == {"crc32", "packet", "link"}


def test_what_is_recorded_is_of_blocks_that_are_there():
    assert trust.strangers(trust.records()) == []


def test_a_stranger_is_told():
    said = trust.strangers({"mutants": {"blocks": {"skid": {}, "none": {}}}})
    assert said == ["docs/trust/mutants.json has none, which rtl/rtl.f does not list"]


def test_every_block_has_a_row():
    rows = trust.page({}).splitlines()
    assert benches.blocks() and all(f"| {block} |" in rows for block in benches.blocks())
