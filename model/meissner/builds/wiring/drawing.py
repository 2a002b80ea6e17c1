"""The wiring of a configuration on a board, as an SVG drawing.

    svg(board, "fingertip")      every port of the board's top is a row of its table, as in the constraints

From left to right: the sensor, what stands before each input, the converters with the numbers of their pins,
the board's pins as a table. A wire is straight; a line that several converters share is a vertical one with a
dot at each of them. What repeats is drawn once, below.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from meissner.builds import pins
from meissner.builds.boards import Board, label
from meissner.builds.build import Config
from meissner.builds.keys import Electrodes
from meissner.builds.wiring.chips import chip
from meissner.builds.wiring.sheet import PITCH, SIZE, SMALL, WIDTH, Sheet

SHARED = ("cs_n", "sclk", "mosi", "convst", "reset")  # lines of all converters
IO_V = 3.3  # of every board's pins
CHANNEL_ROWS = 7  # the height of a channel's divider
CHIP, SENSOR, MUX, SHIFTER = 3.6, 3.4, 2.4, 1.9  # widths, of sensor and multiplexers at least
LISTED = 6  # columns in turn at an input, above which those between are left out
READOUTS = ("amplifier", "resistor")


@dataclass(frozen=True)
class _Row:
    """A bit of a port: a row of the board's table."""

    role: str
    net: str
    pin: str
    at: str
    what: str


def _rows(plan: pins.Plan) -> dict[str, list[_Row]]:
    """{role: its bits}."""
    found: dict[str, list[_Row]] = {}
    for port in plan.ports:
        for k, (net, pin) in enumerate(port.bits):
            role = f"{port.role}, rests" if port.idle is not None else port.role
            found.setdefault(role, []).append(_Row(port.role, net, pin, port.at[k], port.what[k]))
    return found


@dataclass(frozen=True)
class _Inputs:
    """One input of a converter: its number there, and what it reads."""

    number: int
    reads: str


def _turns(group: Sequence[int | None]) -> str:
    """The columns that an input reads in turn; they rise in equal steps."""
    texts = ["-" if n is None else str(n) for n in group]
    return " | ".join(texts if len(texts) <= LISTED else [*texts[:3], "...", *texts[-2:]])


def _inputs(build: Config) -> list[list[_Inputs]]:
    """The inputs in use of each converter."""
    if build.array:
        word = "column" if pins.groups(build.parameters) == 1 else "columns"
        return [
            [
                _Inputs(k, f"{word} {_turns(group)}")
                for k, group in enumerate(zip(*groups))
                if any(n is not None for n in group)
            ]
            for groups in pins.places(build.parameters)
        ]
    if isinstance(build.sensor, Electrodes):
        return [[_Inputs(k, f"E{k + 1}") for k in range(4)]]
    return [[_Inputs(k, str(k)) for k in range(build.channels)]] if build.kind == "channels" else []


