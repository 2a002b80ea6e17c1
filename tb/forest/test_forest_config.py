"""[forest] of a configuration: parameters and settings by hand, from a file and without one; each limit met,
and one beyond refused in one sentence with its place; block RAMs of boards; a build without a sensor."""

import json
import random

import pytest

from forest.trees import forest
from meissner.builds import board_files, boards, config
from meissner.builds.features.forest import LARGEST
from meissner.builds.pins import assign as pins_of
from meissner.builds.pins import description as pins_description
from meissner.forest import file
from meissner.forest.cost import bits_of

FINGER = {
    "about": "of a test",
    "clock": {"mhz": 50.0},
    "sensor": {"kind": "array", "rows": 3, "columns": 3},
    "adc": {"part": "MAX11125", "channels": 3, "volts": 3.3, "rate_hz": 40.0},
    "forest": {"window": 6},
}
HOST = {"about": "of a test", "clock": {"mhz": 12.0}, "sensor": {"kind": "none"}, "link": {"baud": 1_000_000}}
HOST |= {"forest": {"source": "host", "features": 5}}


def of(tables, **change):
    return config.read("a", tables | {"forest": tables["forest"] | change})


def parameters(build):
    return {
        name.removeprefix("Forest"): value for name, value in build.parameters.items() if "Forest" in name
    }


def test_sizes_by_hand():
    common = {
        "": 1,
        "Classes": 2,
        "Trees": 64,
        "Nodes": 1024,
        "Leaves": 256,
        "Engines": 1,
        "Banks": 2,
        "Lanes": 4,
    }
    common |= {"Sdram": 0}
    assert parameters(of(FINGER)) == common | {"Frames": 1, "Features": 54, "Bits": 18}
    assert parameters(of(HOST)) == common | {"Frames": 0, "Features": 5, "Bits": 22}
    given = {
        "classes": 3,
        "trees": 7,
        "nodes": 99,
        "leaves": 5,
        "engines": 2,
        "banks": 1,
        "lanes": 2,
        "bits": 9,
    }
    expected = {name.capitalize(): value for name, value in given.items()}
    assert parameters(of(HOST, **given)).items() >= expected.items()
    build = of(FINGER, slip=[1], classes=3)
    assert (build.settings["forest.slip"], build.settings["forest.grip"]) == (2, 1)
    assert (
        of(HOST, slip=[4, 0], classes=5, grip=False).settings | {"forest.grip": 0, "forest.slip": 17}
        == of(HOST, slip=[4, 0], classes=5, grip=False).settings
    )
    nothing = of(HOST)
    assert nothing.parameters.items() >= {"Adc": 0, "Channels": 1, "Slip": 0}.items()
    assert set(nothing.settings) == {"link.images", "forest.slip", "forest.grip"}


