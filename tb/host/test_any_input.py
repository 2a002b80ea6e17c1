"""Every reader of lines and files, given what hypothesis makes of small whole ones: bytes changed, lines of
TOML exchanged, archives of other arrays.

A decoder yields no packet that its input does not contain; a reader of files returns what it reads or raises
ValueError with one sentence; nothing takes more than 5 s of processor time. MEISSNER_EXAMPLES=20 gives each
of them twenty times as many inputs.
"""

import io
import os
import signal
import tempfile
import warnings
import zipfile
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import h5py
import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import HealthCheck, given, seed, settings
from scipy.io import savemat, wavfile

from host.test_packet_c import decode_c, expected  # noqa: F401 - decode_c is a fixture
from host.test_wire import crc32, stuffed
from meissner import calibration, host, readers, scenes
from meissner.builds import config, units
from meissner.host import line, log
from meissner.host.packets import Image
from meissner.host.replay import replay
from meissner.host.simulated import SimulatedCore
from meissner.twins.link import packet as p
from meissner.twins.link.cobs import encode
from meissner.twins.link.decoder import Decoder

TIMES = int(os.environ.get("MEISSNER_EXAMPLES", "1"))
NASTY = [b"", b"\0", b"\xff" * 4, b"\x7f\xff\xff\xff", b"-1", b"1e999", b"nan", b"9" * 40, b"'", b"\\", b"["]
VALUES = ["0", "-1", "1e400", "nan", "-inf", "''", "true", "[]", "{}", "9" * 19, "0.1", "1", "2", "'\\u0000'"]
NUMBERS = ["0", "1", "3", "17", "255", "1025", "1000000000"]
VALUES += ["1979-05-27", "[1, 'a']", "3", "1023.5", "257", "'MCP3208'", "'array'", "1e-300", "70000"]


def some(count, **strategies):
    """Run a test with ``count`` examples of the strategies, the same ones each time."""
    rules = settings(
        max_examples=count * TIMES,
        database=None,
        deadline=None,
        suppress_health_check=[*HealthCheck],
    )
    return lambda test: seed(1)(rules(given(**strategies)(test)))


@contextmanager
def in_time():
    """Fail after 5 s of processor time: wall-clock time depends on the machine."""

    def late(*_):
        raise AssertionError("more than 5 s of processor time")

    before = signal.signal(signal.SIGPROF, late)
    signal.setitimer(signal.ITIMER_PROF, 5)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def mutated(*seeds):
    """One of ``seeds`` with up to five pieces replaced: by a byte, nothing, more bytes, a part of another."""

    def changed(data, edits):
        for at, length, new in edits:
            at %= len(data) + 1
            data = data[:at] + new + data[at + length :]
        return data

    cut = lambda data, at, length: data[at : at + length]
    part = st.builds(cut, st.sampled_from(seeds), places, st.integers(1, 300))
    new = st.one_of(st.binary(max_size=1), st.binary(max_size=40), st.sampled_from(NASTY), part)
    length = st.sampled_from([0, 1, 1, 1, 2, 4, 9, 60, 10**6])
    return st.builds(changed, st.sampled_from(seeds), st.lists(st.tuples(places, length, new), max_size=5))


places = st.integers(0, 2**16)


# The line

PACKETS = [p.packet(p.SLIP, n, n << 30, p.slip_event(n, n * n, 2)) for n in range(6)]
PACKETS += [p.packet(p.IMAGE, 6 + n, 5, part) for n, part in enumerate(p.image_chunks(3, [*range(150)]))]
PACKETS += [p.packet(p.COP, 9, 6, p.cop_frame(-5, 7, 99, 1)), p.packet(p.HEALTH, 10, 7, p.health(5, 6))]
PACKETS += [p.packet(77, 11, 8, bytes(range(40)))]
LINE = b"".join(map(encode, PACKETS))
lines = st.one_of(
    mutated(LINE),
    mutated(*map(encode, PACKETS)),
    st.binary(max_size=80),
    st.binary(max_size=80).map(lambda data: bytes(byte % 3 for byte in data)),
)


