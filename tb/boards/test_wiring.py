"""The wiring drawings, read as a person reads them: by the places of lines and text in the SVG alone.

Every net of the constraints that place and route gets stands in a row of the board's table with its pin.
From each pin of a converter a wire leads to the row of the net that the data sheet's name asks for; the
columns and rows of an array arrive at the input and the line that docs/scan.md says.
"""

import re
from collections import defaultdict
from functools import cached_property
from itertools import pairwise
from xml.etree import ElementTree

import pytest

from boards import users
from boards.test_pin_plan import located
from meissner import cli
from meissner.builds import board_files, boards
from meissner.builds.toolchain import ROOT
from meissner.builds.wiring.drawing import svg

EVERY = {**boards.BOARDS, boards.ARTY.name: boards.ARTY}
SPACE = "{http://www.w3.org/2000/svg}"
NEAR = 0.2  # of a point
# Numbers of the pins by their data sheets, and the port of each; {}: the converter's bit of it.
MCP3208 = {"10": "adc_cs_n_o", "13": "adc_sclk_o", "11": "adc_mosi_o", "12": "adc_miso_i{}"}
AD7606 = {
    "13": "adc_cs_n_o", "12": "adc_sclk_o", "9, 10": "adc_convst_o", "11": "adc_reset_o",
    "14": "adc_busy_i{}",    "24": "adc_miso_i{}",
}  # fmt: skip
MAX11131 = {"20": "adc_cs_n_o", "19": "adc_sclk_o", "21": "adc_mosi_o", "24": "adc_miso_i{}"}
PAIRS = [(board, name) for board, name in boards.pairs()]
USERS = [("ulx3s", name) for name in users.USERS] + [("icebreaker", "two"), ("arty_a7", "lanes")]


NOTHING = """
about = "a forest for rows from a host"
[clock]
mhz = 25.0
[sensor]
kind = "none"
[forest]
source = "host"
features = 4
classes = 2
trees = 3
nodes = 50
leaves = 60
bits = 13
"""


class Seen:
    """``texts``: [(x, y, text)]; ``joined(a, b)``: whether lines lead from one place to the other."""

    def __init__(self, data):
        root = ElementTree.fromstring(data)
        assert root.find(f"{SPACE}title").text
        self.texts = []
        for text in root.iter(f"{SPACE}text"):
            [line] = text
            self.texts.append((float(text.get("x")), float(text.get("y")) + float(line.get("dy")), line.text))
        self.lines = []
        for path in root.iter(f"{SPACE}path"):
            for part in path.get("d").split("M")[1:]:
                numbers = [float(n) for n in re.findall(r"-?[\d.]+(?:e-?\d+)?", part)]
                places = list(zip(numbers[::2], numbers[1::2]))
                if max(abs(p - q) for p, q in zip(places[0], places[-1])) > NEAR:  # else the outline of a box
                    self.lines += [*pairwise(places)]

    def find(self, words):
        return [(x, y) for x, y, text in self.texts if text == words]

    @cached_property
    def nets(self):
        """The ends of joined lines, net by net: lines join where one ends on the other."""
        of = list(range(len(self.lines)))

        def root(k):
            while of[k] != k:
                k = of[k]
            return k

        for k, one in enumerate(self.lines):
            for j, other in enumerate(self.lines[:k]):
                if any(on(end, *other) for end in one) or any(on(end, *one) for end in other):
                    of[root(k)] = root(j)
        found = defaultdict(list)
        for k, line in enumerate(self.lines):
            found[root(k)] += line
        return [*found.values()]

    def reached(self, place):
        """The ends of all lines that are joined to one that ends at ``place``."""
        [found] = [net for net in self.nets if place in net]
        return found


def on(place, a, b):
    """Whether a place lies on the line from a to b, which is vertical or horizontal."""
    return all(min(p, q) - NEAR <= r <= max(p, q) + NEAR for p, q, r in zip(a, b, place))


def table(seen, plan):
    """{net: (pin, y)} of the rows of the board's table, by text at the same height."""
    heights = defaultdict(dict)
    for x, y, text in seen.texts:
        if x > 0:
            heights[round(y, 1)][x] = text
    nets = {net for net, _ in plan}
    return {text: ([*row.values()], y) for y, row in heights.items() for text in row.values() if text in nets}


def constrained(board, name):
    """[(net, pin)] of the file that place and route reads."""
    suffix = board.constraints
    return located(board_files.constraints(board.plan(name), suffix), suffix)


