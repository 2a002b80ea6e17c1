"""The page of ``live --web``, ``replay --web`` and ``run --web``: what its server sends, takes and refuses.

tb/host/test_web_browser.py looks at it in a browser.
"""

import contextlib
import json
import math
import re
import signal
import socket
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.command import started
from harness.web import TURN_S, Stream, ask, decoded, of_pipe, rows, shown, slipping
from meissner import cli, scenes
from meissner.builds.units import Units
from meissner.host import Core, log, names, packets, sensors, table, web
from meissner.host.line import open_line
from meissner.host.pty import Pty
from meissner.host.simulated import SimulatedCore, of_scenes
from meissner.host.web import hub as hubs
from meissner.host.web.server import MOST_VIEWERS, page, serving
from meissner.twins.link import packet as p

TAXELS = np.arange(6, dtype=np.uint16).reshape(2, 3) * 1000
ITEMS = [
    packets.CopFrame(1000, 0.001, 0.5, -0.25, 700, True, 1.5, -0.75, 0.7),
    packets.CopFrame(2000, 0.002, 0, 0, 3, False, None, None, None),
    packets.Image(2500, 0.0025, 7, TAXELS, 0.001),
    packets.SlipEvent(3000, 0.003, 5, 2, 41, 0.035),
    packets.StateChange(4000, 0.004, 5, 1, 9, None, None, 2, True),
    packets.States(5000, 0.005, 3, (0, 1, 4)),
    packets.Health(6000, 0.006, 4, 1),
    packets.Statistics(7000, 0.007, 6, 12),
    packets.ClassChange(7500, 0.0075, 3, 5, 70_000),
    packets.ClassChange(7600, 0.0076, 2, None, 60_000),
    packets.Gap("unplugged", 1.5),
]


def test_every_packet_is_sent_as_it_is():
    """Against literals of the format, among them a packet type that the page does not know."""
    hub = web.hub.Hub({"title": "a"}, Units())
    hello, viewer = hub.join()
    [(_, head)], rest = decoded(hello)
    assert (head["kind"], head["title"], rest) == ("hello", "a", b"")
    for ms, item in enumerate(ITEMS):
        hub.add(10**18 + ms * 10**6, item)
    hub.event("message", text="µ")
    hub.send()
    messages, rest = decoded(viewer.take(0))
    assert rest == b""
    kinds = [type(item).__name__ for item in ITEMS]  # the order is kept
    assert [head["kind"] for _, head in messages] == [*dict.fromkeys(kinds), "message"]
    of = dict(zip([head["kind"] for _, head in messages], messages))
    assert of["Image"][0] == 0.002 and (of["Image"][1]["taxels"] == TAXELS).all()
    assert of["Image"][1]["number"] == 7 and of["Image"][1]["newtons_per_code"] == 0.001
    assert of["States"] == (0.005, {"kind": "States", "boot": 0, "time": 5000, "time_s": 0.005, "first": 3,
                                    "states": [0, 1, 4]})  # fmt: skip
    assert of["Gap"] == (0.010, {"kind": "Gap", "reason": "unplugged", "seconds": 1.5})
    assert of["message"] == (0.010, {"kind": "message", "text": "µ"})
    first, second = rows(messages, "CopFrame")
    assert first == {"t": 0, "boot": 0, "time": 1000, "time_s": 0.001, "x": 0.5, "y": -0.25, "load": 700,
                     "pressed": 1, "x_mm": 1.5, "y_mm": -0.75, "load_n": 0.7}  # fmt: skip
    assert second.keys() == first.keys() - {"x_mm", "y_mm", "load_n"} and second["t"] == 0.001
    [slip], [change] = rows(messages, "SlipEvent"), rows(messages, "StateChange")
    assert [slip[name] for name in ("t", "channel", "state", "p2p", "p2p_v")] == [0.003, 5, 2, 41, 0.035]
    assert [change[name] for name in ("before", "late", "state")] == [2, 1, 1]
    assert rows(messages, "Statistics")[0]["value"] == 12 and rows(messages, "Health")[0]["faults"] == 1
    first, second = rows(messages, "ClassChange")
    assert [first[name] for name in ("label", "before", "votes")] == [3, 5, 70_000] and "before" not in second
    # A viewer that comes later learns what holds, and gets the same again.
    later, viewer = hub.join()
    [(t, head)], _ = decoded(later)
    now = head["now"]
    assert t == 0.010 and now["health"] == {"4": 1} and now["statistics"] == {"images dropped": 12}
    assert {channel: state for channel, (state, *_) in now["states"].items()} == {"3": 0, "4": 1, "5": 4}
    assert str(decoded(viewer.take(0))[0]) == str(messages)


