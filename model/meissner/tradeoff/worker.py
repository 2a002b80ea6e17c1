"""What a process measures: points of an axis; and the workers of Dask, which may do that."""

import json
from contextlib import contextmanager
from importlib import import_module


def rounded(value):
    """Figures rounded to nine digits: further digits depend on the order in which a library adds."""
    if isinstance(value, dict):
        return {key: rounded(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [rounded(each) for each in value]
    if hasattr(value, "item"):
        value = value.item()
    return float(f"{value:.9g}") if isinstance(value, float) else value


def measured(axis, point):
    """{"cost", "error"} of a point of ``axis``."""
    return rounded({"cost": axis.cost(point), "error": axis.error(point)})


def answers(where, name, points):
    """For each point {"found": ``measured`` for the axis ``name`` in AXES of module ``where``}, or
    {"problem": why}."""
    axis, found = next(axis for axis in import_module(where).AXES if axis.name == name), []
    for point in points:
        try:
            found.append({"found": json.loads(json.dumps(measured(axis, point), allow_nan=False))})
        except Exception as problem:
            found.append({"problem": f"{type(problem).__name__}: {problem}"})
    return found


@contextmanager
def cluster(address):
    """An executor with the workers of a Dask scheduler, which need this package, too."""
    try:
        from dask.distributed import Client
    except ImportError:
        raise ValueError("--scheduler needs Dask: pip install 'meissner-touch[dask]'") from None
    try:
        client = Client(address, timeout="20s")
    except (OSError, ValueError) as problem:
        raise ValueError(f"no scheduler answers at {address}: {problem}") from None
    with client:
        yield client.get_executor(pure=False)
