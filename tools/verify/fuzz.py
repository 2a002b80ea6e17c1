"""Fuzzing of all readers of foreign input (`make fuzz`): mutated and generated input must give the right
result or one sentence (ValueError). Each case is determined by its number alone."""

import io
import os
import random
import re
import shutil
import signal
import subprocess
import tempfile
import time
import zipfile
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from meissner import calibration, files, host
from meissner.builds import config, toolchain
from meissner.host import line, log, packets
from meissner.host.replay import replay
from meissner.twins.link import packet as p
from meissner.twins.link.cobs import encode
from meissner.twins.link.decoder import Decoder

CORPUS = toolchain.ROOT / "tb/corpus"
SLOW_S = 5.0  # CPU time; a case that takes longer counts as a hang
STILL_S = 300.0  # wall-clock time: a case that waits indefinitely takes no CPU time
NASTY = [
    b"",
    b"\0",
    b"\xff" * 4,
    b"\x7f\xff\xff\xff",
    b"-1",
    b"1e999",
    b"nan",
    b"9" * 40,
    b"'",
    b'"',
    b"\\",
    b"[",
]
VALUES = [
    "0",
    "-1",
    "1e400",
    "nan",
    "-inf",
    "''",
    "true",
    "[]",
    "{}",
    "9999999999999999999",
    "0.1",
    "1",
    "2",
    "'\\u0000'",
]
VALUES += [
    "1979-05-27",
    "[1, 'a']",
    "3",
    "1023.5",
    "257",
    "'MCP3208'",
    "'array'",
    "'channels'",
    "1e-300",
    "70000",
]


class Failed(Exception):
    """A case with a wrong result."""


@contextmanager
def in_time(what):
    limits = (
        (signal.SIGPROF, signal.ITIMER_PROF, SLOW_S, "of processor time"),
        (signal.SIGALRM, signal.ITIMER_REAL, STILL_S, "by the clock"),
    )

    def late(number, _):
        _, _, limit, by = next(one for one in limits if one[0] == number)
        raise Failed(f"{what} hangs: more than {limit:g} s {by}")

    before = [signal.signal(number, late) for number, *_ in limits]
    for _, timer, limit, _ in limits:
        signal.setitimer(timer, limit)
    try:
        yield
    finally:
        for (number, timer, *_), handler in zip(limits, before):
            signal.setitimer(timer, 0)
            signal.signal(number, handler)


def mutated(draw, data, others=(b"",)):
    """``data`` with one to six byte changes."""
    data = bytearray(data)
    for _ in range(draw.choice((1, 1, 1, 2, 3, 6))):
        at = draw.randrange(len(data) + 1)
        end = min(len(data), at + draw.choice((1, 1, 2, 4, 9, 60)))
        kind = draw.randrange(8)
        if kind == 0 and at < len(data):
            data[at] ^= 1 << draw.randrange(8)
        elif kind == 1:
            data[at:at] = draw.randbytes(draw.choice((1, 2, 8, 40)))
        elif kind == 2:
            del data[at:end]
        elif kind == 3:
            data[at:end] = draw.choice(NASTY)
        elif kind == 4:
            data[at:at] = data[at:end] * draw.choice((1, 1, 3))
        elif kind == 5:
            del data[at:]
        elif kind == 6:
            other = draw.choice(others)
            cut = draw.randrange(len(other) + 1)
            data[at:at] = other[cut : cut + draw.choice((3, 30, 300))]
        elif at < len(data):
            data[at] = draw.choice((0, 1, 127, 128, 254, 255))
    return bytes(data)


def corpus(target):
    """{name: bytes} of the files in the target's folder; empty without a folder."""
    return {path.name: path.read_bytes() for path in sorted((CORPUS / target).glob("*"))}


class Packets:
    """Mutated and random lines for the decoder in Python: it must yield no packet that was not sent."""

    name = "decoder_python"

    def __init__(self, folder):
        self.line = b"".join(corpus("packets").values())
        whole = Decoder().next(self.line)
        self.sent = {p.packet(q.kind, q.number, q.time, q.payload) for q in whole}
        self.decoder, self.found = Decoder(), 0

    def make(self, draw):
        if draw.randrange(2):
            return draw.randbytes(draw.randrange(80))
        start = draw.randrange(len(self.line))
        return mutated(draw, self.line[start : start + draw.choice((60, 60, 300))], (self.line,))

    def close(self):
        """Release system resources."""

    def check(self, data):
        for q in self.decoder.next(data + b"\0"):
            self.found += 1
            body = p.packet(q.kind, q.number, q.time, q.payload)
            if body not in self.sent and encode(body) not in b"\0" + data + b"\0":
                raise Failed(f"a packet that was not sent: {q}")


