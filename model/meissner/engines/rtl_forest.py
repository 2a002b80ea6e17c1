"""Forests on the Verilated msn_forest: engine ``rtl``'s ``forest``."""

import ctypes
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from meissner.engines import verilated
from meissner.engines.protocol import Waves
from meissner.engines.rtl_cop import TRACE_CLK_KHZ
from meissner.forest import words
from meissner.forest.file import Model

TRACE_ROWS = 4
LOAD = np.dtype([("kind", "u4"), ("engine", "u4"), ("address", "u4"), ("data", "u8")], align=True)


@dataclass(frozen=True)
class Run:
    """``votes`` [rows, classes] and ``index`` of each row; ``steps``: nodes compared in ``clocks`` by
    ``engines``, which took ``seconds`` to simulate. ``alone``: clocks of each row, if each waited for the
    result of the one before."""

    index: NDArray[np.int64]
    votes: NDArray[np.int64]
    steps: int
    clocks: int
    engines: int
    seconds: float
    alone: NDArray[np.int64] | None = None

    @property
    def share(self) -> float:
        """Of the clocks, those in which an engine compares a node."""
        return self.steps / max(self.clocks, 1) / self.engines

    def __str__(self) -> str:
        rows = len(self.index)
        each = self.clocks / max(rows, 1)
        return (
            f"{rows / self.seconds:.0f} decisions/s simulated; {each:.1f} clocks a decision, "
            f"in {100 * self.share:.1f} % of them each of {self.engines} engines compares a node"
        )


def _power(value: int) -> int:
    """The next power of two, so that forests nearly alike share a build."""
    return 1 << max(value - 1, 1).bit_length()


def parameters(model: Model, engines: int, nodes: int) -> dict[str, int]:
    """Of a msn_forest that holds ``model``, with ``nodes`` in its largest engine."""
    trees = -(-len(model.trees) // engines)
    leaves = 1 if len(model.classes) == 2 else _power(len(model.leaves))
    return {
        "Features": len(model.features),
        "Classes": len(model.classes),
        "Trees": _power(trees),
        "Nodes": _power(nodes),
        "Leaves": leaves,
        "Engines": engines,
        "Timeout": _power(2 * len(model.classes) + 4096),
    }


@verilated.cached
def _open(trace: bool, *values: tuple[str, int]) -> ctypes.CDLL:
    lib = ctypes.CDLL(str(verilated.library("msn_forest", "forest_driver.cpp", dict(values), trace)))
    lib.forest_run.restype = ctypes.c_int64
    pointer, number = ctypes.c_void_p, ctypes.c_int64
    lib.forest_run.argtypes = [pointer, number, pointer, number, number, number, ctypes.c_uint32, number]
    lib.forest_run.argtypes += [*[pointer] * 5, ctypes.c_char_p, number, number]
    return lib


def forest(
    q: NDArray[np.int64], model: Model, engines: int = 1, waves: Waves = None, alone: bool = False
) -> Run:
    """Decisions about ``q`` [rows, features], what the nodes of ``model`` compare; it has no missing_left.

    ``waves``: path of a VCD file for the last TRACE_ROWS rows. ``alone``: a row is sent when the one before
    has its result.
    """
    table = np.array(words.loads(model, engines), LOAD)
    nodes = int(table["address"][table["kind"] == words.NODE].max()) + 1
    lib = _open(waves is not None, *parameters(model, engines, nodes).items())
    limit, (count, features), classes = words.THRESHOLD_LIMIT, q.shape, len(model.classes)
    rows = np.ascontiguousarray(q.clip(-limit, limit - 1), np.int32)
    votes, index = np.zeros((count, classes), np.uint32), np.zeros(count, np.int32)
    error, steps, each = np.zeros(count, np.uint8), np.zeros(1, np.int64), np.zeros(count, np.int64)
    timeout = 64 * (nodes + (len(model.trees) + 64) * (classes + 8)) + 64 * features
    begun = perf_counter()
    clocks = lib.forest_run(
        *(table.ctypes.data, len(table), rows.ctypes.data, count, features, classes, words.THRESHOLD_BITS),
        *(timeout, *(array.ctypes.data for array in (votes, index, error, steps))),
        each.ctypes.data if alone else None,
        *(None if waves is None else str(waves).encode(), min(TRACE_ROWS, count), TRACE_CLK_KHZ),
    )
    seconds = perf_counter() - begun
    if clocks < 0 or error.any():
        raise RuntimeError("the core did not give one result per row")
    found = index.astype(np.int64), votes.astype(np.int64), int(steps[0]), int(clocks), engines, seconds
    return Run(*found, each if alone else None)
