"""``meissner config new``: a configuration with comments, from a few answers.

It is checked as any other file and its pins are assigned before it is written, so what cannot be is refused
by the sentence of the check that finds it.
"""

import json
import os
import re
import sys
import tomllib
from argparse import Namespace
from contextlib import suppress
from math import floor
from pathlib import Path
from typing import Any

from meissner.builds import config, pins
from meissner.builds.boards import COP4_ICE
from meissner.builds.flash import EVERY
from meissner.builds.keys import FILES, PARTS
from meissner.files import check_out, written
from meissner.tables import one_of
from meissner.terminal import plain

WORDS = {
    "channels": "single sensors, such as rubber",
    "array": "a matrix",
    "electrodes": "four wires",
    "none": "a forest alone, for rows of a host",
}
FEATURES = {
    "grip": "the reflex of a hand",
    "forest": "a trained forest decides",
    "display": "pins under a finger",
    "shear_speed": "mm/s of sheared rubber",
}
OPTIONS = {"channels", "rows", "columns", "adc", "converters", "volts", "features", "forest", "pins", "rate"}
R_OHM, R0_OHM = 100.0, 1000.0  # of the mesh of the published slip sensor


def command(arguments: Namespace) -> None:
    """``meissner config new``."""
    if check_out(arguments.out).suffix != ".toml":
        raise ValueError(f"{arguments.out} must be a .toml file")
    found = _answers(arguments)
    text = written_from(found, Path(arguments.out))
    with written(arguments.out) as file:
        file.write(text.encode("utf-8"))
    out = plain(arguments.out)
    board = f" --board {found['board']}" if found["board"] else ""
    wiring = f"\n  meissner wiring {out}{board} --out wiring.svg" if found["sensor"] != "none" else ""
    print(f"written: {out}\n  meissner config show {out}{wiring}")
    if found["board"]:
        print(f"  make synth BOARD={found['board']} CONFIG={out}")


def _answers(given: Namespace) -> dict[str, Any]:
    """What the options say; the rest is asked on a terminal, and otherwise the usual."""
    asks, options = sys.stdin.isatty() and sys.stdout.isatty(), dict(vars(given))

    def of(name: str, question: str, usual: Any, kind: type = str) -> Any:
        value = options.pop(name)
        if value is None and asks:
            try:
                said = input(f"{question} [{usual or 'none'}]: ").strip()
            except EOFError:
                raise ValueError(f"no answer: {question}") from None
            try:
                value = kind(said) if said and (usual or said != "none") else usual
            except ValueError:
                raise ValueError(
                    f"{name} = {said!r} must be a {'whole ' if kind is int else ''}number"
                ) from None
        return usual if value is None else value

    def several(names: dict[str, str]) -> str:
        return ", ".join(f"{name} ({words})" for name, words in names.items())

    sensor = of("sensor", f"sensor: {several(WORDS)}", "channels")
    one_of("sensor", sensor, WORDS)
    found: dict[str, Any] = {"sensor": sensor, "features": ["forest"]}
    if sensor == "channels":
        found["channels"] = of("channels", "sensors, each on an input of the converter", 1, int)
    elif sensor != "none":
        side = 3 if sensor == "array" else 7
        found |= {name: of(name, f"{name} of taxels", side, int) for name in ("rows", "columns")}
    if sensor != "none":
        usual = "AD7606" if sensor == "electrodes" else "MCP3208"
        found["adc"] = of("adc", f"converter: {', '.join(PARTS)}", usual).upper()
        one_of("adc", found["adc"], PARTS)
        if sensor == "array":
            found["converters"] = of("converters", "converters side by side", 1, int)
        signed = PARTS[found["adc"]].signed
        found["volts"] = of("volts", "full scale of the converter, volts", 5.0 if signed else 3.3, float)
        offered = {name: FEATURES[name] for name in FEATURES if name in FILES[sensor].__struct_fields__}
        if sensor == "channels":  # whose codes are highest at rest, when every pin would be on
            offered.pop("display")
        implied = [name for name, option in (("forest", given.forest), ("display", given.pins)) if option]
        said = of("features", f"features, with commas: {several(offered)}", ",".join(implied))
        chosen = {*filter(None, map(str.strip, said.split(","))), *implied} - {"none"}
        for name in sorted(chosen):
            one_of("features", name, offered)
        found["features"] = [name for name in FEATURES if name in chosen]
    if "forest" in found["features"]:
        found["forest"] = of("forest", "the forest, an F.json of export-forest", None)
    if "display" in found["features"]:
        found["pins"] = of("pins", "pins of the display, rows x columns", "5x20")
        if not re.fullmatch(r"\d{1,3}x\d{1,3}", found["pins"]):
            raise ValueError(f"pins = {found['pins']!r} must be rows x columns, such as 5x20")
    if sensor != "none":
        found["rate"] = of("rate", "frames a second, or max", "max" if sensor == "array" else "10000")
    found["board"] = of("board", f"board: {', '.join(EVERY)}, or none", None)
    if found["board"] == "none":
        found["board"] = None
    if found["board"] is not None:
        one_of("board", found["board"], EVERY)
    for name in OPTIONS & set(options):
        if options[name] is not None:
            raise ValueError(f"{name} = {options[name]} does not go with sensor = '{sensor}'")
    for key in ("channels", "rows", "columns", "converters"):
        if found.get(key, 1) < 1:
            raise ValueError(f"{key} = {found[key]} must be above 0")
    return found


