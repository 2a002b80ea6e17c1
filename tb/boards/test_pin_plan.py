"""Pins of any configuration on any board: each line that it needs has a pin, no pin is used twice, a
configuration that does not fit is refused before anything is written, and the pins that the pages name do not
move."""

import json
import re
import subprocess
from dataclasses import replace

import pytest

import synth
from boards import users
from meissner.builds import board_files, boards, config, pins, toolchain
from meissner.builds.yowasp import ROOT

ALL = {**boards.BOARDS, "arty_a7": boards.ARTY}
LOCATED = {
    ".lpf": r'LOCATE COMP "(\S+)" SITE "(\w+)"',
    ".pcf": r"(?m)^set_io\s+(?:-\S+\s+yes\s+)*(\S+)\s+(\w+)",
    ".cst": r'IO_LOC "(\S+)" (\w+)',
    ".xdc": r"PACKAGE_PIN (\w+) .*\[get_ports \{([^}]+)\}\]",
}


LANES = {"Adc": 2, "Converters": 2, "AdcLanes": 2}  # AD7606


def located(text, suffix):
    """[(bit of a port, pin)] of a constraints file."""
    found = re.findall(LOCATED[suffix], re.sub(r"(?m)(#|//).*$", "", text))
    return [pair[::-1] for pair in found] if suffix == ".xdc" else found


def port_bits(top):
    """Every bit of every port of a top and its direction, named as place and route names it."""
    found = {}
    for way, high, name in re.findall(r"(?m)^  (input|output)\s+logic (?:\[(\d+):0\] )?(\w+),?$", top):
        bits = [name] if not high else [f"{name}[{k}]" for k in range(int(high) + 1)]
        found |= dict.fromkeys(bits, way)
    return found


@pytest.mark.parametrize("board", users.CLOCKS)
@pytest.mark.parametrize("name", users.USERS)
def test_every_line_has_a_pin_and_no_pin_has_two(board, name, tmp_path):
    file = users.write(tmp_path, name, users.CLOCKS[board])
    try:
        plan = ALL[board].plan(file)
    except ValueError as problem:
        assert board in ("orangecrab", "tangnano20k") and "without a pin" in str(problem)
        pytest.skip(str(problem))  # this board has too few pins; its message is tested below
    top, suffix = board_files.top(plan), ALL[board].constraints
    placed = located(board_files.constraints(plan, suffix), suffix)
    assert {bit for bit, _ in placed} == set(port_bits(top))
    assert len({bit for bit, _ in placed}) == len({pin for _, pin in placed}) == len(placed)
    free = set(pins.description(board).headers.values())
    needed = {}
    for bit, pin in placed:
        if pin in free and bit not in ("slip_o", "gross_o"):
            port = bit.partition("[")[0].replace("moving_n_i", "moving_i")
            needed[port] = needed.get(port, 0) + 1
    assert needed == users.USERS[name][1]
    told = json.loads(plan.json())["pins"]
    assert [(row["port"], row["pin"]) for row in told] == placed
    ways = {bit: {"input": "in", "output": "out"}[way] for bit, way in port_bits(top).items()}
    assert {row["port"]: row["direction"] for row in told} == ways
    for row in told:  # the table lists them too, one line each
        assert re.search(
            rf"(?m)^{re.escape(row['port'])} +{row['pin']} .*{re.escape(row['what'])}$", plan.text()
        )


@pytest.mark.parametrize("board", ALL)
def test_each_pin_of_a_named_pair_is_used_once(board):
    for name in ALL[board].configs:
        plan, suffix = ALL[board].plan(name), ALL[board].constraints
        placed = located(board_files.constraints(plan, suffix), suffix)
        assert len({port for port, _ in placed}) == len({pin for _, pin in placed}) == len(placed) > 5
        assert {bit for bit, _ in placed} == set(port_bits(board_files.top(plan)))