class Feed:
    """A line that delivers one string and then nothing."""

    data = b""

    def read(self, _):
        data, self.data = self.data, b""
        return data


class Host(Packets):
    """The same through a line to meissner.host.Core, which assembles images and types packets."""

    name = "host"

    def __init__(self, folder):
        super().__init__(folder)
        self.feed = Feed()
        self.core = host.Core(line.Pipe(self.feed), registers=False, say=lambda _: None)
        self.feed.data = self.line
        self.told = {self._of(item) for item in self.core.packets(0)}

    def _of(self, item):
        if isinstance(item, packets.Image):
            return item.taxels.tobytes()
        return repr(item)

    def check(self, data):
        self.feed.data = data
        for item in self.core.packets(0):
            self.found += 1
            if self._of(item) not in self.told:
                raise Failed(f"the host tells what was not sent: {item}")


class Terminal(Host):
    """The same through a pseudo-terminal: bytes of every value, in pieces of any size."""

    name = "host_pty"

    def __init__(self, folder):
        super().__init__(folder)
        self.end, slave = os.openpty()
        self.core.line = line.Device(os.ttyname(slave))
        os.close(slave)

    def check(self, data):
        os.write(self.end, data + b"\0")
        wanted = self.core.counts.bytes + len(data) + 1
        while self.core.counts.bytes < wanted:
            for item in self.core.packets(0):
                self.found += 1
                if self._of(item) not in self.told:
                    raise Failed(f"the host tells what was not sent: {item}")

    def close(self):
        self.core.line.close()
        os.close(self.end)


class Files:
    """A reader of files: it must return what it reads, or raise ValueError with one line."""

    def __init__(self, folder):
        self.folder = folder
        self.seeds = corpus(self.name)

    def make(self, draw):
        name = draw.choice([*self.seeds])
        data = self.seeds[name]
        if data[:2] == b"PK" and draw.randrange(4):
            return name, archive(draw, data)
        return name, mutated(draw, data, [*self.seeds.values()])

    def close(self):
        pass

    def check(self, case):
        name, data = case
        path = self.folder / f"case{Path(name).suffix}"
        path.write_bytes(data)
        try:
            self.read(path)
        except ValueError as refused:
            if "\n" in str(refused) or not str(refused).strip():
                raise Failed(f"not one sentence: {str(refused)!r}") from None


class Config(Files):
    name = "config"

    def __init__(self, folder):
        super().__init__(folder)
        named = toolchain.ROOT / "model/meissner/builds/configs"
        self.seeds |= {path.name: path.read_bytes() for path in sorted(named.glob("*.toml"))}

    def make(self, draw):
        name, data = draw.choice([*self.seeds.items()])
        if not draw.randrange(4):
            return name, mutated(draw, data, [*self.seeds.values()])
        lines = data.decode("utf-8", "replace").splitlines()
        for _ in range(draw.choice((1, 1, 2, 4))):
            at = draw.randrange(len(lines))
            kind = draw.randrange(6)
            if kind < 3 and "=" in lines[at]:
                lines[at] = lines[at].split("=")[0] + "= " + draw.choice(VALUES)
            elif kind == 3:
                del lines[at]
            elif kind == 4:
                lines.insert(
                    at,
                    draw.choice(draw.choice([*self.seeds.values()]).decode("utf-8", "replace").splitlines()),
                )
            else:
                lines[at] = re.sub(
                    r"\d+", lambda _: str(draw.choice((0, 1, 3, 8, 17, 255, 1025, 10**9))), lines[at]
                )
            if not lines:
                break
        return name, "\n".join(lines).encode()

    def read(self, path):
        found = config.load(path)
        config.verilog(found.parameters)
        assert isinstance(found.settings, dict)


class Recordings(Files):
    name = "recordings"

    def read(self, path):
        if path.suffix == ".npz":
            calibration.read_recording(path)
        else:
            array = files.read_array(path)
            calibration.check_codes(array)


class Calibrations(Files):
    name = "calibration"

    def read(self, path):
        calibration.load(path)


class Logs(Files):
    name = "log"

    def read(self, path):
        found = log.read(path)
        if found["image"].size < 1000:
            replay(found, "fixed")