def written_from(found: dict[str, Any], out: Path) -> str:
    """The text of a configuration for the file ``out``; ValueError in one sentence if it cannot be built."""
    board = EVERY[found["board"]] if found["board"] else None
    makes = pins.description(board.name).clock["core_mhz"] if board else [24.0]
    sensor, features = found["sensor"], found["features"]
    small = sensor in ("channels", "none")
    mhz = min(makes) if small else max([each for each in makes if each <= 50] or makes)
    few = found["board"] == "icebreaker" and sensor != "none"  # too few cells for registers
    if few:
        _room(found)
    part = {"channels": _channels, "array": _array, "electrodes": _electrodes, "none": _none}[sensor]
    clock = f"the {board.name} makes {_or(makes)}" if board else "of the core"
    about, own, adc, rest = part(found, few)
    about += f", with {', '.join(features)}" if features and sensor != "none" else ""
    for name in features:
        rest += "\n" + FEATURE_TEXTS[name](found, out, mhz)
    text = f"""# Written by `meissner config new`; docs/config.md explains every key, `config check` checks.
about = "{about}"

[clock]
mhz = {mhz}                # {clock}

[sensor]
{own}
{adc}{rest}
[link]
baud = {min(3_000_000 if not small else 1_000_000, round(mhz * 250_000))}
registers = {str(not few).lower()}         # a host reads and writes settings while the core runs
"""
    if few and small and found["channels"] == 1:
        text += "statistics = false\nslip_only = true          # the smallest packets: changes of the state\n"
    if sensor == "array":
        text += "images = true             # beside centre of pressure and load\n"
    text = text.replace("\n\n\n", "\n\n")
    text = re.sub(r"(?m)^(\S.*?) +# ", lambda found: f"{found[1]:<25} # ", text)
    tables = tomllib.loads(text)
    if found.get("forest"):
        tables["forest"]["file"] = found["forest"]  # the text has it as seen from the file
    made = config.read(out.stem, tables)
    if board:
        board.fits(made, out.stem)
    return text


def _room(found: dict[str, Any]) -> None:
    """ValueError for what no build for an iCEBreaker has room for."""
    if found["sensor"] == "electrodes":
        raise ValueError(f"sensor = 'electrodes' must be on another board than the icebreaker: {COP4_ICE}")
    needs = [name for name in found["features"] if name != "display"]
    if needs:
        raise ValueError(
            f"features = '{needs[0]}' must be on another board than the icebreaker: it needs registers, for "
            "which a sensor leaves no cells"
        )


def _adc(found: dict[str, Any], more: str = "") -> str:
    """[adc]."""
    try:
        rate = '"max"' if found["rate"] == "max" else f"{float(found['rate'])}"
    except ValueError:
        raise ValueError(f"rate = {found['rate']!r} must be a number, or max") from None
    end = "the end of the range" if PARTS[found["adc"]].signed else "the reference"
    return f"""[adc]
part = "{found["adc"]}"
volts = {found["volts"]:g}               # {end}
rate_hz = {rate}          # frames a second; "max": the fastest that converter, scan, line and features allow
{more}
"""