@some(1500, data=lines)
def test_the_decoder_yields_only_packets_that_were_sent(data):
    with in_time():
        found = Decoder().next(data + b"\0")
    for q in found:
        body = bytes([q.kind, q.number]) + q.time.to_bytes(6, "little") + q.payload
        assert stuffed(body + crc32(body).to_bytes(4, "little")) in b"\0" + data + b"\0"


@some(60, several=st.lists(lines, max_size=25))
def test_the_decoder_in_c_yields_the_same(decode_c, several):  # noqa: F811
    data = b"\0".join(several)
    assert decode_c(data) == expected(data)


class Feed:
    """A line that delivers pieces, then nothing."""

    def __init__(self, *pieces):
        self.pieces = [*pieces]

    def read(self, _):
        return self.pieces.pop(0) if self.pieces else b""


def told(item):
    return item.taxels.tobytes() if isinstance(item, Image) else repr(item)


@cache
def sent():
    """What a host says about the whole line."""
    core = host.Core(line.Pipe(Feed(LINE)), registers=False, say=lambda _: None)
    return {told(item) for item in core.packets(0)}


@some(600, data=lines, cut=st.integers(0, 300))
def test_the_host_tells_only_what_was_sent(data, cut):
    core = host.Core(line.Pipe(Feed(data[:cut], data[cut:] + b"\0")), registers=False, say=lambda _: None)
    with in_time():
        assert {told(item) for item in core.packets(0)} <= sent()


@pytest.fixture(scope="module")
def terminal():
    """(our end, a Core that listens at the other end) of a pseudo-terminal."""
    ours, theirs = os.openpty()
    device = line.Device(os.ttyname(theirs))
    os.close(theirs)
    yield ours, host.Core(device, registers=False, say=lambda _: None)
    device.close()
    os.close(ours)


@some(150, data=lines)
def test_every_byte_comes_through_a_terminal(terminal, data):
    ours, core = terminal
    wanted = core.counts.bytes + len(data) + 1
    os.write(ours, data + b"\0")
    with in_time():
        while core.counts.bytes < wanted:
            assert {told(item) for item in core.packets(0)} <= sent()


def test_packets_come_through_the_terminal(terminal):
    ours, core = terminal
    os.write(ours, LINE)
    wanted, found = core.counts.bytes + len(LINE), set()
    while core.counts.bytes < wanted:
        found |= {told(item) for item in core.packets(0)}
    assert found == sent() and len(found) > 5


# Files

rng = np.random.default_rng(1)
CODES = rng.integers(0, 4096, (4, 2, 3))
KNOWN = {"offset": CODES[0], "gain": CODES[1], "gain_shift": 12, "dead": CODES[0] > 3000}
KNOWN |= {"force_lsb_n": 1e-3}
KNOTS = np.where(CODES[0] > 900, np.nan, np.linspace(0.0, 8.0, 5)[:, None, None])
BENT = KNOWN | {"knot_codes": 100 * KNOTS, "knot_n": KNOTS}
PRESS = {"codes": CODES, "force_n": np.array([1.0, 2, 0, 3])}
PRESS |= {"probed": np.array([[0, 0], [1, 2], [-1, -1], [0, 1]])}
KINDS = ("i1", "u8", "f2", "f8", "?", "U3", "c8", "O", "M8[s]")
SINGLE = [0, -1, 2**62, 1e300, float("nan"), "x", b"", 1j, True]
TABLE = b"x, y\n1,2\n3,4095\n-1,0\n"
TABLES = [
    TABLE,
    "Zeit;Kanal A\n(µs);(V)\n\n0,0;1,5\n50,0;-2\n".encode(),
    b"Light:5,Heat:-2.5\nLight:6,Heat:3\n",
]
TABLES += [b"12:00:00.000 -> 5\n12:00:00.010 -> 6\n", b"#Sample rate: 1kHz\n#Time [s]\ta\n0.0\t1\n0.1\t2\n"]
TABLES += [b"0,0.0,5\n1,0.1,6\n2,0.2,7\n3,0.3,8\n", b'"a (mV)","b"\n"1","x"\n']


