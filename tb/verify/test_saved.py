"""tools/saved.py: the rows about what scenes save become stale with the files that they depend on, and the
page shows it."""

import copy

import pytest

import saved as tool

FRESH = {"ms": 4.0, "on": "2026-01-02", "of": None, "rests_on": "shared"}


@pytest.fixture
def told():
    """A record of every row on fixed, which depends on one file and the scene, and of one scene on rtl."""
    table = {"rests_on": {"shared": ["model/meissner/scenes/rates.py"]}, "fixed": {"full": {}, "scenes": {}}}
    for row in tool.rows():
        part = "full" if row.startswith(tool.FULL) else "scenes"
        own = FRESH | {"of": tool.digest(table, row, "shared")}
        table["fixed"][part][row.removeprefix(tool.FULL)] = own
    table["rtl"] = {"scenes": {"cop_load": table["fixed"]["scenes"]["cop_load"] | {"of": "before"}}}
    return table


def late(told, engine="fixed"):
    return [row for row in tool.rows() if tool.stale(told, engine, row)]


def test_a_row_is_stale_with_its_files_its_scene_and_without_a_digest(told, monkeypatch):
    assert late(told) == [] and late(told, "rtl") == tool.rows()
    changed = copy.deepcopy(told)
    changed["fixed"]["scenes"]["fsr_3x3"]["of"] = None
    del changed["fixed"]["full"]["cop_slip"]
    assert late(changed) == ["full: cop_slip", "fsr_3x3"]
    read, of_files = [], tool.revision.of_files
    monkeypatch.setattr(
        tool.revision, "of_files", lambda names, kind: read.append(names) or of_files(names, kind)
    )
    tool.stale(told, "fixed", "fsr_3x3")
    assert read == [["model/meissner/scenes/rates.py", "model/meissner/scenes/fsr/fsr_3x3.toml"]]
    told["rests_on"]["shared"] = ["model/meissner/scenes/truth.py"]
    assert late(told) == tool.rows()


def test_the_page_marks_what_is_stale(told):
    lines = tool.table(told).splitlines()
    count = len(tool.rows()) - len(tool.scenes.names())
    assert lines[2] == f"| everything on | {4 * count} | 1 |  |  |"
    assert f"| `cop_load` | 4 | {count} | 4 (stale) |  |" in lines
    told["fixed"]["full"]["cop_slip"]["of"] = "before"
    lines = tool.table(told).splitlines()
    assert lines[2].startswith(f"| everything on | {4 * count} (stale) | 1 |")
    assert f"| `cop_load` | 4 | {count} (stale) | 4 (stale) |  |" in lines
    with pytest.raises(ValueError, match="has 0 tables"):
        tool.page("no table", told)


def test_the_page_is_that_of_the_record():
    def fresh(text):
        return text.replace(" (stale)", "")

    text = tool.PAGE.read_text("utf-8")
    assert fresh(text) == fresh(tool.page(text, tool.load())), "python tools/saved.py --page"