def drawn(board, name, **more):
    nets = constrained(board, name)
    seen = Seen(svg(board, name, **more))
    return seen, nets, table(seen, nets)


@pytest.mark.parametrize("board, name", PAIRS, ids=[f"{board.name}-{name}" for board, name in PAIRS])
def test_every_net_of_the_constraints_is_on_the_drawing_with_its_pin(board, name):
    _, nets, rows = drawn(board, name)
    assert len(nets) > 5
    for net, pin in nets:
        assert pin in rows[net][0], net


@pytest.mark.parametrize("board, name", USERS)
def test_a_users_configuration_is_drawn_whole(board, name, tmp_path):
    file = users.write(tmp_path, name, users.CLOCKS[board])
    _, nets, rows = drawn(EVERY[board], file)
    for net, pin in nets:
        assert pin in rows[net][0], net


def test_a_build_without_a_sensor_is_drawn(tmp_path):
    """A forest for rows from a host: its pins are the board's own, and the flags."""
    (tmp_path / "rows.toml").write_text(NOTHING)
    _, nets, rows = drawn(boards.BOARDS["ulx3s"], str(tmp_path / "rows.toml"))
    for net, pin in nets:
        assert pin in rows[net][0], net


@pytest.mark.parametrize(
    "board, name, pins, count",
    [
        ("icebreaker", "slip1", MCP3208, 1),
        ("icebreaker", "fingertip", MCP3208, 1),
        ("ulx3s", "cop4", AD7606, 1),
        ("orangecrab", "grip", MCP3208, 1),
        ("ulx3s", "array64", AD7606 | {"25": "adc_miso_i{}"}, 8),
        ("ulx3s", "max", MAX11131, 2),
        ("ulx3s", "three", MCP3208, 3),
    ],
)
def test_a_wire_leads_from_each_pin_of_a_converter_to_its_net(board, name, pins, count, tmp_path):
    """The numbers stand over the wires, a little to the right of the chip."""
    file = name if name in EVERY[board].configs else users.write(tmp_path, name, users.CLOCKS[board])
    seen, _, rows = drawn(EVERY[board], file)
    lanes = 2 if "25" in pins else 1
    for number, net in pins.items():
        places = sorted((y, x) for x, y in seen.find(number) if x < 0)
        assert len(places) == count, number
        for k, (y, x) in enumerate(places):
            level = [(a, b) for a, b in seen.lines if abs(a[1] - b[1]) < NEAR and 0 <= a[1] - y < 6]
            [start] = [a for a, b in level if min(a[0], b[0]) <= x <= max(a[0], b[0])]
            bit = k * lanes + (number == "25") if net.startswith("adc_miso") else k
            wanted = net.format("" if count * lanes == 1 or count == 1 else f"[{bit}]")
            ends = [y for x, y in seen.reached(start) if x > -NEAR]
            at = {other for other, (_, height) in rows.items() if any(abs(y - height) < NEAR for y in ends)}
            assert at == {wanted}, (number, k)


def test_columns_and_rows_arrive_where_the_scan_says():
    """docs/scan.md: column = (group*inputs + input)*converters + converter; 64 on eight converters."""
    seen, _, rows = drawn(boards.BOARDS["ulx3s"], "array64")
    inputs = [sorted((y for x, y in seen.find(str(49 + 2 * k)) if x < 0)) for k in range(8)]
    for converter in range(8):
        for k in range(8):
            [(_, y)] = seen.find(f"column {8 * k + converter}")
            assert abs(y - inputs[k][converter]) < 8
    seen, _, rows = drawn(boards.BOARDS["icebreaker"], "fingertip")
    for k in range(3):
        [(_, y)] = [at for at in seen.find(f"row {k}") if at[0] < 0]  # the signal's name is the same
        assert abs(y - rows[f"row_o[{k}]"][1]) < NEAR
        [(_, y)] = seen.find(f"column {k}")
        assert min(abs(y - py) for _, py in seen.find(str(k + 1))) < 8


