"""The limits of the SDRAM's part model from both sides: exactly at a limit passes, a picosecond short is
reported. By the figures of docs/sdram.md, repeated here as numbers. Rules that are not times are each broken
once."""

from dataclasses import fields
from types import SimpleNamespace

import pytest

from parts import sdram
from parts.edges import Edges, Pin

PS = 0.001
ALL, AUTO = 0x400, 0x400
PINS = {"clk": 0, "cke": 1, "cs_n": 1, "ras_n": 1, "cas_n": 1, "we_n": 1, "ba": 0, "a": 0, "dqm": 0}
PINS |= {"dq_o": 0, "dq_oe": 0, "dq_i": 0}
CODES = {"MRS": 0, "REF": 1, "PRE": 2, "ACT": 3, "WRITE": 4, "READ": 5, "STOP": 6, "NOP": 7}


def run(monkeypatch, *script, rows=8, ref_max=1e6):
    """Clock edges, each a gap in ns after the last, with a command: (gap, name, {pins})."""
    edges = Edges(monkeypatch, sdram)
    pins = SimpleNamespace(**{name: Pin(edges, level) for name, level in PINS.items()})
    limits = sdram.Limits(t_ref_max=ref_max)
    model = sdram.Sdram(pins, limits, edges.reports.append, rises=1, rows=rows)
    time = 0
    for gap, name, *given in script:
        time += gap
        code = CODES[name]
        levels = {"cs_n": name == "NOP", "ras_n": code >> 2, "cas_n": code >> 1 & 1, "we_n": code & 1}
        levels |= {"dq_oe": 0, "dqm": 0, "cke": 1, "ba": 0, "a": 0} | (given[0] if given else {})
        for pin, level in levels.items():
            edges.at(time - 1, getattr(pins, pin), int(level))
        edges.at(time, pins.clk, 1)
        edges.at(time + 1, pins.clk, 0)
    edges.run()
    return edges, model, pins


def nops(count, gap=7.5):
    return [(gap, "NOP")] * count


def setup(power=200_000, rp=21, rfc=70, count=8, mode=0x032):
    return [
        (power, "PRE", {"a": ALL}),
        (rp, "REF"),
        *[(rfc, "REF")] * (count - 1),
        (rfc, "MRS", {"a": mode & 0x1FFF}),
    ]


def cycle(
    power=200_000, ck=7.5, mrd=15, rcd=21, rp=21, ras=44, ras_max=100_000, rc=67.5, rrd=15, rfc=70, wr=20
):
    """Two banks, a write, rows closed as early and as late as is allowed, a refresh."""
    data = {"dq_oe": 1, "dq_o": 0xA000}
    return [
        *setup(power, rp, rfc),
        *nops(1),
        (mrd - 7.5, "ACT", {"ba": 0, "a": 5}),
        *nops(1),
        (rrd - 7.5, "ACT", {"ba": 1, "a": 8191}),
        *nops(1),
        (rcd - 7.5, "WRITE", {"ba": 1, "a": 508} | data),
        *[(ck, "NOP", data | {"dq_o": 0xA001 + beat}) for beat in range(3)],
        *nops(1),
        (wr - 7.5, "PRE", {"ba": 1}),
        (rp, "ACT", {"ba": 1, "a": 8190}),
        (ras, "PRE", {"ba": 1}),
        (rc - ras, "ACT", {"ba": 1, "a": 1}),
        (rcd, "READ", {"ba": 1, "a": 0 | AUTO}),
        *nops(8),
        (ras_max - (rrd + rcd + 22.5 + wr + rp + rc + rcd + 60), "PRE", {"ba": 0}),
        (rp, "REF"),
        (rfc, "REF"),
    ]


LIMITS = {
    "power": (200_000, {"t_power"}),
    "ck": (7.5, {"t_ck"}),
    "mrd": (15, {"t_mrd", "t_ck"}),  # two clocks of 7.5 ns
    "rcd": (21, {"t_rcd"}),
    "rp": (21, {"t_rp"}),
    "ras": (44, {"t_ras"}),
    "rc": (67.5, {"t_rc"}),
    "rrd": (15, {"t_rrd", "t_ck"}),
    "rfc": (70, {"t_rfc"}),
    "wr": (20, {"t_wr"}),
}


@pytest.mark.parametrize("name", LIMITS)
def test_limits(monkeypatch, name):
    limit, reported = LIMITS[name]
    edges, model, _ = run(monkeypatch, *cycle(**{name: limit}))
    assert edges.names() == set(), edges.reports
    assert model.memory[1, 8191, 508:512].tolist() == [0xA000, 0xA001, 0xA002, 0xA003]
    assert run(monkeypatch, *cycle(**{name: limit - PS}))[0].names() == reported