def packed(arrays, save=np.savez):
    made = io.BytesIO()
    save(made, **arrays) if isinstance(arrays, dict) else np.save(made, arrays)
    return made.getvalue()


@cache
def logged(kind):
    """The bytes of a small log."""
    with tempfile.TemporaryDirectory() as folder:
        model, path = SimulatedCore(size=(3, 4), clk_khz=1000), Path(folder) / f"small.{kind}"
        known = units.Units(newtons_per_code=0.25)
        with host.Core(line.Pipe(model), known) as core, log.recording(path, core) as out:
            model.say(p.COP, 1000, p.cop_frame(5, -6, 700, 1))
            for part in p.image_chunks(1, [*range(0, 60_000, 5000)], 5):
                model.say(p.IMAGE, 1000, part)
            model.say(p.SLIP, 1500, p.slip_event(3, 99, 3))
            model.say(p.HEALTH, 1600, p.health(2, 5))
            model.say(p.STATISTIC, 1700, p.statistic(1, 4))
            for item in core.packets(0.05):
                out.add(item)
        return path.read_bytes()


@st.composite
def archives(draw, data):
    """A complete .npz whose arrays have other shapes or types, are missing or mutated."""
    with np.load(io.BytesIO(data)) as found:
        arrays = {name: found[name] for name in found.files}
    changed = draw(st.lists(st.sampled_from(sorted(arrays)), min_size=1, max_size=2))
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as out:
        for name, array in arrays.items():
            kind = draw(st.integers(0, 5)) if name in changed else None
            if kind == 0:
                continue
            if kind == 1:
                with np.errstate(invalid="ignore"):  # a NaN as an integer
                    array = array.astype(draw(st.sampled_from(KINDS)))
            elif kind == 2:
                array = array.ravel()[: draw(st.integers(0, array.size))]
            elif kind == 3:
                array = array[..., None] if draw(st.booleans()) else np.stack([array, array])
            elif kind == 4:
                array = np.array(draw(st.sampled_from(SINGLE)))
            inner = io.BytesIO()
            np.lib.format.write_array(inner, np.asarray(array), allow_pickle=True)
            body = inner.getvalue()
            out.writestr(f"{name}.npy", draw(mutated(body)) if kind == 5 else body)
    return made.getvalue()


def of(suffix, *seeds):
    """Files made of archives, or of ones of another kind."""
    made = mutated(*seeds)
    if suffix == ".npz":
        made = st.one_of(made, archives(*seeds), archives(*seeds))
    return made.map(lambda data: (suffix, data))


@st.composite
def toml(draw, texts):
    """One of ``texts`` with up to four lines changed: another value or number, a line of another, or none."""
    rows = draw(st.sampled_from(texts)).splitlines()
    for _ in range(draw(st.integers(0, 4))):
        at, kind = draw(st.integers(0, len(rows) - 1)), draw(st.integers(0, 4))
        if kind <= 1 and "=" in rows[at]:
            rows[at] = rows[at].split("=")[0] + "= " + draw(st.sampled_from(VALUES))
        elif kind == 2:
            for digits in {*"0123456789"} & {*rows[at]}:
                rows[at] = rows[at].replace(digits, draw(st.sampled_from(NUMBERS)))
        elif kind == 3:
            rows[at : at + 1] = draw(st.sampled_from([[], [*rows[at : at + 1] * 2]]))
        else:
            rows.insert(at, draw(st.sampled_from(draw(st.sampled_from(texts)).splitlines())))
        if not rows:
            break
    return ".toml", "\n".join(rows).encode()


def toml_or_bytes(texts):
    return st.one_of(toml(texts), toml(texts), of(".toml", *(text.encode() for text in texts)))


CONFIGS = [path.read_text("utf-8") for path in sorted(config.FOLDER.glob("*.toml"))]