class _Drawing:
    """The columns of the sheet, from the board's left edge at 0 to the left; then what is in them."""

    def __init__(self, board: Board, name: str, volts: float | None, readout: str) -> None:
        self.board, self.build, self.plan = board, board.config(name), board.plan(name)
        self.readout, self.chip = readout, chip(self.build.part)
        own = self.plan.board.onboard
        self.onboard = own.get("inputs", ()) if "cs_n" in own and self._is_onboard() else ()
        self.two_supplies = self.build.part.has_busy
        usual = self.build.adc.volts if self.two_supplies else min(self.build.adc.volts, IO_V)
        self.volts = usual if volts is None else volts
        self.shifted = not self.two_supplies and self.volts > IO_V + 0.3
        self.rows, self.inputs = _rows(self.plan), _inputs(self.build)
        self.converters = len(self.inputs)
        self.lanes = self.build.adc.lanes
        self.shared = [role for role in SHARED if role in self.rows]
        self.sheet = Sheet()
        self.title = f"Wiring of {label(name)} on the {board.title}"
        buses = 0.4 * len(self.shared) if self.converters > 1 else 0.0
        self.chip_right = -1.2 - buses - (SHIFTER + 0.9 if self.shifted else 0.0)
        self.chip_left = self.chip_right - CHIP
        self.front = self.chip_left - 1.5  # the right end of what stands before the inputs
        longest = max((len(one.reads) for each in self.inputs for one in each), default=0)
        self.mux_wide = max(MUX, SMALL / SIZE * WIDTH * longest)
        self.mux = self.front - self.mux_wide - 0.3 if "group" in self.rows else None
        self.front = self.front if self.mux is None else self.mux - 0.3
        self.sensor_right = self.front - 1.0
        self.sensor_left = self.sensor_right - max(SENSOR, WIDTH * longest + 0.3)
        self.used: set[str] = set()

    def _is_onboard(self) -> bool:
        return "cs_n" in self.plan.roles and self.plan.roles["cs_n"].at == ("on the board",)

    # What is drawn

    def draw(self) -> bytes:
        sheet, top = self.sheet, 0.0
        self.table: list[tuple[float, _Row]] = []
        self.column_places: list[float] = []
        buses: dict[str, list[float]] = {role: [] for role in self.shared}
        y = -2.5 * PITCH
        for k in range(self.converters):
            y = self._converter(k, y, buses) - 1.5 * PITCH
        self._buses(buses)
        y = self._groups(y)
        y = self._sensor_rows(y)
        y = self._rest(y)
        self._board(top, y)
        if self.column_places:
            self._sensor()
        x = self.chip_left - 4.5 if self._channels else self.sensor_left
        x = x if self.inputs else -1.0
        sheet.text((x, 1.6), self.title, size=SIZE + 4)
        y = self._details(x, y - 2 * PITCH)
        for k, note in enumerate(self._notes()):
            sheet.text((x, y - k * 0.75 * PITCH), note, size=SMALL + 1)
        return sheet.svg(self.title)

    def _converter(self, k: int, top: float, buses: dict[str, list[float]]) -> float:
        """Converter ``k`` with its wires, from ``top`` down; returns the lowest place that it takes."""
        sheet, left, right = self.sheet, self.chip_left, self.chip_right
        lines = [(role, self.chip.lines[role], 0) for role in self.shared]
        lines += [("busy", self.chip.lines["busy"], k)] if "busy" in self.rows else []
        lines += [("miso", self.chip.lanes[j], k * self.lanes + j) for j in range(self.lanes)]
        pitch = PITCH * (1 if not self._channels else CHANNEL_ROWS)
        count = len(self.inputs[k])
        height = max(len(lines) * PITCH, count * pitch)
        low = top - height - 0.5 * PITCH
        sheet.box((left, low), (right, top + 0.5 * PITCH), dashed=bool(self.onboard))
        number = f" {k}" if self.converters > 1 else ""
        where = ", on the board" if self.onboard else f", {self.chip.package}"
        sheet.text(
            (left, top + 0.6 * PITCH),
            f"{self.build.part.name.upper()}{number}{where}",
            size=SMALL + 1,
            up=True,
        )
        for place, (role, (name, pin), bit) in enumerate(lines):
            y = top - place * PITCH
            sheet.text((right - 0.12, y), name, "right")
            if pin and not self.onboard:
                sheet.text((right + 0.1, y + 0.03), pin, size=SMALL, up=True)
            self._line(role, bit, k, y, buses)
        start = top - 0.5 * (height - (count - 1) * pitch) if self._channels else top
        for place, one in enumerate(self.inputs[k]):
            y = start - place * pitch
            name, pin = self.chip.inputs[one.number]
            at = self.onboard[one.number] if self.onboard else pin
            sheet.text((left + 0.12, y), name)
            sheet.text((left - 0.1, y + 0.03), at, "right", size=SMALL, up=True)
            self._input(one, y)
        return low

    @property
    def _channels(self) -> bool:
        return self.build.kind == "channels"

    def _line(self, role: str, bit: int, k: int, y: float, buses: dict[str, list[float]]) -> None:
        """The wire of a line from converter ``k`` to the board's row, or to the vertical line."""
        right = self.chip_right
        if self.shifted:
            middle = right + 0.9
            self.sheet.line((right, y), (middle, y))
            ends = f"{IO_V:g} V", self._supply
            text = " to ".join(ends if role != "miso" else ends[::-1])
            self.sheet.box((middle, y - 0.22), (middle + SHIFTER, y + 0.22))
            self.sheet.text((middle + SHIFTER / 2, y), text, "center", size=SMALL)
            right = middle + SHIFTER
        if role in self.shared and self.converters > 1:
            x = self._bus(self.shared.index(role))
            self.sheet.line((right, y), (0.0 if k == 0 else x, y))
            self.sheet.dot((x, y))
            buses[role].append(y)
        else:
            self.sheet.line((right, y), (0.0, y))
        if role not in self.shared or k == 0:
            self._row(self.rows[role][bit], y)

    def _bus(self, place: int) -> float:
        """Where the vertical line of the shared line ``place`` is, right of the numbers of the pins."""
        return -0.5 - 0.4 * (len(self.shared) - 1 - place)

    def _buses(self, buses: dict[str, list[float]]) -> None:
        for place, ys in enumerate(buses.values()):
            if len(ys) > 1:
                x = self._bus(place)
                self.sheet.line((x, max(ys)), (x, min(ys)))

    def _row(self, row: _Row, y: float) -> None:
        self.table.append((y, row))
        self.used.add(row.net)

    def _input(self, one: _Inputs, y: float) -> None:
        """What stands before an input, and the wire from the sensor."""
        sheet, left = self.sheet, self.chip_left
        if self._channels:
            self._divider(one, y)
            return
        if self.mux is not None:
            sheet.line((self.mux + self.mux_wide, y), (left, y))
            sheet.text((self.mux + self.mux_wide / 2, y), one.reads.partition(" ")[2], "center", size=SMALL)
            right = self.mux
        else:
            right = left
        at = self.front - 0.5
        sheet.line((self.sensor_right, y), (at, y))
        sheet.line((at + 0.45, y), (right, y))
        if self.readout == "resistor" and self.build.array:
            sheet.box((at, y - 0.18), (at + 0.45, y + 0.18))
            sheet.text((at + 0.225, y), "R", "center", size=SMALL)
        else:
            sheet.amplifier((at, y))
        sheet.text((self.sensor_right - 0.12, y), one.reads, "right")
        self.column_places.append(y)

    def _divider(self, one: _Inputs, y: float) -> None:
        sheet, x = self.sheet, self.chip_left - 2.0
        sheet.line((x, y), (self.chip_left, y))
        sheet.dot((x, y))
        top, low = (x, y + 1.15), (x, y - 1.15)
        wiring = self.build.wiring
        kind = "rubber" if wiring == "pulled_up" else "sensor"
        sensor, fixed = f"{kind} {one.reads}", "1 kΩ" if wiring == "pulled_up" else "R"
        if wiring == "differential":
            sheet.text((x - 0.15, y), f"bridge and amplifier {one.reads}", "right")
            return
        upper, lower = (fixed, sensor) if wiring == "pulled_up" else (sensor, fixed)
        for a, b, text in ((top, (x, y), upper), ((x, y), low, lower)):
            varies = text == sensor
            sheet.part("ResistorVarIEC" if varies else "ResistorIEC", a, b, text)
        sheet.supply(top, self._supply)
        sheet.ground(low)

    @property
    def _supply(self) -> str:
        return f"{self.volts:g} V"

    def _groups(self, y: float) -> float:
        """The lines that select a group of columns, and the box of the multiplexers."""
        if self.mux is None:
            return y
        sheet, right = self.sheet, self.mux + self.mux_wide
        for k, row in enumerate(self.rows["group"]):
            sheet.line((right, y), (0.0, y))
            sheet.text((right - 0.12, y), f"S{k}", "right")
            self._row(row, y)
            y -= PITCH
        top = max(self.column_places) + 0.5 * PITCH
        sheet.box((self.mux, y + 0.5 * PITCH), (right, top))
        sheet.text((self.mux, top + 0.1), "multiplexers", size=SMALL, up=True)
        return y - 0.5 * PITCH

    def _sensor_rows(self, y: float) -> float:
        """The lines of the rows: straight to the sensor, or through decoders."""
        rows = self.rows.get("row", [])
        self.row_places: list[float] = []
        if not rows:
            return y
        sheet, count = self.sheet, self.build.shape[0]
        if count == len(rows):
            for k, row in enumerate(rows):
                sheet.line((self.sensor_right, y), (0.0, y))
                sheet.text((self.sensor_right - 0.12, y), f"row {k}", "right")
                self.row_places.append(y)
                self._row(row, y)
                y -= PITCH
            return y - 0.5 * PITCH
        top, left, right = y, self.chip_left, self.chip_right
        for k, row in enumerate(rows):
            sheet.line((right, y), (0.0, y))
            sheet.text((right - 0.12, y), "E (low: on)" if row is rows[-1] else f"A{k}", "right")
            self._row(row, y)
            y -= PITCH
        sheet.box((left, y + 0.5 * PITCH), (right, top + 0.5 * PITCH))
        sheet.text((left, top + 0.6 * PITCH), f"row decoder, 1 of {count}", size=SMALL + 1, up=True)
        middle = (top + y) / 2 + PITCH / 2
        sheet.line((self.sensor_right, middle), (left, middle), bold=True)
        sheet.text((self.sensor_right - 0.12, middle), f"rows 0 to {count - 1}", "right")
        self.row_places.append(middle)
        return y - 0.5 * PITCH

    def _rest(self, y: float) -> float:
        """The headers' other pins with an open end, then what is wired on the board, then the supply."""
        every = [row for rows in self.rows.values() for row in rows if row.net not in self.used]
        for row in sorted(every, key=lambda row: row.at == "on the board"):
            if row.at != "on the board":
                self.sheet.line((-0.6, y), (0.0, y))
                self.sheet.dot((-0.67, y), is_open=True)
            self._row(row, y)
            y -= PITCH
        for what, at in self.plan.board.power.items() if self.inputs else ():
            fed = "of the sensor" if self.onboard else f"of the converter: {self.chip.fed}"
            of = "of converter and sensor" if what == "GND" else fed
            self._row(_Row("power", what, "", at, of), y)
            y -= PITCH
        return y

    def _board(self, top: float, low: float) -> None:
        """The board's table; the width of a column is that of its longest text."""
        columns = ("at", "pin", "net", "what")
        head = {"at": "header", "pin": "FPGA", "net": "net", "what": "signal"}
        x, sheet = 0.15, self.sheet
        for key in columns:
            texts = [head[key], *(getattr(row, key) for _, row in self.table)]
            sheet.text((x, top - PITCH), head[key], size=SMALL)
            for y, row in self.table:
                if getattr(row, key):
                    sheet.text((x, y), getattr(row, key))
            x += WIDTH * max(map(len, texts)) + 0.35
        sheet.box((0.0, low), (x, top))
        sheet.text((0.15, top + 0.1), self.board.title, size=SMALL + 2, up=True)

    def _sensor(self) -> None:
        """The box of a scanned sensor, with its columns' ends above those of its rows."""
        sheet, places = self.sheet, self.column_places + self.row_places
        top, low = max(places) + 0.8 * PITCH, min(places) - 0.8 * PITCH
        left, size = self.sensor_left, " × ".join(map(str, self.build.shape))
        sheet.box((left, low), (self.sensor_right, top))
        sheet.text(
            (left, top + 0.1), f"sensor, {size}" if self.build.array else "sensor", size=SMALL + 1, up=True
        )
        if not self.build.array:
            for k, y in enumerate(self.column_places):
                sheet.text((left + 0.12, y), ("left", "top", "right", "bottom")[k], size=SMALL)

    # What repeats, drawn once

    def _details(self, x: float, y: float) -> float:
        """The circuits that stand for a small symbol above; returns the place below them."""
        if isinstance(self.build.sensor, Electrodes):
            self._electrodes(x, y)
            return y - 10.6
        if not self.build.array:
            return y
        self._seen(x, y)
        start = x + 6.0
        below = y if self.mux is None else y - 0.5  # the longer title reaches over the amplifier
        self.sheet.text((start, y), "Each column" + ("" if self.mux is None else ", before its multiplexer"))
        (self._amplifiers if self.readout == "amplifier" else self._resistor)(start, below - 1.6)
        return below - 5.0

    def _seen(self, x: float, y: float) -> None:
        """The numbers of rows and columns, seen from above."""
        sheet = self.sheet
        sheet.text((x, y), "Seen from above")
        left, top, step = x + 0.9, y - 1.4, 0.8
        for across, count, word in (
            (True, self.build.shape[1], "column"),
            (False, self.build.shape[0], "row"),
        ):
            names = [str(k) for k in range(count)] if count <= 4 else ["0", "1", "...", str(count - 1)]
            other = min(self.build.shape[0 if across else 1], 4)
            for k, name in enumerate(names):
                if across:
                    sheet.line(
                        (left + k * step, top + 0.3), (left + k * step, top - (other - 1) * step - 0.3)
                    )
                    sheet.text((left + k * step, top + 0.5), name, "center", size=SMALL)
                else:
                    sheet.line(
                        (left - 0.3, top - k * step), (left + (other - 1) * step + 0.3, top - k * step)
                    )
                    sheet.text((left - 0.4, top - k * step), name, "right", size=SMALL)
            if across:
                sheet.text((left + (len(names) - 1) * step + 0.35, top + 0.5), word, size=SMALL)
            else:
                sheet.text((left - 0.4, top - len(names) * step + 0.3), word, "right", size=SMALL)

    def _cell(self, x: float, y: float) -> float:
        """A cell between a row and its column, which ends at the place returned."""
        self.sheet.text((x, y + 0.1), "row i", up=True)
        self.sheet.line((x, y), (x + 0.8, y))
        self.sheet.part("ResistorVarIEC", (x + 0.8, y), (x + 2.4, y), "cell i, j")
        return x + 2.4

    def _resistor(self, x: float, y: float) -> None:
        end = self._cell(x, y)
        self.sheet.line((end, y), (end + 2.2, y))
        self.sheet.dot((end + 0.8, y))
        self.sheet.text((end + 0.8, y + 0.12), "column j", "center", size=SMALL, up=True)
        self.sheet.part("ResistorIEC", (end + 0.8, y), (end + 0.8, y - 1.4), "R")
        self.sheet.ground((end + 0.8, y - 1.4))
        self.sheet.text((end + 2.3, y), "to the input")

    def _amplifiers(self, x: float, y: float) -> None:
        """The column is held at 0 V; the second amplifier turns the sign."""
        end = self._cell(x, y)
        self.sheet.line((end, y), (end + 1.5, y))
        self.sheet.text((end + 0.45, y + 0.1), "column j", "center", size=SMALL, up=True)
        out = self._stage(end + 1.5, y, "Rf")
        start = (out[0] + 0.4, out[1])
        self.sheet.line(out, start)
        self.sheet.part("ResistorIEC", start, (start[0] + 1.5, start[1]), "10 kΩ")
        end_of = self._stage(start[0] + 1.9, start[1], "10 kΩ", (start[0] + 1.5, start[1]))
        self.sheet.part("ResistorIEC", end_of, (end_of[0] + 1.6, end_of[1]), "1 kΩ")
        self.sheet.text((end_of[0] + 1.7, end_of[1]), "to the input")

    def _stage(
        self, x: float, y: float, feedback: str, start: tuple[float, float] | None = None
    ) -> tuple[float, float]:
        """An inverting amplifier whose inverting input is at (x, y); returns its output."""
        sheet = self.sheet
        if start is not None:
            sheet.line(start, (x, y))
        one = sheet.part("Opamp", (x, y), anchor="in1")
        out, plus = one.out, one.in2
        sheet.line((plus[0], plus[1]), (plus[0] - 0.4, plus[1]))
        sheet.ground((plus[0] - 0.4, plus[1]))
        near, over = (x - 0.3, y), y + 1.1
        sheet.dot(near)
        sheet.line(near, (near[0], over), (near[0] + 0.3, over))
        sheet.part("ResistorIEC", (near[0] + 0.3, over), (out[0] - 0.1, over), feedback)
        sheet.line((out[0] - 0.1, over), (out[0] + 0.2, over), (out[0] + 0.2, out[1]))
        sheet.dot((out[0] + 0.2, out[1]))
        sheet.line(tuple(out), (out[0] + 0.2, out[1]))
        return out[0] + 0.2, out[1]

    def _electrodes(self, x: float, y: float) -> None:
        """E1 and E3 with their resistors and amplifiers; E2 and E4 have the same."""
        sheet, cop4 = self.sheet, self.build.cop4
        assert cop4 is not None
        gain, more, mesh = cop4.gain, cop4.difference_gain, cop4.mesh
        sheet.text((x, y), "E1 and E3; E2 and E4 have the same, at -V0 in place of +V0")
        for number, at, sign in (("1", y - 2.6, 1), ("3", y - 8.0, -1)):
            sheet.text((x, at), f"E{number}")
            sheet.line((x + 0.5, at), (x + 3.0, at))
            sheet.dot((x + 1.6, at))
            sheet.part("ResistorIEC", (x + 1.6, at + 1.4), (x + 1.6, at), f"{mesh.R0:g} Ω")
            sheet.supply((x + 1.6, at + 1.4), f"+{mesh.V0:g} V")
            one = sheet.part("Opamp", (x + 3.0, at), anchor="in2", flip=sign > 0)
            out, minus, right = one.out, one.in1, one.out[0] + 1.2
            near = out[1] - sign * 1.5
            sheet.line((out[0], out[1]), (right + 0.8, out[1]))
            sheet.dot((right, out[1]))
            back = ((minus[0] - 0.3, near), (minus[0] - 0.3, minus[1]), (minus[0], minus[1]))
            if more > 1:
                sheet.part(
                    "ResistorIEC",
                    (right, max(out[1], near)),
                    (right, min(out[1], near)),
                    self._feedback(more),
                )
                sheet.dot((right, near))
                sheet.line((right, near), *back)
            else:
                sheet.line((right, out[1]), (right, near), *back)
            self._scaled(right + 0.8, out[1], gain, f"to {self.chip.inputs[int(number) - 1][0]}")
        if more > 1:  # between both inverting inputs
            sheet.part("ResistorIEC", (right, y - 2.6 - 0.625 - 1.5), (right, y - 8.0 + 0.625 + 1.5), "1 kΩ")

    @staticmethod
    def _feedback(gain: float) -> str:
        """R of g = 1 + 2 R/Rg with Rg = 1 kΩ."""
        return f"{(gain - 1) / 2:g} kΩ"

    def _scaled(self, x: float, y: float, gain: float, text: str) -> None:
        """A divider to ``gain`` times the voltage; a gain above 1 is only named."""
        sheet = self.sheet
        if gain >= 1:
            sheet.text((x + 0.1, y), text if gain == 1 else f"{gain:g} times {text}")
            return
        sheet.part("ResistorIEC", (x, y), (x + 1.7, y), f"{10 * (1 - gain):g} kΩ")
        sheet.line((x + 1.7, y), (x + 2.3, y))
        sheet.dot((x + 1.7, y))
        sheet.part("ResistorIEC", (x + 1.7, y), (x + 1.7, y - 1.3), f"{10 * gain:g} kΩ")
        sheet.ground((x + 1.7, y - 1.3))
        sheet.text((x + 2.4, y), text)

    def _notes(self) -> Iterator[str]:
        """What the drawing does not show."""
        part, build = self.build.part.name.upper(), self.build
        if not self.inputs:
            yield "No sensor: a host writes what the core computes with. Open ends may stay open."
            return
        if self.onboard:
            yield f"{part}: on the {self.board.name}, its reference {IO_V:g} V; only the sensor is wired."
        else:
            low = "low (±5 V)" if build.adc.volts <= 5 else "high (±10 V)"
            for tie in self.chip.ties:
                yield f"{part}: " + tie.format(volts=self._supply, io=f"{IO_V:g} V", range=low)
        if self.chip.unverified and not self.onboard:
            yield f"Pin numbers from memory, check them against the data sheet: {self.chip.unverified}."
        if not self.two_supplies and self.volts != build.adc.volts:
            share = self.volts / build.adc.volts
            yield (
                f"Drawn at {self._supply}, the file says {build.adc.volts:g} V: a code is a share of it, "
                f"so the bitstream is the same; 1 V of the file is then {share:.2g} V."
            )
        if self.shifted:
            yield f"Level shifters: 74AHCT125 at {self._supply} up, 74LVC125 at {IO_V:g} V back."
        if self._channels and build.wiring == "pulled_down":
            yield "R: as large as the sensor under a middle force."
        if build.array:
            yield "A row that is not driven is grounded: no current returns through other rows (docs/fsr.md)."
            if self.readout == "amplifier":
                yield (
                    "Amplifiers: ±5 V. Rf: full scale at the largest force, 1 kΩ for FSR400, 12 kΩ "
                    "for Velostat."
                )
            else:
                yield "R: 1 kΩ for FSR400. Only for a few rows: pressed cells of a column load each other."
        if build.array and len(self.rows["row"]) != build.shape[0]:
            yield (
                "Row decoder: outputs low while E is high, as 74HC4514; a pull-up at E until the FPGA is "
                "configured; drivers for the rows' current."
            )
        if self.mux is not None:
            yield "Multiplexers: one for each input, an analogue switch such as 74HC4052 or 74HC4051."
        if build.cop4:
            yield f"Amplifiers: supplies beyond ±{build.cop4.mesh.V0:g} V, such as ±18 V."
        if "display" in build.features:
            yield (
                "Pins' drivers: 5 V logic behind a buffer with TTL inputs; BL to ground and POL up by "
                "resistors; the high voltage last (docs/pin_display.md)."
            )
        yield "Lines that cross without a dot are apart. Open ends go where the signal says, if at all."


def svg(board: Board, name: str, volts: float | None = None, readout: str = "amplifier") -> bytes:
    """The drawing of a configuration, a name or a TOML file, on a board.

    Parameters
    ----------
    volts : float, optional
        Supply of a converter with one supply: 3.3 V, that of the board's pins, unless it is given. Above it
        level shifters are drawn.
    readout : str
        What each column of an array ends in: an "amplifier" that holds it at 0 V, or a "resistor" to ground.
    """
    if readout not in READOUTS:
        raise ValueError(f"readout = {readout!r} must be one of {', '.join(READOUTS)}")
    return _Drawing(board, name, volts, readout).draw()
