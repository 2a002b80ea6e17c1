"""``meissner config new``: a configuration with comments, from a few answers.

It is checked as any other file and its pins are assigned before it is written, so what cannot be is refused
by the sentence of the check that finds it.
"""

import re
import sys
import tomllib
from argparse import Namespace
from math import floor
from pathlib import Path
from typing import Any

from meissner.builds import config, pins
from meissner.builds.flash import EVERY
from meissner.builds.keys import PARTS
from meissner.files import check_out, written
from meissner.tables import one_of
from meissner.terminal import plain

WORDS = {"channels": "single sensors, such as rubber", "array": "a matrix", "electrodes": "four wires"}
R_OHM, R0_OHM = 100.0, 1000.0  # of the mesh of the published slip sensor


def command(arguments: Namespace) -> None:
    """``meissner config new``."""
    if check_out(arguments.out).suffix != ".toml":
        raise ValueError(f"{arguments.out} must be a .toml file")
    text = written_from(_answers(arguments), Path(arguments.out).stem)
    with written(arguments.out) as file:
        file.write(text.encode("utf-8"))
    out = plain(arguments.out)
    board = f" --board {arguments.board}" if arguments.board else ""
    print(f"written: {out}\n  meissner config show {out}\n  meissner wiring {out}{board} --out wiring.svg")
    if arguments.board:
        print(f"  make synth BOARD={arguments.board} CONFIG={out}")


def _answers(given: Namespace) -> dict[str, Any]:
    """What the options say; the rest is asked on a terminal, and otherwise the usual."""
    asks = sys.stdin.isatty() and sys.stdout.isatty()

    def of(name: str, question: str, usual: Any, kind: type = str) -> Any:
        value = getattr(given, name)
        if value is None and asks:
            try:
                said = input(f"{question} [{usual or 'none'}]: ").strip()
            except EOFError:
                raise ValueError(f"no answer: {question}") from None
            try:
                value = kind(said) if said else usual
            except ValueError:
                raise ValueError(
                    f"{name} = {said!r} must be a {'whole ' if kind is int else ''}number"
                ) from None
        value = usual if value is None else value
        setattr(given, name, value)
        return value

    kinds = ", ".join(f"{kind} ({word})" for kind, word in WORDS.items())
    found = {"sensor": of("sensor", f"sensor: {kinds}", "channels")}
    one_of("sensor", found["sensor"], WORDS)
    if found["sensor"] == "channels":
        found["channels"] = of("channels", "sensors, each on an input of the converter", 1, int)
    else:
        side = 3 if found["sensor"] == "array" else 7
        found |= {name: of(name, f"{name} of taxels", side, int) for name in ("rows", "columns")}
    usual = "AD7606" if found["sensor"] == "electrodes" else "MCP3208"
    found["adc"] = of("adc", f"converter: {', '.join(PARTS)}", usual).upper()
    one_of("adc", found["adc"], PARTS)
    signed = PARTS[found["adc"]].signed
    if found["sensor"] == "array":
        found["converters"] = of("converters", "converters side by side", 1, int)
    found["volts"] = of("volts", "full scale of the converter, volts", 5.0 if signed else 3.3, float)
    found["rate"] = of("rate", "frames a second, or max", "max" if found["sensor"] == "array" else "10000")
    board = found["board"] = of("board", f"board: {', '.join(EVERY)}, or none", None)
    if board is not None:
        one_of("board", board, EVERY)
    for key in ("channels", "rows", "columns", "converters"):
        if getattr(given, key) is not None and key not in found:
            raise ValueError(f"--{key} is not for --sensor {found['sensor']}: omit it")
        if found.get(key, 1) < 1:
            raise ValueError(f"{key} = {found[key]} must be above 0")
    return found


def written_from(found: dict[str, Any], name: str) -> str:
    """The text of a configuration called ``name``; ValueError in one sentence if it cannot be built."""
    board = pins.description(found["board"]) if found["board"] else None
    makes = board.clock["core_mhz"] if board else [24.0]
    small = found["sensor"] == "channels"
    mhz = min(makes) if small else max([each for each in makes if each <= 50] or makes)
    try:
        rate = '"max"' if found["rate"] == "max" else f"{float(found['rate'])}"
    except ValueError:
        raise ValueError(f"rate = {found['rate']!r} must be a number, or max") from None
    few = found["board"] == "icebreaker"  # too few cells for registers
    part = {"channels": _channels, "array": _array, "electrodes": _electrodes}[found["sensor"]]
    clock = f"the {board.name} makes {_or(makes)}" if board else "of the core"
    about, sensor, adc, rest = part(found, few)
    signed = PARTS[found["adc"]].signed
    text = f"""# Written by `meissner config new`; docs/config.md explains every key, `config check` checks.
about = "{about}"

[clock]
mhz = {mhz}                # {clock}

[sensor]
{sensor}
[adc]
part = "{found["adc"]}"
volts = {found["volts"]:g}               # {"the end of the range" if signed else "the reference"}
rate_hz = {rate}          # frames a second; "max": the fastest that converter, scan and line allow
{adc}
{rest}
[link]
baud = {min(3_000_000 if not small else 1_000_000, round(mhz * 250_000))}
registers = {str(not few).lower()}         # a host reads and writes settings while the core runs
"""
    if few and small and found["channels"] == 1:
        text += "statistics = false\nslip_only = true          # the smallest packets: changes of the state\n"
    if found["sensor"] == "array":
        text += "images = true             # beside centre of pressure and load\n"
    text = re.sub(r"(?m)^(\S.*?) +# ", lambda found: f"{found[1]:<25} # ", text)
    made = config.read(name, tomllib.loads(text))
    if board:
        pins.assign(board, name, made.parameters, made.slip_pins)
    return text


def _or(numbers: list[float]) -> str:
    *most, last = (f"{each:g}" for each in numbers)
    return f"{', '.join(most)} or {last}" if most else last


def _channels(found: dict[str, Any], few: bool) -> tuple[str, str, str, str]:
    count, volts = found["channels"], found["volts"]
    serial = few and count == 1 and found["adc"] == "MCP3208"
    return (
        f"{count} rubber sensor{'s' * (count > 1)} on one {found['adc']}",
        f'kind = "channels"\nchannels = {count}              # on inputs 0 and up of the converter\n',
        "",
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
        f"converters = {converters}\n"
        f"channels = {inputs}              # inputs used of each; more columns take turns\n",
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
        "",
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