WIRED = {  # docs/boards.md, from the boards' own constraint files
    ("icebreaker", "fingertip"): {
        "clk_12m_i": "35", "rx_i": "6", "tx_o": "9", "led_red_n_o": "11", "led_green_n_o": "37",
        "adc_cs_n_o": "4", "adc_mosi_o": "2", "adc_miso_i": "47", "adc_sclk_o": "45", "moving_n_i": "3",
        "row_o[0]": "43", "row_o[1]": "38", "row_o[2]": "34", "slip_o": "48", "gross_o": "46",
    },
    ("ulx3s", "slip1"): {
        "clk_25m_i": "G2", "rx_i": "M1", "tx_o": "L4", "led_gross_o": "B2", "led_slip_o": "C2",
        "led_touched_o": "C1", "led_pressed_o": "D2", "led_good_o": "D1", "led_5_o": "E2", "led_6_o": "E1",
        "led_7_o": "H3", "adc_cs_n_o": "R17", "adc_mosi_o": "R16", "adc_miso_i": "U16", "adc_sclk_o": "P17",
        "moving_i": "A5", "slip_o": "B1", "gross_o": "B4",
    },
    ("ulx3s", "cop4"): {
        "clk_25m_i": "G2", "rx_i": "M1", "tx_o": "L4", "led_gross_o": "B2", "led_slip_o": "C2",
        "led_touched_o": "C1", "led_pressed_o": "D2", "led_good_o": "D1", "led_5_o": "E2", "led_6_o": "E1",
        "led_7_o": "H3", "onboard_cs_n_o": "R17", "onboard_sclk_o": "P17", "onboard_mosi_o": "R16",
        "adc_cs_n_o": "C4", "adc_sclk_o": "B13", "adc_convst_o": "A4", "adc_reset_o": "A2",
        "adc_busy_i": "C11", "adc_miso_i": "H18", "moving_i": "A5", "slip_o": "B1", "gross_o": "B4",
    },
    ("orangecrab", "fingertip"): {
        "clk_48m_i": "A9", "rx_i": "N17", "tx_o": "M18", "led_red_n_o": "K4", "led_green_n_o": "M3",
        "led_blue_n_o": "J3", "adc_cs_n_o": "B10", "adc_miso_i": "N15", "adc_mosi_o": "N16",
        "adc_sclk_o": "R17", "moving_i": "L4", "row_o[0]": "C10", "row_o[1]": "C9", "row_o[2]": "B9",
        "slip_o": "C8", "gross_o": "B8",
    },
    ("tangnano20k", "slip1"): {
        "clk_27m_i": "4", "rx_i": "70", "tx_o": "69", "led_touched_n_o": "15", "led_pressed_n_o": "16",
        "led_slip_n_o": "17", "led_gross_n_o": "18", "adc_cs_n_o": "73", "adc_mosi_o": "74",
        "adc_miso_i": "75", "adc_sclk_o": "85", "moving_i": "77", "slip_o": "76", "gross_o": "80",
    },
    ("arty_a7", "slip1"): {
        "clk_100m_i": "E3", "rx_i": "A9", "tx_o": "D10", "led_gross_o": "H5", "led_slip_o": "J5",
        "led_touched_o": "T9", "led_pressed_o": "T10", "adc_cs_n_o": "G13", "adc_mosi_o": "B11",
        "adc_miso_i": "A11", "adc_sclk_o": "D12", "moving_i": "D13", "slip_o": "B18", "gross_o": "A18",
    },
}  # fmt: skip


@pytest.mark.parametrize("board, name", WIRED)
def test_the_named_pairs_are_wired_as_the_page_says(board, name):
    suffix = ALL[board].constraints
    assert dict(located(board_files.constraints(ALL[board].plan(name), suffix), suffix)) == WIRED[board, name]


def test_eight_converters_are_wired_as_the_page_says():
    """BUSY of converter k is GNk, DOUTA GP(18+k), DOUTB GN(18+k); the row number is on GP0 to GP5, its enable
    on GP6."""
    at = {row["port"]: row["at"] for row in boards.BOARDS["ulx3s"].plan("array64").rows()}
    for k in range(8):
        assert at[f"adc_busy_i[{k}]"] == f"J1 GN{k}"
        assert (at[f"adc_miso_i[{2 * k}]"], at[f"adc_miso_i[{2 * k + 1}]"]) == (
            f"J2 GP{18 + k}",
            f"J2 GN{18 + k}",
        )
    assert [at[f"row_o[{k}]"] for k in range(7)] == [f"J1 GP{k}" for k in range(7)] and "row_o[7]" not in at
    assert (at["adc_convst_o"], at["adc_reset_o"], at["adc_cs_n_o"]) == ("J1 GP8", "J1 GP9", "J1 GP10")


