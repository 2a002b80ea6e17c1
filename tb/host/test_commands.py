"""``meissner regs``, ``live``, ``log``, ``replay`` as a user starts them, against a simulated core over a
pty: output on a terminal and in a pipe, exit codes, Ctrl-C, one sentence for bad input, no incomplete
files."""

import contextlib
import os
import pty as ptys
import re
import signal
import termios
import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from harness.command import ended, started
from meissner import cli, engines, host
from meissner.builds import config, toolchain
from meissner.host import line, log, packets, view
from meissner.host.pty import Pty
from meissner.host.simulated import SimulatedCore, of_scenes
from meissner.twins.link import cobs
from meissner.twins.link import packet as p


@pytest.fixture
def meissner(capsys, monkeypatch, tmp_path):
    """A function that runs the command in this process and an empty folder: (exit code, stdout, stderr)."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        code = 0
        try:
            cli.main([str(argument) for argument in arguments])
        except SystemExit as end:
            code = end.code
        return code, *capsys.readouterr()

    return run


@pytest.fixture
def port():
    with Pty(of_scenes(speed="10")) as pty:
        yield pty


def test_regs_reads_and_writes(meissner, port):
    code, out, err = meissner(
        "regs", port.url, "slip.threshold=0x30", "slip.contact_level=-2", "core.size.rows"
    )
    assert (code, err) == (0, "")
    assert out.splitlines() == [
        "slip.threshold      48         0x30",
        "slip.contact_level  -2         0xffffe",
        "core.size.rows      25         0x19",
    ]
    code, out, _ = meissner("regs", port.url, "slip")
    assert code == 0 and out.splitlines()[0].split()[:2] == ["slip.threshold", "48"]
    source = (toolchain.ROOT / "rtl/registers.rdl").read_text("utf-8")
    listed = re.findall(
        r"^    reg .*\} (\w+);$", source.partition('"Slip of each')[2].partition("} slip @")[0], re.M
    )
    assert len(listed) >= 11
    assert [text.split()[0] for text in out.splitlines()] == [f"slip.{name}" for name in listed]
    code, out, _ = meissner("regs", port.url)
    assert {text.split()[0] for text in out.splitlines()} >= {"core.id", "adc.period", "slip.blanked"}


@pytest.mark.parametrize(
    "given, sentence",
    [
        (["slip.threshold=1", "slip.treshold=2"], "there is no register 'slip.treshold'"),
        (["slip.threshold=1", "slip.hold=many"], "'many' is neither an integer"),
        (["slip.threshold=1", "slip.hold=65536"], "slip.hold = 65536 must lie in 0 .. 65535"),
        (["slip.threshold=1", "core.id=1"], "core.id can only be read"),
    ],
)
def test_regs_writes_all_or_nothing(meissner, given, sentence):
    model = SimulatedCore()
    with Pty(model) as pty:
        code, out, err = meissner("regs", pty.url, *given)
    assert (code, out) == (2, "")
    assert sentence in err and len(err.splitlines()) == 1
    assert model.registers.access(False, 0x200)[0] == 0x3FFFF  # cut to 18 bits


def test_regs_in_physical_units(meissner, tmp_path):
    """A fingertip's samples are forces of 2 mN at 4 kHz and level 1; a rubber sensor's are 5 V in 12 bits."""
    rubber = tmp_path / "rubber.toml"  # the smallest build, with registers
    text = (toolchain.ROOT / "model/meissner/builds/configs/slip1.toml").read_text()
    text = text.replace("registers = false", "registers = true").replace("slip_only = true", "")
    text = text.replace("serial = true", "")
    rubber.write_text(text.replace("statistics = false", "statistics = true"))
    rubber = str(rubber)
    with Pty(SimulatedCore(size=(3, 3), clk_khz=24_000)) as pty:
        given = ("slip.threshold=50mN", "slip.contact_level=0.2N", "slip.hold=20ms", "cop.min_load=.2N")
        code, out, err = meissner("regs", "--config", "fingertip", pty.url, *given, "scan.settle=2e-6s")
        assert (code, err) == (0, "")
        assert [text.split()[1] for text in out.splitlines()] == ["35", "200", "40", "100", "48"]
    with Pty(SimulatedCore(size=(1, 1), clk_khz=12_000)) as pty:
        code, out, err = meissner(
            "regs", "--config", rubber, pty.url, "slip.threshold=20mV", "slip.contact_level=4.3V"
        )
        assert (code, err) == (0, "")
        assert [text.split()[1] for text in out.splitlines()] == ["23", "7045"]
        for given, sentence in (
            ("slip.threshold=1N", "forces"),
            ("slip.hold=1V", "seconds"),
            ("slip.hold=0.0.5s", "0.0.5s"),
            ("adc.drapped=1V", "adc.drapped"),
        ):
            code, out, err = meissner("regs", "--config", rubber, pty.url, given)
            assert (code, out) == (2, "") and sentence in err and len(err.splitlines()) == 1
        code, _, err = meissner("regs", "--config", "fingertip", pty.url, "core.id")
        assert (
            code == 0
            and "fingertip does not match the core: its clk_khz is 24000, the core's is 12000" in err
        )


def test_live_in_a_pipe(port):
    slip = "slip, channel 0, incipient, peak-to-peak"
    both = lambda lines: slip in "\n".join(lines) and " load " in lines[-1]
    code, lines, err = ended(both, "live", port.url)
    assert (code, err) == (0, "meissner: stopped\n")
    full = [text for text in lines if text.startswith(("x ", "not pressed"))]
    assert "load" in full[-1] and " 0 lost, 0 damaged" in full[-1]
    above = sum(slip in text for text in lines[: lines.index(full[-2])])  # the last is after the interrupt
    assert int(full[-2].split(" slip event")[0].split()[-1]) == above > 0


def test_live_begins_with_the_channels_states(meissner):
    model = SimulatedCore()
    model.states = [1, 2, 0, 1, 3]
    with Pty(model) as pty:
        _, out, _ = meissner("live", pty.url, "--seconds", 0.5)
    assert "; 0 slip events, 4 in contact, 2 slipping; " in out.splitlines()[-1]


@pytest.mark.parametrize(
    "port, config, baud",
    [
        ("serial:/dev/x", (), 3_000_000),
        ("/dev/ttyX", ("--config", "grip"), 1_000_000),
        ("serial:/dev/x?baud=9600", ("--config", "grip"), 9600),
    ],
)
def test_the_baud_rate_is_the_lines_then_the_configurations(meissner, monkeypatch, port, config, baud):
    opened = []

    def device(path, rate):
        opened.append(rate)
        raise OSError("it is not there")

    monkeypatch.setattr(line, "Device", device)
    assert meissner("live", port, *config)[0] == 2 and opened == [baud]


def test_live_on_a_terminal(port):
    """A real terminal shows slip, centre of pressure and the image."""
    ours, theirs = ptys.openpty()
    termios.tcsetwinsize(theirs, (50, 100))
    environment = {**os.environ, "TERM": "xterm-256color"}
    shown = bytearray()
    parts = ("slip, ", "incipient", "centre of pressure", "load", "25×5", "packets/s", "█")
    with started("live", port.url, stdout=theirs, stderr=theirs, env=environment) as child:
        os.close(theirs)
        while not all(part.encode() in shown for part in parts):
            shown += os.read(ours, 65536)  # OSError if the command has ended
        child.send_signal(signal.SIGINT)
        with contextlib.suppress(OSError):
            while os.read(ours, 65536):
                pass
    os.close(ours)
    assert child.returncode == 0


def test_live_says_when_the_line_goes(meissner, tmp_path):
    link = tmp_path / "core"
    model = SimulatedCore()
    first = Pty(model)
    link.symlink_to(first.path)
    command = started("live", f"pty:{link}", stdout=-1, stderr=-1, text=True)
    with command as child:
        assert "packets/s" in child.stdout.readline()
        link.unlink()  # first, because the number may be reused
        first.unplug()
        assert "is gone" in child.stderr.readline()
        with Pty(model) as second:
            link.symlink_to(second.path)
            assert "is back after" in child.stderr.readline()
            while " 1 gaps" not in (text := child.stdout.readline()):
                assert text
            child.send_signal(signal.SIGINT)
            assert " 0 packets/s" not in child.communicate()[0].splitlines()[-1]
            assert child.returncode == 0


def test_log_and_replay(meissner, port):
    for name in ("a.mcap", "a.npz"):
        code, out, err = stopped(
            started("log", port.url, "--out", name, stdout=-1, stderr=-1, text=True), name
        )
        assert (code, err) == (0, "meissner: stopped\n")
        rows = {key: len(a) for key, a in log.read(name).items() if key.endswith("_ns") and a.ndim}
        del rows["slip_ns"]  # those are among the changes
        assert int(out.split()[0]) == sum(rows.values()) > 0 and " 0 lost, 0 damaged" in out
        code, out, err = meissner("replay", name, "--engine", "fixed", "--out", "out.npz", "--overwrite")
        assert (code, err) == (0, "")
        assert "of 25×5 on engine fixed" in out and ", of which 0 differ; out.npz" in out
        count = len(log.read(name)["change_time"])
        assert (
            out.splitlines()[1]
            == f"{count} changes of channels' states, 0 of them after others that are missing"
        )
        result, found = np.load("out.npz"), log.read(name)
        again = engines.process_cop(found["image"], "fixed", int(found["min_load"]))
        assert all(np.array_equal(result[field], again[field]) for field in again)
        assert result["logged"][1:].all()  # the first one's CoP may have come before the log began
        code, out, _ = meissner("replay", name, "--min-load", 1 << 20, "--out", "out.npz", "--overwrite")
        assert code == 0 and "(at most: x " in out and "pressed 1" in out


def stopped(command, name, which=signal.SIGINT):
    """(exit code, stdout, stderr) of a command that logs and gets a signal once it has kept two images and a
    change of a state."""
    spool = Path(f"{name}.part.{'rows' if str(name).endswith('.npz') else 'mcap'}")
    with command as child:
        kept = False
        while not kept:
            assert child.poll() is None, child.communicate()
            time.sleep(0.02)
            with contextlib.suppress(ValueError):  # it has not begun
                found = log.read(spool)
                kept = len(found["image"]) >= 2 and len(found["change_time"]) >= 1
        child.send_signal(which)
        out, err = child.communicate()
    return child.returncode, out, err


@pytest.mark.parametrize("which", [signal.SIGINT, signal.SIGTERM])
def test_log_that_is_stopped_is_whole(port, tmp_path, which):
    command = started("log", port.url, "--out", tmp_path / "a.mcap", stdout=-1, stderr=-1, text=True)
    code, out, err = stopped(command, tmp_path / "a.mcap", which)
    assert code == 0 and "stopped" in err and "packets of" in out
    assert len(log.read(tmp_path / "a.mcap")["cop_time"]) > 0
    assert [path.name for path in tmp_path.iterdir()] == ["a.mcap"]


def test_a_capture_is_read_like_a_line(meissner, tmp_path):
    frames = [cobs.encode(p.packet(p.SLIP, k, 1000 * k, p.slip_event(3, k, 3))) for k in range(5)]
    (tmp_path / "a.bin").write_bytes(b"".join(frames[:2] + frames[3:]))
    code, out, err = meissner("live", "file:a.bin", "--clk-khz", 1000)
    assert (code, err) == (0, "")
    assert out.splitlines()[0] == "0.0000 s: slip, channel 3, gross, peak-to-peak 0"
    assert "4 slip events" in out and "1 lost" in out
    code, out, err = meissner("live", "file:a.bin")
    assert "3000 clocks: slip" in out
    code, _, err = meissner("log", "file:a.bin", "--out", "a.npz", "--clk-khz", 1000)
    assert code == 0 and list(log.read("a.npz")["slip_p2p"]) == [0, 1, 3, 4]


def test_a_core_without_registers_is_listened_to(meissner):
    model = SimulatedCore([(k, p.SLIP, p.slip_event(0, k, 2)) for k in range(5)])
    model.write = lambda data: None
    with Pty(model) as pty:
        code, _, err = meissner("live", pty.url, "--seconds", 0.2)
        assert code == 2 and "sends packets but does not answer" in err and "only be listened to" in err
    model.restart()
    with Pty(model) as pty:
        code, lines, _ = ended(lambda lines: len(lines) == 5, "live", pty.url, "--listen")
        assert code == 0 and "5 slip events" in lines[-1]


def test_live_shows_the_slip_of_a_build_without_registers(meissner):
    """slip1 has no registers and is listened to; its events and the simulated time are shown."""
    with host.connect("core:slip1") as core:
        assert core.registers is False
        shown = view.View(core)
        for item in core.packets():
            told = shown.add(item)
            if isinstance(item, packets.SlipEvent):
                break
        assert told.startswith("0.1") and "s: slip, channel 0, incipient, peak-to-peak" in told
        assert core.line.pipe.simulated_s >= item.time_s > 0.1
        now = core.line.pipe.now
        assert (
            f"; 1 slip event, 1 in contact, 1 slipping; simulated {now / 12_000_000:.3f} s, " in shown.line()
        )
    code, out, err = meissner("live", "core:slip1", "--seconds", 0.2)
    assert (code, err) == (0, "meissner: core:slip1 is built without registers: it is only listened to\n")
    assert re.search(r"; simulated \d\.\d{3} s, ", out.splitlines()[-1])


def test_live_takes_a_users_configuration(meissner, tmp_path):
    build = config.load("fingertip")
    text = (config.FOLDER / "fingertip.toml").read_text()
    for old, new in (
        ("rows = 3", "rows = 2"),
        ("columns = 3", "columns = 5"),
        ("channels = 3", "channels = 5"),
    ):
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "mine.toml").write_text(text)
    with host.connect("core:mine.toml") as core:
        assert (core["core.size.rows"], core["core.size.columns"], build.clk_khz) == (
            2,
            5,
            core.units.clk_khz,
        )
        images = (item for item in core.packets() if isinstance(item, packets.Image))
        assert next(images).taxels.shape == (2, 5)


@pytest.mark.parametrize("arguments", [("regs", "core:slip1"), ("regs", "pty:/none", "--config", "slip1")])
def test_a_build_without_registers_is_not_read(meissner, arguments):
    code, out, err = meissner(*arguments)
    assert (code, out) == (2, "") and len(err.splitlines()) == 1
    assert "slip1 is built without registers: it can only be listened to" in err


def test_a_core_that_never_answers_may_be_one_without_registers(meissner):
    with Pty(SimulatedCore()) as pty:
        pty.pipe.write = lambda data: None
        code, _, err = meissner("regs", pty.url)
        assert code == 2 and "nothing received from" in err and len(err.splitlines()) == 1
        assert "A build without registers (slip1, and every build for the iCEBreaker) never answers" in err


@pytest.mark.parametrize(
    "port, more, baud",
    [
        ("serial:/dev/ttyX", (), 3_000_000),
        ("serial:/dev/ttyX", ("--config", "slip1"), 1_000_000),
        ("serial:/dev/ttyX?baud=57600", ("--config", "slip1"), 57_600),
        ("/dev/ttyX", ("--config", "slip1"), 1_000_000),
    ],
)
def test_the_rate_of_a_line_is_the_configurations(meissner, monkeypatch, port, more, baud):
    asked = []

    def device(path, rate=None):
        asked.append((path, rate))
        raise OSError("not here")

    monkeypatch.setattr(line, "Device", device)
    code, _, err = meissner("live", port, *more)
    assert code == 2 and "not here" in err
    assert asked == [("/dev/ttyX", baud)]


def test_heat_map():
    taxels = np.zeros((3, 4), np.uint16)
    taxels[1, 2], taxels[0, 0], taxels[2, 3] = 65535, 1, 40000
    assert view.heat_map(taxels) == ["        ", "    ██  ", "      ▒▒"]
    assert view.heat_map(np.zeros((2, 2), np.uint16)) == ["    ", "    "]
    large = np.zeros((1024, 1000), np.uint16)
    large[1023, 999] = 9
    shown = view.heat_map(large)
    assert (len(shown), len(shown[0])) == (view.HIGHEST, 2 * view.WIDEST)
    assert shown[-1][-2:] == "██" and "".join(shown).strip() == "██"


def test_view_of_pins():
    """A display's state, and the pins of an image: 2 x 3 taxels on 2 x 3 pins, a level for each 100 above
    50. A frame of a host in words of three levels."""
    from rich.console import Console

    state = {"size.rows": 2, "size.columns": 3, "size.bits": 2, "source": 0, "floor": 50, "step": 100}
    state |= {"top": 255, "most": 4095, "marker": 0}
    state["state"], state["size"] = 1 | 1 << 2 | 5 << 8, 2 | 3 << 8 | 2 << 16  # running, limited, five pins
    state["increment"] = round(230 * 2**40 / 25e6)  # of a drive of 230 Hz

    class Core(SimpleNamespace):
        def __getitem__(self, name):
            return state[name.removeprefix("display.")]

        def __setitem__(self, name, value):
            written.append((name, value))
            if value >> 24 and resent:
                if resent.pop() is None:
                    raise OSError("gone")
                self.counts.retries += 1
                written.append((name, value))

    written, resent = [], []
    counts = SimpleNamespace(restarts=0, packets=0, lost=0, damaged=0, images_lost=0, gaps=0, gap_s=0.0)
    counts.retries = 0
    core = Core(counts=counts, retries=3, registers=True, features=["display"], line=None, ended=False)
    core._frame_ended, core.units = False, SimpleNamespace(clk_khz=25_000, rows=2)
    shown = view.View(core)
    assert "; 5 pins on, 230 Hz, limited; " in shown.line()
    taxels = np.array([[49, 50, 149], [150, 250, 9999]], np.uint16)  # levels 0 1 1, 2 3 3
    shown.add(packets.Image(5, None, 1, taxels, None))
    centre = packets.CopFrame(6, None, -1.0, 1.0, 9, True, None, None, None)  # of the first pin
    shown.add(centre)
    assert shown.pins.picture(shown.image, shown.cop) == ["  ░░░░", "▓▓████"]
    console = Console(width=100, record=True, file=open(os.devnull, "w"))  # noqa: SIM115
    console.print(shown.picture())
    assert "display, 5 pins on, 230 Hz, limited" in console.export_text()
    lifted = replace(centre, pressed=False)
    for at, more, cop, picture in (
        (1e9, {"top": 2, "most": 4}, centre, ["  ▒▒▒▒", "████  "]),  # 0 1 1, 2 2 and no more
        (2e9, {"marker": 1}, centre, ["██▒▒▒▒", "██    "]),  # 3 1 1, 2: within both limits 2 1 1, 2
        (3e9, {"most": 5}, replace(centre, x=0.0, y=0.0), ["  ▒▒▒▒", "██████"]),
        (4e9, {}, lifted, ["  ▒▒▒▒", "██████"]),
        (5e9, {"state": 0}, centre, ["      "] * 2),
    ):
        state |= more
        shown.tick(at)
        assert shown.pins.picture(shown.image, cop) == picture
    state |= {"state": 1}
    shown.tick(6e9)
    assert shown.pins.picture(None, replace(centre, x=0.999, y=-1.0)) == ["      ", "    ██"]  # electrodes
    assert shown.pins.picture(None, None) == []
    taken = [shown.pins.take(each) for each in (centre, shown.image, lifted, shown.image)]
    assert [taken[0].tolist(), taken[1].tolist()] == [[[2, 0, 0], [0, 0, 0]], [[2, 1, 1], [2, 2, 0]]]
    assert taken[2] is None and taken[3].tolist() == [[0, 1, 1], [2, 2, 2]]
    words = [("display.levels", 0xFF0201), ("display.levels", 0x1_050400)]
    with pytest.raises(ValueError, match=r"display\.source = 0"):
        host.Core.show(core, [[1, 2, 255], [0, 4, 5]])
    state |= {"state": 2, "source": 1}
    shown.tick(7e9)
    for _ in range(2):  # the first one twice: the end of what another host may have sent a part of
        host.Core.show(core, [[1, 2, 255], [0, 4, 5]])
    assert written == 3 * words
    resent.append(1)
    host.Core.show(core, [[1, 2, 255], [0, 4, 5]])
    assert written == 3 * words + words[:1] + 2 * words[1:] + words  # a word twice: the whole again
    resent.append(None)
    with pytest.raises(OSError, match="gone"):
        host.Core.show(core, [[1, 2, 255], [0, 4, 5]])
    del written[:]
    host.Core.show(core, [[1, 2, 255], [0, 4, 5]])
    assert written == 2 * words
    for wrong, what in (
        ([[1, 2], [3, 4]], "fit the display: it has 2 x 3"),
        ([[0, 0, 256]] * 2, "level = 256"),
        ([[0, 0, 1.5]] * 2, "levels must be whole numbers"),
    ):
        with pytest.raises(ValueError, match=what):
            host.Core.show(core, wrong)
    assert (
        "; off, a fault of the sensor; " in shown.line() and shown.pins.picture(shown.image, shown.cop) == []
    )


def test_view_of_everything():
    """A view without units, with faulty taxels and unknown states, can be drawn."""
    from rich.console import Console

    core = host.Core(line.Pipe(SimulatedCore()), registers=False)
    shown = view.View(core)
    assert shown.line().startswith("no centre of pressure yet; 0 slip events")
    shown.add(packets.SlipEvent(5, None, 70, 6, 9, None))
    assert shown.add(packets.SlipEvent(5, None, 65535, 2, 9, None)).startswith(
        "5 clocks: slip, channel load, "
    )
    shown.add(packets.CopFrame(5, None, 0.0, 0.0, 3, False, None, None, None))
    assert shown.line().startswith("not pressed, load 3; 2 slip events, 1 in contact, 1 slipping;")
    change = packets.StateChange(7, 0.007, 65535, 1, 3, None, None, 2, True)
    assert shown.add(change) == "0.0070 s: channel load, incipient to contact, late"
    assert shown.add(packets.States(8, None, 0, (0, 2, 1, 3))) is None
    assert "2 slip events, 4 in contact, 2 slipping;" in shown.line()
    assert shown.add(packets.Health(5, None, 12, 5)) == "5 clocks: taxel 12 faults 0b101"
    shown.add(packets.Statistics(5, None, 2, 99))
    shown.add(packets.Image(5, None, 1, np.ones((2, 2), np.uint16), None))
    shown.messages.append("the line is gone")
    console = Console(width=100, record=True, file=open(os.devnull, "w"))  # noqa: SIM115
    console.print(shown.picture())
    text = console.export_text()
    for part in (
        "state 6",
        "not pressed, load 3",
        "12: 0b101",
        "99 time-outs",
        "████",
        "the line is gone",
        "2×2",
    ):
        assert part in text, part
    rows = [line.split() for line in text.splitlines() if line.startswith("│")]
    listed = [row[1] for row in rows if row[2] in ("gross", "incipient", "contact", "none", "state")]
    assert listed == ["channel", "3", "1", "2", "load", "0", "70"]  # what slips first
    shown.add(packets.CopFrame(9, 1.0, 0.5, -0.5, 3, True, 1.0, -1.0, 0.25))
    assert shown.line().startswith("x +0.500 y -0.500 (+1.00, -1.00 mm), load 0.250 N")
