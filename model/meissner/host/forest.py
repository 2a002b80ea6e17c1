"""A forest (F.json) in a core: written over its registers while it runs; rows of a host, decided by it.

A core decides by the old forest until all of the new one is written, then by the new one.
"""

from itertools import groupby

import numpy as np
from numpy.typing import ArrayLike

from meissner.forest import place, words
from meissner.forest.cost import Size, size_of
from meissner.forest.file import Model
from meissner.forest.forest import Forest, ForestResult
from meissner.host.core import Core
from meissner.host.load import TRIES, wait
from meissner.twins.forest.sdram import BANK_WORDS, WORDS

WHAT = "the forest"
RUN = 256  # writes that are done again if one of them was sent twice
Row = tuple[int, int, int, int]  # kind, engine, address, data (rtl/forest/msn_forest.sv)


def load(core: Core, model: Model) -> None:
    """Write ``model`` into ``core`` and use it, and again after each reset.

    Raises
    ------
    ValueError
        If the core cannot take this forest, or refuses a write.
    OSError
        If the core is reset again and again meanwhile, or does not answer.
    """
    given, model = model, check(core, model)
    core.forget(WHAT)
    rows = _rows(core, model)
    for _ in range(TRIES):
        restarts = core.counts.restarts
        if _write(core, rows) and core.counts.restarts == restarts:
            break
    else:
        raise OSError("the core was reset, or lost writes, in each attempt to write its forest")
    core.keep(WHAT, lambda: load(core, given))


def columns(core: Core, model: Model) -> tuple[Model, words.Inputs]:
    """The forest and its inputs as ``core`` takes them: in a frame no value is missing."""
    frames, features = (core[f"forest.size.{key}"] for key in ("frames", "features"))
    return words.without_missing(model, 0 if frames else features)


def check(core: Core, model: Model) -> Model:
    """``model`` as ``core`` takes it; ValueError with one sentence if the core has no room for it."""
    if not core.registers:
        raise ValueError("this core is only listened to: a forest is loaded over its registers")
    if "forest" not in core.features:
        raise ValueError("this core is built without a forest: [forest] in its configuration")
    if core["forest.size.frames"] and any(each.thresholds is not None for each in model.features):
        raise ValueError("this core makes its rows from frames, which are integers: export --integer all")
    model = columns(core, model)[0]
    room = Size(
        features=core["forest.size.features"],
        classes=core["forest.room.classes"],
        trees=core["forest.room.trees"],
        nodes=core["forest.nodes"],
        leaves=core["forest.leaves"] or 1,
        bits=core["forest.size.bits"],
    )
    words.check(model)
    need = size_of(model, max(1, core["forest.size.engines"]))
    for name, least in vars(need).items():
        there = getattr(room, name)
        if least != there if name in ("features", "classes") else least > there:
            of = " for an engine" if name in ("trees", "nodes") else ""
            raise ValueError(f"the forest needs {least} {name}{of} but the core has {there}")
    return model


def _rows(core: Core, model: Model) -> list[Row]:
    if core["forest.nodes"] == WORDS:
        return place.loads(place.place(model, room=BANK_WORDS // core["forest.size.banks"]))
    return sorted(words.loads(model, core["forest.size.engines"]))


def _runs(rows: list[Row]) -> list[list[Row]]:
    """Rows of one target at addresses that follow each other, at most RUN."""
    near = lambda at: (at[1][:2], at[1][2] - at[0], at[0] // RUN)
    return [[row for _, row in run] for _, run in groupby(enumerate(rows), key=near)]


def _write(core: Core, rows: list[Row]) -> bool:
    """Whether nothing was refused; a write sent twice may have been, since it moves those after it."""
    wait(core, "forest.state.swapping", 0, "the core did not end an earlier load")
    core["forest.clear"] = 1
    for run in _runs(rows):
        for _ in range(TRIES):
            retries = core.counts.retries
            _put(core, run)
            if core.counts.retries == retries:
                break
    wait(core, "forest.state.waits", 0, "the core did not take a write")
    if core["forest.state.refused"]:
        return False
    core["forest.swap"] = 1
    wait(core, "forest.state.swapping", 0, "the core did not take the forest")
    return bool(core["forest.state.loaded"])


def _put(core: Core, run: list[Row]) -> None:
    kind, engine, address, _ = run[0]
    label = address >> 16 if kind == words.VOTE else 0
    core["forest.target"] = kind | engine << 2 | label << 8
    core["forest.address"] = address & 0xFFFF if kind == words.VOTE else address
    high = None
    for _, _, _, data in run:
        if kind == words.NODE and data >> 32 != high:
            core["forest.high"] = high = data >> 32
        core["forest.data"] = data & 0xFFFF_FFFF


def decide(core: Core, forest: Forest, x: ArrayLike) -> ForestResult:
    """The core's decisions about rows of features [rows, features], by a forest loaded before.

    Raises
    ------
    ValueError
        For rows as Forest.quantise refuses them, a core that makes its rows from frames, and a decision that
        the core could not make.
    """
    if core["forest.size.frames"]:
        raise ValueError("this core makes its rows from frames: source = 'host' in its configuration")
    q, missing = forest.quantise(x)
    q = columns(core, forest.model)[1].of(q, missing)
    votes = np.zeros((len(q), len(forest.classes_)), np.int64)
    for row, values in enumerate(q.tolist()):
        for index, value in enumerate(values):
            top = words.THRESHOLD_LIMIT
            held = min(max(value, -top), top - 1)
            core["forest.feature"] = held & 2 * top - 1 | index << 22
        done = core["forest.decisions"]
        core["forest.start"] = 1
        wait(core, "forest.decisions", done, "the core did not decide", other=True)
        if error := core["forest.state.error"]:
            raise ValueError(f"row {row}: the core did not decide: forest.state.error is {error}")
        for label in range(votes.shape[1]):
            core["forest.select"] = label
            votes[row, label] = core["forest.votes"]
    return ForestResult(votes.argmax(1), votes)
