"""Engine ``gate``: the netlist after synthesis, in ECP5 cells, with the drivers of engine ``rtl``."""

from functools import cache
from typing import Any

from meissner.engines import rtl
from meissner.engines.verilated import of_gates


@cache
def __getattr__(name: str) -> Any:
    return of_gates(getattr(rtl, name))