@pytest.mark.parametrize("converters", [3, 5, 6, 7])
def test_any_number_of_converters_is_wired(converters):
    """64 columns on a ULX3S: each has its BUSY, DOUTA and DOUTB, all share the other lines; there are 3, 2, 2
    and 2 groups of columns, 64 / (8 · converters) rounded up, so two bits or one."""
    array = {"Array": 1, "Rows": 64, "Columns": 64, "ClkKhz": 100_000}
    adc = {"Adc": 2, "AdcLanes": 2, "AdcChannels": 8, "Converters": converters}
    plan = pins.assign(pins.description("ulx3s"), "x", array | adc)
    found = {row["port"]: row["what"] for row in plan.rows() if row["port"].startswith(("adc_", "group_"))}
    shared = {"cs_n_o": "CS", "sclk_o": "SCLK", "convst_o": "CONVST", "reset_o": "RESET"}
    expected = {f"adc_{port}": f"{name} of all {converters} converters" for port, name in shared.items()}
    for k in range(converters):
        expected[f"adc_busy_i[{k}]"] = f"BUSY of converter {k}"
        expected |= {
            f"adc_miso_i[{2 * k + n}]": f"DOUT{line} of converter {k}" for n, line in enumerate("AB")
        }
    bits = ["group_o[0]", "group_o[1]"] if converters == 3 else ["group_o"]
    expected |= {bit: f"bit {k} of the number of the group of columns" for k, bit in enumerate(bits)}
    assert found == expected
    text = plan.text().splitlines()
    assert all(
        any(line.startswith(f"{port} ") and line.endswith(f"  {what}") for line in text)
        for port, what in found.items()
    )
    assert len({row["pin"] for row in plan.rows()}) == len(plan.rows())
    # Neighbouring columns are on different converters; the last of a group's 8 inputs may have none.
    places = {
        k: list(range(k, 8 * converters * (3 if converters == 3 else 2), converters))
        for k in range(converters)
    }
    for line, k in zip(text[-converters:], range(converters), strict=True):
        name, told = line.split(": columns ")
        assert name == f"converter {k}, inputs 0 to 7" and [len(g.split()) for g in told.split(" | ")] == [
            8
        ] * 2 + [8] * (converters == 3)
        assert told.replace(" | ", " ").split() == [str(n) if n < 64 else "-" for n in places[k]]


def test_the_columns_of_seven_converters_are_those_of_the_page():
    """docs/scan.md: 64 columns, five inputs each: l, l + 7 .. l + 28, then l + 35 .. l + 63."""
    adc = {"Adc": 2, "AdcChannels": 5, "Converters": 7, "Array": 1, "Rows": 64, "Columns": 64}
    plan = pins.assign(pins.description("ulx3s"), "x", adc | {"ClkKhz": 100_000})
    assert plan.text().splitlines()[-7::6] == [
        "converter 0, inputs 0 to 4: columns 0 7 14 21 28 | 35 42 49 56 63",
        "converter 6, inputs 0 to 4: columns 6 13 20 27 34 | 41 48 55 62 -",
    ]


@pytest.mark.parametrize("lanes", [1, 8])
def test_an_ad7606c_has_an_input_for_its_registers(lanes):
    """On a ULX3S: CS, SCLK, CONVST, RESET, BUSY, DIN, and a line for each DOUT, by its letter."""
    plan = pins.assign(pins.description("ulx3s"), "x", {"Adc": 6, "AdcLanes": lanes, "ClkKhz": 25_000})
    found = {row["port"]: row["what"] for row in plan.rows() if row["port"].startswith("adc_")}
    names = ["adc_miso_i"] if lanes == 1 else [f"adc_miso_i[{k}]" for k in range(lanes)]
    outputs = {name: f"DOUT{letter} of the converter" for name, letter in zip(names, "ABCDEFGH")}
    inputs = {"cs_n_o": "CS", "sclk_o": "SCLK", "convst_o": "CONVST", "reset_o": "RESET", "mosi_o": "DIN"}
    assert found == outputs | {f"adc_{port}": f"{name} of the converter" for port, name in inputs.items()} | {
        "adc_busy_i": "BUSY of the converter"
    }


