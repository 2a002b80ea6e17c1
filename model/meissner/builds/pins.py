"""Assigns a board's pins to a configuration: the lines it needs, their pins, the ports and the pin map.

    plan = assign(description("ulx3s"), "mine", config.parameters)    ValueError: what does not fit
    plan.ports, plan.rows()                                           ports with their pins; the pin map

A board's description is constraints/<board>.toml. The lines that a configuration needs are assigned to the
pins that the board prefers for them, then to free pins in the order of its headers; each pin is used once.
"""

import json
import tomllib
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from meissner.builds.toolchain import ROOT
from meissner.twins.frontend.adc_spi import PARTS

MOST_ROW_LINES = 8  # more rows are output as a binary number (rtl/boards/msn_board.sv)
PULLS = (None, "up", "down", "none")


@dataclass(frozen=True)
class Description:
    """A board's pins. ``leds``: {port: {"pin": its pin, "shows": an expression of the top's signals}};
    ``headers``: {label: pin}, in the order of assignment; ``prefer``: {role: labels}; ``onboard``: lines of
    its own converter; ``sdram``: {line of rtl/forest/msn_sdram.sv: pin, or pins from bit 0 on};
    ``pulls``: {role: pull}; ``inverted``: inputs that idle high on this board; ``usb``: how it is loaded and
    where its serial line appears; ``power``: {supply: where it is}.
    """

    name: str
    source: str
    clock: dict[str, Any]
    serial: dict[str, str]
    leds: dict[str, dict[str, str]]
    headers: dict[str, str]
    prefer: dict[str, list[str]]
    pulls: dict[str, str]
    usb: dict[str, Any]
    power: dict[str, str]
    onboard: dict[str, Any] = field(default_factory=dict)
    sdram: dict[str, Any] = field(default_factory=dict)
    inverted: tuple[str, ...] = ()


@cache
def description(name: str) -> Description:
    """The Description in constraints/<name>.toml; ValueError for a duplicate pin or a preferred pin that does
    not exist."""
    found = tomllib.loads((ROOT / f"constraints/{name}.toml").read_text("utf-8"))
    headers = {
        f"{header} {label}": pin for header, pins in found["headers"].items() for label, pin in pins.items()
    }
    own = [found["clock"]["pin"], *found["serial"].values(), *(led["pin"] for led in found["leds"].values())]
    own += [pin for pin in found.get("onboard", {}).values() if isinstance(pin, str)]
    for lines in found.get("sdram", {}).values():
        own += [lines] if isinstance(lines, str) else lines
    given = [*own, *headers.values()]
    if len(set(given)) < len(given):
        twice = next(pin for pin in given if given.count(pin) > 1)
        raise ValueError(f"constraints/{name}.toml: the pin {twice} is listed twice")
    for role, labels in found["prefer"].items():
        for label in labels:
            if label not in headers:
                raise ValueError(
                    f"constraints/{name}.toml: {role} prefers '{label}', which is not on any header"
                )
    for role, pull in found["pulls"].items():
        if pull not in PULLS:
            raise ValueError(f"constraints/{name}.toml: the pull of {role} must be up, down or none")
    return Description(name, headers=headers, **{k: v for k, v in found.items() if k != "headers"})


@dataclass(frozen=True)
class Need:
    """``count`` lines of one kind: ``port`` of the board's top, and the purpose of each line by number."""

    role: str
    port: str
    count: int
    what: tuple[str, ...]

    @property
    def is_input(self) -> bool:
        return self.port.endswith("_i")


@dataclass(frozen=True)
class Port:
    """A port of the top. ``pins``: its pins, lowest bit first; ``at``: the location of each; ``idle``: the
    constant level of an unused port, None if it is in use."""

    role: str
    port: str
    pins: tuple[str, ...]
    at: tuple[str, ...]
    what: tuple[str, ...]
    pull: str | None = None
    idle: int | None = None

    @property
    def is_input(self) -> bool:
        return self.port.endswith("_i")

    @property
    def direction(self) -> str:
        return "in" if self.is_input else "inout" if self.port.endswith("_io") else "out"

    @property
    def bits(self) -> list[tuple[str, str]]:
        """(name of the bit for place and route, its pin)."""
        if len(self.pins) == 1:
            return [(self.port, self.pins[0])]
        return [(f"{self.port}[{k}]", pin) for k, pin in enumerate(self.pins)]