def _or(numbers: list[float]) -> str:
    *most, last = (f"{each:g}" for each in numbers)
    return f"{', '.join(most)} or {last}" if most else last


def _channels(found: dict[str, Any], few: bool) -> tuple[str, str, str, str]:
    count, volts = found["channels"], found["volts"]
    serial = few and count == 1 and found["adc"] == "MCP3208"
    return (
        f"{count} rubber sensor{'s' * (count > 1)} on one {found['adc']}",
        f'kind = "channels"\nchannels = {count}              # on inputs 0 and up of the converter\n',
        _adc(found),
        f"""[slip]                    # volts of a sample and of a detail's peak to peak (docs/slip.md)
serial = {str(serial).lower()}            # true: one channel, two bits a clock, the fewest cells
window = 64               # samples
threshold_p2p_v = {0.004 * volts:.4g}  # a slip above this; `meissner threshold` finds it from a recording
gross_threshold_p2p_v = {0.024 * volts:.4g}
contact_level_v = {0.9 * volts:.4g}    # the code falls as the rubber is pressed: below this it is in contact
release_level_v = {0.96 * volts:.4g}   # above this it is free
hold_ms = 150.0           # a flag lasts this long after its cause
refractory_ms = 20.0
blank_ms = 100.0          # no flag for this long after contact begins
""",
    )


