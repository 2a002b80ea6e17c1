"""What every command refuses: exit code 2, one sentence that names what is wrong, and nothing written.

A line is a word of the sentence, then the commands. A command gets the options of DEFAULTS that it does not
give.
"""

import os
import shlex
import zipfile

import numpy as np
import pytest
from mcap.writer import Writer

from harness.command import meissner
from meissner import host
from meissner.builds.toolchain import ROOT
from meissner.host import line, log
from meissner.host.simulated import SimulatedCore

DEFAULTS = {
    "slip": "process slip --rate 10000 --threshold 40 --out out.npz",
    "cop": "process cop --out out.npz",
    "cop4": "process cop4 --config c.toml --out out.npz",
    "calibrate": "calibrate --out new.npz",
    "replay": "replay --out out.npz",
    "log": "log --out out.npz",
    "run": "run --out results",
}
REFUSED = r"""
window: slip in.npy --window 48; slip in.npy --window 2; slip in.npy --window 2048
hop: slip in.npy --hop 5; slip in.npy --hop 0
level: slip in.npy --level 4
threshold: slip in.npy --threshold -1; slip in.npy --threshold 4294967296; slip in.npy --threshold 4.5
rate: slip in.npy --rate 0; slip in.npy --rate nan
warp: slip in.npy --engine warp; cop cube.npy --engine warp; cop4 in.npy --engine warp
warp: run acrylic_slip --engine warp; run cop_load --engine warp; run cop_slip --engine warp
nowhere: slip nowhere.npy; cop nowhere.npy; cop4 nowhere.npy; cop4 in.npy --config nowhere.toml
nowhere: calibrate nowhere.npz; fit-rubber nowhere.csv; cop cube.npy --calibration nowhere.npz
nowhere: replay nowhere.mcap; log sim: --out nowhere/a.npz; replay good.npz --out nowhere/o.npz
nowhere: regs sim: --forest nowhere.json; live sim: --forest nowhere.json
nowhere: cop4 in.npy --config nothing-nowhere; live sim: --config nowhere; choose array --out /nowhere/x.toml
text.npy: slip text.npy
in.pdf: slip in.pdf; budget --cop4 --out in.pdf
archive.npy: slip archive.npy
broken.npy: slip broken.npy
empty.csv: slip empty.csv
words.csv: slip words.csv; fit-rubber words.csv
shape: slip single.npy; slip cube.npy; cop in.npy; cop in.csv; cop empty.npy
shape: cop4 single.npy; cop4 turned.npy; cop4 five.csv; cop4 none.npy
integers: slip complex.npy; slip half.npy; cop half3.npy; cop complex3.npy; cop4 complex4.npy
NaN: slip nan.npy; cop nan3.npy; cop nan32.npy --calibration cal.npz; cop4 nan4.npy
outside: slip wide.npy; cop negative.npy; cop high.npy; cop far.npy --calibration cal.npz; cop4 wide4.npy
4096: slip many.npy
1025: cop tall.npy; cop broad.npy; budget --cols 1025; budget --cop4 --columns 1025
folder: slip in.npy --out no/out.npz; slip in.npy --out folder; cop folder; cop folder.csv; config show folder
folder: replay folder; live file:folder; calibrate press.npz --out no/cal.npz; cop4 good4.npy --out no/out.npz
folder: budget --cop4 --out no/one.png
out: cop cube.npy --out out; slip in.npy --out out.npy
cal.csv: calibrate press.npz --out cal.csv
pipe: slip in.npy --out pipe; slip pipe; slip pipe.npy; cop cube.npy --calibration pipe; calibrate pipe
pipe: calibrate pipe.npz; calibrate cube.npy --force pipe.npy; cop4 in.npy --config pipe; config check pipe
pipe: replay pipe.npz; log file:pipe; run acrylic_slip --out pipe; fit-rubber pipe
/dev/zero: slip /dev/zero
tall_header.npy: slip tall_header.npy
20000: cop cube.npy --calibration bomb.npz
400000000: cop cube.npy --calibration bomb1.npz
bomb2.npz: cop cube.npy --calibration bomb2.npz
memory: calibrate bomb3.npz; replay bomb3.npz
min-load: cop cube.npy --min-load -1; cop cube.npy --min-load 8388608; replay good.npz --min-load -1
offset: cop cube.npy --calibration other.npz
gains: cop cube.npy --calibration gain.npz
in.npy: cop cube.npy --calibration in.npy; run acrylic_slip --out in.npy/results; cop4 in.npy --config in.npy
3×2: cop cube.npy --calibration cal.npz; regs sim:walk_25x5 --calibration cal.npz
offset: live sim: --calibration other.npz; log sim: --calibration other.npz; regs sim: --calibration other.npz
listen: live sim: --listen --calibration cal.npz; log sim: --listen --calibration cal.npz
reached: live file:a.bin --calibration cal.npz
array: regs core:grip --calibration cal.npz
codes: calibrate other.npz; calibrate cube.npy
hop: threshold in.npy --rate 1000 --hop 5
short: threshold in.npy --rate 10000
.png: threshold in.npy --rate 10000 --out t.pdf
rate: threshold in.npy; threshold in.npy --rate 0
nowhere: threshold nowhere.csv; threshold in.npy nowhere.csv --rate 1000; threshold in.npy --config nowhere
per-hour: threshold in.npy --rate 1000 --per-hour nan
input: threshold in.npy --rate 1000 --out in.npy
array: cop cube.npy --config cop4; calibrate cube.npy --force in.npy --config cop4
column: slip in.csv --column 3; fit-rubber in.csv --column 1,2
volts-per-code: slip in.npy --volts-per-code 0; cop cube.npy --volts-per-code nan
3x: cop in.npy --shape 3x
1×2: cop in.csv --shape 1x2 --config fingertip; calibrate in.csv --shape 1x2 --config fingertip
shape: cop4 half.npy; cop4 in.csv
choose: process slip ten.csv --config fingertip --out out.npz
alike: threshold timed.csv slow.csv
text.npz: calibrate text.npz; fit-rubber text.npz
forces: calibrate press.npz --force in.npy
force_n: calibrate cube.npy --force in.npy
cells: calibrate few.npz
lsb: calibrate press.npz --lsb 1e-9; calibrate press.npz --lsb nan
codes-per-v: fit-rubber x.csv --codes-per-v 0
time_s: fit-rubber bomb.npz
rows: cop4 in.npy --config short.toml
load: budget --cop4 --load 0; budget --cop4 --load nan
sensor: cop4 in.npy --config half.toml; choose wires
electrodes: cop4 in.npy --config fingertip
config: process cop4 in.npy --out out.npz
nope: run nope
waves: run acrylic_slip --waves; run walk_25x5 --waves; run cop_slip --waves
seed: run acrylic_slip --seed -1
COMMAND: ;
x1b: run x "--\x1b[2J"; slip "\x1b[2J\u202e\n.npy"
telepathy: live telepathy
seconds: live sim: --seconds 0; live sim: --seconds nan
domain: bridge dds sim: --domain 233; bridge dds sim: --domain -1
listen-on: bridge foxglove sim: --listen-on 8765; bridge foxglove sim: --listen-on a:b
clk-khz: live sim: --clk-khz 0; live sim: --clk-khz 999; live sim: --clk-khz 12000000
reached: regs file:a.bin
a.txt: log sim: --out a.txt
clock: log file:a.bin; budget --clock 12; budget --clock 12000; budget --clock 2.1e8; budget --clock nan
a.bin: replay a.bin
empty.mcap: replay empty.mcap
no facts about a core's log: replay other.mcap
oracle: replay empty.mcap --engine oracle
other.npz: replay other.npz
press.npz: replay press.npz --out out.txt
image: replay good.npz
rows: budget --rows 0; budget --cop4 --rows 0; choose channels --rows 3
columns: choose electrodes --rows 3 --columns 4
settle: budget --settle-us nan; budget --settle-us -1; budget --settle-us 2000
adc: budget --adc abacus; choose channels --adc AD1; choose electrodes --adc MCP3208
converters: budget --converters 0; budget --converters 9
adc-lanes: budget --demod --adc max11123 --adc-lanes 2
lanes: budget --adc-lanes 3; budget --adc-lanes 0; budget --adc ad7606c-16 --adc-lanes 16
channels: budget --channels 9; choose channels --channels 9
sclk_khz: budget --sclk-khz 0
bits-per-clock: budget --bits-per-clock 3
BUSY: budget --demod --adc ad7606
sample_period: budget --demod --adc max11123 --sample-period 1
periods: budget --demod --adc max11123 --periods 0
skip: budget --demod --adc max11123 --skip -1
out: budget --out x.png
/dev/null: tradeoff --out /dev/null
2.5: budget --cop4 --columns 2.5
r: budget --cop4 --r 0
R0: budget --cop4 --R0 -1
V0: budget --cop4 --V0 inf
k: budget --cop4 --k nan
adc-bits: budget --cop4 --adc-bits 7; budget --cop4 --adc-bits 25
gain: budget --cop4 --gain 0.5; budget --cop4 --gain nan; budget --cop4 --gain 2000
slp: tradeoff --axis slp
axis: tradeoff --point bits=12
bits: tradeoff --axis slip --point bits; tradeoff --axis slip --point bit=12
bits: tradeoff --axis slip --point bits=1.5; tradeoff --axis slip --point bits=-1
noise_mv: tradeoff --axis slip --point noise_mv=nan
window: tradeoff --axis slip --point window=48
runs: tradeoff --axis slip --point runs=0
kind: tradeoff --axis slip --point bits=8 kind=round
cop4: tradeoff --axis cop4 --point R0_ohm=0
workers: tradeoff --workers 0
pi: choose channels --board pi
error: choose channels --error -1; choose channels --error nan
requirements: choose channels --latency 0.001
lut: choose channels --lut 3; choose channels --lut 3 --board icebreaker --adc MCP3208
icebreaker: choose electrodes --board icebreaker
requirements: choose array --latency 0.1 --rows 64 --adc MCP3208
sweep: choose array --sweep /nowhere
overwrite: slip in.npy --out cal.npz; cop cube.npy --out cal.npz; cop4 good4.npy --out cal.npz
overwrite: calibrate press.npz --out cal.npz; log sim: --out cal.npz; replay good.npz --out cal.npz
overwrite: choose channels --out c.toml; run walk_25x5 --out done; budget --cop4 --out done
overwrite: budget --cop4 --out done/budget_cop4.png; slip in.npy --out linked.npz
input: slip in.csv --out in.csv --overwrite; slip in.csv --out ./in.csv
input: log file:c.npz --out c.npz --overwrite
input: slip in.csv --out hard.csv --overwrite; cop cube.npy --calibration cal.npz --out cal.npz --overwrite
input: cop cube.npy --calibration cal.npz --out linked.npz --overwrite; calibrate press.npz --out press.npz
input: cop4 good4.csv --out good4.csv --overwrite; replay good.npz --out good.npz --overwrite
input: calibrate cube.npy --force press.npz --out press.npz --overwrite
input: log sim: --config c.npz --out c.npz --overwrite
"""