@dataclass(frozen=True)
class Plan:
    """The ports of a board's top for one configuration; ``columns``: of an array, by converter, in words."""

    board: Description
    config: str
    ports: tuple[Port, ...]
    columns: tuple[str, ...] = ()

    @property
    def roles(self) -> dict[str, Port]:
        return {port.role: port for port in self.ports if port.idle is None}

    @property
    def taken(self) -> int:
        """The number of header pins in use."""
        free = set(self.board.headers.values())
        return sum(pin in free for port in self.ports for pin in port.pins)

    def rows(self) -> list[dict[str, str | None]]:
        """The pin map, one dict per pin."""
        return [
            {
                "port": name,
                "pin": pin,
                "at": port.at[k],
                "direction": port.direction,
                "pull": port.pull,
                "what": port.what[k],
            }
            for port in self.ports
            for k, (name, pin) in enumerate(port.bits)
        ]

    def text(self) -> str:
        """The pin map as a table."""
        rows = self.rows()
        head: dict[str, str | None] = {
            "port": "port",
            "pin": "pin",
            "at": "where",
            "direction": "",
            "pull": "pull",
            "what": "what",
        }
        keys = ("port", "pin", "at", "direction", "pull")
        width = {key: max(len(str(row[key] or "-")) for row in [head, *rows]) for key in keys}
        lines = [
            "  ".join(f"{row[key] or '-':<{width[key]}}" for key in keys) + f"  {row['what']}"
            for row in [head | {"direction": "way"}, *rows]
        ]
        there = len(self.board.headers)
        title = f"pins of {self.config} on the {self.board.name}: {self.taken} of the headers' {there}"
        return "\n".join([title, *lines, *self.columns]) + "\n"

    def json(self) -> str:
        found = {"board": self.board.name, "config": self.config, "source": self.board.source}
        return json.dumps(found | {"pins": self.rows()}, indent=1, ensure_ascii=False) + "\n"


def row_pins(parameters: dict[str, int]) -> int:
    """Number of lines for the rows: one each, or the bits of a number and an enable above them."""
    rows = parameters.get("Rows", 1)
    return rows if rows <= MOST_ROW_LINES else (rows - 1).bit_length() + 1


def _inputs(parameters: dict[str, int]) -> int:
    """Inputs used of each converter."""
    return 1 if parameters.get("Demod") else parameters.get("AdcChannels", 8)