def test_status_pins_are_the_preferred_ones_then_free_ones_then_none():
    """A ULX3S prefers GN9 and GN10; a Tang Nano has 16 pins and no preference. An AD7606 takes 8 with both
    lanes."""

    def shown(board, channels=0):
        needs = {"Adc": 2, "AdcLanes": 2, "ClkKhz": 1000 * board.clock["core_mhz"][0]}
        ports = pins.assign(board, "x", needs, channels).ports
        return {port.port: port.at[0] for port in ports if port.role in ("slip", "gross")}

    ulx3s, tang = pins.description("ulx3s"), pins.description("tangnano20k")
    assert shown(ulx3s) == {"slip_o": "J1 GN9", "gross_o": "J1 GN10"}
    other = replace(ulx3s, prefer={"gross": ["J1 GP4"]})  # the first that is free
    assert shown(other) == {"slip_o": "J1 GN4", "gross_o": "J1 GP4"}
    assert shown(tang) == {"slip_o": "J5 48", "gross_o": "J5 49"}
    assert shown(tang, 6) == {"slip_o": "J5 52", "gross_o": "J6 74"}
    assert shown(tang, 7) == {"slip_o": "J6 74"}
    assert shown(tang, 8) == {}
    said = r"16; lines without a pin: slip_each_o \(high while channel 8 slips\)$"
    with pytest.raises(ValueError, match=said):
        shown(tang, 9)


@pytest.mark.parametrize("name", ["fingertip", "cop4"])
def test_what_has_no_channels_has_no_slip_of_each(name, tmp_path):
    text = (config.FOLDER / f"{name}.toml").read_text()
    text += "" if "[link]\n" in text else "[link]\n"
    (tmp_path / "mine.toml").write_text(text.replace("[link]\n", "[link]\nslip_pins = true\n"))
    with pytest.raises(ValueError, match=r"\[link\]: slip_pins must go with single channels$"):
        config.load(tmp_path / "mine.toml")


SAME = ("rx_i", "tx_o", "moving_i", "adc_cs_n_o", "adc_sclk_o", "adc_miso_i")
FLAGS = {"clk_i": "clk", "good_i": "good", "slip_o": "slip", "gross_o": "gross"}
FLAGS |= {"touched_o": "touched", "pressed_o": "pressed"}
NO_HAND = {"pwm_o": "unused_pwm"}


@pytest.mark.parametrize(
    "name, same, other",
    [
        (
            "lanes",
            ("adc_convst_o", "adc_reset_o", "adc_busy_i", "row_o"),
            {"adc_mosi_o": "unused_mosi", "group_o": "unused_group"},
        ),
        (
            "groups",
            ("adc_mosi_o", "row_o", "group_o"),
            {"adc_convst_o": "unused_convst", "adc_reset_o": "unused_reset", "adc_busy_i": "'0"},
        ),
        (
            "channels",
            ("adc_convst_o", "adc_reset_o", "adc_busy_i"),
            {"adc_mosi_o": "unused_mosi", "row_o": "unused_row", "group_o": "unused_group"},
        ),
    ],
)
def test_each_line_of_the_core_goes_to_the_port_of_its_name(name, same, other, tmp_path):
    top = board_files.top(boards.BOARDS["ulx3s"].plan(users.write(tmp_path, name, 25.0)))
    instance = top.partition("msn_board u_board (")[2].partition(");")[0]
    wired = dict(re.findall(r"\.(\w+) *\(([^()]+)\)", instance))
    assert wired == {port: port for port in (*SAME, *same)} | FLAGS | NO_HAND | other
    shown = dict(re.findall(r"assign (\w+) = (.+);", top))
    assert shown == {
        "onboard_cs_n_o": "1'b1", "onboard_sclk_o": "1'b1", "onboard_mosi_o": "1'b0", "slip_o": "slip",
        "gross_o": "gross", "led_gross_o": "gross", "led_slip_o": "slip", "led_touched_o": "touched",
        "led_pressed_o": "pressed", "led_good_o": "good", "led_5_o": "1'b0", "led_6_o": "1'b0",
        "led_7_o": "1'b0",
    }  # fmt: skip


