"""However a log ends, the packets received are kept and readable: signals, a closed terminal, SIGKILL, a disk
that becomes full while packets arrive or while the arrays are written. A file cut anywhere is read up to its
last complete chunk. A log reports what it had to drop, with the reason."""

import errno
import fcntl
import io
import os
import pty as ptys
import resource
import select
import signal
import subprocess
import sys
import termios
import time

import numpy as np
import pytest

from meissner import cli, host
from meissner.builds import units
from meissner.host import line, log, packets
from meissner.host.simulated import SimulatedCore
from meissner.twins.link import cobs
from meissner.twins.link import packet as p

CLK_KHZ = 1000
COUNT = 300


def frames(count=COUNT, first=0):
    """Bytes of CoP frames; the load of each is its index."""
    return b"".join(
        cobs.encode(p.packet(p.COP, k, 1000 * k, p.cop_frame(3, -5, k, 1)))
        for k in range(first, first + count)
    )


def part(path, number=""):
    """The file in which a log of this name keeps packets until it ends."""
    return path.with_name(f"{path.name}.part{number}.{'rows' if path.suffix == '.npz' else 'mcap'}")


class Listened:
    """``meissner log --listen`` on a pseudo-terminal that the test writes into."""

    def __init__(self, folder, name, **more):
        self.folder, self.name = folder, name
        self.ours, theirs = ptys.openpty()
        os.set_blocking(self.ours, False)
        attributes = termios.tcgetattr(theirs)
        attributes[0] = attributes[1] = attributes[3] = 0  # raw
        termios.tcsetattr(theirs, termios.TCSANOW, attributes)
        command = [sys.executable, "-m", "meissner.cli", "log", f"pty:{os.ttyname(theirs)}", "--listen"]
        command += ["--clk-khz", str(CLK_KHZ), "--out", name]
        # A shell's background job ignores Ctrl-C, nohup a closed terminal, and both pass that on to their
        # children; this restores a terminal's state.
        ends = (signal.SIGINT, signal.SIGHUP)
        before = [signal.signal(end, signal.default_int_handler) for end in ends]
        try:
            streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | more
            self.child = subprocess.Popen(command, cwd=folder, text=True, **streams)
        finally:
            for end, handler in zip(ends, before):
                signal.signal(end, handler)
        self.theirs, self.spool = theirs, part(folder / name)
        self.until(self.spool.exists)

    def until(self, holds):
        while not holds():
            assert self.child.poll() is None, self.child.communicate()
            time.sleep(0.02)

    def say(self, data):
        """Write, as long as the command runs: nobody empties the terminal of one that ended."""
        while data and self.child.poll() is None:
            if select.select([], [self.ours], [], 0.1)[1]:
                data = data[os.write(self.ours, data[:1024]) :]

    def kept(self):
        """Loads in the spool, as far as it is readable now."""
        try:
            return log.read(self.spool)["cop_load"].tolist()
        except ValueError:
            return []

    def close(self):
        self.child.kill()
        self.child.communicate()
        os.close(self.ours)
        os.close(self.theirs)


@pytest.fixture
def listened(tmp_path):
    open_ones = []

    def start(name, **more):
        open_ones.append(Listened(tmp_path, name, **more))
        return open_ones[-1]

    yield start
    for one in open_ones:
        one.close()


@pytest.mark.parametrize("which", ["SIGINT", "SIGTERM", "SIGHUP"])
@pytest.mark.parametrize("name", ["a.npz", "a.mcap"])
def test_a_signal_ends_the_log_whole(tmp_path, listened, name, which):
    one = listened(name)
    one.say(frames())
    one.until(lambda: len(one.kept()) == COUNT)
    one.child.send_signal(getattr(signal, which))
    out, err = one.child.communicate()
    assert (one.child.returncode, err) == (0, "meissner: stopped\n")
    assert out.startswith(f"{COUNT} packets of ")
    assert [path.name for path in tmp_path.iterdir()] == [name]
    found = log.read(tmp_path / name)
    assert found["cop_load"].tolist() == list(range(COUNT)) and "partial" not in found


