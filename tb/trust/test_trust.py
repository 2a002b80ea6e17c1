"""docs/trust.md and README's line say what docs/trust/ has recorded, of blocks that are there."""

import trust
from meissner.trust import benches


def test_the_pages_say_what_is_recorded():
    recorded = trust.records()
    assert recorded and trust.PAGE.read_text() == trust.page(recorded), "`python tools/trust.py --page`"
    assert trust.summary(recorded) in trust.README.read_text().splitlines(), "`python tools/trust.py --page`"


def test_what_is_recorded_is_of_blocks_that_are_there():
    assert trust.strangers(trust.records()) == []


def test_a_stranger_is_told():
    said = trust.strangers({"mutants": {"blocks": {"skid": {}, "none": {}}}})
    assert said == ["docs/trust/mutants.json has none, which rtl/rtl.f does not list"]


def test_every_block_has_a_row():
    rows = trust.page({}).splitlines()
    assert benches.blocks() and all(f"| {block} |" in rows for block in benches.blocks())
