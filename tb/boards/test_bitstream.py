"""How a bitstream is built: a failed build leaves the one before, each device has its own folder, a seed that
does not finish is skipped, and a larger device is tried where one is too small."""

import json
import re

import pytest

import synth
from boards import users
from meissner.builds import bitstream, boards, config, yowasp
from meissner.builds.yowasp import ROOT, ToolError
from meissner.parser import parser

REPORT = {"utilization": {"TRELLIS_COMB": {"used": 11}}, "detailed_net_timings": []}


@pytest.fixture
def out(monkeypatch, tmp_path):
    """Builds go to this test's own folder, in place of the repository."""
    monkeypatch.setattr(bitstream, "ROOT", tmp_path)
    return tmp_path / bitstream.OUT


def test_a_build_takes_its_place_whole_and_one_that_fails_leaves_it(out):
    for text in ("first", "second"):
        with bitstream.private("a-b") as folder:
            place = out.parent.parent / folder
            assert place.parent == out and place != out / "a-b"
            (place / "x.bit").write_text(text)
            (place / f"{text}.log").write_text("")
            assert text == "first" or (out / "a-b/x.bit").read_text() == "first"  # until that is complete
    for error in (ToolError("why"), KeyboardInterrupt()):
        with pytest.raises(type(error)), bitstream.private("a-b") as folder:
            (out.parent.parent / folder / "x.log").write_text("why")
            raise error
    assert (out / "a-b/x.bit").read_text() == "second"
    assert sorted(path.name for path in (out / "a-b").iterdir()) == ["second.log", "x.bit"]
    assert [path.name for path in (out / "a-b.part").iterdir()] == ["x.log"]


def test_each_device_has_its_own_folder(out, monkeypatch, capsys):
    def build(board, config, device, folder, seeds, patient, limit_s, step):
        step("packing", f"{folder}/x.log")
        (out.parent.parent / folder / "x.bit").write_text(device)
        return {"device": device, "clk_mhz": 50.0, "mhz_worst": 60, **dict.fromkeys(bitstream.AREA, 0)}

    monkeypatch.setattr(synth, "build", build)
    monkeypatch.setattr(synth, "ROOT", out.parent.parent)
    monkeypatch.setattr(synth, "warm_up", lambda: None)
    for device in ("85F", "12F"):
        synth.main(["ulx3s", "slip1", "--device", device])
        said = capsys.readouterr().out
        assert f"bitstream: build/synth/ulx3s-slip1-{device}/ulx3s_top.bit" in said
        assert f"pins: build/synth/ulx3s-slip1-{device}/pins.txt and pins.json" in said
        assert re.search(r"(?m)^adc_cs_n_o +R17 ", said)
        assert f"ulx3s-slip1-{device}: packing ...\n" in said
    assert [(out / f"ulx3s-slip1-{device}/x.bit").read_text() for device in ("85F", "12F")] == ["85F", "12F"]


def test_it_ends_with_what_to_do_next(out, monkeypatch, capsys):
    """Each command as it stands, with the files that it names; port and rate of this board and build."""
    result = {"clk_mhz": 24.0, "mhz_worst": 25, **dict.fromkeys(bitstream.AREA, 0)}
    monkeypatch.setattr(synth, "build", lambda *_: result)
    monkeypatch.setattr(synth, "ROOT", out.parent.parent)
    monkeypatch.setattr(synth, "warm_up", lambda: None)
    synth.main(["icebreaker", "fingertip"])
    said = capsys.readouterr().out.partition("what next:\n")[2]
    lines = dict(line.strip().split("  ", 1) for line in said.splitlines())
    folder = "build/synth/icebreaker-fingertip"
    assert lines["wire it"].split()[0] == f"{folder}/wiring.svg,"
    assert (
        lines["its port"]
        .strip()
        .startswith("/dev/ttyUSB1, the second channel of its FT2232H, 3000000 baud; ")
    )
    assert "cp host/60-meissner.rules /etc/udev/rules.d/" in lines["once"]
    flash, live = (lines[key].split() for key in ("load it", "see it"))
    assert flash == [".venv/bin/meissner", "flash", "icebreaker", f"{folder}/icebreaker_top.bin"]
    given = parser().parse_args(live[1:])
    assert (given.command, given.port, given.config) == ("live", "/dev/ttyUSB1", f"{folder}/config.toml")
    made = config.load(out.parent.parent / folder / "config.toml")  # as the board has it, not the file
    assert (made.clk_khz, made.link.registers, config.load("fingertip").link.registers) == (
        24_000,
        False,
        True,
    )
    assert b"adc_miso_i" in (out / "icebreaker-fingertip/wiring.svg").read_bytes()


