"""Debian's Chromium without a window, driven through a pair of pipes (its DevTools protocol): no package of
Python or Node between. ``missing`` says why there is none.
"""

import base64
import fcntl
import json
import os
import re
import shutil
import subprocess
import tempfile
import time
from contextlib import contextmanager, suppress
from pathlib import Path

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
missing = "" if CHROMIUM else "there is no Chromium on this machine (apt install chromium)"
OPTIONS = ("--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run")
OPTIONS += ("--disable-extensions", "--disable-background-networking", "--disable-dev-shm-usage")


def _high(fd):
    """The same pipe above the numbers that the shell redirects."""
    found = fcntl.fcntl(fd, fcntl.F_DUPFD, 20)
    os.close(fd)
    return found


class Page:
    """A tab: ``do`` runs JavaScript, ``until`` waits for it to be true."""

    def __init__(self, browser, target):
        self._browser = browser
        given = {"targetId": target, "flatten": True}
        self._session = browser.call("Target.attachToTarget", given)["sessionId"]
        self.call("Page.enable")
        self.call("Runtime.enable")

    def call(self, method, given=None):
        return self._browser.call(method, given, self._session)

    def do(self, script):
        given = {"expression": script, "awaitPromise": True, "returnByValue": True}
        found = self.call("Runtime.evaluate", given)
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def until(self, script, timeout_s=500):
        end = time.monotonic() + timeout_s
        while not (found := self.do(script)):
            assert time.monotonic() < end, (script, self.do("document.body.innerText"), self._browser.wrong)
            time.sleep(0.05)
        return found

    def size(self, width, height, scheme="light", ratio=1):
        given = {"width": width, "height": height, "deviceScaleFactor": ratio, "mobile": width < 600}
        self.call("Emulation.setDeviceMetricsOverride", given)
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        self.call("Emulation.setEmulatedMedia", {"features": features})

    def key(self, key, text=None):
        given = {"type": "keyDown", "key": key} | ({"text": text} if text else {})
        self.call("Input.dispatchKeyEvent", given)
        self.call("Input.dispatchKeyEvent", {"type": "keyUp", "key": key})

    def picture(self, path, whole=False):
        given = {"format": "png", "captureBeyondViewport": whole}
        if whole:
            size = self.call("Page.getLayoutMetrics")["cssContentSize"]
            given["clip"] = {"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1}
        with open(path, "wb") as file:
            file.write(base64.b64decode(self.call("Page.captureScreenshot", given)["data"]))


class Browser:
    """``open`` returns a Page; ``wrong``: exceptions and errors of the pages so far."""

    def __init__(self, folder):
        there, self._in = os.pipe()
        self._out, here = os.pipe()
        there, here = _high(there), _high(here)
        command = f'exec "$0" "$@" --remote-debugging-pipe --user-data-dir={folder} 3<&{there} 4>&{here}'
        self._process = subprocess.Popen(
            ["bash", "-c", command, CHROMIUM, *OPTIONS, "about:blank"],
            pass_fds=(there, here),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(there)
        os.close(here)
        self._rest, self._number, self.wrong = b"", 0, []

    def call(self, method, given=None, session=None):
        self._number += 1
        asked = {"id": self._number, "method": method, "params": given or {}}
        asked |= {"sessionId": session} if session else {}
        os.write(self._in, json.dumps(asked).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == self._number:
                assert "error" not in answer, (method, answer["error"])
                return answer["result"]
            if answer.get("method") == "Runtime.exceptionThrown":
                self.wrong.append(answer["params"]["exceptionDetails"])

    def _next(self):
        while b"\0" not in self._rest:
            data = os.read(self._out, 1 << 20)
            assert data, "Chromium has ended"
            self._rest += data
        one, _, self._rest = self._rest.partition(b"\0")
        return json.loads(one)

    def open(self, url, width=1280, height=900, scheme="light"):
        page = Page(self, self.call("Target.createTarget", {"url": "about:blank"})["targetId"])
        page.size(width, height, scheme)
        page.call("Page.navigate", {"url": url})
        page.until(f"location.href === {json.dumps(url)} && document.readyState === 'complete'")
        return page

    def resident_mb(self):
        """Memory of all its processes, what they share counted once."""

        def own(pid):
            root = Path(f"/proc/{pid}")
            with suppress(OSError):  # it may have ended
                [line] = re.findall(r"^Pss: +(\d+) kB", (root / "smaps_rollup").read_text(), re.MULTILINE)
                children = " ".join(each.read_text() for each in root.glob("task/*/children"))
                return int(line) + sum(map(own, children.split()))
            return 0

        return own(self._process.pid) * 1024 / 1e6

    def close(self):
        self._process.terminate()
        self._process.wait()
        os.close(self._in)
        os.close(self._out)


@contextmanager
def browser():
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        found = Browser(folder)
        try:
            yield found
        finally:
            found.close()