def presses(few=False):
    """A press recording of 3×3 cells, each cell on its own line; ``few``: two cells have too few presses."""
    force_n = np.arange(5.0)[:, None, None] * np.ones((3, 3))
    own = np.arange(9).reshape(3, 3)
    codes = np.rint(100 + 10 * own + (300 + own) * force_n)
    if few:
        force_n[2:, 0, 1] = force_n[1:, 2, 0] = np.nan
    return {"codes": codes.astype(int), "force_n": force_n}


def header(shape):
    """The header of a .npy file of 64-bit integers, by NEP 1."""
    text = f"{{'descr': '<i8', 'fortran_order': False, 'shape': {shape}}}".ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode()


def archive(path, **shapes):
    """A .npz whose arrays are headers followed by a few zeros."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name, shape in shapes.items():
            file.writestr(f"{name}.npy", header(shape) + bytes(800))


@pytest.fixture(scope="module")
def inputs(tmp_path_factory):
    """A folder with the files that REFUSED names: no command changes it."""
    folder = tmp_path_factory.mktemp("inputs")
    x = np.random.default_rng(1).integers(-20, 21, (2, 1000))
    np.save(folder / "in.npy", x)
    np.savetxt(folder / "in.csv", x.T, fmt="%d", delimiter=",")
    for name, text in {
        "text.npy": "not an array",
        "text.npz": "not an archive",
        "in.pdf": "1\n",
        "words.csv": "a,b\n",
        "empty.csv": "# nothing\n",
        "five.csv": "1,2,3,4,5\n" * 2,
        "ten.csv": "1,2,3,4,5,6,7,8,9,10\n" * 9,
        "slow.csv": "t (s),a\n" + "".join(f"{k / 400},{k % 3}\n" for k in range(99)),
        "timed.csv": "t (s),a\n" + "".join(f"{k / 500},{k % 3}\n" for k in range(99)),
        "short.toml": "[mesh]\n[converter]\n",
        "half.toml": 'about = "half"\n[clock]\nmhz = 25.0\n',
        "c.toml": (ROOT / "docs/cop4.toml").read_text("utf-8"),
    }.items():
        (folder / name).write_text(text)
    (folder / "a.bin").write_bytes(b"\0")
    (folder / "empty.mcap").write_bytes(b"")
    with open(folder / "other.mcap", "wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("std_msgs/msg/Int32", "ros2msg", b"int32 data")
        writer.add_message(writer.register_channel("/tactile/slip", "cdr", schema), 1, b"\0\1\0\0\5\0\0\0", 1)
        writer.finish()
    with log.recording(folder / "good.npz", host.Core(line.Pipe(SimulatedCore()))):
        pass
    (folder / "broken.npy").write_bytes(b"PK\x03\x04 and no more")
    with open(folder / "archive.npy", "wb") as file:
        np.savez(file, x=np.zeros(100, int))
    for name in ("pipe", "pipe.npy", "pipe.npz"):
        os.mkfifo(folder / name)
    for name in ("folder", "folder.csv", "done"):
        (folder / name).mkdir()
    for name in ("done/summary.json", "done/budget_cop4.png", "c.npz", "good4.csv"):
        (folder / name).write_text("1,2,3,4\n")
    (folder / "hard.csv").hardlink_to(folder / "in.csv")
    (folder / "linked.npz").symlink_to("cal.npz")
    (folder / "tall_header.npy").write_bytes(header((1 << 40,)) + bytes(64))
    archive(folder / "bomb.npz", offset=(20_000, 20_000), gain=(3, 2))
    archive(folder / "bomb1.npz", offset=(3, 2), gain=(400_000_000,))
    archive(folder / "bomb3.npz", codes=(1 << 40, 32, 32), force_n=(5,))
    with zipfile.ZipFile(folder / "bomb2.npz", "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("offset.npy", b"\x93NUMPY\x02\x00" + (1 << 24).to_bytes(4, "little") + bytes(1 << 24))
    for name, x in {
        "single": np.int64(5),
        "complex": np.zeros(100, complex),
        "nan": np.full(100, np.nan),
        "half": np.full(100, 0.5),
        "wide": np.full(100, 1 << 20),
        "many": np.zeros((4097, 64), int),
        "cube": np.zeros((2, 2, 64), int),
        "negative": np.arange(-1, 10).reshape(1, 1, 11),
        "high": np.array([[[0, 65536]]]),
        "empty": np.zeros((3, 0, 5), int),
        "tall": np.zeros((1, 1025, 1), int),
        "broad": np.zeros((1, 1, 1025), int),
        "nan3": np.full((1, 2, 2), np.nan),
        "half3": np.full((1, 2, 2), 0.5),
        "complex3": np.zeros((1, 2, 2), complex),
        "good4": np.zeros((2, 4), int),
        "turned": np.zeros((4, 6), int),
        "none": np.zeros((0, 4), int),
        "nan4": np.full((1, 4), np.nan),
        "half4": np.full((1, 4), 0.5),
        "complex4": np.zeros((1, 4), complex),
        "wide4": np.array([[0, 0, 0, -(1 << 23) - 1]]),
    }.items():
        np.save(folder / f"{name}.npy", x)
    np.save(folder / "far.npy", np.full((1, 3, 2), 65536) * [0, 1])
    np.save(folder / "nan32.npy", np.full((1, 3, 2), np.nan))
    np.savez(folder / "other.npz", x=np.zeros(3))
    np.savez(folder / "press.npz", **presses())
    np.savez(folder / "few.npz", **presses(few=True))
    lines = {"offset": np.zeros((3, 2), int), "gain": np.ones((3, 2), int), "gain_shift": 12}
    lines |= {"dead": np.zeros((3, 2), bool), "force_lsb_n": 1e-3}
    np.savez(folder / "cal.npz", **lines)
    np.savez(folder / "gain.npz", **lines | {"gain": np.full((3, 2), 65536)})
    return folder


def whole(text):
    """The arguments of a command, with what DEFAULTS adds, and escapes as their characters."""
    first, *given = [
        word.encode().decode("unicode_escape") if "\\" in word else word for word in shlex.split(text)
    ]
    added = shlex.split(DEFAULTS.get(first, first))
    start = next((at for at, word in enumerate(added) if word.startswith("--")), len(added))
    options = [pair for pair in zip(added[start::2], added[start + 1 :: 2]) if pair[0] not in given]
    return [*added[:start], *given, *(word for pair in options for word in pair)]


def state(folder):
    """What a folder holds, and when each file was written."""
    return sorted((path, path.stat().st_mtime_ns) for path in folder.rglob("*"))


@pytest.mark.parametrize("row", REFUSED.strip().splitlines())
def test_bad_input_is_one_sentence_and_writes_nothing(inputs, row):
    word, commands = row.split(": ", 1)
    before = state(inputs)
    for text in commands.split("; "):
        done = meissner(*(whole(text) if text.strip(";") else []), cwd=inputs)
        assert (done.returncode, done.stdout) == (2, ""), (text, done)
        assert word in done.stderr and len(done.stderr.strip().splitlines()) == 1, (text, done.stderr)
    assert state(inputs) == before
