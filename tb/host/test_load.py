"""Calibrations in a core, over its registers: the forces of the RTL are those of the formula, in each kind of
table; a register that reads back another value, a reset meanwhile or later, and what does not fit."""

from dataclasses import replace
from fractions import Fraction
from math import floor

import numpy as np
import pytest

from meissner import calibration, cli, host
from meissner.builds import config
from meissner.calibration import Calibration
from meissner.engines.rtl_core import CoreOnPins
from meissner.host import line, names, packets
from meissner.host.load import load
from meissner.host.pty import Pty
from meissner.host.sensors import statistics_source, together
from meissner.host.simulated import SimulatedCore
from meissner.twins.link import bridge

ARRAY = """about = "an array to calibrate"
clock.mhz = 24.0
sensor = {{ kind = "array", rows = 3, columns = 5 }}
adc = {{ part = "MCP3208", volts = 5.0, rate_hz = 500.0, converters = {converters}, channels = {channels} }}
array = {{ tare = {tare}, gains = "{gains}" }}
{more}
cop.min_load_n = 0.001
link = {{ images = true, baud = 3_000_000 }}
"""


def built(folder, tare=False, gains="taxel", converters=1):
    text = ARRAY.format(
        tare=str(tare).lower(),
        gains=gains,
        converters=converters,
        channels={1: 5, 3: 2}[converters],
        more="tare = { contact_codes = 64, step = 0 }" if tare else "",
    )
    (folder / "mine.toml").write_text(text)
    return config.load(folder / "mine.toml")


def lines_of(shape, seed=1):
    """Each cell its own, with the ends of the registers, zeros below 0, and a dead cell with a gain."""
    rng = np.random.default_rng(seed)
    lines = Calibration(
        offset=rng.integers(-3000, 3000, shape),
        gain=rng.integers(2, 65534, shape),
        gain_shift=12,
        dead=np.zeros(shape, bool),
        force_lsb_n=0.002,
    )
    lines.gain[0, :2], lines.dead[-1, 1] = (1, 65535), True
    return lines


def forces_of(codes, lines):
    found = np.zeros(codes.shape, int)
    for at in np.ndindex(codes.shape):
        if not lines.dead[at]:
            exact = Fraction(int(codes[at] - lines.offset[at]) * int(lines.gain[at]), 1 << 12)
            found[at] = min(max(floor(exact + Fraction(1, 2)), 0), 65535)
    return found


@pytest.mark.parametrize("tare, converters", [(False, 1), (True, 3)])
def test_the_core_computes_what_was_loaded(tmp_path, tare, converters):
    """With tare the offsets are its zeros; five columns on three converters leave a lane of each row
    unused, and their two beats could be four lanes."""
    build = built(tmp_path, tare, converters=converters)
    codes = np.random.default_rng(3).integers(0, 4096, (1, 3, 5))
    with CoreOnPins(build, codes) as pins, host.Core(line.Pipe(pins), build.units) as core:
        for seed in (1, 2):  # the second into the half that the first one left
            lines = lines_of((3, 5), seed)
            if tare:
                lines.offset[0] = 0, 65535, -65536, 4095, 4096
            load(core, lines)
            began = core.now
            found = {packets.CopFrame: {}, packets.Image: {}}
            for one in core.packets(600.0):
                if type(one) in found and one.time > began:
                    found[type(one)][one.time] = one
                if both := set.intersection(*map(set, found.values())):
                    break
            frame, image = (of[min(both)] for of in found.values())
            forces = forces_of(codes[0], lines)
            assert image.taxels.tolist() == forces.tolist() and frame.load == forces.sum()
            assert core.units.newtons_per_code == 0.002 and core.counts.restarts == 0
        assert core["calibrate.swapping"] == 0 and (not tare or core["tare.state.loading"] == 0)


class Tables(SimulatedCore):
    """A simulated core that keeps what is written into the calibration's two halves."""

    def __init__(self, size=(3, 5), **more):
        self.half, self.used, self.swaps, self.after = {}, None, 0, None
        super().__init__(
            together(statistics_source), ["calibrate", "cop", "link"], size=size, speed=50, **more
        )

    def write(self, data):
        found, _ = bridge.accesses(data)
        super().write(data)
        for operation, _, address, _ in found:
            if operation != bridge.WRITE:
                continue
            if address == names.place("calibrate.write").address:
                offset, gain, word = (
                    names.place(f"calibrate.{name}").value(self.registers.setting("calibrate", name))
                    for name in ("offset", "gain", "word")
                )
                self.half[word] = offset, gain
                if self.after == len(self.half):
                    self.after = None
                    self.restart()
            elif address == names.place("calibrate.swap").address:
                self.used, self.half, self.swaps = self.half, {}, self.swaps + 1

    def restart(self):
        self.half, self.used = {}, None
        super().restart()


def expected(lines):
    gains = np.where(lines.dead, 0, lines.gain)
    return dict(enumerate(zip(lines.offset.ravel().tolist(), gains.ravel().tolist())))


