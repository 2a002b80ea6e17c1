"""Reports: pictures are drawn; a page needs no external file, begins with verdict and picture, and has words
for every key of every scene; no table is wider than the page (in headless Chromium)."""

import dataclasses
import re
from html.parser import HTMLParser

import numpy as np
import pytest
from msgspec import structs

from meissner import scenes
from meissner.report import page as report
from meissner.report import words as report_words
from meissner.run import run
from meissner.scenes.rubber import pictures
from meissner.scenes.verdict import slips, verdict

PNG = b"\x89PNG not really"


@pytest.mark.parametrize(
    "name, flag", [("acrylic_slip", 3.9), ("acrylic_slip", None), ("normal_force", None)]
)
def test_a_slip_run_is_drawn(tmp_path, name, flag):
    run = scenes.simulate(scenes.load(name), seed=1)
    count = len(run.time_s) // 2
    picture = tmp_path / "slip.png"
    pictures.draw_slip(
        picture,
        run,
        detail_time_s=run.time_s[1::2],
        detail_v=np.diff(run.volts)[::2] / -np.sqrt(2),
        p2p_v=np.zeros(count),
        state=np.arange(count) * 5 // count,
        threshold_v=0.02,
        flag_s=flag,
    )
    assert picture.read_bytes().startswith(b"\x89PNG") and picture.stat().st_size > 30_000


def test_the_report_needs_no_other_file(tmp_path):
    (tmp_path / "one.png").write_bytes(PNG)
    summary = {"scene": "a <b> & c", "modelled": ["rubber", "adc"], "delay_s": 0.00123456, "flag_s": None}
    page = report.write_html(
        tmp_path / "report.html",
        summary,
        [(tmp_path / "one.png", "2 N & more", "a caption"), (str(tmp_path / "one.png"), "4 N", "another")],
        {"conditions": [{"load_g": 2.0, "missed": 0}, {"load_g": None, "missed": 1}], "empty": []},
        verdict="1 < 2",
    ).read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 2
    assert "a &lt;b&gt; &amp; c" in page and "rubber, adc" in page and "1.235 ms" in page
    assert "1 &lt; 2" in page and "<b>2 N &amp; more</b>: a caption" in page
    assert 'title="slips missed">missed</th>' in page and ">load (g)</th>" in page and "empty" not in page
    assert "<li><i>missed</i>: slips missed</li>" in page and "<i>load (g)</i>" not in page
    assert page.count('<input type="checkbox"') == 2 and "width: max(100%, 68rem)" in page
    assert 'data-label="load (g)">2</td>' in page and 'data-label="load (g)">–</td>' in page
    assert not re.search(r"""(src|href)=["'](?!data:)|https?://|url\(""", page)


@pytest.mark.parametrize(
    "key, value, heading, shown",
    [
        ("delay_s", 0.0128, "from onset to flag, shown run (ms)", "12.8 ms"),
        ("onset_s", 3.8451022, "onset (truth), shown run (s)", "3.8451 s"),
        ("seconds_simulated", 2040.0, "simulated time (s)", "2,040 s"),
        ("flag_s", None, "slip flag rises, shown run (s)", "none"),
        ("contact_share_of_sliding", 0.0415, "share of sliding time in which the state is not slip (%)",
         "4.15 %"),
        ("direction_deg", -3.36646, "reported direction of slip, shown run (°)", "-3.366°"),
        ("load_drop", {"maximum": 0.7, "mean": 0.1}, "fall of the load output before the object moves (%)",
         "10 % in the mean, 70 % at most"),
        ("samples_per_second", 577238, "samples through the engine per second", "577,238"),
        ("seed", 4711, "first seed", "4711"),
        ("clk_khz", 24000, "clock (MHz)", "24 MHz"),
        ("dead_as_injected", False, "dead cells are those injected", "no"),
        ("left_out", [], "left out", "nothing"),
        ("condition", "paper, 3 N", "condition", "paper, 3 N"),
        ("condition", 1.0494, "condition number, at most", "1.049"),
        ("engine", "rtl", "engine", "rtl: the core itself, simulated"),
        # Keys without a description: words and unit come from the key itself.
        ("new_thing_ms", 1.5, "new thing (ms)", "1.5 ms"),
        ("way_of_it", "left", "way of it", "left"),
        ("ms", 2, "ms", "2"),
    ],
)  # fmt: skip
def test_words_stand_for_keys(key, value, heading, shown):
    assert report_words.heading(key, value) == heading
    assert report_words.fact(key, value) == shown