def test_a_viewer_learns_since_when_a_register_has_its_value():
    """And from a change what it was before, so that what came before the change can be drawn."""
    hub = web.hub.Hub({}, Units())
    hub.remember("register", "slip.threshold", 40)
    hub.add(10**18, packets.Statistics(0, 0.0, 0, 0))
    hub.send()
    hub.add(10**18 + 3 * 10**9, packets.Statistics(0, 3.0, 0, 0))
    for value in (60, 60, 50):
        hub.remember("register", "slip.threshold", value)
    hub.send()
    hello, viewer = hub.join()
    [(_, head)], _ = decoded(hello)
    assert head["now"]["register"] == {"slip.threshold": 50} and head["since"] == {"slip.threshold": 3}
    assert head["first"] == 0
    found = [head for _, head in decoded(viewer.take(0))[0] if head["kind"] == "register"]
    assert [(one["value"], one["before"]) for one in found] == [(40, None), (60, 40), (50, 60)]


def test_what_is_kept_is_bounded(monkeypatch):
    """The history, what waits for a viewer and what a new one gets, in bytes and in seconds; the newest stay,
    whole."""
    monkeypatch.setattr(hubs, "ROOM", 30_000)
    monkeypatch.setattr(hubs, "RECENT", 20_000)
    monkeypatch.setattr(hubs, "HISTORY", 100_000)
    hub = web.hub.Hub({}, Units())
    _, viewer = hub.join()
    image = np.zeros((64, 64), np.uint16)
    for number in range(400):
        hub.add(number * 250_000_000, packets.Image(number, None, number % 256, image, None))
        hub.send()
        assert hub.history_size <= 100_000 + 5 * image.nbytes
    waiting, rest = decoded(viewer.take(0))
    assert [head["number"] for _, head in waiting] == [397 % 256, 398 % 256, 399 % 256] and rest == b""
    assert viewer.dropped == 397
    assert len(decoded(hub.join()[1].take(0))[0]) == 2
    small = web.hub.Hub({}, Units())
    for second in range(400):
        small.add(second * 10**9, packets.Health(second, None, 1, 0))
        small.send()
    assert len(decoded(small.join()[1].take(0))[0]) == 11  # RECENT_S and both ends
    assert len(small._history) <= hubs.HISTORY_S + 2


@pytest.mark.parametrize("kind", [".npz", ".mcap"])
def test_the_packets_of_a_log_are_those_that_were_logged(tmp_path, kind):
    """``table.items`` gives back what ``Table`` and the files took."""
    known = Units(clk_khz=1000, rows=2, columns=3, newtons_per_code=0.001, volts_per_code=0.001, pitch_mm=4)
    writer = log.KINDS[kind](log.UnfinishedLog(tmp_path / f"log{kind}", log.KINDS[kind].KIND), known)
    writer.tell({"clk_khz": 1000})
    given = [
        *ITEMS,
        replace(ITEMS[5], first=9),  # two packets of one clock
        packets.Reset(1, 5),
        replace(ITEMS[6], boot=1),
        replace(ITEMS[3], time=10, time_s=1e-5, boot=1),
    ]
    for ms, item in enumerate(given):
        writer.add(10**18 + ms * 10**6, item)
    writer.flush({"clk_khz": 1000})
    writer.finish(tmp_path / f"log{kind}", {"clk_khz": 1000})
    found = list(table.items(log.read(tmp_path / f"log{kind}"), known))
    assert [stamp for stamp, _ in found] == [10**18 + ms * 10**6 for ms in range(len(given))]
    for (_, one), other in zip(found, given):
        assert type(one) is type(other)
        # Units come from ``known`` here; those of ITEMS are made up.
        for name in {*vars(other)} - {"x_mm", "y_mm", "load_n", "p2p_v", "p2p_n", "taxels"}:
            assert getattr(one, name) == getattr(other, name), (one, name)
    [image] = [item for _, item in found if isinstance(item, packets.Image)]
    assert (image.taxels == TAXELS).all()
    cop = found[0][1]
    assert (cop.x_mm, cop.y_mm, cop.load_n) == (0.5 * 2 * 2, -0.25 * 2, 700 * 0.001)
    assert found[3][1].p2p_v == pytest.approx(0.041 / math.sqrt(2), rel=1e-12)