def test_groups_of_columns_and_decoded_rows_are_named(tmp_path):
    """16 columns in four groups on two converters of two inputs, by hand; 16 rows by a number of 4 bits."""
    seen, _, rows = drawn(boards.BOARDS["ulx3s"], users.write(tmp_path, "groups", 25.0))
    for text in (
        "columns 0 | 4 | 8 | 12",
        "columns 2 | 6 | 10 | 14",
        "columns 1 | 5 | 9 | 13",
        "rows 0 to 15",
    ):
        assert len(seen.find(text)) == 1, text
    for text, net in (
        ("S0", "group_o[0]"),
        ("S1", "group_o[1]"),
        ("A3", "row_o[3]"),
        ("E (low: on)", "row_o[4]"),
    ):
        [(_, y)] = seen.find(text)
        assert abs(y - rows[net][1]) < NEAR, text


TURNS = """about = "31 columns in 11 turns"
[clock]
mhz = 12.0
[sensor]
kind = "array"
rows = 3
columns = 31
[adc]
part = "MCP3208"
volts = 3.3
rate_hz = "max"
converters = 3
channels = 1
[link]
registers = false
"""


def test_texts_do_not_overlap(tmp_path):
    """A letter takes 0.6 of its size in width at most on average; lines of text stand apart, and within the
    picture. Input 0 of the converters 0, 1, 2 reads columns 0, 3 .. 30, then 1, 4 .. 28 and 2, 5 .. 29."""
    (tmp_path / "turns.toml").write_text(TURNS)
    turns = boards.BOARDS["icebreaker"], str(tmp_path / "turns.toml")
    seen = Seen(svg(*turns))
    for text in ("0 | 3 | 6 | ... | 27 | 30", "1 | 4 | 7 | ... | 28 | -", "2 | 5 | 8 | ... | 29 | -"):
        assert len(seen.find(text)) == len(seen.find(f"columns {text}")) == 1
    for board, name in [*PAIRS, turns]:
        root = ElementTree.fromstring(svg(board, name))
        boxes, (x0, _, width, _) = [], map(float, root.get("viewBox").split())
        for text in root.iter(f"{SPACE}text"):
            [line] = text
            size, anchor = float(text.get("font-size")), text.get("text-anchor")
            x, y = float(text.get("x")), float(text.get("y")) + float(line.get("dy"))
            wide = 0.5 * size * len(line.text)
            left = x - {"start": 0, "middle": wide / 2, "end": wide}[anchor]
            middle = y if text.get("dominant-baseline") == "central" else y - size / 2
            boxes.append((left, left + wide, middle - 0.4 * size, middle + 0.4 * size, line.text))
        for k, (left, right, top, low, text) in enumerate(boxes):
            assert x0 <= left and right <= x0 + width, (board.name, name, text)
            for other in boxes[:k]:
                apart = right <= other[0] or other[1] <= left or low <= other[2] or other[3] <= top
                assert apart, (board.name, name, text, other[4])


def test_a_higher_supply_gets_level_shifters_and_a_symmetric_part_none():
    five = Seen(svg(boards.BOARDS["icebreaker"], "slip1", volts=5.0))
    assert len(five.find("3.3 V to 5 V")) == 3 and len(five.find("5 V to 3.3 V")) == 1
    usual = Seen(svg(boards.BOARDS["icebreaker"], "slip1"))
    assert not usual.find("3.3 V to 5 V") and usual.find("3.3 V")
    assert not Seen(svg(boards.BOARDS["ulx3s"], "cop4")).find("5 V to 3.3 V")


@pytest.mark.parametrize(
    "words, says",
    [
        (["fingertip", "--board", "nano", "--out", "x.svg"], "board = 'nano' must be one of"),
        (["nothing", "--out", "x.svg"], "'nothing' is neither a file"),
        (["array64", "--board", "icebreaker", "--out", "x.svg"], "36 header pins but the board has only 24"),
        (["fingertip", "--out", "x.png"], "x.png must be a .svg file"),
        (["fingertip", "--volts", "0.5", "--out", "x.svg"], "volts = 0.5 must lie in 1 .. 10"),
        (["fingertip", "--columns-in", "glue", "--out", "x.svg"], "columns-in = 'glue' must be one of"),
    ],
)
def test_what_cannot_be_drawn_is_refused(words, says, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit, match="2"):
        cli.main(["wiring", *words])
    assert says in capsys.readouterr().err and not list(tmp_path.iterdir())


def test_the_drawings_of_the_pages_are_those_of_today():
    import wiring

    assert wiring.PAGE.read_text("utf-8") == wiring.page(), "`make wiring`"
    for name, drawing in wiring.pictures().items():
        assert (ROOT / "docs/wiring" / name).read_bytes() == drawing, f"{name}: `make wiring`"