def test_a_hand_gets_a_pin_for_its_pulses(tmp_path):
    text = (config.FOLDER / "grip.toml").read_text()
    assert "mhz = 24.0" in text
    mine = tmp_path / "hand.toml"
    mine.write_text(text.replace("mhz = 24.0", "mhz = 25.0"))
    plan = boards.BOARDS["ulx3s"].plan(str(mine))
    [row] = [row for row in plan.rows() if row["port"] == "pwm_o"]
    assert (row["direction"], row["what"]) == ("out", "pulses for the hand") and row["pin"]
    top = board_files.top(plan)
    assert re.search(r"output logic pwm_o\b", top) and re.search(r"\.pwm_o +\(pwm_o\)", top)
    assert (
        "pwm_o"
        not in board_files.top(boards.BOARDS["ulx3s"].plan("slip1")).partition("(")[2].partition(")")[0]
    )


def test_a_pull_is_written_as_each_tool_reads_it():
    port = pins.Port("moving", "moving_i", ("7",), ("x",), ("y",), "up")
    plan = pins.Plan(pins.description("ulx3s"), "x", (port,))
    written = {suffix: board_files.constraints(plan, suffix) for suffix in LOCATED}
    assert "\nset_io -pullup yes moving_i 7\n" in written[".pcf"]
    assert '\nIOBUF PORT "moving_i" PULLMODE=UP IO_TYPE=LVCMOS33;\n' in written[".lpf"]
    assert '\nIO_PORT "moving_i" IO_TYPE=LVCMOS33 PULL_MODE=UP;\n' in written[".cst"]
    assert "{PACKAGE_PIN 7 IOSTANDARD LVCMOS33 PULLUP TRUE} [get_ports {moving_i}]" in written[".xdc"]
    down = pins.Plan(plan.board, "x", (pins.Port("busy", "busy_i", ("8",), ("x",), ("y",), "down"),))
    assert "PULLMODE=DOWN" in board_files.constraints(down, ".lpf")
    with pytest.raises(ValueError, match="busy_i"):
        board_files.constraints(down, ".pcf")


def test_an_input_that_rests_high_is_turned_around():
    """An iCE40 has no pull-down; an open moving_n_i is pulled high, which means that the actuator rests."""
    plan = boards.BOARDS["icebreaker"].plan("slip1")
    assert "\nset_io -pullup yes moving_n_i 3\n" in board_files.constraints(plan, ".pcf")
    assert ".moving_i    (!moving_n_i)" in board_files.top(plan)
    assert "low while the actuator moves" in plan.text()


@pytest.mark.parametrize("board", ALL)
def test_every_input_but_the_clock_has_a_pull_to_its_rest(board):
    rest = {"rx_i": "up", "adc_miso_i": "up", "adc_busy_i": "down", "moving_i": "down", "moving_n_i": "up"}
    plan = pins.assign(pins.description(board), "x", LANES | {"ClkKhz": 1000 * round(users.CLOCKS[board])})
    inputs = [port for port in plan.ports if port.is_input and port.role != "clock"]
    assert len(inputs) == 4
    for port in inputs:
        none = (board, port.port) == ("icebreaker", "adc_busy_i")  # no pull-down; its converter drives it
        assert port.pull == (None if none else rest[port.port])


def test_no_description_gives_a_pin_twice(tmp_path, monkeypatch):
    text = (ROOT / "constraints/orangecrab.toml").read_text()
    (tmp_path / "constraints").mkdir()
    monkeypatch.setattr(pins, "ROOT", tmp_path)
    for wrong, said in (
        (text.replace('A5 = "T17"', 'A5 = "A9"'), "A9"),
        (text.replace('cs_n = ["feather 5"]', 'cs_n = ["feather 7"]'), "feather 7"),
        (text.replace('busy = "down"', 'busy = "left"'), "busy"),
    ):
        assert wrong != text
        (tmp_path / "constraints/wrong.toml").write_text(wrong)
        with pytest.raises(ValueError, match=said):
            pins.description.__wrapped__("wrong")


def said_of(capsys, *arguments):
    """The message with which synth refuses: one sentence, exit code 2, nothing written."""
    there = sorted((ROOT / "build/synth").glob("*")) if (ROOT / "build/synth").exists() else []
    with pytest.raises(SystemExit) as end:
        synth.main(list(arguments))
    out, err = capsys.readouterr()
    assert end.value.code == 2 and not out and err.startswith("synth: ") and err.count("\n") == 1
    assert [p for p in there if not p.exists()] == []
    assert not list((ROOT / "build/synth").glob("*refused-here*"))
    return err