def test_sizes_of_a_file(tmp_path):
    """Of each engine, the fullest; a class by its label; the bits in which no threshold is lost."""
    given = forest(random.Random(4), 54, 3, 9, leaves=5, span=100, depth=3)
    path = tmp_path / "F.json"
    file.write(path, given)
    own = [max(len(tree.feature), 1) for tree in given.trees]
    (tmp_path / "a.toml").write_text(
        "about = 'a'\nclock = {mhz = 50.0}\nsensor = {kind = 'array', rows = 3, columns = 3}\n"
        "adc = {part = 'MAX11125', channels = 3, volts = 3.3, rate_hz = 40.0}\n"
        "forest = {file = 'F.json', window = 6, slip = [2]}\n"
    )
    found = config.load(tmp_path / "a.toml")
    assert parameters(found).items() >= {"Nodes": sum(own), "Trees": 9, "Leaves": 5, "Bits": 8}.items()
    assert found.settings["forest.slip"] == 4
    with pytest.raises(
        ValueError, match=r"\[forest\]: slip = 3 must be one of the first 32 classes: 0, 1, 2$"
    ):
        of(FINGER, file=str(path), slip=[3])
    for key, least in (("nodes", sum(own)), ("trees", 9), ("leaves", 5), ("bits", 8)):
        assert parameters(of(FINGER, file=str(path), **{key: least}))[key.capitalize()] == least
        with pytest.raises(
            ValueError, match=rf"\[forest\]: {key} = {least - 1} must be at least {least} for"
        ):
            of(FINGER, file=str(path), **{key: least - 1})
    for classes in (2, 4):
        with pytest.raises(ValueError, match=rf"\[forest\]: classes = {classes} must be 3 for"):
            of(FINGER, file=str(path), classes=classes)
    with pytest.raises(ValueError, match=r"\[forest\]: the forest in .* has 54 features but a row has 45"):
        of(FINGER, file=str(path), window=5)
    ranked = json.loads(path.read_text())
    for feature in ranked["features"]:
        feature |= {"kind": "float", "thresholds": [float(n) for n in range(300)]}
    for tree in ranked["trees"]:
        tree["threshold"] = [abs(value) for value in tree["threshold"]]
    del ranked["crc32"]
    file.write(path, file.check(ranked))
    with pytest.raises(ValueError, match=r"\[forest\]: .* compares ranks of x0, .*--integer all"):
        of(FINGER, file=str(path))


def test_the_greatest_rate_leaves_time_for_a_decision(tmp_path):
    file.write(tmp_path / "F.json", forest(random.Random(4), 54, 3, 900, leaves=5, span=100, depth=3))
    rate = lambda hz: FINGER | {"adc": FINGER["adc"] | {"rate_hz": hz}, "link": {"baud": 12_500_000}}
    found = of(rate("max"), file=str(tmp_path / "F.json"))
    assert found.period_clocks > 2 * found.least_period
    with pytest.raises(ValueError, match=r"too fast for \[forest\]: a decision takes up to"):
        of(rate(5e7 / (found.period_clocks - 1)), file=str(tmp_path / "F.json"))


def test_bits_hold_every_threshold_and_what_is_beyond():
    """t in b bits: -2^(b-1) <= t <= 2^(b-1) - 2, so that a value that is held goes the same way."""
    for bits in (2, 5, 22):
        top = 1 << bits - 1
        for threshold, needed in ((top - 2, bits), (top - 1, bits + 1), (-top, bits), (-top - 1, bits + 1)):
            tree = {"feature": [0], "threshold": [threshold], "left": [-1], "right": [-2]}
            assert bits_of(forest(random.Random(1), 1, 2, [tree], leaves=2)) == max(needed, 2)


@pytest.mark.parametrize(
    "tables, change, says",
    [
        (FINGER, {"window": None}, r"\[forest\]: window must be given with source = 'frames'"),
        (FINGER, {"source": "host", "features": 3}, r"\[forest\]: window must not be given"),
        (FINGER, {"features": 54}, r"\[forest\]: features = channels times window"),
        (FINGER, {"window": 29}, r"\[forest\]: 261 features, channels times window, are more than 256"),
        (HOST, {"features": 257}, r"\[forest\]: features = 257 must lie in 1 .. 256"),
        (HOST, {"features": None}, r"\[forest\]: features must be given, or a file"),
        (HOST, {"slip": [32], "classes": 33}, r"\[forest\]: slip = 32 must be one of the first 32 classes"),
        (HOST, {"memory": "sdram"}, r"\[clock\]: mhz = 12 must be 100 with memory = 'sdram'"),
        (HOST, {"memory": "sdram", "engines": 2}, r"\[forest\]: engines = 2 must be 1 with memory = 'sdram'"),
        (
            HOST,
            {"source": "frames", "window": 2, "features": None},
            "source = 'frames' must be 'host' with kind = 'none'",
        ),
        (
            HOST,
            {"nodes": 1 << 20},
            rf"1048576 nodes for each of 1 engines in 2 banks need \d+ .* the {LARGEST[0]} has 207",
        ),
    ],
)
def test_refuses(tables, change, says):
    kept = {key: value for key, value in (tables["forest"] | change).items() if value is not None}
    with pytest.raises(ValueError, match=says):
        config.read("a", tables | {"forest": kept})