# What is refused


REFUSED = [
    ("POST", "/set", {"Origin": "http://elsewhere.example"}, 403, "http://elsewhere.example"),
    ("POST", "/set", {"Origin": "http://127.0.0.1:1"}, 403, "http://127.0.0.1:1"),
    ("POST", "/set", {"Origin": None}, 403, "elsewhere"),
    ("POST", "/set", {"Origin": "null"}, 403, "null"),
    ("POST", "/set", {"Host": "rebound.example:80", "Origin": "http://rebound.example:80"}, 403, "rebound"),
    ("GET", "/", {"Host": "rebound.example"}, 403, "this machine"),
    ("GET", "/stream", {"Host": "192.168.1.7:8642"}, 403, "192.168.1.7"),
    ("GET", "/", {"Host": "127.0.0.1.example:1"}, 403, "127.0.0.1.example"),
    ("POST", "/set", {"Content_Type": "text/plain"}, 415, "application/json"),
    ("POST", "/other", {}, 404, "/other"),
    ("POST", "/stream", {}, 404, "/stream"),
    ("GET", "/../server.py", {}, 404, "server.py"),
    ("GET", "/panels/", {}, 404, "/panels/"),
]


@pytest.fixture(scope="module")
def address():
    with shown(of_pipe(SimulatedCore(), Units(volts_per_code=1e-3, rate_hz=1000))) as found:
        yield found


@pytest.mark.parametrize("method, path, headers, status, words", REFUSED)
def test_others_are_refused(address, method, path, headers, status, words):
    body = {"name": "slip.hold", "value": 3} if method == "POST" else None
    found, sentence = ask(address, method, path, body, **headers)
    assert found == status and words in sentence and "\n" not in sentence


@pytest.mark.parametrize("name", ["127.0.0.1:9", "localhost", "localhost:9", "[::1]:9"])
def test_this_machine_under_its_names_is_served(address, name):
    """Another port may be the near end of an ssh tunnel."""
    assert ask(address, "GET", "/", Host=name)[0] == 200
    body = {"name": "slip.hold", "value": 4}
    assert ask(address, "POST", "/set", body, Host=name, Origin=f"http://{name}")[0] == 200


@pytest.mark.parametrize(
    "path, body, words",
    [
        ("/set", {"name": "slip.hold", "value": 65536}, "65536 must lie in 0 .. 65535"),
        ("/set", {"name": "slip.hold", "value": 1.5}, "an integer"),
        ("/set", {"name": "slip.hold", "value": True}, "an integer"),
        ("/set", {"name": 5, "value": 1}, "an integer"),
        ("/set", {"name": "slip.hold"}, "an integer"),
        ("/set", {"name": "core.scratch", "value": 1}, "core.scratch is not one of the page's settings"),
        ("/set", {"name": "slip.treshold", "value": 1}, "slip.treshold"),
        ("/set", [1], "a JSON object"),
        ("/save", {"begin": 0, "end": "9"}, "seconds"),
        ("/save", {"begin": 0, "end": 1e300}, "seconds"),
        ("/save", {"begin": 1e6, "end": 2e6}, "no packet from 1000000.000 s"),
    ],
)
def test_what_cannot_be_done_is_one_sentence(address, path, body, words):
    status, sentence = ask(address, "POST", path, body)
    assert status == 400 and words in sentence and "\n" not in sentence


def test_a_body_is_bounded(address):
    assert ask(address, "POST", "/set", {"name": "x" * 5000, "value": 1})[0] == 413
    for length, status in (("4097", 413), ("-1", 413), ("x", 413), ("1e3", 413)):
        assert ask(address, "POST", "/set", Content_Length=length)[0] == status
    with socket.create_connection(address, timeout=500) as line:  # bytes that are no JSON, nor text
        host = f"{address[0]}:{address[1]}"
        head = f"POST /set HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n"
        line.sendall(
            f"{head}Content-Type: application/json\r\nContent-Length: 2\r\n\r\n".encode() + b"\xff\xfe"
        )
        assert b" 400 " in line.recv(4096)


