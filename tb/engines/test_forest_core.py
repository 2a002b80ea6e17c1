"""A forest in the core, on engine rtl, from codes at the pins to packets, registers and the reflex, against
the models: loaded by the host's library while frames come, replaced by another in the middle; rows that a
host writes to a core without a sensor; nodes in an SDRAM; the examples; what cannot be loaded."""

import random
import tomllib

import numpy as np
import pytest
from sklearn.ensemble import RandomForestClassifier

import bench
from forest.trees import forest, rows
from meissner import Forest, host
from meissner.builds import config
from meissner.builds.toolchain import ROOT
from meissner.engines.rtl_core import CoreOnPins
from meissner.host import forest as loader
from meissner.host import line
from meissner.host.simulated import SimulatedCore
from meissner.twins import core as twins

FINGER = {
    "about": "of a test",
    "clock": {"mhz": 4.0},
    "sensor": {"kind": "array", "rows": 3, "columns": 3},
    "adc": {"part": "MCP3208", "channels": 3, "volts": 5.0, "rate_hz": 1000.0, "settle_us": 2.0},
    "array": {"tare": False},
    "forest": {"window": 2, "slip": [1], "classes": 3, "engines": 2, "trees": 4, "nodes": 64, "bits": 13},
    "grip": {"cycle_ms": 1.0, "silent_ms": 5000.0, "step": 50},
    "link": {"baud": 1_000_000, "statistics": False},
}
MOVES = 700  # frames; then the sensor rests


def labelled(build, given, forces):
    """{frame: (class, votes, slips)} by the model with this forest."""
    classify = twins.classify_of(build)
    for row in loader.words.loads(given, 2):
        classify.load(*row)
    classify.swap()
    return {frame: (of.label, int(of.votes.max()), of.slips) for frame, of in classify.next(forces.T)}


def told(labels):
    """[(frame, class, class before, votes)] of the changes in {frame: (class, votes, ..)}."""
    found, before = [], None
    for frame, (label, votes, _) in labels.items():
        found += [(frame, label, before, votes)] if label != before else []
        before = label
    return found