def test_what_does_not_fit_is_refused_with_what_is_missing(capsys, tmp_path):
    file = tmp_path / "refused-here.toml"
    file.write_text(users.array(24.0, "AD7606", 8, 64, 8, 8, lanes=2, rate_hz=100.0), "utf-8")
    said = said_of(capsys, "icebreaker", str(file))
    assert (
        "refused-here needs 37 header pins (1 adc_cs_n_o, 1 adc_sclk_o, 1 adc_convst_o, "
        "1 adc_reset_o, 8 adc_busy_i, 16 adc_miso_i, 8 row_o, 1 moving_n_i) but the icebreaker "
        "has only 24; lines without a pin: "
    ) in said
    assert said.count("(DOUT") == 13 and said.endswith("adc_miso_i (DOUTB of converter 7)\n")


@pytest.mark.parametrize(
    "board, text, said",
    [
        ("ulx3s", users.array(24.0, "MCP3208", 2, 4, 2, 2),
         "24 MHz"),
        ("tangnano20k", users.array(25.0, "MCP3208", 2, 4, 2, 2),
         "25 MHz"),
        ("ulx3s", "about = 'no more'", "refused-here.toml: "),
        ("ulx3s", "[[[", "TOML"),
        ("ulx3s", users.array(25.0, "MCP3208", 2, 4, 9, 2), "must lie in 1 .. 8"),
    ],
)  # fmt: skip
def test_a_bad_file_is_answered_by_a_sentence(capsys, tmp_path, board, text, said):
    file = tmp_path / "refused-here.toml"
    file.write_text(text, "utf-8")
    assert said in said_of(capsys, board, str(file))


def test_neither_a_folder_nor_nothing_is_a_configuration(capsys, tmp_path):
    for where in (tmp_path, tmp_path / "none.toml"):
        assert "has no configuration" in said_of(capsys, "ulx3s", str(where))


def test_only_the_named_are_recorded(capsys, tmp_path):
    file = users.write(tmp_path, "two", 25.0)
    assert "named" in said_of(capsys, "ulx3s", file, "--check")


def test_the_pins_alone(capsys, tmp_path):
    synth.main(["ulx3s", users.write(tmp_path, "two", 25.0), "--pins"])
    lines = capsys.readouterr().out.splitlines()
    # On the headers: cs, sclk, din, 2 dout, 2 rows, moving, slip, gross.
    assert lines[0] == "pins of two on the ulx3s: 10 of the headers' 42"
    assert [line.split()[1] for line in lines if line.startswith("adc_miso_i")] == ["H18", "H17"]


def test_a_users_file_does_not_take_a_named_ones_folder(tmp_path):
    assert boards.label("slip1") == "slip1"
    assert boards.label(str(tmp_path / "slip1.toml")) == "slip1.toml"
    assert boards.label("my finger (left).toml") == "my_finger_left_"
    assert boards.label("mine.toml") == "mine"


LINTED = [
    ("ulx3s", "two"),
    ("ulx3s", "three"),
    ("ulx3s", "groups"),
    ("icebreaker", "lanes"),
    ("icebreaker", "each"),
]


@pytest.mark.parametrize("board, name", LINTED)
def test_the_top_lints(board, name, tmp_path):
    folder = f"build/tb/top-{board}-{name}"
    board = ALL[board]
    boards.write_board(folder, board, users.write(tmp_path, name, users.CLOCKS[board.name]))
    own = [toolchain.ROOT / path for path in (*board.sources, f"{folder}/{board.top}.sv", "tb/lint/cells.v")]
    flags = ["--lint-only", "--quiet", "-Wall", str(ROOT / "rtl/verilator.vlt"), f"-I{ROOT / folder}"]
    command = ["verilator", *flags, *map(str, [*toolchain.sources(), *own]), "--top-module", board.top]
    done = subprocess.run(command, env=toolchain.environment(), capture_output=True, text=True)
    assert (done.returncode, done.stdout + done.stderr) == (0, "")


def test_the_named_configurations_that_a_board_leaves_out_do_not_fit():
    """They need too many pins, or are too large for the board: docs/boards.md."""
    for board in boards.BOARDS.values():
        for name, reason in board.left_out.items():
            build = config.load(name)
            needed = sum(need.count for need in pins.needs(pins.description(board.name), build.parameters))
            there = len(pins.description(board.name).headers)
            if "header pins" in reason:
                assert (
                    needed > there and f"needs {needed} header pins" in reason and f"only {there}" in reason
                )
            else:
                assert needed <= there