def test_what_goes_with_it():
    with pytest.raises(ValueError, match=r"\[forest\] must go with .* registers = true"):
        config.read("a", HOST | {"link": {"registers": False, "baud": 9600}})
    grip = FINGER | {"grip": {}}
    assert config.read("a", grip).parameters["Grip"] == 1
    del grip["forest"]
    with pytest.raises(ValueError, match=r"\[grip\] must go with \[forest\] for kind = .array."):
        config.read("a", grip)
    with pytest.raises(ValueError, match=r"\[sensor\]: kind = 'none' must go with \[forest\]"):
        config.read("a", {key: value for key, value in HOST.items() if key != "forest"})


def test_block_rams_of_boards(tmp_path):
    """1280 nodes of 2 + 3 + 22 + 32 bits: 18.4 times the 256 · 16 bits of an iCE40's RAM; roots of 11 bits:
    0.7 for each 256. Two decisions' rows take 2, places and queues 1 + 1 + 2; 29 of a UP5K's 30 are for the
    forest. The largest device is the board's with the most."""
    most = max(
        (count, f"{board.name} {name}".strip(), board.cells)
        for board in boards.BOARDS.values()
        for name, count in board.rams.items()
    )
    assert (most[1], most[2], most[0]) == LARGEST
    text = (
        "about = 'a'\nclock = {mhz = 12.0}\nsensor = {kind = 'none'}\nlink = {baud = 1000000}\n"
        "forest = {source = 'host', features = 5, banks = 1, nodes = 1280, trees = %d}\n"
    )
    path, board = tmp_path / "mine.toml", boards.BOARDS["icebreaker"]
    path.write_text(text % 1280)  # 19 + 4 + 6
    plan = board.plan(str(path))
    assert {port.role for port in plan.ports} >= {"clock", "rx", "tx"} and "miso" not in plan.roles
    path.write_text(text % 1281)
    with pytest.raises(
        ValueError, match=r"1280 nodes .* need 30 block RAMs but the icebreaker has 29 for them: .*--fit"
    ):
        board.plan(str(path))


def test_an_sdram_has_its_pins(tmp_path):
    """On the ULX3S, by its board's list; a board without one is refused, and so is another clock."""
    path = tmp_path / "mine.toml"
    text = (
        "about = 'a'\nclock = {mhz = %s}\nsensor = {kind = 'none'}\n"
        "forest = {source = 'host', features = 5, memory = 'sdram', trees = 400}\n"
    )
    path.write_text(text % 100.0)
    plan = boards.BOARDS["ulx3s"].plan(str(path))
    pins = {name: pin for port in plan.ports for name, pin in port.bits}
    assert (pins["sdram_clk_o"], pins["sdram_dq_io[0]"], pins["sdram_dq_io[15]"]) == ("F19", "J16", "J17")
    assert (pins["sdram_ba_o[1]"], pins["sdram_a_o[12]"], pins["sdram_dqm_o[0]"]) == ("N20", "G19", "U19")
    assert {row["direction"] for row in plan.rows() if "dq_io" in row["port"]} == {"inout"}
    top = board_files.top(plan)
    assert "inout  wire [15:0] sdram_dq_io" in top and ".Q(sdram_clk_o)" in top
    assert "assign sdram_we_n_o = sdram.we_n;" in top and ".sdram_dq_i  (sdram_dq_io)" in top
    macros = boards.sizes(boards.BOARDS["ulx3s"].parameters(str(path)))
    assert macros["SDRAM"] == 1 and "SDRAM" not in boards.sizes(of(HOST).parameters)
    with pytest.raises(ValueError, match="mine has a forest in an SDRAM but the icebreaker has none"):
        pins_of(pins_description("icebreaker"), "mine", of(HOST).parameters | {"ForestSdram": 1})
