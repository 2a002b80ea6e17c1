"""A core's packets as ROS messages while they arrive, and its thresholds: for the node and the bridges."""

import time
from collections.abc import Iterator, Mapping

from meissner.builds.units import CODES
from meissner.host.core import Core
from meissner.host.packets import Gap, Item
from meissner.host.ros import DIAGNOSE_NS, FRAME_ID, Converter, Message
from meissner.host.stamps import Stamps

BEAT_S = 0.02  # a setting waits at most this long


def beats(core: Core, seconds: float | None, every_s: float) -> Iterator[tuple[Item | None, bool]]:
    """Yield (packet, whether ``every_s`` passed again), and (None, True) where no packet came in time."""
    end = None if seconds is None else time.monotonic() + seconds
    following = time.monotonic() + every_s
    while True:
        now = time.monotonic()
        left = every_s if end is None else min(every_s, end - now)
        if left <= 0:
            return
        for item in core.packets(min(left, max(0.0, following - now) + 1e-3)):
            beat = time.monotonic() >= following
            if beat:
                following = time.monotonic() + every_s
            yield item, beat
        if core.ended:
            return
        if time.monotonic() >= following:
            following = time.monotonic() + every_s
            yield None, True


def stream(
    core: Core, seconds: float | None = None, frame_id: str = FRAME_ID
) -> Iterator[tuple[int, str, Message] | None]:
    """(ns of UTC, topic, message) as packets arrive, and None at least every BEAT_S: time for settings."""
    convert, stamps, told = Converter(core.units, core, frame_id), Stamps(core, follow=True), 0.0
    core.ask_states()
    for item, beat in beats(core, seconds, BEAT_S):
        if item is not None:
            for stamp, one in stamps.next(item):
                for topic, message in convert.messages(stamp, one):
                    yield stamp, topic, message
        if isinstance(item, Gap):
            core.ask_states()
        if beat and time.monotonic() >= told:
            told = time.monotonic() + DIAGNOSE_NS / 1e9
            stamp = time.time_ns()
            yield stamp, *convert.diagnostics(stamp)
        if beat:
            yield None


def thresholds(core: Core) -> list[str]:
    """The names of the thresholds, levels, times and loads that this core lets a host set."""
    if not core.registers:
        return []
    groups = ("slip", "cop", "cop4", "cop_slip")
    names = dict.fromkeys(name for name, _ in CODES if name.split(".")[0] in groups)
    return [name for name in names if name in core.names()]


def set_thresholds(core: Core, values: Mapping[str, float]) -> dict[str, int]:
    """Write them for the same frame and read them back.

    Raises
    ------
    ValueError
        If the core cannot take one of them, or reads back another value: all are as before.
    OSError
        If the core does not answer.
    """
    codes: dict[str, int] = {}
    for name, value in values.items():
        if name not in thresholds(core):
            raise ValueError(f"{name} is no threshold of this core")
        whole = isinstance(value, int | float) and not isinstance(value, bool) and float(value).is_integer()
        if not whole:
            raise ValueError(f"{name} = {value!r} must be an integer, in codes")
        codes[name] = int(value)
        core.check(name, codes[name])
    if not codes:
        return {}
    with core.impatient():
        before = {name: core[name] for name in codes}
        found = _written(core, codes)
        wrong = {name: value for name, value in codes.items() if found[name] != value}
        if wrong:
            _written(core, before)
    for name, value in wrong.items():
        raise ValueError(f"{name} reads back {found[name]} where {value} was written: it is as before")
    return found


def _written(core: Core, codes: Mapping[str, int]) -> dict[str, int]:
    with core.together():
        for name, value in codes.items():
            core[name] = value
    return {name: core[name] for name in codes}