def test_a_port_in_use_is_said(capsys):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        for number, words in ((port, f"port {port} of 127.0.0.1 is in use"), (65536, "0 .. 65535")):
            with pytest.raises(SystemExit) as end:
                cli.main(["live", "sim:walk_25x5", "--web-port", str(number)])
            assert end.value.code == 2
            [sentence] = capsys.readouterr().err.splitlines()
            assert words in sentence


def test_only_this_machine_reaches_the_port():
    with shown(of_pipe(SimulatedCore())) as (host, _):
        assert host == "127.0.0.1"


# A core behind the page


def test_a_threshold_that_is_set_changes_the_flags():
    """At the demo's threshold the scene slips; above every peak-to-peak it never does again, and reads back
    so for every viewer."""
    pipe = slipping(5)
    with shown(of_pipe(pipe, pipe.units)) as address, Stream(address) as stream, Stream(address) as other:
        _, hello = stream.until("hello")
        settings = {setting["name"]: setting for setting in hello["settings"]}
        threshold = settings["slip.threshold"]
        # 17 bits of a sample and one of the level; 12 bits of the converter reach 4095 up and down.
        assert (threshold["most"], threshold["reach"]) == ((1 << 18) - 1, [0, 8190])
        assert threshold["scale"][2] == "V"
        before = hello["now"]["register"]["slip.threshold"]
        # 0.02 V of the coefficient; a code of the detail is an LSB of 5 V / 4096 over sqrt(2).
        assert before == 23 and before * threshold["scale"][0] == pytest.approx(23 * 5 / 4096 / math.sqrt(2))
        stream.until("SlipEvent")
        status, answer = ask(address, "POST", "/set", {"name": "slip.threshold", "value": 8190})
        assert (status, json.loads(answer)) == (200, {"name": "slip.threshold", "value": 8190})
        for viewer in (stream, other):
            found = viewer.until(
                "register", lambda head: (head["name"], head["value"]) == ("slip.threshold", 8190)
            )
        at = found[0]
        stream.seen.clear()
        stream.until("Trace", lambda head: head["time_s"] > at + 2 * TURN_S)
        assert not [row for row in rows(stream.seen, "SlipEvent") if row["t"] > at + 0.1]
        ask(address, "POST", "/set", {"name": "slip.threshold", "value": 23})
        stream.until("SlipEvent")