def archive(draw, data):
    """A complete .npz whose arrays have other shapes or types, are missing or mutated."""
    with np.load(io.BytesIO(data)) as found:
        arrays = {name: found[name] for name in found.files}
    made = io.BytesIO()
    changed = {draw.choice([*arrays]) for _ in range(draw.choice((1, 1, 2)))}
    with zipfile.ZipFile(made, "w") as out:
        for name, array in arrays.items():
            kind = draw.randrange(7) if name in changed else None
            if kind == 0:
                continue
            if kind == 1:
                array = array.astype(draw.choice(("i1", "u8", "f2", "f8", "?", "U3", "c8", "O", "M8[s]")))
            elif kind == 2:
                array = array.ravel()[: draw.randrange(array.size + 1)]
            elif kind == 3:
                array = array[..., None] if draw.randrange(2) else np.stack([array, array])
            elif kind == 4:
                array = np.array(draw.choice((0, -1, 2**62, 1e300, float("nan"), "x", b"", True)))
            inner = io.BytesIO()
            np.lib.format.write_array(inner, np.asarray(array), allow_pickle=True)
            body = inner.getvalue()
            out.writestr(f"{name}.npy", mutated(draw, body) if kind in (5, 6) else body)
    return made.getvalue()


TARGETS = {
    target.name: target for target in (Packets, Host, Terminal, Config, Recordings, Calibrations, Logs)
}
CASES = {  # one or two CPU minutes each; a million would take hours
    "host_pty": 200_000,
    "config": 200_000,
    "recordings": 400_000,
    "calibration": 200_000,
    "log": 50_000,
}

C_NAME = "decoder_c"
SOURCES = [toolchain.ROOT / "host/msn_packet.c", toolchain.ROOT / "tb/host/packet_fuzz.c"]
STRICT = ["-std=c99", "-g", "-O1", "-I", str(toolchain.ROOT / "host")]


def run_c(count, seed=1):
    """Run ``count`` strings through the C decoder; return a description. Failed has the sanitizers' output.

    With clang and its libFuzzer, coverage guides half of them; the others, or all, come from
    tb/host/packet_fuzz.c. A compiler without sanitizers builds without them, which the description states.
    """
    line = CORPUS / "packets/line.bin"
    with tempfile.TemporaryDirectory() as folder:

        def do(command):
            return subprocess.run([*map(str, command)], cwd=folder, capture_output=True, text=True)

        def must(done):
            if done.returncode:
                raise Failed(f"{C_NAME}: {(done.stderr or done.stdout)[-2000:]}")

        guided = "-fsanitize=fuzzer,address,undefined"
        used = []
        if shutil.which("clang") and not do(["clang", *STRICT, guided, *SOURCES, "-o", "guided"]).returncode:
            (Path(folder) / "found").mkdir()
            options = [
                f"-runs={count // 2}",
                f"-seed={seed}",
                "-max_len=600",
                f"-timeout={STILL_S:.0f}",  # libFuzzer has no limit in CPU time
                "found",
                line.parent,
            ]
            must(do(["./guided", *options]))
            used.append(f"{count // 2} by libFuzzer")
            count -= count // 2
        sane = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
        note = ""
        if do(["cc", *STRICT, "-DSTANDALONE", *sane, *SOURCES, "-o", "own"]).returncode:
            note = " without sanitizers, which this compiler has not"
            must(do(["cc", *STRICT, "-DSTANDALONE", *SOURCES, "-o", "own"]))
        must(do(["./own", count, seed, line]))
        used.append(f"{count} of its own{note}")
    return ", ".join(used)


def run(target, count, seed=1, first=0):
    """Run ``count`` cases; return the CPU seconds of the slowest. Failed describes the error."""
    slowest = 0.0
    with tempfile.TemporaryDirectory(dir="/dev/shm" if Path("/dev/shm").is_dir() else None) as folder:
        reader = TARGETS[target](Path(folder))
        for index in range(first, first + count):
            case = reader.make(random.Random(seed << 40 | index))
            begin = time.process_time()
            try:
                with in_time(target):
                    reader.check(case)
            except Exception as problem:
                raise Failed(f"{target}, case {index}: {type(problem).__name__}: {problem}") from problem
            slowest = max(slowest, time.process_time() - begin)
        reader.close()
    return slowest


def summary(facts):
    return f"{facts['cases']:,} cases"


def total(targets):
    cases = sum(facts["cases"] for facts in targets)
    return f"{cases:,} fuzzed inputs to {len(targets)} readers, no crash, hang or false packet"
