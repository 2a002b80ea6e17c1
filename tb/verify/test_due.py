"""`make trust TRUST=--due`: changed blocks come before blocks that contain them, the longest runs come last,
the time limit is kept, and records state the time they took."""

import json
import sys
import time
from types import SimpleNamespace

import pytest

import trust
from verify import due, record

QUICK, SLOW = (SimpleNamespace(kind=kind, command=f"{kind}.py") for kind in ("quick", "slow"))


def recorded(**kinds):
    return {
        kind: {"blocks": {name: {"cpu_s": s} for name, s in rows.items()}} for kind, rows in kinds.items()
    }


def test_what_was_changed_comes_first_and_what_takes_longest_last():
    """msn_packet contains msn_crc32, msn_link contains msn_packet; msn_fifo is in none of them."""
    told = recorded(quick={"crc32": 4, "packet": 1, "link": 2, "fifo": 9}, slow={"crc32": 50, "packet": 30})
    listed = due.pieces([(QUICK, ["link", "packet", "crc32", "fifo"]), (SLOW, ["packet", "crc32"])], told)
    assert [(piece.step.kind, piece.block, piece.seconds) for piece in listed] == [
        ("quick", "crc32", 4),
        ("quick", "fifo", 9),
        ("slow", "crc32", 50),
        ("quick", "packet", 1),
        ("quick", "link", 2),
        ("slow", "packet", 30),
    ]


def test_what_was_never_recorded_is_taken_for_the_middle_of_its_kind():
    told = recorded(quick={"skid": 2, "sync": 7, "fork": 40})
    listed = due.pieces([(QUICK, ["fifo", "skid"]), (SLOW, ["fork"])], told)
    assert [(piece.block, piece.seconds) for piece in listed] == [("skid", 2), ("fifo", 7), ("fork", 30.0)]


@pytest.mark.parametrize(
    ("facts", "seconds"),
    [
        ({"cpu_s": 3.5, "seconds": 9}, 3.5),
        ({"seconds": 20, "source": {"seconds": 11}}, 31),
        ({"ecp5": {"cpu_s": 1.5}, "reset": {"cpu_s": 2}}, 3.5),
        ({"proofs": {"a": {"seconds": {"x": 2, "y": 3}}, "b": {}}}, 5),
        ({"line": [1, 2, 3]}, None),
    ],
)
def test_records_say_what_they_took(facts, seconds):
    assert due.took(facts) == seconds


def test_the_time_is_kept_and_what_is_left_is_told():
    now, ran = [100.0], []

    def run(piece, rest):
        ran.append((piece.block, rest))
        now[0] += piece.seconds

    listed = [due.Piece(QUICK, name, False, s) for name, s in (("a", 20), ("b", 41), ("c", 40), ("d", 1))]
    left = due.within(listed, 60, run, clock=lambda: now[0])
    assert ran == [("a", 60), ("c", 40)], "b needs 41 of 40 s, c just fits"
    assert [piece.block for piece in left] == ["b", "d"]
    ran.clear()
    assert due.within(listed, None, run) == [] and ran == [(name, None) for name in "abcd"]


def test_a_run_that_does_not_end_is_ended_with_what_it_started(tmp_path):
    started = tmp_path / "child.py"
    started.write_text("import sys, time\nopen(sys.argv[1], 'w').close()\ntime.sleep(600)\n")
    text = "import subprocess, sys; subprocess.run([sys.executable, *sys.argv[1:]])"
    begun = tmp_path / "begun"
    assert due.limited(["-c", text, str(started), str(begun)], 3) is None
    for _ in range(100):
        if not [line for line in processes() if str(started) in line]:
            break
        time.sleep(0.1)
    else:
        raise AssertionError("its child runs on")
    assert due.limited(["-c", "import sys; sys.exit(7)"], None) == 7


def processes():
    from pathlib import Path

    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            found.append(path.read_bytes().replace(b"\0", b" ").decode("utf-8", "replace"))
        except OSError:  # the process has ended
            continue
    return found


def test_a_record_has_the_seconds_of_a_processor(tmp_path, monkeypatch):
    monkeypatch.setattr(record, "FOLDER", tmp_path)
    monkeypatch.setattr(record, "_since", lambda: 9.0)

    def keep(join, **blocks):
        told = lambda facts: "known"
        path = record.merge("kind", "make", blocks, told, lambda rows: "", join)
        return {name: row["cpu_s"] for name, row in json.loads(path.read_text())["blocks"].items()}

    assert keep(dict.__or__, skid={}, fork={}) == {"skid": 4.5, "fork": 4.5}
    monkeypatch.setattr(record, "_since", lambda: 2.0)
    assert keep(dict.__or__, skid={}) == {"skid": 4.5, "fork": 4.5}, "a part of it, joined"
    assert keep(record._replace, fork={}) == {"skid": 4.5, "fork": 2.0}


def test_options_of_due_are_refused_without_it(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["trust", "--minutes", "3"])
    with pytest.raises(SystemExit) as stopped:
        trust.main()
    assert stopped.value.code == 2
    assert capsys.readouterr().err == "trust: --minutes and --list are of --due\n"