@pytest.fixture
def placed(monkeypatch):
    """``build`` with place and route replaced by ``results`` {(device, seed): MHz or an exception}; also
    returns the calls that were made."""
    asked, packed, results = [], [], {}

    def place(board, config, device, stem, clk_mhz, seed, limit_s):
        asked.append((device, seed, limit_s))
        result = results[device, seed]
        if isinstance(result, Exception):
            raise result
        return REPORT | {"fmax": {"clk": {"achieved": result}}}

    monkeypatch.setattr(bitstream, "synthesise", lambda *_: ("stem", {}))
    monkeypatch.setattr(bitstream, "place", place)
    monkeypatch.setattr(bitstream, "tool", lambda program, *_: packed.append(program))
    return asked, packed, results


def test_a_seed_that_does_not_end_is_passed_over(placed, tmp_path):
    asked, packed, results = placed
    board = boards.BOARDS["orangecrab"]
    results |= {(None, 1): ToolError("no end"), (None, 2): 47.96, (None, 3): 48.04}
    steps = []
    made = bitstream.build(board, "slip1", None, "x", (1, 2, 3), False, 77, lambda *step: steps.append(step))
    assert [what.split()[0] for what, _ in steps] == ["synthesis", "place", "place", "place", "packing"]
    assert steps[2] == ("place and route by nextpnr, seed 2", "stem.2.pnr.log")
    assert asked == [(None, 1, 77), (None, 2, 77), (None, 3, 77)] and packed == ["yowasp-ecppack"]
    assert (made["mhz"], made["clk_mhz"]) == ([47.9, 48.0], 48.0)  # rounded down; 48.0 is enough
    with pytest.raises(ToolError, match="no end"):  # every seed is measured, so each must finish
        bitstream.build(board, "slip1", None, "x", (1, 2, 3), True, 77)
    with pytest.raises(ToolError, match="no end"):
        bitstream.build(board, "slip1", None, "x", (1,), False, 77)
    with pytest.raises(
        ToolError,
        match=r"47\.9 MHz",
    ):
        bitstream.build(board, "slip1", None, "x", (1, 2), False, 77)


def test_three_seeds_are_measured_and_more_until_one_meets_the_clock(placed):
    asked, packed, results = placed
    board, found = boards.BOARDS["orangecrab"], [47.1, 47.2, 47.4, 47.98, 48.1, 60.0]
    for first, tried in ((47.1, 5), (48.0, 3)):
        results |= {(None, seed): mhz for seed, mhz in enumerate([first, *found[1:]], 1)}
        made = bitstream.build(board, "slip1", None, "x", range(1, 7), True, 77)
        assert [seed for _, seed, _ in asked] == [*range(1, tried + 1)] and packed == ["yowasp-ecppack"]
        assert made["mhz"] == [first, 47.2, 47.4, 47.9, 48.1][:tried]
        assert made["mhz_worst"] == min(first, 47.2)
        del asked[:], packed[:]


def test_a_larger_device_where_one_is_too_small(placed, tmp_path):
    asked, packed, results = placed
    board, mine = boards.BOARDS["ulx3s"], users.write(tmp_path, "two", 25.0)
    results |= {("25F", 1): bitstream.TooLarge("25F"), ("45F", 1): ToolError("no way")}
    results |= {("45F", 2): 25.0, ("85F", 1): 99.0}
    made = bitstream.build(board, mine, None, "x", (1, 2), False)
    assert [(device, seed) for device, seed, _ in asked] == [("25F", 1), ("45F", 1), ("25F", 2)] or made
    assert made["device"] == "45F" and packed == ["yowasp-ecppack"]
    results |= {("45F", 1): bitstream.TooLarge("45F"), ("85F", 1): bitstream.TooLarge("85F")}
    with pytest.raises(bitstream.TooLarge, match="85F"):
        bitstream.build(board, mine, None, "x", (1, 2), False)
    with pytest.raises(bitstream.TooLarge, match="25F"):  # the requested device
        bitstream.build(board, mine, "25F", "x", (1, 2), False)


