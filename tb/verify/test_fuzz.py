"""`make fuzz` in a short form: each reader over its corpus and some thousand cases; inputs found earlier are
refused with a sentence; and it finds a decoder that accepts a damaged packet and a reader that raises another
error."""

import time
import warnings
import zipfile

import numpy as np
import pytest

from meissner import calibration, files
from meissner.host import log
from meissner.twins.link import decoder
from verify import fuzz

CASES = {
    "decoder_python": 4000,
    "host": 1500,
    "host_pty": 500,
    "config": 300,
    "recordings": 500,
    "calibration": 200,
    "log": 100,
}


@pytest.mark.parametrize("target", CASES)
def test_short(target):
    with warnings.catch_warnings(action="ignore"):
        fuzz.run(target, CASES[target], seed=2)


def test_packets_come_through_the_terminal(tmp_path):
    reader = fuzz.Terminal(tmp_path)
    reader.check(reader.line)
    reader.close()
    assert reader.found == len(reader.told) > 5


def test_decoder_in_c():
    assert "of its own" in fuzz.run_c(40_000)


def test_finds_a_decoder_without_checksum(monkeypatch):
    monkeypatch.setattr(decoder.zlib, "crc32", lambda body: int.from_bytes(body[-4:], "little"))
    monkeypatch.setattr(decoder.Decoder, "_packet", _careless(decoder.Decoder._packet))
    with pytest.raises(fuzz.Failed, match="was not sent"):
        fuzz.run("decoder_python", 4000)


def _careless(packet):
    def taken(self, frame):
        body = decoder.decode(frame)
        if body is None or len(body) < 12:
            return None
        return decoder.Packet(body[0], body[1], int.from_bytes(body[2:8], "little"), bytes(body[8:-4]), {})

    return taken


def test_finds_a_reader_that_breaks(monkeypatch):
    monkeypatch.setattr(calibration, "load", lambda path: files.read_arrays(path)["gain"].sum() + 1)
    with pytest.raises(fuzz.Failed, match=r"case [0-9]+: "):
        fuzz.run("calibration", 300)


def hangs(_):
    while True:
        pass


@pytest.mark.parametrize(
    ("limit", "hang", "by"),
    [("SLOW_S", hangs, "of processor time"), ("STILL_S", lambda _: time.sleep(9), "by the")],
)
def test_finds_what_hangs(monkeypatch, limit, hang, by):
    monkeypatch.setattr(fuzz, limit, 0.05)
    monkeypatch.setattr(calibration, "load", hang)
    with pytest.raises(fuzz.Failed, match=f"hangs: more than 0.05 s {by}"):
        fuzz.run("calibration", 1)


def test_a_slow_machine_is_no_hang(monkeypatch):
    monkeypatch.setattr(fuzz, "SLOW_S", 0.05)
    monkeypatch.setattr(calibration, "load", lambda _: time.sleep(0.2))
    fuzz.run("calibration", 1)


HEADER = (
    b"\x93NUMPY\x01\x00\x76\x00{'descr': '<i8', 'fortran_order': False, 'shape': (2, 3), "  # no closing brace
)


def test_a_header_that_python_cannot_parse(tmp_path):
    (tmp_path / "a.npy").write_bytes(HEADER.ljust(128) + bytes(48))
    with pytest.raises(ValueError, match=r"not a \.npy file of numbers"):
        files.read_array(tmp_path / "a.npy")


def test_an_archive_of_what_is_no_array(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.writestr("slip_time.npy", b"no array")
    with pytest.raises(ValueError, match="is cut off or damaged"):
        log.read(tmp_path / "a.npz")


def test_a_calibration_in_complex_newtons(tmp_path):
    known = dict(np.load(fuzz.CORPUS / "calibration/small.npz"))
    np.savez(tmp_path / "a.npz", **known | {"force_lsb_n": np.array(1j)})
    with pytest.raises(ValueError, match="force_lsb_n must be newtons"):
        calibration.load(tmp_path / "a.npz")
