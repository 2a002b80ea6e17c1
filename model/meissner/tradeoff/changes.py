"""Changes of the unpublished constants of the physics, to test which conclusions survive them.

docs/tradeoff.md shows the first list, docs/constants.md the second.
"""

import contextlib
from typing import NamedTuple

from meissner.physics import grip, plate, rubber


class Change(NamedTuple):
    """A changed constant; ``first``: first_event of the condition."""

    name: str
    value: float
    module: object = rubber
    first: float | None = None


CHANGES = (
    Change("QUALITY", 1.0),
    Change("QUALITY", 10.0),
    Change("THICKNESS_MM", 0.5),
    Change("THICKNESS_MM", 1.0),
    Change("PATCHES", 20),
    Change("PATCHES", 1000),
    Change("EVENT_SHARE", rubber.EVENT_SHARE / 4),
    Change("EVENT_SHARE", rubber.EVENT_SHARE / 2),
    Change("EVENT_SHARE", rubber.EVENT_SHARE * 2),
    Change("EVENT_SPREAD", 0.2),
    Change("EVENT_SPREAD", 0.5),
    Change("first event", rubber.PUBLISHED_ONSET, first=rubber.PUBLISHED_ONSET),
    Change("RIPPLE_N", 2 * plate.RIPPLE_N, plate),
    Change("RIPPLE_LIMIT_HZ", 2000.0, plate),
    Change("FRICTION_SPREAD", 0.1, plate),
)
HELD_CHANGES = (
    Change("LEVER_MM", grip.LEVER_MM / 2, grip),
    Change("LEVER_MM", grip.LEVER_MM * 2, grip),
    Change("TILT", 4 * grip.TILT, grip),
    Change("GRIP_RISE", 0.0, grip),
    Change("FRICTION_SPREAD", 0.1, plate),
)


@contextlib.contextmanager
def changed(change):
    """Within this context the constant and those computed from it are changed."""
    if change.first is not None:
        yield
        return
    names = (change.name, *(("RING_HZ", "RING_S") if change.module is rubber else ()))
    before = {name: getattr(change.module, name) for name in names}
    setattr(change.module, change.name, change.value)
    if change.module is rubber:
        rubber.RING_HZ, rubber.RING_S = rubber.ring(rubber.THICKNESS_MM, rubber.QUALITY)
    try:
        yield
    finally:
        for name, value in before.items():
            setattr(change.module, name, value)