def groups(parameters: dict[str, int]) -> int:
    """Number of groups of columns that the multiplexers upstream of the converters select from."""
    return -(-parameters.get("Columns", 1) // (parameters.get("Converters", 1) * _inputs(parameters)))


def places(parameters: dict[str, int]) -> list[list[list[int | None]]]:
    """The column on each input of each converter of an array [converter][group][input], None: no column
    (docs/scan.md)."""
    converters, inputs = parameters.get("Converters", 1), _inputs(parameters)
    return [
        [
            [
                n if (n := (group * inputs + channel) * converters + k) < parameters["Columns"] else None
                for channel in range(inputs)
            ]
            for group in range(groups(parameters))
        ]
        for k in range(converters if parameters.get("Array") else 0)
    ]


def columns(parameters: dict[str, int]) -> list[str]:
    """A line for each converter of an array: the columns on its inputs, group by group."""
    lines = []
    for k, read in enumerate(places(parameters)):
        told = " | ".join(" ".join("-" if n is None else str(n) for n in group) for group in read)
        lines.append(f"converter {k}, inputs 0 to {len(read[0]) - 1}: columns {told}")
    return lines


def needs(board: Description, parameters: dict[str, int], slip_pins: int = 0) -> list[Need]:
    """The lines of a configuration but those wired on the board; ``slip_pins``: channels with a pin each."""
    moving = Need("moving", "moving_i", 1, ("high while the actuator moves",))
    if "moving" in board.inverted:
        moving = Need("moving", "moving_n_i", 1, ("low while the actuator moves",))
    pulses = [Need("pwm", "pwm_o", 1, ("pulses for the hand",))] if parameters.get("Grip") else []
    slips = tuple(f"high while channel {k} slips" for k in range(slip_pins))
    each = [Need("slip_each", "slip_each_o", slip_pins, slips)] if slip_pins else []
    return [*_lines(parameters), moving, *pulses, *each, *_display(parameters)]


def _display(parameters: dict[str, int]) -> list[Need]:
    """The lines of a tactile display's drivers; all chains share all but the data."""
    if not parameters.get("Display"):
        return []
    chains = parameters["PinChains"]
    data = tuple(f"DIOA of the first driver of chain {k}" for k in range(chains))
    rest = {
        "clk": "CLK",
        "le": "LE",
        "bl": "BL, with a pull-down",
        "pol": "POL, with a pull-up",
        "dir": "DIR",
    }
    lines = [
        Need(f"hv_{name}", f"hv_{name}_o", 1, (f"{what}, of all drivers",)) for name, what in rest.items()
    ]
    return [Need("hv_data", "hv_data_o", chains, data), *lines]


def _lines(parameters: dict[str, int]) -> list[Need]:
    """The lines of the sensor."""
    if not parameters["Adc"]:
        return []
    part = PARTS[parameters["Adc"]]
    converters, lanes = parameters.get("Converters", 1), parameters.get("AdcLanes", 1)
    every = "the converter" if converters == 1 else f"all {converters} converters"
    of = [every] if converters == 1 else [f"converter {k}" for k in range(converters)]
    found = [
        Need("cs_n", "adc_cs_n_o", 1, (f"CS of {every}",)),
        Need("sclk", "adc_sclk_o", 1, (f"SCLK of {every}",)),
    ]
    if part.has_busy:
        found += [
            Need("convst", "adc_convst_o", 1, (f"CONVST of {every}",)),
            Need("reset", "adc_reset_o", 1, (f"RESET of {every}",)),
            Need("busy", "adc_busy_i", converters, tuple(f"BUSY of {name}" for name in of)),
        ]
        outputs = [f"DOUT{lane} of {name}" for name in of for lane in "ABCDEFGH"[:lanes]]
    else:
        outputs = [f"DOUT of {name}" for name in of]
    if part.cs_per_channel:
        found += [Need("mosi", "adc_mosi_o", 1, (f"DIN of {every}",))]
    found += [Need("miso", "adc_miso_i", converters * lanes, tuple(outputs))]
    if parameters.get("Array"):
        rows, lines = parameters["Rows"], row_pins(parameters)
        if rows <= MOST_ROW_LINES:
            drives: tuple[str, ...] = tuple(f"row {k}" for k in range(rows))
        else:
            number = [f"bit {k} of the row's number" for k in range(lines - 1)]
            drives = (*number, "low while a row is driven")
        found += [Need("row", "row_o", lines, drives)]
        if groups(parameters) > 1:
            bits = (groups(parameters) - 1).bit_length()
            shown = tuple(f"bit {k} of the number of the group of columns" for k in range(bits))
            found += [Need("group", "group_o", bits, shown)]
    return found


# Levels that are output if a pin is left for them.
SHOWN = (
    Need("slip", "slip_o", 1, ("high while anything slips",)),
    Need("gross", "gross_o", 1, ("high while anything slips wholly",)),
)


def _onboard(board: Description, parameters: dict[str, int]) -> bool:
    """Whether the configuration reads the board's own converter."""
    part = PARTS[parameters["Adc"]].name.upper() if parameters["Adc"] else ""
    return part in board.onboard.get("parts", ()) and parameters.get("Converters", 1) == 1


def _own(role: str, port: str, pin: str, what: str, **more: Any) -> Port:
    """A port whose pin is wired on the board."""
    return Port(role, port, (pin,), ("on the board",), (what,), **more)


def _fixed(board: Description, used: bool, sdram: bool) -> list[Port]:
    """Ports of every configuration; ``used``: the board's own converter is in use; ``sdram``: its SDRAM."""
    clock, serial = board.clock, board.serial
    ports = [
        _own("clock", clock["port"], clock["pin"], f"{clock['mhz']:g} MHz", pull=clock.get("pull")),
        _own("rx", "rx_i", serial["rx"], "serial line in", pull=board.pulls.get("rx")),
        _own("tx", "tx_o", serial["tx"], "serial line out"),
    ]
    ports += [_own("led", name, led["pin"], f"LED: {led['shows']}") for name, led in board.leds.items()]
    for line, pins in board.sdram.items() if sdram else ():
        every = (pins,) if isinstance(pins, str) else tuple(pins)
        told = ("on the board",) * len(every), (f"{line} of the SDRAM",) * len(every)
        ports.append(Port(f"sdram_{line}", f"sdram_{line}_{'io' if line == 'dq' else 'o'}", every, *told))
    for role, level in ({} if used else board.onboard.get("idle", {})).items():
        what = f"{role} of the board's own converter, which rests"
        ports.append(_own(role, f"onboard_{role}_o", board.onboard[role], what, idle=level))
    return ports


def assign(board: Description, config: str, parameters: dict[str, int], slip_pins: int = 0) -> Plan:
    """The pins of a configuration; ValueError that names what is missing: lines without a pin, or the clock.

    Parameters
    ----------
    board : Description
        The board's pins.
    config : str
        The configuration's name, for sentences and files.
    parameters : dict of str to int
        Parameters of rtl/msn_core.sv.
    slip_pins : int
        Channels whose slip gets a pin of its own.

    Returns
    -------
    Plan
        Every port of the board's top with its pins.
    """
    mhz = parameters["ClkKhz"] / 1000
    if mhz not in board.clock["core_mhz"]:
        made = " or ".join(f"{value:g}" for value in board.clock["core_mhz"])
        raise ValueError(f"the {board.name} can clock the core at {made} MHz but {config} needs {mhz:g} MHz")
    own = _onboard(board, parameters)
    sdram = bool(parameters.get("ForestSdram"))
    if sdram and not board.sdram:
        raise ValueError(f"{config} has a forest in an SDRAM but the {board.name} has none that is described")
    ports, wanted = _fixed(board, own, sdram), needs(board, parameters, slip_pins)
    got: dict[Need, list[str]] = {}
    used: set[str] = set()
    for need in list(wanted):
        if own and need.role in board.onboard:
            pin, what = board.onboard[need.role], need.what[0]
            ports.append(_own(need.role, need.port, pin, what, pull=_pull(board, need)))
            wanted.remove(need)
    for need in wanted:  # preferred pins first, then the others
        chosen = [label for label in board.prefer.get(need.role, ()) if label not in used][: need.count]
        used.update(chosen)
        got[need] = chosen
    left = [label for label in board.headers if label not in used]
    missing = []
    for need in wanted:
        while len(got[need]) < need.count and left:
            got[need].append(left.pop(0))
        missing += [f"{need.port} ({what})" for what in need.what[len(got[need]) :]]
    if missing:
        total = ", ".join(f"{need.count} {need.port}" for need in wanted)
        raise ValueError(
            f"{config} needs {sum(need.count for need in wanted)} header pins ({total}) but the {board.name} "
            f"has only {len(board.headers)}; lines without a pin: {', '.join(missing)}"
        )
    shown = {need: [at] for need in SHOWN for at in board.prefer.get(need.role, ()) if at in left}
    left = [at for at in left if [at] not in shown.values()]
    got |= {need: shown.get(need) or [left.pop(0)] for need in SHOWN if need in shown or left}
    for need, labels in got.items():
        pins = tuple(board.headers[label] for label in labels)
        ports.append(Port(need.role, need.port, pins, tuple(labels), need.what, _pull(board, need)))
    return Plan(board, config, tuple(ports), tuple(columns(parameters)))


def _pull(board: Description, need: Need) -> str | None:
    return board.pulls.get(need.role) if need.is_input else None