@pytest.mark.parametrize("name", ["a.npz", "a.mcap"])
def test_a_lost_terminal_ends_the_log_whole(tmp_path, listened, name):
    """The window is closed: SIGHUP comes, and writing to the terminal fails."""
    ours, theirs = ptys.openpty()

    def own():
        os.setsid()
        fcntl.ioctl(theirs, termios.TIOCSCTTY, 0)

    one = listened(name, stdin=theirs, stdout=theirs, stderr=theirs, preexec_fn=own)
    os.close(theirs)
    one.say(frames())
    one.until(lambda: len(one.kept()) == COUNT)
    os.close(ours)
    one.child.wait()
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert log.read(tmp_path / name)["cop_load"].tolist() == list(range(COUNT))


@pytest.mark.parametrize("name", ["a.npz", "a.mcap"])
def test_who_ignores_the_hang_up_is_not_ended_by_it(tmp_path, listened, name):
    one = listened(name, preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    one.say(frames())
    one.until(lambda: len(one.kept()) == COUNT)
    one.child.send_signal(signal.SIGHUP)
    one.say(frames(7, COUNT))
    one.until(lambda: len(one.kept()) == COUNT + 7)
    one.child.send_signal(signal.SIGTERM)
    one.child.communicate()
    assert log.read(tmp_path / name)["cop_load"].tolist() == list(range(COUNT + 7))


@pytest.mark.parametrize("name", ["a.npz", "a.mcap"])
def test_a_killed_log_keeps_the_packets_received(tmp_path, listened, name, monkeypatch, capsys):
    one = listened(name)
    one.say(frames())
    one.until(lambda: len(one.kept()) == COUNT)  # without a further packet, since a quiet line is flushed too
    one.child.kill()
    one.child.wait()
    assert [path.name for path in tmp_path.iterdir()] == [part(tmp_path / name).name]
    found = log.read(one.spool)
    assert found["cop_load"].tolist() == list(range(COUNT)) and found["partial"]
    assert (int(found["clk_khz"]), int(found["start_time"])) == (CLK_KHZ, 0)
    assert np.diff(found["cop_ns"]).tolist() == (COUNT - 1) * [10**6]
    with pytest.raises(ValueError, match=part(tmp_path / name).name):
        log.read(tmp_path / name)
    # Another log of that name does not touch it.
    again = listened(name)
    again.spool = part(tmp_path / name, 2)
    again.say(frames(5))
    again.until(lambda: len(again.kept()) == 5)
    again.child.send_signal(signal.SIGTERM)
    again.child.communicate()
    assert sorted(path.name for path in tmp_path.iterdir()) == [name, part(tmp_path / name).name]
    assert log.read(one.spool)["cop_load"].tolist() == list(range(COUNT))


@pytest.mark.parametrize("name", ["a.npz", "a.mcap"])
def test_a_full_disk_is_one_sentence_and_keeps_what_came(tmp_path, monkeypatch, capsys, name):
    """Of a recorded line, each packet in a chunk of its own; the file may grow to 100,000 bytes."""
    limit, sent = 100_000, 1000
    rng = np.random.default_rng(1)  # so that it does not compress
    events = [p.packet(p.SLIP, k, k, p.slip_event(k, int(rng.integers(1 << 24)), 3)) for k in range(sent)]
    (tmp_path / "a.bin").write_bytes(b"".join(map(cobs.encode, events)))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(log, "FLUSH_S", 1e-9)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, before[1]))
    try:
        with pytest.raises(SystemExit) as end:
            cli.main(["log", "file:a.bin", "--clk-khz", str(CLK_KHZ), "--out", name])
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    spool = part(tmp_path / name)
    found = log.read(spool)
    kept = len(found["slip_channel"])
    assert end.value.code == 2
    assert capsys.readouterr() == (
        "",
        f"meissner: {name} could not be written, the file may not grow any more: the {kept} packets "
        f"received are in {spool.name}, which `meissner replay` reads\n",
    )
    data = spool.read_bytes()
    assert found["slip_channel"].tolist() == list(range(kept)) and found["partial"]
    at, most = 8, 0  # behind the magic: kind, 64-bit length, content, or 32-bit length, checksum, content
    while at < len(data):
        mcap = spool.suffix == ".mcap"
        size = int.from_bytes(data[at + 1 : at + 9] if mcap else data[at : at + 4], "little")
        at += size + (9 if mcap else 8)
        most = max(most, size)
    assert at == len(data)  # nothing of the incomplete record remains
    # The next packet did not fit. An MCAP chunk comes with an index of its messages.
    assert limit - 3 * most < len(data) <= limit and 3 < kept < sent
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.bin", spool.name]