def _array(found: dict[str, Any], few: bool) -> tuple[str, str, str, str]:
    rows, columns, converters = (found[key] for key in ("rows", "columns", "converters"))
    inputs = min(8, -(-columns // converters))
    many = f"{converters} {found['adc']}" if converters > 1 else f"one {found['adc']}"
    return (
        f"{rows}×{columns} taxels on {many}",
        f'kind = "array"\nrows = {rows}                  # driven one at a time, 0 at the top\n'
        f"columns = {columns}               # read together, 0 at the left\n",
        _adc(
            found,
            f"converters = {converters}\n"
            f"channels = {inputs}              # inputs used of each; more columns take turns\n",
        ),
        """[array]
newtons_per_count = 0.001 # of one code of force, after calibration (docs/calibration.md)
pitch_mm = 5.0            # from taxel to taxel

[cop]
min_load_n = 0.2          # pressed from this load on

[slip]                    # newtons of a taxel
window = 32               # frames
threshold_p2p_n = 0.05
gross_threshold_p2p_n = 0.4
contact_level_n = 0.2
release_level_n = 0.1
""",
    )


def _electrodes(found: dict[str, Any], few: bool) -> tuple[str, str, str, str]:
    rows, columns = found["rows"], found["columns"]
    spans = [
        (2 * across * R0_OHM / R_OHM + along + 1) / (along - 1)  # Cx and Cy of docs/mesh.md
        for across, along in ((rows, columns), (columns, rows))
        if along > 1
    ]
    gain = max(1, floor(0.65 * min(spans, default=1)))
    return (
        f"four electrodes of {rows}×{columns} taxels on one {found['adc']}",
        'kind = "electrodes"\n',
        _adc(found),
        f"""[mesh]
rows = {rows}
columns = {columns}
r_ohm = {R_OHM}             # between taxels
R0_ohm = {R0_OHM}           # from each electrode to its supply
V0_v = 15.0               # the supplies, plus and minus
k_n_ohm = 4320.0          # a taxel under F newtons has k/F ohms

[load]
gain = {0.06 * found["volts"]:g}                # brings 15 V into the converter's range
difference_gain = {gain}.0    # of E1 - E3 and of E2 - E4 (docs/cop4.md)
lsb_n = 0.001
min_n = 0.3               # a position from this load on
correction = "none"

[cop_slip]
lag_ms = 128.0
drop = 0.3                # of the load one lag earlier
move = 0.0035             # of the half range
min_load_n = 0.3
hold_ms = 50.0
refractory_ms = 100.0
""",
    )


def _none(found: dict[str, Any], few: bool) -> tuple[str, str, str, str]:
    return "a forest for rows of a host", 'kind = "none"\n', "", ""


def _grip(found: dict[str, Any], out: Path, mhz: float) -> str:
    answers, sample = ("a finger", "sample") if found["sensor"] == "channels" else ("a decision", "frame")
    return f"""[grip]                    # the command of a hand, in counts (docs/grip.md)
rule = "any"              # any finger that slips, or the weakest
immediate = true          # clocks after the {sample} that shows it; false: at the next cycle
cycle_ms = 10.0           # from command to command
silent_ms = 50.0          # the hand holds when {answers} is late by more
step = 256                # for each window over the threshold
rate = 2048               # most of a cycle
minimum = 1024
maximum = 60_000
"""


def _forest(found: dict[str, Any], out: Path, mhz: float) -> str:
    channels = found.get("channels") or found.get("rows", 0) * found.get("columns", 0)
    frames = found["sensor"] in ("channels", "array")
    labels: list[Any] = [0, 1]
    window = max(1, min(6, 256 // (channels or 1)))
    size = (
        "" if frames else "features = 16             # of a row\nbits = 12                 # of a feature\n"
    )
    size += "classes = 2\ntrees = 64\nnodes = 1024\n"
    if path := found["forest"]:
        from meissner.forest import file, words

        model = words.without_missing(file.read(Path(path)))[0]
        labels, window = list(model.classes), max(1, len(model.features) // (channels or 1))
        beside = os.path.relpath(path, out.parent)
        size = f"file = {json.dumps(beside)}  # sizes follow from it; it is not in the bitstream\n"
    rows = f"window = {window}                # frames whose differences are a row\n" if frames else ""
    banks = 1 if found["board"] == "icebreaker" else 2
    slips = json.dumps(labels[1:] if len(labels) == 2 else [])
    slip = f"slip = {slips}                # what is a slip for [grip], of {json.dumps(labels[:8])}\n"
    return f"""[forest]                  # a host loads it: live, log, regs --forest F.json (docs/forest.md)
source = "{"frames" if frames else "host"}"         # where its rows come from
{rows}{size}banks = {banks}                 # 2: one is loaded while another decides
{slip if "grip" in found["features"] else ""}"""


def _display(found: dict[str, Any], out: Path, mhz: float) -> str:
    from meissner.twins.actuate.pin_display import DisplaySize

    rows, columns = map(int, found["pins"].split("x"))
    chains, bits = 1, 4
    for chains, bits in [(chains, bits) for bits in (4, 3, 2, 1) for chains in (1, 2, 4, 8)]:
        with suppress(ValueError):
            DisplaySize(rows * columns, chains, bits, round(1000 * mhz))
            break
    shows = {
        "array": "floor_n = 0.05            # a pin is on from this mean force of its taxels\n"
        "step_n = 0.2              # each more of these is a level more\n",
        "electrodes": "marker = true             # the pin under the centre of pressure\n"
        "cue_frames = 100          # while it slips, stripes that move a pin every so many samples\n",
    }[found["sensor"]]
    return f"""[display]                 # its lines, and the limits to know: docs/pin_display.md
rows = {rows}
columns = {columns}
chains = {chains}                # of drivers, side by side
amplitude_bits = {bits}        # of a pin's level
drive_hz = 230.0
{shows}most_pins = {min(4095, max(1, rows * columns * 3 // 5))}            # at once
duty = 0.5                # share of any 10 s in which a pin is driven
left_on_s = 5.0           # a pin that stays on is switched off after 4.3 to 5.7 s
stop_s = 0.5              # all is off after this time without a frame
"""


def _shear_speed(found: dict[str, Any], out: Path, mhz: float) -> str:
    share, lsb = found["volts"] / 5, found["volts"] / (1 << PARTS[found["adc"]].data_bits)
    return f"""[shear_speed]             # of a lot of rubber: `meissner fit-rubber` (docs/shear.md)
k0_v = {1.55 * share:.4g}
k1 = -0.27
n = 0.11
vi_min_v = {2 * share:.4g}
vi_max_v = {4 * share:.4g}
noise_v = {0.1 * share:.4g}
still_v = {max(0.0025 * share, 2 * lsb):.4g}
limit_mm_s = 3.0
"""


FEATURE_TEXTS = {"grip": _grip, "forest": _forest, "display": _display, "shear_speed": _shear_speed}