def test_what_the_register_reads_back_is_shown(monkeypatch):
    """Not what was written: here the core holds half of it."""
    pipe = SimulatedCore()
    place, access = names.place("slip.hold"), pipe.registers.access

    def halved(write, address, data=0, **more):
        return access(write, address, data // 2 if write and address == place.address else data, **more)

    monkeypatch.setattr(pipe.registers, "access", halved)
    with shown(of_pipe(pipe)) as address:
        status, answer = ask(address, "POST", "/set", {"name": "slip.hold", "value": 40})
        assert (status, json.loads(answer)) == (200, {"name": "slip.hold", "value": 20})


def test_a_trace_is_what_the_windows_saw():
    """Least and greatest sample and greatest peak-to-peak of spans, computed by plain loops."""
    rng = np.random.default_rng(5)
    codes, p2p = rng.integers(0, 4096, (17, 128)), rng.integers(0, 8192, (17, 64))
    trace = sensors.traced(25_000, 10_000.0, 20_000, codes, p2p)
    assert (trace.time, trace.time_s, trace.first) == (50_000_000, 2.0, 0)
    assert trace.low.shape == (16, 4) and trace.step_s == 32 / 10_000  # 64 details, halved to 500 or fewer
    for channel in range(16):
        for span in range(4):
            samples = [int(code) for code in codes[channel, 32 * span : 32 * span + 32]]
            assert (trace.low[channel, span], trace.high[channel, span]) == (min(samples), max(samples))
            assert trace.p2p[channel, span] == max(p2p[channel, 16 * span : 16 * span + 16].tolist())


def test_what_is_seen_is_saved(tmp_path):
    items = [(k * 250_000, p.COP, p.cop_frame(k, -k, 10 * k, True)) for k in range(1, 400)]
    pipe = SimulatedCore(items, speed=20)
    with shown(of_pipe(pipe, Units(pitch_mm=1))) as address, Stream(address) as stream:
        seen = []
        while len(seen) < 399:  # 4 s, which a viewer that comes late gets whole
            stream.until("CopFrame")
            seen = rows(stream.seen, "CopFrame")
        begin, end = seen[100]["t"], seen[200]["t"]
        status, data = ask(address, "POST", "/save", {"begin": begin - 1e-7, "end": end + 1e-7})
    assert status == 200
    (tmp_path / "seen.mcap").write_bytes(data)
    found = log.read(tmp_path / "seen.mcap")
    assert found["cop_time"].tolist() == [250_000 * k for k in range(101, 202)]
    assert found["cop_load"].tolist() == [10 * k for k in range(101, 202)]
    assert int(found["clk_khz"]) == 25_000 and "partial" not in found


def test_a_viewer_that_reads_nothing_holds_nothing_up(monkeypatch):
    """Another viewer gets every image, and the one that stopped is told how many parts it missed."""
    monkeypatch.setattr(hubs, "ROOM", 100_000)
    hub, image, sent = web.hub.Hub({}, Units()), np.zeros((64, 64), np.uint16), 2000
    with (
        serving(hub, lambda name, value: value, 0) as server,
        Stream(server.server_address, 4096) as stopped,
        Stream(server.server_address) as reading,
    ):
        while len(hub.viewers) < 2:
            time.sleep(0.001)
        for k in range(sent):  # 16 MB: more than the sockets between take
            hub.add(k * 10**7, packets.Image(k, None, k % 256, image, None))
            hub.send()
            assert reading.until("Image")[1]["time"] == k
            reading.seen.clear()
        missed = max(viewer.dropped for viewer in hub.viewers)
        assert missed > 500 and min(viewer.dropped for viewer in hub.viewers) == 0
        stopped.until("dropped", lambda head: head["count"] == missed)
        times = [head["time"] for _, head in stopped.seen if head["kind"] == "Image"]
        assert times == sorted(times) and len(times) <= sent - missed


def test_viewers_are_counted_and_bounded(address):
    with contextlib.ExitStack() as stack:
        for _ in range(MOST_VIEWERS):
            stack.enter_context(Stream(address)).until("hello")
        status, sentence = ask(address, "GET", "/stream")
        assert status == 503 and f"{MOST_VIEWERS} viewers" in sentence


def test_a_source_that_dies_and_comes_back(tmp_path):
    """Unplugged: said, and a setting refused in a sentence; back: packets again, with the gap between."""
    port = tmp_path / "port"
    first = Pty(of_scenes("walk_25x5"))
    port.symlink_to(first.path)
    core = Core(open_line(f"pty:{port}"))
    source = web.OfCore(core, "a port")
    core.say = source.say
    with shown(source) as address, Stream(address) as stream:
        stream.until("CopFrame")
        first.unplug()
        stream.until("message", lambda head: "is gone" in head["text"])
        stream.until("status", lambda head: head["down"])
        status, sentence = ask(address, "POST", "/set", {"name": "cop.min_load", "value": 3})
        assert status == 400 and "interrupted" in sentence
        with Pty(of_scenes("walk_25x5")) as second:
            port.unlink()
            port.symlink_to(second.path)
            stream.until("Gap")
            stream.until("CopFrame")
            stream.until("status", lambda head: not head["down"])
            assert ask(address, "POST", "/set", {"name": "cop.min_load", "value": 3})[0] == 200
    core.close()


def test_a_page_left_open_over_a_restart():
    """The stream ends; at the same port a new one begins, with another session and the same page."""
    sessions = []
    port = 0
    for _ in range(2):
        source = of_pipe(SimulatedCore())
        with serving(source.hub, source.write, port) as server:
            port = server.server_address[1]
            stream = Stream(server.server_address)
            _, hello = stream.until("hello")
            sessions.append((hello["session"], hello["page"]))
        with pytest.raises(EOFError):
            stream.until("nothing")
        stream.close()
    assert sessions[0][0] != sessions[1][0] and sessions[0][1] == sessions[1][1]


def test_a_core_that_is_only_listened_to(capsys):
    """Its packets are shown if its clock is known; nothing can be set."""
    items = [(k * 250_000, p.COP, p.cop_frame(k, -k, 10 * k, True)) for k in range(1, 100)]
    source = of_pipe(SimulatedCore(items), Units(clk_khz=25_000), registers=False)
    with shown(source) as address, Stream(address) as stream:
        assert stream.until("hello")[1]["settings"] == []
        stream.until("CopFrame")
        status, sentence = ask(address, "POST", "/set", {"name": "slip.threshold", "value": 3})
        assert status == 400 and "slip.threshold" in sentence
    with pytest.raises(ValueError, match="clock is unknown"):
        of_pipe(SimulatedCore(items), registers=False)


# The commands


def page_of(process):
    """The address that a command printed."""
    for text in process.stdout:
        if found := re.search(r"http://([\d.]+):(\d+)/", text):
            return found[1], int(found[2])
    raise AssertionError(process.stderr.read())


@pytest.mark.parametrize("kind", ["live", "replay", "run"])
def test_the_command_shows_a_page_until_it_is_stopped(kind, tmp_path):
    if kind == "live":
        given = ("live", "sim:walk_25x5")
    elif kind == "replay":
        cli.main(["log", "sim:walk_25x5", "--seconds", "0.5", "--out", str(tmp_path / "log.npz")])
        given = ("replay", str(tmp_path / "log.npz"))
    else:
        given = ("run", "walk_25x5", "--out", str(tmp_path / "out"))
    with started(*given, "--web-port", 0, stdout=-1, stderr=-1, text=True) as child:
        try:
            address = page_of(child)
            assert ask(address, "GET", "/")[0] == 200
            with Stream(address) as stream:
                _, hello = stream.until("hello")
                assert [hello["core"][name] for name in ("rows", "columns")] == [25, 5]
                stream.until("CopFrame")
                _, image = stream.until("Image")
                assert image["taxels"].shape == (25, 5)
                if kind == "run":
                    if "link" not in hello["now"]:
                        stream.until("link", lambda head: head["value"] == "/report.html")
                    assert b"walk_25x5" in ask(address, "GET", "/report.html")[1]
                if kind == "replay":
                    stream.until("status", lambda head: head["ended"])
                    assert "no core is connected" in ask(
                        address, "POST", "/set", {"name": "cop.min_load", "value": 1}
                    )[1]  # fmt: skip
            child.send_signal(signal.SIGINT)
            _, err = child.communicate(timeout=500)
        finally:
            child.kill()
    assert child.returncode == 0 and "Traceback" not in err, err
    if kind == "run":
        assert (tmp_path / "out/report.html").exists()


def test_what_cannot_be_shown_is_said(capsys, tmp_path):
    cli.main(["log", "sim:acrylic_slip", "--seconds", "0.1", "--out", str(tmp_path / "log.npz")])
    capsys.readouterr()
    (tmp_path / "scene.toml").write_text(scenes.source("cop_load"))
    (tmp_path / "raw").write_bytes(b"\0")
    for given, words in (
        (("run", "capacitive_crosstalk", "--web"), "capacitive_crosstalk has nothing to show"),
        (("replay", tmp_path / "log.npz"), "--web"),
        (("replay", tmp_path / "no.npz", "--web"), "no.npz"),
        (("live", "sim:no", "--web"), "'no'"),
        (("live", "fingertip", "--web"), "core:fingertip simulates it"),
        (("live", "acrylic_slip", "--web"), "sim:acrylic_slip plays"),
        (("live", "mine.toml"), "--config mine.toml"),
        (("live", tmp_path / "log.npz"), "meissner replay"),
        (("live", tmp_path / "scene.toml"), "it is a scene, which sim:"),
        (("live", tmp_path / "raw"), "file:"),
    ):
        with pytest.raises(SystemExit) as end:
            cli.main([*map(str, given)])
        assert end.value.code == 2
        [sentence] = capsys.readouterr().err.splitlines()
        assert words in sentence


# The files


def test_the_page_is_small_and_asks_nobody_else():
    files = page()
    assert sum(len(content) for _, content in files.values()) < 200_000
    listed = re.findall(r'src="(/panels/\w+\.js)"', files["/"][1].decode())
    folder = Path(web.__file__).parent / "page/panels"
    assert listed == [f"/panels/{path.name}" for path in sorted(folder.iterdir())] and len(listed) >= 8
    assert b"Copyright (c) 2022 Leon Sorokin" in files["/uPlot.LICENSE"][1]
    for at, (_, content) in files.items():
        named = [
            name for name in re.findall(rb"https?://[^\s\"')]+", content) if b"leeoniya/uPlot" not in name
        ]
        assert not named, (at, named)