def test_delays_of_pins():
    """The longest way out and in of each kind; of the SDRAM's clock none, and none between registers."""
    ends = lambda *found: [{"event": event, "cell": cell, "delay": list(ns)} for event, cell, *ns in found]
    net = lambda event, driver, *found: {"event": event, "driver": driver, "endpoints": ends(*found)}
    given = [
        net(
            "posedge clk",
            "ff",
            ("<async>", "adc_cs_n_o$tr_io", 1.0, 4.26),
            ("posedge clk", "adc_cs_n_q", 9.0),
        ),
        net("posedge clk", "ff", ("<async>", "sdram_a_o[3]$tr_io", 5.0), ("<async>", "sdram_clk_o", 8.0)),
        net("posedge clk", "ff", ("<async>", "sdram_dq_io[1]$tr_io", 6.12, 2.0), ("<async>", "led_o", 7.0)),
        net("<async>", "sdram_dq_io[1]$tr_io", ("posedge clk", "ff", 0.5), ("posedge clk", "ff", 1.5)),
        net("<async>", "rx_i$tr_io", ("posedge clk", "ff", 3.0)),
    ]
    assert bitstream.pin_delays({"detailed_net_timings": given}) == {
        "spi_out_ns": 4.3,
        "sdram_out_ns": 6.1,
        "sdram_in_ns": 1.5,
    }


def test_a_tool_that_does_not_end_is_stopped(tmp_path, monkeypatch):
    (ROOT / "build/tb/endless").mkdir(parents=True, exist_ok=True)
    with pytest.raises(ToolError, match="processor time"):
        yowasp.tool("python", ["-c", "while True: pass"], "build/tb/endless/log", 1)


STORES = """
module stores (input logic clk, rst, begun, go, input logic [7:0] valid, input logic [2:0] word,
               input logic [11:0] code, output logic [7:0][22:0] out);
for (genvar c = 1; c <= 8; c++) begin : gen_store
  localparam int unsigned Bits = msn_pkg::index_width(c);
  msn_adc_store #(.Channels(c)) u_store (
    .clk_i(clk), .rst_i(rst), .begin_i(begun), .in_valid_i(valid[c-1]), .in_word_i(word[Bits-1:0]),
    .in_data_i(code), .in_bad_i(1'b0), .out_ready_i(go), .out_valid_o(out[c-1][22]),
    .out_last_o(out[c-1][21]), .out_user_o(out[c-1][20]), .out_data_o(out[c-1][16:0]),
    .out_id_o(out[c-1][16+Bits:17])
  );
end
endmodule
"""


@pytest.mark.parametrize("name", ["ulx3s", "icebreaker"])
def test_a_store_of_any_number_of_channels_has_one_driver_a_net(name):
    """Of two channels, one net that is kept is a register's output and the other its inverse."""
    board, stem = boards.BOARDS[name], f"build/tb/netlist-store/{name}"
    (ROOT / stem).parent.mkdir(parents=True, exist_ok=True)
    (ROOT / f"{stem}.sv").write_text(STORES, "utf-8")
    script = f"{yowasp.read_rtl(board.cells, 'msn_adc_store')} {stem}.sv; "
    yowasp.yosys(script + yowasp.synthesis(board.synth, "stores"), f"{stem}.log")


def test_a_kept_net_is_one_bit_wide():
    """As above: a kept vector may get a second driver."""
    for source in yowasp.rtl():
        kept = re.findall(r"\(\* *keep *\*\) *logic *(?:signed *)?(\[)?", (ROOT / source).read_text("utf-8"))
        assert not any(kept), source


@pytest.mark.long
def test_an_array_with_multipliers_is_synthesised_for_an_ecp5():
    """The final check of synth_ecp5 elaborates the top again and then misses the modules flattened into
    it."""
    _, cells = bitstream.synthesise(boards.BOARDS["ulx3s"], "fingertip", "build/tb/netlist-mult")
    assert cells["MULT18X18D"] == 1 and cells["LUT4"] > 1000


@pytest.mark.long
@pytest.mark.parametrize("board, name", [("ulx3s", "lanes"), ("icebreaker", "two")])
def test_yosys_makes_a_netlist_with_every_port(board, name, tmp_path):
    board = boards.BOARDS[board]
    folder = f"build/tb/netlist-{board.name}-{name}"
    file = users.write(tmp_path, name, users.CLOCKS[board.name])
    stem, cells = bitstream.synthesise(board, file, folder)
    module = json.loads((ROOT / f"{stem}.json").read_text())["modules"][board.top]
    bits = {port: len(told["bits"]) for port, told in module["ports"].items()}
    assert bits == {port.port: len(port.pins) for port in board.plan(file).ports}
    data = module["ports"]["adc_miso_i"]["bits"]
    read = {bit for cell in module["cells"].values() for net in cell["connections"].values() for bit in net}
    assert set(data) <= read, "a converter's data go nowhere"
    assert cells
