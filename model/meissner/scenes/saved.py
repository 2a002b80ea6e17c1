"""The time that a scene saves against everything on; tools/saved.py records it and reports stale records."""

import json
from contextlib import contextmanager
from functools import cache
from importlib import resources

FILE = "saved.json"


@cache
def _recorded():
    try:
        return json.loads((resources.files(__package__) / FILE).read_text("utf-8"))
    except FileNotFoundError:
        return {}


def compared(scene_ms, full_ms):
    """Compare a scene with everything on, both in milliseconds of world and engine per simulated second."""
    return {
        "scene_ms_per_s": scene_ms,
        "full_ms_per_s": full_ms,
        "times_faster": round(full_ms / scene_ms, 1),
    }


_measured = []  # comparisons of the runs in progress


@contextmanager
def measured(found):
    """Within this context ``of`` returns ``found``, if it is not None."""
    _measured.append(found)
    try:
        yield
    finally:
        _measured.pop()


def of(scene, engine):
    """The comparison of a scene on an engine, measured now or recorded; else its record on fixed, or None."""
    if _measured and _measured[-1] is not None:
        return _measured[-1]
    for other in (engine, "fixed"):
        recorded = _recorded().get(other, {})
        if scene.name in recorded.get("scenes", {}):
            own, every = recorded["scenes"][scene.name], recorded["full"].values()
            found = compared(own["ms"], sum(part["ms"] for part in every))
            return found | {"engine": other, "on": min(own["on"], *(part["on"] for part in every))}
    return None


def tell(scene, engine, found):
    """The line to print for the result of ``of``."""
    command = f"meissner run {scene} --engine {found['engine'] if found else engine} --full"
    if found is None:
        return f"saved: not measured; `{command}` measures it"
    when = f"recorded {found['on']} by" if "on" in found else "measured now, by"
    return (
        f"saved: {found['times_faster']:g} times faster than with everything on: per simulated second, world "
        f"and engine take {found['scene_ms_per_s']:.4g} ms, with everything on "
        f"{found['full_ms_per_s']:.5g} ms ({when} `{command}`)"
    )
