"""The page in a real browser, Debian's Chromium where there is one: it draws, it updates, a threshold moved
in it changes the flags of the simulated core, the source may die and come back, and so may the server."""

import re
import threading
import time
from dataclasses import dataclass

import numpy as np
import pytest

from harness import browser as chromium
from harness.web import TURN_S, Fed, of_pipe, resident_mb, shown, slipping
from meissner.builds.toolchain import ROOT
from meissner.builds.units import Units
from meissner.host import Core, packets, sensors, web
from meissner.host.line import open_line
from meissner.host.pty import Pty
from meissner.host.simulated import SimulatedCore, of_scenes
from meissner.host.web import server
from meissner.host.web.server import serving

pytestmark = pytest.mark.skipif(bool(chromium.missing), reason=chromium.missing)
WIDE = "document.documentElement.scrollWidth <= innerWidth"
# The share of a canvas that is drawn, and whether it changes.
INK = """(() => { const c = document.querySelector('#%s canvas');
const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
let n = 0; for (let k = 3; k < d.length; k += 4) n += d[k] > 0; return n / (d.length / 4); })()"""
SHOWN = "!document.getElementById('%s').hidden"
STATE = "document.getElementById('state').dataset.state"


@pytest.fixture(scope="module")
def browser():
    with chromium.browser() as found:
        yield found
        assert not found.wrong


def url(address):
    return f"http://{address[0]}:{address[1]}/"


def test_it_draws_and_updates_and_a_threshold_changes_the_flags(browser):
    """The slider is moved by keys, as a user does; at the top of the scale the scene does not slip again."""
    pipe = slipping(3)
    with shown(of_pipe(pipe, pipe.units)) as address:
        page = browser.open(url(address))
        page.until("meissner.firstPicture !== null")
        for panel in ("signal", "states", "settings", "events", "link"):
            page.until(SHOWN % panel)
        for panel in ("touch", "load", "grip", "forest", "pins"):
            assert not page.do(SHOWN % panel)
        page.until(f"{INK % 'signal'} > 0.01")
        before = page.do("meissner.newest")
        page.until(f"meissner.newest > {before} + 1")
        page.until("meissner.events.some(one => one.text.includes('slip, incipient'))")
        assert page.do("meissner.registers.now('slip.threshold')") == 23
        said = "document.querySelector('#settings output').textContent"
        page.until(f"{said} === 'has 23, 19.9 mV'")
        page.do("document.querySelector('#settings input[type=range]').focus()")
        page.key("End")
        page.until("meissner.registers.now('slip.threshold') === 8190")
        assert pipe.registers.setting("slip", "threshold") == 8190
        page.until(f"{said}.startsWith('has 8190')")
        at = page.do("meissner.newest")
        page.until(f"meissner.newest > {at + 2 * TURN_S}")
        slips = f"meissner.states.of.get(0).some(one => one.t > {at + 0.3} && one.value.state === 2)"
        assert not page.do(slips)
        # And back: a number typed into the field.
        field = "document.getElementById('set-slip.threshold')"
        page.do(f"{field}.value = 23; {field}.onchange()")
        page.until(slips)
        assert page.do(WIDE)


def test_pause_scroll_save_and_keys(browser, tmp_path):
    pipe = of_scenes("walk_25x5")
    with shown(of_pipe(pipe, pipe.units)) as address:
        page = browser.open(url(address), 390, 800, "dark")
        page.until("meissner.newest > 3 && meissner.cop.length > 10")
        assert page.do(WIDE) and page.do("meissner.view.span") == 10
        page.key("-")
        page.until("meissner.view.span === 20")
        for _ in range(4):
            page.key("+")
        page.until("meissner.view.span === 1")
        page.key(" ", " ")
        page.until("document.getElementById('pause').getAttribute('aria-pressed') === 'true'")
        to = page.do("meissner.view.to")
        page.until(f"meissner.newest > {to} + 0.5")
        assert page.do("meissner.view.to") == to
        page.key("ArrowLeft")
        page.until(f"meissner.view.to < {to}")
        where = {"behavior": "allow", "downloadPath": str(tmp_path)}
        page.call("Page.setDownloadBehavior", where)
        page.key("s", "s")
        page.until("document.getElementById('notice').textContent.startsWith('saved as')")
        end = time.monotonic() + 500
        while not (found := list(tmp_path.glob("*.mcap"))) and time.monotonic() < end:
            time.sleep(0.05)
        from meissner.host import log

        rows = log.read(found[0])
        begin, end = page.do("[meissner.from, meissner.to]")
        assert len(rows["cop_time"]) and np.ptp(rows["cop_ns"]) <= (end - begin) * 1e9
        page.key("End")
        page.until("!meissner.view.paused")