def test_longest_times(monkeypatch):
    """A row open for 100 us, and 8 rows refreshed within 300 us of the first of the last 8."""
    assert run(monkeypatch, *cycle(ras_max=100_000 + PS))[0].names() == {"t_ras_max"}
    for late, reported in ((0, set()), (PS, {"t_ref_max"})):
        script = [*setup(), *nops(1), (300_000 - 8 * 70 - 7.5 + late, "REF")]
        assert run(monkeypatch, *script, ref_max=300_000)[0].names() == reported
    checked = {f"t_{name}" for name in LIMITS} | {"t_ras_max", "t_ref_max", "t_ac", "t_oh"}
    assert checked == {field.name for field in fields(sdram.Limits)}


def test_words_arrive_in_order_after_their_delays(monkeypatch):
    """CAS latency 3: word k is there 6.5 ns after the edge 2 + k of the READ, gone 2.5 ns after the next;
    columns wrap around within four."""
    script = [*setup(), *nops(2), (7.5, "ACT", {"ba": 3, "a": 77})]
    write = {"ba": 3, "a": 6, "dq_oe": 1}
    script += [(21, "WRITE", write | {"dq_o": 0x6666})]
    script += [(10, "NOP", {"dq_oe": 1, "dq_o": value}) for value in (0x7777, 0x4444, 0x5555)]
    script += [*nops(2, 10), (10, "READ", {"ba": 3, "a": 4}), *nops(8, 10)]
    edges, model, pins = run(monkeypatch, *script)
    assert edges.names() == set(), edges.reports
    assert model.memory[3, 77, 4:8].tolist() == [0x4444, 0x5555, 0x6666, 0x7777]
    start = 200_000 + 21 + 8 * 70 + 22.5 + 21 + 60 + 20
    for number, word in enumerate([0x4444, 0x5555, 0x6666, 0x7777]):
        here = start + 10 * number
        assert pins.dq_i.was(here + 6.5 - PS) != word
        assert pins.dq_i.was(here + 6.5) == pins.dq_i.was(here + 12.5 - PS) == word
        assert pins.dq_i.was(here + 12.5) != word


OPEN = [*setup(), *nops(2), (7.5, "ACT", {"ba": 0, "a": 1})]
DRIVEN = {"dq_oe": 1}
RULES = {
    "open again": ([*OPEN, *nops(10), (7.5, "ACT", {"a": 2})], "ACT of bank 0, which has row 1 open"),
    "closed": ([*OPEN, *nops(3), (7.5, "READ", {"ba": 1})], "READ of bank 1, which has no row open"),
    "cut": ([*OPEN, *nops(3), (7.5, "READ"), *nops(2), (7.5, "READ")], "READ cuts a burst"),
    "pre cuts": ([*OPEN, *nops(5), (7.5, "READ"), *nops(2), (7.5, "PRE")], "PRE cuts a burst"),
    "column": ([*OPEN, *nops(3), (7.5, "READ", {"a": 0x200})], "READ of column 0x0200"),
    "dqm": ([*OPEN, *nops(3), (7.5, "READ", {"dqm": 2})], "READ with DQM high"),
    "masked": (
        [*OPEN, *nops(3), (7.5, "WRITE", DRIVEN), (7.5, "NOP", {"dq_oe": 1, "dqm": 1})],
        "word 1 of a WRITE is masked or not driven",
    ),
    "not driven": (
        [*OPEN, *nops(3), (7.5, "WRITE", DRIVEN), *[(7.5, "NOP", DRIVEN)] * 2, (7.5, "NOP")],
        "word 3 of a WRITE is masked or not driven",
    ),
    "first driven": ([*OPEN, *nops(3), (7.5, "READ"), *nops(1), (7.5, "NOP", DRIVEN)], "both drive DQ"),
    "last driven": ([*OPEN, *nops(3), (7.5, "READ"), *nops(6), (7.5, "NOP", DRIVEN)], "both drive DQ"),
    "refresh": ([*OPEN, *nops(10), (7.5, "REF")], "REF with an open row"),
    "mode open": ([*OPEN, *nops(10), (7.5, "MRS", {"a": 0x32})], "MRS with an open row"),
    "mode": ([*setup(mode=0x033)], "mode 0x0033 is not 0x032"),
    "mode's bank": ([*setup()[:-1], (70, "MRS", {"a": 0x32, "ba": 1})], "mode 0x2032 is not 0x032"),
    "refreshes": ([*setup(count=7)], "MRS after 7 REF of 8"),
    "early": ([*setup()[:-1], (70, "ACT")], "ACT before the mode register is set"),
    "a clock after": ([*setup(), (15, "REF")], "REF a clock after MRS"),
    "stop": ([*OPEN, *nops(3), (7.5, "STOP")], "STOP is not used"),
    "cke": ([*setup(), *nops(2), (7.5, "ACT", {"cke": 0})], "ACT with CKE low"),
}


@pytest.mark.parametrize("name", RULES)
def test_rules(monkeypatch, name):
    script, says = RULES[name]
    reports = [str(report) for report in run(monkeypatch, *script)[0].reports]
    assert reports[:1] == [f"rule: {says}"] and len(set(reports)) <= 2, reports


def test_dq_is_free_after_its_end(monkeypatch):
    script = [*OPEN, *nops(3), (7.5, "READ"), *nops(7), (7.5, "NOP", DRIVEN)]
    assert run(monkeypatch, *script)[0].reports == []