def some(recording, count=3):
    for k in range(count):
        recording.add(packets.Statistics(10 * k, None, 2, 70 + k))


def test_a_disk_that_fills_up_while_the_arrays_are_written(tmp_path, monkeypatch):
    def full(file, **arrays):
        if not isinstance(file, io.BytesIO):
            raise OSError(errno.ENOSPC, "No space left on device")
        save(file, **arrays)

    save = np.savez_compressed
    monkeypatch.setattr(np, "savez_compressed", full)
    core = host.Core(line.Pipe(SimulatedCore(clk_khz=CLK_KHZ)))
    sentence = (
        r"a.npz could not be written, the disk is full: the 3 packets received are in .*a.npz.part.rows, "
    )
    with pytest.raises(OSError, match=sentence), log.recording(tmp_path / "a.npz", core) as recording:
        some(recording)
    assert [path.name for path in tmp_path.iterdir()] == ["a.npz.part.rows"]
    assert log.read(tmp_path / "a.npz.part.rows")["statistics_value"].tolist() == [70, 71, 72]


@pytest.mark.parametrize("name", ["a.npz", "a.mcap"])
def test_an_error_keeps_what_came(tmp_path, name):
    said = []
    core = host.Core(line.Pipe(SimulatedCore(clk_khz=CLK_KHZ)), say=said.append)
    with pytest.raises(RuntimeError, match="mine"), log.recording(tmp_path / name, core) as recording:
        some(recording)
        raise RuntimeError("mine")
    assert log.read(part(tmp_path / name))["statistics_value"].tolist() == [70, 71, 72]
    assert len(said) == 1 and "was not finished: the 3 packets received are in" in said[0]


def test_a_file_cut_anywhere_is_read_up_to_its_last_whole_chunk(tmp_path, monkeypatch):
    monkeypatch.setattr(log, "FLUSH_S", -1.0)  # one chunk per packet
    core = host.Core(line.Pipe(SimulatedCore(clk_khz=CLK_KHZ)))
    with log.recording(tmp_path / "a.mcap", core) as recording:
        some(recording, 5)
    whole, seen = (tmp_path / "a.mcap").read_bytes(), set()
    for end in range(0, len(whole), 23):
        (tmp_path / "cut.mcap").write_bytes(whole[:end])
        try:
            found = log.read(tmp_path / "cut.mcap")
        except ValueError as problem:
            assert not seen, (end, problem)  # only as long as nothing was readable
            continue
        values = found["statistics_value"].tolist()
        assert values == [70, 71, 72, 73, 74][: len(values)] and found["partial"]
        assert not seen or len(values) >= max(seen)
        seen.add(len(values))
    assert seen == {0, 1, 2, 3, 4, 5}


def test_replay_reads_a_part(tmp_path, monkeypatch, capsys):
    core = host.Core(line.Pipe(SimulatedCore(clk_khz=CLK_KHZ)), say=lambda _: None)
    taxels = np.array([[0, 7, 0], [0, 0, 21]], np.uint16)
    with pytest.raises(RuntimeError), log.recording(tmp_path / "a.mcap", core) as recording:
        recording.add(packets.Image(40, None, 5, taxels, None))
        raise RuntimeError
    monkeypatch.chdir(tmp_path)
    cli.main(["replay", "a.mcap.part.mcap", "--out", "out.npz"])
    assert "1 image of 2×3 on engine fixed" in (said := capsys.readouterr().out)
    assert "the log was not finished; out.npz" in said
    assert np.load("out.npz")["sum"].tolist() == [28]


def capture(path, sizes, more=b""):
    """Images of these sizes, numbered from 9, each in parts of up to 5 taxels, then other packets."""
    number, data = 0, b""
    for k, size in enumerate(sizes):
        for part in p.image_chunks(9 + k, range(size), 5):
            data += cobs.encode(p.packet(p.IMAGE, number, 50 * k, part))
            number += 1
    path.write_bytes(b"\0" + data + more)