def read_config(path):
    found = config.load(path)
    config.verilog(found.parameters)
    assert isinstance(found.settings, dict)


def read_recording(path):
    if path.suffix == ".npz":
        calibration.read_recording(path)
    else:
        readers.read(path, shape=(1, 2) if path.suffix == ".csv" else None).scaled()


def read_mat(path):
    """In a process of its own for each file, so fewer of them."""
    read_any(path)


def read_any(path):
    """Nor does it take memory or time for what a file only declares."""
    found = readers.read(path)
    assert found.values.size <= 1000 and "\n" not in found.said
    found.scaled(volts_per_code=0.5)


def whole_files(suffix):
    """A small file of another kind, by its library."""
    made = io.BytesIO()
    if suffix == ".mat":
        savemat(made, {"x": CODES[0], "fs": 5.0})
    elif suffix == ".wav":
        wavfile.write(made, 800, CODES[0].astype(np.int16))
    elif suffix == ".sr":
        with zipfile.ZipFile(made, "w") as session:
            session.writestr("metadata", "[device 1]\ntotal probes=0\nsamplerate=5 Hz\nanalog1=A\n")
            session.writestr("analog-1-1-1", np.arange(5, dtype="<f4").tobytes())
    else:
        with h5py.File(made, "w") as file:
            file["x"] = CODES[0]
    return of(suffix, made.getvalue())


def read_log(path):
    found = log.read(path)
    if found["image"].size < 1000:
        replay(found, "fixed")


READERS = {  # reader: (examples, its files)
    read_config: (300, toml_or_bytes(CONFIGS)),
    scenes.load: (100, toml_or_bytes([scenes.source(name) for name in scenes.names()])),
    read_recording: (
        300,
        st.one_of(of(".npz", packed(PRESS)), of(".npy", packed(CODES.astype(np.int16))), of(".csv", TABLE)),
    ),
    calibration.load: (300, st.one_of(of(".npz", packed(KNOWN)), of(".npz", packed(BENT)))),
    read_any: (
        500,
        st.one_of(*(of(".csv", table) for table in TABLES), *map(whole_files, (".wav", ".sr", ".h5"))),
    ),
    read_mat: (8, whole_files(".mat")),
    read_log: (120, st.one_of(of(".npz", logged("npz")), of(".mcap", logged("mcap")))),
}


@pytest.mark.parametrize("reader", READERS, ids=lambda reader: reader.__qualname__)
def test_a_file_is_read_or_refused_in_a_sentence(tmp_path, reader):
    count, strategy = READERS[reader]
    refused = []

    @some(count, case=strategy)
    def check(case):
        path = tmp_path / f"case{case[0]}"
        path.write_bytes(case[1])
        try:
            with in_time(), warnings.catch_warnings(action="ignore"):
                reader(path)
        except ValueError as problem:
            refused.append(problem)
            assert str(problem).strip() and "\n" not in str(problem)

    check()
    assert 0 < len(refused) < count * TIMES, "some of the files are still whole"


# Found by such tests earlier

HEADER = (
    b"\x93NUMPY\x01\x00\x76\x00{'descr': '<i8', 'fortran_order': False, 'shape': (2, 3), "  # no closing brace
)


def test_a_header_that_python_cannot_parse(tmp_path):
    (tmp_path / "a.npy").write_bytes(HEADER.ljust(128) + bytes(48))
    with pytest.raises(ValueError, match=r"a\.npy"):
        readers.read(tmp_path / "a.npy")


def test_an_archive_of_what_is_no_array(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.writestr("slip_time.npy", b"no array")
    with pytest.raises(ValueError, match=r"a\.npz"):
        log.read(tmp_path / "a.npz")


def test_a_calibration_in_complex_newtons(tmp_path):
    np.savez(tmp_path / "a.npz", **KNOWN | {"force_lsb_n": np.array(1j)})
    with pytest.raises(ValueError, match="force_lsb_n"):
        calibration.load(tmp_path / "a.npz")