def test_the_report_of_a_scene_is_linked(browser):
    source, seen = of_pipe(SimulatedCore()), []
    with web.beside(source, 0, seen.append) as stay:
        page = browser.open(seen[0].partition(": ")[2])
        page.until("meissner.hello")
        assert page.do("document.getElementById('report').hidden")
        thread = threading.Thread(target=stay, args=(b"<p>all slips</p>",), daemon=True)
        thread.start()
        page.until("!document.getElementById('report').hidden")
        text = "fetch(document.getElementById('report').href).then(answer => answer.text())"
        assert page.do(text) == "<p>all slips</p>"
        source.stop()
        thread.join()


@dataclass(frozen=True)
class Votes(packets.OfBoot):
    """A packet of a feature to come, as docs/host.md shows it."""

    time: int
    score: float


def test_a_panel_is_one_file(browser, monkeypatch):
    """The page's example: its packet reaches it, and it is hidden until then."""
    [text] = re.findall(r"```js\n(.*?)```", (ROOT / "docs/host.md").read_text("utf-8"), re.DOTALL)
    files = server.page()
    kind, index = files["/"]
    index = index.replace(b"</body>", b'<script type="module" src="/panels/90_votes.js"></script></body>')
    more = {"/": (kind, index), "/panels/90_votes.js": (server.TYPES[".js"], text.encode())}
    monkeypatch.setattr(server, "page", lambda: files | more)
    source = of_pipe(SimulatedCore())
    with shown(source) as address:
        page = browser.open(url(address))
        page.until("meissner.hello")
        assert not page.do(SHOWN % "votes")
        source.hub.ask(lambda: [source.hub.add(10**18 + k * 10**7, Votes(k, k * 0.5)) for k in range(50)])
        page.until(SHOWN % "votes")
        page.until(f"{INK % 'votes'} > 0.005")


def test_it_survives_a_source_that_dies(browser, tmp_path):
    port = tmp_path / "port"
    first = Pty(of_scenes("walk_25x5"))
    port.symlink_to(first.path)
    core = Core(open_line(f"pty:{port}"))
    source = web.OfCore(core, "a port")
    core.say = source.say
    with shown(source) as address:
        page = browser.open(url(address))
        page.until("meissner.cop.length > 3")
        first.unplug()
        page.until(f"{STATE} === 'down'")
        with Pty(of_scenes("walk_25x5")) as second:
            port.unlink()
            port.symlink_to(second.path)
            page.until(f"{STATE} === 'live'")
            count = page.do("meissner.received")
            page.until(f"meissner.received > {count} + 20")
            page.until("meissner.events.some(one => one.text.startsWith('interrupted for'))")
    core.close()


def test_it_survives_a_restart_of_the_server(browser):
    port = 0
    for turn in range(2):
        source = of_pipe(of_scenes("walk_25x5"))
        with serving(source.hub, source.write, port) as served:
            thread = threading.Thread(target=web.play, args=(source,), daemon=True)
            thread.start()
            port = served.server_address[1]
            if not turn:
                page = browser.open(served.url)
            page.until(f"meissner.hello?.session === '{source.hub.session}' && meissner.cop.length > 3")
            source.stop()
            thread.join()
        page.until(f"{STATE} === 'down'")
    assert "started again" in page.do("document.getElementById('notice').textContent")


# Whether a column of a canvas at a time of the page, 0 .. 1 of its room, has a colour of the page.
COLOURED = """((selector, left, wide, share, name) => {
const c = document.querySelector(selector), x = Math.round(left + share * wide);
const d = c.getContext('2d').getImageData(x, 0, 1, c.height).data;
const text = getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
const want = [1, 3, 5].map(k => parseInt(text.slice(k, k + 2), 16));
const same = k => d[k + 3] > 200 && want.every((v, j) => Math.abs(v - d[k + j]) < 12);
return [...Array(c.height).keys()].some(row => same(4 * row)); })(%s)"""