def test_a_log_with_the_wrong_configuration_says_what_it_dropped(tmp_path, monkeypatch, capsys):
    """fingertip has 3×3 taxels; all but one of the core's images have 12."""
    monkeypatch.chdir(tmp_path)
    unknown = cobs.encode(p.packet(77, 14, 9, b"new"))
    capture(tmp_path / "a.bin", [12, 12, 9, 12, 12], unknown)
    cli.main(["log", "file:a.bin", "--config", "fingertip", "--out", "a.npz"])
    out, err = capsys.readouterr()
    assert "0 lost, 0 damaged, 0 images lost, 4 images dropped because they do not have 3×3 taxels, " in out
    assert ", 1 packets of unknown types, 0 gaps" in out
    assert err == (
        "meissner: images of 12 taxels from a.bin are dropped, 3×3 are expected: is this the core's "
        "configuration?\n"
    )
    found = log.read("a.npz")
    assert found["image_number"].tolist() == [11] and (found["images_unfit"], found["unknown"]) == (4, 1)


@pytest.mark.parametrize(
    "parts, whole, lost",
    [
        ("0.0 0.1 1.0 1.1 2.0 2.1", [0, 1, 2], 0),
        ("0.1 1.0 1.1", [1], 0),  # the first one began before the host listened
        ("0.0 1.0 1.1", [1], 1),
        ("0.0 1.0 2.0 3.0", [], 3),  # none is complete; the last still may be
        ("0.0 0.1 1.1 2.0 2.1", [0, 2], 1),
        ("0.0 0.1 4.0 4.1", [0, 4], 3),
        ("0.0 0.1 4.1 5.0 5.1", [0, 5], 4),
        ("0.1 4.0 4.1", [4], 3),
        ("254.0 254.1 1.0 1.1", [254, 1], 2),  # numbers have 8 bits
        ("0.0 0.0 0.1", [0], 1),  # a repeated start: the earlier end was lost
    ],
)
def test_lost_images_are_counted(parts, whole, lost):
    """IMAGE.PART for images of 2×3 taxels in two parts; the time stamp is that of the image."""
    stamped = []
    for text in parts.split():
        image, part = map(int, text.split("."))
        stamped.append((100 * (image + 1), p.IMAGE, list(p.image_chunks(image, range(6), 4))[part]))
    core = host.Core(line.Pipe(SimulatedCore(stamped)), registers=False, say=pytest.fail)
    core.units = units.Units(rows=2, columns=3)
    found = [item for item in core.packets(0.05) if isinstance(item, packets.Image)]
    assert [item.number for item in found] == whole
    assert (core.counts.images_lost, core.counts.images_unfit) == (lost, 0)


def test_rows_that_are_cut_or_damaged(tmp_path):
    """The spool of a .npz is read up to its last complete block, and no further than the first damaged
    one."""
    core = host.Core(line.Pipe(SimulatedCore(clk_khz=CLK_KHZ)), say=lambda _: None)
    with pytest.raises(RuntimeError), log.recording(tmp_path / "a.npz", core) as recording:
        for k in range(3):
            recording.add(packets.Statistics(10 * k, None, 2, 70 + k))
            recording.flush()
        raise RuntimeError
    whole, seen = part(tmp_path / "a.npz").read_bytes(), set()
    for end in sorted({*range(0, len(whole), 41), len(whole)}):
        (tmp_path / "cut.rows").write_bytes(whole[:end])
        try:
            values = log.read(tmp_path / "cut.rows")["statistics_value"].tolist()
        except ValueError as problem:
            assert not seen, (end, problem)
            continue
        assert values == [70, 71, 72][: len(values)] and len(values) >= max(seen, default=0)
        seen.add(len(values))
    assert seen == {0, 1, 2, 3}
    for at in range(0, len(whole), 97):
        wrong = bytearray(whole)
        wrong[at] ^= 0x10
        (tmp_path / "wrong.rows").write_bytes(wrong)
        try:
            values = log.read(tmp_path / "wrong.rows")["statistics_value"].tolist()
        except ValueError as problem:
            assert "\n" not in str(problem)
        else:  # if a length points beyond the end
            assert values == [70, 71][: len(values)]
