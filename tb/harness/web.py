"""The page of meissner.host.web as a viewer gets it: HTTP on this machine, messages decoded from the format
that the head of meissner.host.web.hub states."""

import contextlib
import http.client
import json
import math
import socket
import struct
import threading
import time
from pathlib import Path

import numpy as np

from meissner import scenes
from meissner.builds.units import Units, of_scene
from meissner.host import Core, packets, web
from meissner.host.line import Pipe
from meissner.host.sensors import blocks_of, settings_of, slip_source
from meissner.host.simulated import SimulatedCore
from meissner.host.web.server import serving

TYPES = {"f8": "<f8", "f4": "<f4", "u2": "<u2", "u1": "u1"}


@contextlib.contextmanager
def shown(source):
    """The address of a page of ``source``, which a thread plays."""
    thread = threading.Thread(target=web.play, args=(source,), daemon=True)
    with serving(source.hub, source.write, 0) as server:
        thread.start()
        try:
            yield server.server_address
        finally:
            source.stop()
            thread.join()


def of_pipe(pipe, known=None, title="a core", **settings):
    return web.OfCore(Core(Pipe(pipe), known, **settings), title)


TURN_S = 2.0


def slipping(speed):
    """A simulated core that plays the last seconds of the demo's scene, TURN_S, again and again: in each turn
    the plate, held, slips."""
    scene = scenes.load("acrylic_slip")
    config, recording = scene.slip_config(), scenes.simulate(scene, 0, 1)
    codes = recording.codes[None, -round(TURN_S * scene.rate_hz) :]
    source = slip_source(blocks_of(codes, config.level, loop=True), scene.rate_hz, config.window, config.hop)
    core = SimulatedCore(source, settings=settings_of(config), speed=speed, level=config.level)
    core.units = of_scene(scene)
    return core


class Fed:
    """A source of images and centres of pressure at RATE_HZ, without a core."""

    RATE_HZ, SIDE = 100, 64

    def __init__(self):
        known = Units(clk_khz=25_000, rows=self.SIDE, columns=self.SIDE, newtons_per_code=0.001, pitch_mm=1)
        self.hub, self.stopped = web.hub.Hub(web.sources.about("fed", known, [], []), known), False
        place = np.arange(self.SIDE) - self.SIDE / 2
        self._images = [
            (
                4000 * np.exp(-((place[:, None] - 12 * np.sin(a)) ** 2 + (place - 12 * np.cos(a)) ** 2) / 60)
            ).astype(np.uint16)
            for a in np.linspace(0, 2 * np.pi, self.RATE_HZ, endpoint=False)
        ]
        self._began, self.sent = time.monotonic(), 0

    def stop(self):
        self.stopped = True

    def write(self, name, value):
        raise ValueError("nothing can be set")

    def step(self):
        time.sleep(web.sources.PERIOD_S)
        while self.sent < (time.monotonic() - self._began) * self.RATE_HZ:
            k, t = self.sent, self.sent / self.RATE_HZ
            image = self._images[k % len(self._images)]
            stamp = round(t * 1e9) + 1
            self.hub.add(stamp, packets.Image(round(t * 25e6), t, k % 256, image, 0.001))
            x, y = 0.3 * np.cos(k / 16), -0.3 * np.sin(k / 16)
            self.hub.add(stamp, packets.CopFrame(round(t * 25e6), t, x, y, 90, True, 30 * x, 30 * y, 0.09))
            self.sent += 1
        self.hub.answer()
        self.hub.event("status", counts={}, down=False, ended=False, viewers=len(self.hub.viewers))
        self.hub.send()


def resident_mb():
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 1e6


def ask(address, method, path, body=None, **headers):
    """(status, content or the sentence of a refusal)."""
    line = http.client.HTTPConnection(*address, timeout=500)
    own = f"{address[0]}:{address[1]}"
    given = {"Host": own, "Origin": f"http://{own}", "Content-Type": "application/json"}
    given |= {name.replace("_", "-"): value for name, value in headers.items()}
    given = {name: value for name, value in given.items() if value is not None}
    line.request(method, path, None if body is None else json.dumps(body), given)
    answer = line.getresponse()
    data = answer.read()
    line.close()
    return answer.status, json.loads(data)["error"] if answer.status >= 400 else data


def decoded(data):
    """[(t, head with its arrays)] of complete messages, and the bytes of the rest."""
    found, at = [], 0
    while len(data) - at >= 16:
        length, text, t = struct.unpack_from("<IId", data, at)
        if len(data) - at < length:
            break
        head, place = json.loads(data[at + 16 : at + 16 + text]), at + 16 + text
        for name, kind, shape in head.pop("arrays", []):
            count = math.prod(shape)
            head[name] = np.frombuffer(data, TYPES[kind], count, place).reshape(shape)
            place += -(-count * int(kind[1:]) // 8) * 8
        assert place == at + length and length % 8 == 0
        found.append((t, head))
        at += length
    return found, data[at:]


class Stream:
    """A viewer: ``until`` reads messages until one of ``kind`` for which ``wanted`` is true."""

    def __init__(self, address, room=None):
        self._socket = socket.socket()
        if room:
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, room)
        self._socket.settimeout(60)
        self._socket.connect(address)
        host = f"{address[0]}:{address[1]}"
        self._socket.sendall(f"GET /stream HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())
        self._rest = b""
        while b"\r\n\r\n" not in self._rest:
            self._rest += self._read()
        head, _, self._rest = self._rest.partition(b"\r\n\r\n")
        assert head.startswith(b"HTTP/1.1 200"), head
        self.seen = []

    def _read(self):
        data = self._socket.recv(1 << 16)
        if not data:
            raise EOFError
        return data

    def until(self, kind, wanted=lambda head: True):
        for t, head in iter(self.next, None):
            if head["kind"] == kind and wanted(head):
                return t, head

    def next(self):
        while not (found := decoded(self._rest)[0]):
            self._rest += self._read()
        t, head = found[0]
        self._rest = self._rest[struct.unpack_from("<I", self._rest)[0] :]
        self.seen.append((t, head))
        return t, head

    def close(self):
        self._socket.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def rows(messages, kind):
    """Each row of a kind's tables as a dict, without what is not known."""
    return [
        {name: value for name, value in zip(head["columns"], row) if not math.isnan(value)}
        for _, head in messages
        if head["kind"] == kind
        for row in head["rows"].tolist()
    ]