def test_a_late_viewer_sees_the_past_as_it_was(browser):
    """A threshold and a state that changed before it came hold from then on; what they were before holds only
    as far back as this viewer knows, 10 s, and before that nothing is drawn."""
    hub = web.hub.Hub(web.sources.about("late", Units(), [], []), Units())
    begin = 10**18

    def at(seconds, item=None, **register):
        stamp = begin + round(seconds * 1e9)
        hub.add(stamp, item or packets.Statistics(0, seconds, 0, 0))
        for name, value in register.items():
            hub.remember("register", f"slip.{name}", value)
        hub.send()

    def change(channel, before, state):
        return packets.StateChange(0, None, channel, state, 9, None, None, before)

    at(0, threshold=40, gross_threshold=500)
    at(0.5, change(0, 0, 1))
    at(5, change(3, 0, 1))
    at(8, gross_threshold=300)
    at(20)  # the first that a viewer gets who comes at 30 s
    at(20.5, threshold=60)
    at(21, packets.SlipEvent(0, None, 0, 2, 55, None))
    at(22, change(0, 2, 1))
    at(25, threshold=90)
    at(30)
    with serving(hub, lambda name, value: value, 0) as server:
        page = browser.open(url(server.server_address))
        page.until("meissner.newest === 30 && meissner.states.of.size === 2")
        known = {("threshold", 19.9): None, ("threshold", 20): 40, ("threshold", 20.49): 40,
                 ("threshold", 20.5): 60, ("threshold", 24.9): 60, ("threshold", 25): 90,
                 ("gross_threshold", 7.9): None, ("gross_threshold", 8): 300}  # fmt: skip
        for (name, t), value in known.items():
            assert page.do(f"meissner.registers.at('slip.{name}', {t}) ?? null") == value, (name, t)
        known = {(0, 19.9): None, (0, 20): 1, (0, 20.9): 1, (0, 21): 2, (0, 21.9): 2, (0, 22): 1,
                 (3, 4.9): None, (3, 5): 1}  # fmt: skip
        for (channel, t), state in known.items():
            assert page.do(f"meissner.states.at({channel}, {t})?.state ?? null") == state, (channel, t)
        # From 16 s to 28 s, in twelfths.
        page.do("Object.assign(meissner.view, {paused: true, span: 12, to: 28})")
        page.until("document.getElementById('at').textContent === '16.00 – 28.00 s'")
        time.sleep(0.2)
        bands = "document.querySelector('#states canvas').width"
        wide = page.do(bands)
        for t, name, drawn in (
            (21.5, "incipient", True),
            (20.2, "incipient", False),
            (22.5, "incipient", False),
        ):
            where = f"'#states canvas', 48, {wide - 48}, {(t - 16) / 12}, '{name}'"
            assert page.do(COLOURED % where) == drawn, t
        chart = "#signal > div > div:nth-of-type(2)"
        left, wide = (
            page.do(f"document.querySelector('{chart} .u-over').{side}")
            for side in ("offsetLeft", "offsetWidth")
        )
        columns = lambda ends, name: sum(
            page.do(COLOURED % f"'{chart} canvas', {left}, {wide}, {(t - 16) / 12}, '{name}'")
            for t in np.linspace(*ends, 24)
        )
        assert columns((16.2, 19.8), "incipient") == 0 < columns((20.1, 27.8), "incipient")
        assert columns((16.2, 20.8), "second") == 0 < columns((21.1, 21.9), "second")  # peaks of 55, then 9


def test_an_empty_page_says_what_it_waits_for(browser):
    hub = web.hub.Hub(web.sources.about("empty", Units(), [], []), Units())
    empty = "document.getElementById('empty')"
    with serving(hub, lambda name, value: value, 0) as server:
        page = browser.open(url(server.server_address))
        for status, words in (
            ({}, "first packet"),
            ({"counts": {"packets": 1}}, "1 packet received"),
            ({"counts": {"packets": 2}}, "2 packets received"),
            ({"down": True}, "can be opened"),
            ({"ended": True}, "has ended"),
        ):
            hub.event("status", **({"counts": {}, "down": False, "ended": False, "viewers": 1} | status))
            hub.send()
            page.until(f"!{empty}.hidden && {empty}.textContent.includes('{words}')")
        hub.add(10**18, packets.ClassChange(0, None, 3, None, 65535))
        hub.send()
        page.until(f"{empty}.hidden && {SHOWN % 'forest'}")


