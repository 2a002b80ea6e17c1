"""docs/papers shows what is recorded, and marks it if it is stale; each paper has a page."""

import importlib
import json

import pytest

import papers
from published import Row, Table


def test_each_paper_has_a_page():
    assert papers.NAMES == (
        "capacitive_array",
        "cop_slip_and_net",
        "initial_slip",
        "rope_slip",
        "shear_and_mesh",
    )
    assert {path.stem for path in papers.FOLDER.glob("*.md")} == set(papers.NAMES)
    assert {path.stem for path in papers.FOLDER.glob("*.json")} == set(papers.NAMES)


@pytest.mark.parametrize("name", papers.NAMES)
def test_a_page_says_what_is_recorded(name):
    record = papers.load(name)
    page = papers.page(name, record, papers.stale(record))
    assert (papers.FOLDER / f"{name}.md").read_text("utf-8") == page, "`python tools/papers.py --page`"
    rows = [part for part in record["parts"] if "figure" in part]
    assert rows, "no figure of the paper"
    for row in rows:
        assert all(row[key] for key in ("figure", "what", "published", "ours")), row
    for file, caption in record["pictures"]:
        size = (papers.FOLDER / file).stat().st_size
        assert 4_000 < size < 200_000 and len(caption) > 20, file
        assert file in page
    drawn = {file for one in papers.NAMES for file, _ in papers.load(one)["pictures"]}
    assert {path.name for path in papers.FOLDER.glob("*.png")} == drawn


def test_rows_stand_under_the_heading_before_them_and_stale_ones_say_so(monkeypatch):
    parts = [
        Row("fig. 1", "a", "1 V", "2 V", "+1 V", "K"),
        Table("Numbers", "Of a run.", ("x", "y"), ((1, 2), (3, 4))),
        Row("fig. 2", "b", "none stated", "5 V", "", "none"),
    ]
    module = type("Module", (), {"TITLE": "A paper", "HEAD": "\nAbout it.\n"})
    monkeypatch.setattr(importlib, "import_module", lambda name: module)
    recorded = json.loads(
        json.dumps({"parts": [part.__dict__ for part in parts], "pictures": [["a.png", "A curve."]]})
    )
    page = papers.page("a", recorded, False).split("\n\n")
    header = "| figure | what | published | ours | difference | constants of ours |\n|" + " --- |" * 6
    assert page[:2] == ["# A paper", "About it."]
    assert page[2].startswith("`python tools/papers.py --record a` computes this page. ")
    assert page[3:] == [
        f"{header}\n| fig. 1 | a | 1 V | 2 V | +1 V | K |",
        "## Numbers",
        "Of a run.",
        "| x | y |\n| --- | --- |\n| 1 | 2 |\n| 3 | 4 |",
        f"{header}\n| fig. 2 | b | none stated | 5 V | – | none |",
        "![A curve.](a.png)",
        "A curve.\n",
    ]
    assert "**stale**" in papers.page("a", recorded, True)


def test_a_record_is_of_the_files_that_made_it():
    for name in papers.NAMES:
        rests_on = papers.load(name)["rests_on"]
        assert f"tools/published/{name}.py" in rests_on and "tools/papers.py" in rests_on
        assert papers.stale(papers.load(name) | {"of": "before"})