@pytest.mark.long
def test_from_frames_to_the_hand():
    """Every packet is one of the first forest's or, from one frame on, of the second's; the command has a
    step for each decision for class 1."""
    build, draw = config.read("finger", FINGER), random.Random(bench.SEED)
    first, second = (forest(draw, 18, 3, 8, leaves=9, span=400, depth=3) for _ in range(2))
    rng = np.random.default_rng(bench.SEED)
    codes = np.clip(2000 + np.cumsum(rng.integers(-260, 261, (5 * MOVES, 3, 3)), axis=0) % 1900, 0, 4095)
    codes[MOVES:] = codes[MOVES]
    got = []
    with (
        CoreOnPins(build, codes) as built,
        host.Core(line.Pipe(built), build.units, timeout_s=600.0) as core,
    ):

        def until(frame):
            while built.frames < frame:
                got.extend(core.packets(0.02))

        loader.load(core, first)
        assert core["forest.state.loaded"] and core["forest.absent"] > 0
        absent = core["forest.absent"]
        until(built.frames + 150)
        loader.load(core, second)
        assert built.frames < MOVES - 100
        until(MOVES + 60)
        seen = {name: core[f"forest.{name}"] for name in ("absent", "late", "broken", "missed", "label")}
        command, closed = core["grip.command"], core["grip.tightenings"]
    starts = [q.time for q in got if isinstance(q, host.CopFrame)]
    zero = starts[0] % build.period_clocks  # of the first frame, soon after the reset
    assert zero < 100 and all(at % build.period_clocks == zero for at in starts)
    told_by = [q for q in got if isinstance(q, host.ClassChange)]
    packets = [(q.time // build.period_clocks, q.label, q.before, q.votes) for q in told_by]
    assert all(q.time % build.period_clocks == zero for q in told_by)
    frames = MOVES + 60
    forces = twins.expected(build, codes[:frames]).images
    one, two = (labelled(build, given, forces) for given in (first, second))
    begins, ways = packets[0][0], []
    for swapped in range(begins + 1, frames):
        joined = {at: (one if at < swapped else two)[at] for at in range(begins, frames)}
        if told(joined) == packets:
            ways.append(sum(slips for *_, slips in joined.values()))
    assert ways and len(packets) > 40 and len({label for _, label, *_ in packets}) == 3
    assert seen == {"absent": absent, "late": 0, "broken": 0, "missed": 0, "label": packets[-1][1]}
    assert 1024 + 50 * closed == command and closed in ways and closed > 30


@pytest.mark.long
def test_rows_of_a_host_need_no_sensor():
    """The iCEBreaker's example on engine rtl: votes of every class as in Python; another number of features,
    too many trees, and thresholds beyond the build's bits are refused."""
    build = config.load(ROOT / "examples/forest/host_icebreaker.toml")
    draw = random.Random(bench.SEED)
    given = forest(draw, 16, 3, 20, leaves=9, span=2000, depth=4)
    wide, many = forest(draw, 16, 3, 1, span=2100, depth=3), forest(draw, 16, 3, 101)
    model, x = Forest(given), rows(draw, given, 8, 2048)
    with (
        CoreOnPins(build, np.zeros((1, 1))) as built,
        host.Core(line.Pipe(built), build.units, timeout_s=600.0) as core,
    ):
        assert core.features == ["link", "forest"]
        for wrong, says in (
            (forest(draw, 15, 3, 1), "features"),
            (wide, "bits"),
            (many, "trees for an engine"),
        ):
            with pytest.raises(ValueError, match=rf"the forest needs .* {says} .*but the core has"):
                loader.load(core, wrong)
        with pytest.raises(ValueError, match=r"did not decide: forest\.state\.error is 1"):
            loader.decide(core, model, x[:1])
        loader.load(core, given)
        assert loader.decide(core, model, x).votes.tolist() == model.process(x).votes.tolist()


class Sizes(dict):
    """A core's registers of sizes, as a host reads them."""

    registers, features = True, ("link", "forest")


def test_a_forest_of_scikit_learn_has_a_column_per_feature_where_nothing_is_missing(tmp_path):
    """scikit-learn writes into every forest where missing values go. Frames have none; a host's core has the
    columns for them, or, with as many features as the forest, refuses them."""
    x = np.random.default_rng(1).integers(-99, 99, (300, 18))
    trained = RandomForestClassifier(5, random_state=1).fit(x, x[:, 0] > x[:, 5])
    given = Forest(trained, integer=True)
    given.to_file(tmp_path / "F.json")
    wide = len({(f, m) for each in given.model.trees for f, m in zip(each.feature, each.missing_left)})
    assert wide > 18
    of = lambda **more: {"file": str(tmp_path / "F.json")} | more
    frames = config.read("a", FINGER | {"forest": of(window=2)})
    alone = {"about": "of a test", "clock": {"mhz": 12.0}, "sensor": {"kind": "none"}}
    hosts = [
        config.read("a", alone | {"forest": of(source="host", **more)}) for more in ({}, {"features": 18})
    ]
    for build, features in ((frames, 18), (hosts[0], wide), (hosts[1], 18)):
        size = build.parameters
        assert size["ForestFeatures"] == features
        named = {"size": ("features", "bits", "engines", "frames"), "room": ("classes", "trees")}
        of = [(group, key) for group, keys in named.items() for key in keys]
        core = Sizes({f"forest.{group}.{key}": size[f"Forest{key.capitalize()}"] for group, key in of})
        core |= {"forest.leaves": 0, "forest.nodes": size["ForestNodes"]}
        _, inputs = loader.columns(core, given.model)
        twin = twins.classify_of(build)
        for row in loader.words.loads(loader.check(core, given.model), 1):
            twin.load(*row)
        twin.swap()
        q, _ = given.quantise(x)
        votes = [found.votes.tolist() for found in twin.rows(inputs.of(q, None))]
        assert votes == given.process(x).votes.tolist()
        holes = np.where(np.arange(18) == 7, np.nan, x[:1])
        if features == wide:
            found = next(twin.rows(inputs.of(*given.quantise(holes)))).votes
            assert found.tolist() == given.process(holes).votes[0].tolist()
        else:
            with pytest.raises(ValueError, match="row 0: feature 7 is NaN"):
                inputs.of(*given.quantise(holes))


def test_a_core_that_cannot_be_loaded_says_why():
    given = forest(random.Random(1), 6, 2, 1)
    for features, says in (
        (["link"], "built without a forest"),
        (["link", "forest"], "6 features but the core has 0"),
    ):
        core = host.Core(line.Pipe(SimulatedCore(features=features)))
        with core, pytest.raises(ValueError, match=says):
            loader.load(core, given)


def test_examples_are_builds():
    """Their sizes by hand; in two banks the one of the ULX3S does not fit."""
    rope = tomllib.loads((ROOT / "examples/forest/rope_ulx3s.toml").read_text("utf-8"))
    build = config.read("rope", rope)
    assert (
        build.parameters.items()
        >= {"Forest": 1, "ForestFeatures": 54, "ForestNodes": 49_152, "Grip": 1}.items()
    )
    assert build.settings.items() >= {"forest.slip": 2, "forest.grip": 1}.items()
    outside = config.load(ROOT / "examples/forest/sdram_ulx3s.toml").parameters
    assert outside.items() >= {"ForestSdram": 1, "ForestNodes": 1 << 21, "ClkKhz": 100_000}.items()
    with pytest.raises(ValueError, match=r"\[forest\]: 49152 nodes .* 2 banks need .* ulx3s 85F has 207"):
        config.read("rope", rope | {"forest": rope["forest"] | {"banks": 2}})


@pytest.mark.long
def test_a_forest_in_an_sdram():
    """The nodes at the pins of a memory, loaded and swapped twice; the same votes."""
    tables = {"about": "of a test", "clock": {"mhz": 100.0}, "sensor": {"kind": "none"}}
    tables |= {"forest": {"source": "host", "memory": "sdram", "features": 5, "classes": 2, "trees": 9}}
    build, draw = config.read("outside", tables), random.Random(bench.SEED)
    with (
        CoreOnPins(build, np.zeros((1, 1))) as built,
        host.Core(line.Pipe(built), build.units, timeout_s=600.0) as core,
    ):
        for _ in range(2):
            given = forest(draw, 5, 2, 9, leaves=9, span=2000, depth=5)
            model, x = Forest(given), rows(draw, given, 6, 4000)
            loader.load(core, given)
            assert loader.decide(core, model, x).votes.tolist() == model.process(x).votes.tolist()