@pytest.mark.long
def test_64x64_at_100_frames_a_second_without_growth(browser):
    """Three minutes: every frame arrives, and in the second half neither process grows. What may grow before:
    the history on both sides, which is full after one minute."""
    source = Fed()
    with shown(source) as address:
        page = browser.open(url(address))
        count = "if (window.last && image.time !== last + 250_000) window.gaps++; window.last = image.time;"
        page.do(f"window.gaps = 0; import('/page.js').then(it => it.on('Image', image => {{ {count} }}))")
        first, sizes = source.sent, []
        for seconds in (90, 90):
            time.sleep(seconds)
            page.call("HeapProfiler.collectGarbage")
            sizes.append((resident_mb(), page.do("performance.memory.usedJSHeapSize") / 1e6))
        assert page.do("[gaps, meissner.dropped]") == [0, 0]
        page.until(f"last > {first + 17_000} * 250_000")  # a second late at most
        (before, heap), (after, heap_after) = sizes
        assert after - before < 4 and heap_after - heap < 4, sizes


@pytest.mark.parametrize("width", [1280, 390])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_an_array_with_faults_and_a_grip(browser, width, scheme):
    """Every panel at both widths and in both styles; what a panel draws is in the page's own colours."""
    pipe = SimulatedCore(size=(4, 6))
    pipe.status["grip", "command", "value"] = 1234
    pipe.status["grip", "fault", "value"] = 3
    source = of_pipe(pipe, Units(newtons_per_code=0.001, pitch_mm=2))
    with shown(source) as address:
        page = browser.open(url(address), width, 800, scheme)
        page.until("meissner.hello")
        taxels = np.arange(24, dtype=np.uint16).reshape(4, 6) * 50

        def more():
            hub = source.hub
            begin = 10**18 + int(hub.newest_s * 1e9)
            hub.add(begin, packets.Image(0, None, 1, taxels, 0.001))
            hub.add(begin + 10**6, packets.CopFrame(0, None, 0.5, 0.5, 900, True, 2.5, 1.5, 0.9))
            hub.add(begin + 2 * 10**6, packets.Health(0, None, 9, 5))
            hub.add(begin + 3 * 10**6, packets.StateChange(0, None, 7, 1, 9, None, None))
            hub.add(begin + 4 * 10**6, packets.SlipEvent(0, None, 7, 2, 70, None))
            hub.add(begin + 5 * 10**6, packets.ClassChange(0, None, 3, 1, 131_070))
            hub.add(begin + 6 * 10**6, sensors.Pins(0, None, np.arange(6, dtype=np.uint8).reshape(2, 3), 5))

        source.hub.ask(more)
        for panel in (
            "touch",
            "signal",
            "states",
            "load",
            "forest",
            "settings",
            "grip",
            "pins",
            "events",
            "link",
        ):
            page.until(SHOWN % panel)
        page.until(f"{INK % 'touch'} > 0.3")
        # Row 0 is at the top, y points up: of ±5 and ±3 mm between the outer cells' centres, 2.5 and 1.5.
        hot, cold, mark = (page.do(f"getComputedStyle(document.documentElement).getPropertyValue('--{name}')")
                           for name in ("hot", "cold", "incipient"))  # fmt: skip
        shown_at = {(5.5 / 6, 3.5 / 4): hot, (0.5 / 6, 0.5 / 4): cold, (4.25 / 6, 1.25 / 4): mark}
        for (across, down), colour in shown_at.items():
            at = f"Math.round(c.width * {across}), Math.round(c.height * {down})"
            script = f"[...c.getContext('2d').getImageData({at}, 1, 1).data.slice(0, 3)]"
            found = page.do(f"(c => {script})(document.querySelector('#touch canvas'))")
            assert found == [int(colour.strip()[k : k + 2], 16) for k in (1, 3, 5)], (across, down)
        page.until("document.querySelector('#touch small').textContent === '2.50, 1.50 mm, load 0.9 N'")
        assert "9 dead, blinking" in page.do("document.querySelector('#touch .note').textContent")
        page.until("document.querySelector('#grip small').textContent === '1234 counts'")
        page.until("document.querySelector('#forest small').textContent === 'class 3'")
        assert page.do(INK % "pins") > 0.4
        words = "a finger is silent, a finger is unhealthy; 0 tightenings"
        assert page.do("document.querySelector('#grip .note').textContent") == words
        assert page.do(WIDE), page.do("document.documentElement.scrollWidth")
        dark = page.do("getComputedStyle(document.body).backgroundColor")
        assert (dark == "rgb(20, 24, 28)") == (scheme == "dark")