def test_every_cell_is_written_and_written_again_after_a_reset():
    model, lines, said = Tables(), lines_of((3, 5)), []
    with host.Core(line.Pipe(model), say=said.append, timeout_s=30.0) as core:
        load(core, lines)
        assert (model.used, model.swaps) == (expected(lines), 1)
        list(core.packets(0.05))
        model.restart()
        assert model.used is None
        for _ in core.packets(30.0):
            if model.swaps == 2:
                break
        assert (model.used, core.counts.restarts) == (expected(lines), 1)
    assert said[-1] == "the calibration was written into the core on the simulated core again"


def test_a_table_that_was_loaded_before_the_calibration_is_loaded_again_too():
    model, lines, loads, said = Tables(), lines_of((3, 5)), [], []
    with host.Core(line.Pipe(model), say=said.append, timeout_s=30.0) as core:
        core.keep("another table", lambda: loads.append(core.counts.restarts))
        load(core, lines)
        list(core.packets(0.05))
        model.restart()
        for _ in core.packets(30.0):
            if model.swaps == 2:
                break
        assert (model.used, loads) == (expected(lines), [1])
    assert [sentence.partition(" was written")[0] for sentence in said[-2:]] == [
        "another table",
        "the calibration",
    ]


def test_a_reset_while_it_is_written_begins_again():
    model, lines = Tables(), lines_of((3, 5))
    with host.Core(line.Pipe(model), say=lambda _: None) as core:
        list(core.packets(0.05))
        model.after = 7
        load(core, lines)
        assert model.used == expected(lines) and core.counts.restarts == 1


def test_a_swap_that_is_sent_again_begins_again():
    """The answer to the first swap is lost; the second puts the former table back into use."""
    model, lines = Tables(), lines_of((3, 5))
    honest = model.read
    model.read = lambda n: b"" if (data := honest(n)) and model.swaps == 1 else data
    with host.Core(line.Pipe(model)) as core:
        load(core, lines)
    assert model.used == expected(lines) and model.swaps >= 3


@pytest.mark.parametrize("name", ["calibrate.word", "calibrate.offset", "calibrate.gain"])
def test_a_register_that_reads_back_another_value_is_an_error(name):
    model, place = Tables(), names.place(name)
    honest = model.registers.access

    def access(operation, address, *more, **also):
        word, error, rest = honest(operation, address, *more, **also)
        wrong = operation == bridge.READ and address == place.address and word & 4
        return word ^ (1 if wrong else 0), error, rest

    model.registers.access = access
    with host.Core(line.Pipe(model)) as core:
        with pytest.raises(ValueError, match=f"{name} reads back .* the core is not calibrated"):
            load(core, lines_of((3, 5)))
        assert model.swaps == 0


def test_what_the_core_cannot_hold_is_refused(tmp_path):
    build = built(tmp_path, tare=True, gains="row_column")
    with (
        CoreOnPins(build, np.zeros((1, 3, 5), int)) as pins,
        host.Core(line.Pipe(pins)) as core,
        pytest.raises(ValueError, match="rows and columns"),
    ):
        load(core, lines_of((3, 5)))
    model = Tables()
    with host.Core(line.Pipe(model)) as core:
        for lines, says in (
            (lines_of((5, 3)), "5×3 cells but the core has 3×5"),
            (replace(lines_of((3, 5)), gain_shift=11), "gain_shift = 11"),
        ):
            with pytest.raises(ValueError, match=says):
                load(core, lines)
        model.status["calibrate", "swapping", "value"] = 1
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("meissner.host.load.SWAP_S", 0.1)
            with pytest.raises(ValueError, match="did not take the calibration"):
                load(core, lines_of((3, 5)))
    with host.Core(line.Pipe(Tables()), registers=False) as core, pytest.raises(ValueError, match="listened"):
        load(core, lines_of((3, 5)))
    model = SimulatedCore(features=["slip"])
    with host.Core(line.Pipe(model)) as core, pytest.raises(ValueError, match="no array"):
        load(core, lines_of((3, 5)))


@pytest.mark.parametrize("command", ["regs", "live", "log"])
def test_the_commands_load_a_calibration(tmp_path, monkeypatch, capsys, command):
    """The kinds that calibrate writes: with a dead cell, with bent ones; the load is then in newtons."""
    monkeypatch.chdir(tmp_path)
    newtons = np.linspace(0, 3, 31)
    codes = np.rint(300 + 900 * (1 - np.exp(-newtons[:, None, None] / np.linspace(0.5, 9, 15).reshape(3, 5))))
    codes[:, 2, 1] = 77
    np.savez("press.npz", codes=codes.astype(int), force_n=newtons)
    cli.main(["calibrate", "press.npz", "--out", "cal.npz"])
    lines = calibration.load("cal.npz")
    assert lines.bent.any() and lines.dead.sum() == 1
    model = Tables()
    more = {
        "regs": ("calibrate.gain",),
        "live": ("--seconds", "0.3"),
        "log": ("--seconds", "0.3", "--out", "l.npz"),
    }
    with Pty(model) as pty:
        cli.main([command, pty.url, *more[command], "--calibration", "cal.npz"])
    assert model.used == expected(lines)
    assert "writing the calibration of 15 cells in cal.npz into the core" in capsys.readouterr().err
    if command == "log":
        assert np.load("l.npz")["newtons_per_code"] == lines.force_lsb_n