def _row(runs, missed, false_alarms, delay_ms=None, lead_ms=None):
    row = {"runs": runs, "missed": missed, "false_alarms": false_alarms, "delay_ms_median": delay_ms}
    return row | {"delay_ms_max": delay_ms, "lead_ms_min": lead_ms}


@pytest.mark.parametrize(
    "rows, text",
    [
        (
            [_row(5, 0, 0, 9.5, 40.0), _row(7, 0, 0, 12.0, 31.0)],
            "All 12 slips were detected at most 12 ms after the first partial slip and at least 31 ms before "
            "the whole contact slipped, without a false alarm.",
        ),
        (
            [_row(5, 2, 0, 9.5, -3.0), _row(7, 7, 0), _row(11, 0, 1)],
            "9 of 12 slips were missed; the flags rose at most 9.5 ms after the first partial "
            "slip, the latest 3 ms after the whole contact slipped, with 1 false alarm.",
        ),
        ([_row(5, 5, 2), _row(7, 0, 0)], "All 5 slips were missed, with 2 false alarms."),
        ([_row(1, 1, 0)], "The slip was missed, without a false alarm."),
        ([_row(1, 0, 0, 2.0, 0.5)], "The slip was detected at most 2 ms after the first partial slip and at "
         "least 0.5 ms before the whole contact slipped, without a false alarm."),
        ([_row(1, 1, 0, 2.0, 0.0)], "The slip was missed; the flag rose at most 2 ms after the first partial "
         "slip, the latest 0 ms after the whole contact slipped, without a false alarm."),
        ([_row(3, 2, 0, 9.5, 4.0)], "2 of 3 slips were missed; the others were detected at most 9.5 ms after "
         "the first partial slip and at least 4 ms before the whole contact slipped, without a false alarm."),
        ([_row(7, 0, 0)], "Nothing slips in 7 runs, and no slip was reported."),
        ([_row(7, 0, 3)], "Nothing slips in 7 runs, and 3 false alarms rose."),
    ],
)  # fmt: skip
def test_the_verdict_on_slip(rows, text):
    summary = {key: sum(row[key] for row in rows) for key in ("runs", "missed", "false_alarms")}
    summary["conditions"] = rows
    assert (
        slips(summary) == verdict(summary, text) == verdict(summary | {"twin_mismatches": None}, text) == text
    )
    equal = f"{text[:-1]}; the core equals its integer twin in every value."
    assert verdict(summary | {"twin_mismatches": 0}, text) == equal
    differs = "The core differs from its integer twin in 6 values: its results are not valid. "
    assert verdict(summary | {"twin_mismatches": 6}, text) == differs + text


class Page(HTMLParser):
    """The elements of the body, each as (tag, class, text), with those inside a figure or table apart."""

    def __init__(self, text):
        super().__init__()
        self.order, self.stack, self.texts, self.meta, self.tables = [], [], {}, {}, []
        self.feed(text)
        self.close()
        assert not self.stack, "an element is not closed"

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        if tag == "meta":
            self.meta[attrs.get("name")] = attrs["content" if "name" in attrs else "charset"]
        if tag == "table":
            self.tables.append(self.stack[-1])
        if tag in ("meta", "img", "input"):
            if tag == "img":
                self.order.append(("img", "", attrs["alt"]))
            return
        self.stack.append((tag, attrs.get("class", "")))
        if "body" in [name for name, _ in self.stack]:
            self.order.append((tag, attrs.get("class", ""), ""))

    def handle_endtag(self, tag):
        assert self.stack.pop()[0] == tag

    def handle_data(self, data):
        # Text belongs to the innermost open element.
        if self.stack and self.stack[-1][0] not in ("style", "html", "head", "body"):
            self.texts.setdefault(self.stack[-1][0], []).append(data)

    def all_text(self, *tags):
        return [text for tag in tags for text in self.texts.get(tag, [])]


