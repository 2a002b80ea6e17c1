"""The host library for a connected core: docs/host.md.

with meissner.host.connect("serial:/dev/ttyUSB0?baud=3000000") as core:
    core["slip.threshold"] = 40
    for packet in core.packets():
        print(packet)
"""

from typing import Any

from meissner.builds.units import Units
from meissner.host.core import Core, NoAnswer, Refused
from meissner.host.line import open_line
from meissner.host.packets import (
    ClassChange,
    CopFrame,
    Gap,
    Health,
    Image,
    SlipEvent,
    StateChange,
    States,
    Statistics,
)

__all__ = [
    "ClassChange",
    "CopFrame",
    "Core",
    "Gap",
    "Health",
    "Image",
    "NoAnswer",
    "Refused",
    "SlipEvent",
    "StateChange",
    "States",
    "Statistics",
    "Units",
    "connect",
    "open_line",
]


def connect(
    url: str,
    units: Units | None = None,
    registers: bool | None = None,
    baud: int | None = None,
    **settings: Any,
) -> Core:
    """The Core at ``url``, found and checked.

    Parameters
    ----------
    url : str
        A line of meissner.host.line.
    units : Units, optional
        Facts that the core does not know about itself.
    registers : bool, optional
        False only listens, to a core built without registers; None reads registers, unless the line is a
        file or a core in this process that has none.
    baud : int, optional
        Of a serial port, unless the url gives it.
    **settings
        timeout_s (of a command), retries, give_up_s (for an interrupted line during an access), say (a
        function that takes a sentence).

    Raises
    ------
    ValueError
        For a url that is no line, or a core (Refused) that this host does not support.
    NoAnswer
        If no core answers.
    """
    line = open_line(url, baud)
    pipe = getattr(line, "pipe", None)
    try:
        asks = getattr(pipe, "registers", True)
        if registers and not asks:
            raise ValueError(f"{url} is built without registers: it can only be listened to (meissner live)")
        if registers is None:
            registers = not url.startswith("file:") and bool(asks)
        return Core(line, units or getattr(pipe, "units", None), registers, **settings)
    except BaseException:
        line.close()
        raise