def _brief(condition):
    return structs.replace(condition, duration_s=4.0)


def written(scene, out):
    """The scene's report and summary, with one seed per condition."""
    if hasattr(scene, "seeds"):
        scene = dataclasses.replace(scene, seeds=1)
    if scene.sensor == "hand":  # the full duration in closed loop takes minutes; the words are the same
        brief = tuple(map(_brief, scene.conditions))
        scene = dataclasses.replace(scene, conditions=brief, world=scene.world | {"hold_from_s": 1.0})
    if "trees" in getattr(scene, "world", ()):
        scene = dataclasses.replace(scene, world=scene.world | {"trees": 20})
    summary = run(scene, "fixed", out)
    return (out / "report.html").read_text(encoding="utf-8"), summary


def keys(value):
    """All keys of a summary, including nested ones."""
    if isinstance(value, dict):
        return set(value) | set().union(*map(keys, value.values()))
    return set().union(*map(keys, value)) if isinstance(value, list) else set()


# Keys that are no facts: containers of tables, statistics, and keys that a report leaves out.
HOLDERS = {"conditions", "constants", "pins", "solver", "locus", "maximum", "mean"}
HOLDERS |= {"count", "rate", "low", "high"}


@pytest.mark.parametrize("name", scenes.names())
def test_every_scene_is_reported_verdict_first_and_in_words(tmp_path, undrawn, name):
    """The page does not depend on a picture's content."""
    scene = scenes.load(name)
    text, summary = written(scene, tmp_path)
    page = Page(text)
    tags = [tag for tag, _, _ in page.order]
    assert tags[:3] == ["body", "h1", "p"] and page.order[2][1] == "verdict"
    assert tags[3:8] == ["figure", "label", "img", "figcaption", "b"]
    assert page.meta["color-scheme"] == "light dark" and "prefers-color-scheme: dark" in text
    assert page.meta["viewport"].startswith("width=device-width")

    (sentence,) = page.texts["p"]
    assert re.fullmatch(r"[A-Z\d][^\n]*\.", sentence) and re.search(r"slip|\d", sentence), sentence
    assert "_" not in sentence and not sentence.endswith("done."), sentence
    # The caption of every picture names the condition, the seed and the engine.
    conditions = page.texts["b"]
    assert len(conditions) == tags.count("figure") == tags.count("img") >= 1
    named = [c.name for c in getattr(scene, "conditions", ())] or [scene.title]
    for condition in conditions:
        assert any(one in condition for one in named), condition
        assert condition.endswith(", seed 1, engine fixed")
    for one in named:
        assert any(one in condition for condition in conditions), one
    assert all(len(shown) > 20 for shown in page.texts["figcaption"])

    missing = keys(summary) - set(report_words.WORDS) - HOLDERS
    assert not missing, f"report_words.WORDS has no words for {missing}"
    raw = [words for words in page.all_text("th", "td", "h2") if "_" in words and words != name]
    assert not raw, raw
    cell = r'<th scope="col" title="([^"]+)">([^<]+)</th>'
    for head in re.findall(r"<thead>(.*?)</thead>", text):
        assert len({short for _, short in re.findall(cell, head)}) == len(re.findall(cell, head)), head
    for whole, column in re.findall(cell, text):
        name = column.rpartition(" (")[0] if column.endswith(")") else column
        assert len(name.split()) <= 2 or name.endswith(" %"), (
            f"report_words.SHORT has no two words for {whole!r}"
        )
    assert page.tables and set(page.tables) == {("div", "table")}
    assert re.search(r"\.table \{[^}]*overflow-x: auto", text)
