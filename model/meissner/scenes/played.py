"""A scene as a page plays it (``meissner run SCENE --web``): inputs of a core, again and again.

Each sensor's module ``play`` has ``played(scene)``: functions of a seed, one for each part of a core that the
scene drives; none if the scene ends before anything that a packet or a register could report. Each function
gives one of these; meissner.host.sensors makes packets of them.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from importlib import import_module
from typing import TYPE_CHECKING, Any

from meissner.arrays import Bools, Ints
from meissner.builds.units import Units
from meissner.twins.cop.cop_slip import CopSlipRegisters
from meissner.twins.slip.config import SlipConfig

if TYPE_CHECKING:
    from meissner.physics.cop4_config import Cop4Config

SHORT_S = 1.0  # what is shorter is played more slowly, in twice the time,
LEAST_HZ = 4.0  # if that is not slower


@dataclass(frozen=True, kw_only=True)
class Part:
    """``rate_hz``: of its arrays' first axis; ``span``: the length of that; ``units``: of what it reports."""

    rate_hz: float
    span: float
    units: Units = field(default_factory=Units)


@dataclass(frozen=True, kw_only=True)
class Slips(Part):
    """Codes [samples, channels] for the slip path, and for the shear speed with a ShearConfig, ``shear``;
    ``moving`` [samples]: the normal force changes."""

    codes: Ints
    config: SlipConfig
    shear: Any = None
    moving: Bools | None = None


@dataclass(frozen=True, kw_only=True)
class Frames(Part):
    """Forces [frames, rows, columns]; ``min_load``: of a centre of pressure."""

    forces: Ints
    min_load: int = 1


@dataclass(frozen=True, kw_only=True)
class Wires(Part):
    """Codes [samples, 4] of four electrodes; ``registers``, ``lag``: of the slip in their load; ``cop``: the
    centre is reported, too."""

    codes: Ints
    config: "Cop4Config"
    registers: CopSlipRegisters | None = None
    lag: int = 16
    cop: bool = True


@dataclass(frozen=True, kw_only=True)
class Classes(Part):
    """A forest's class and its votes of each frame [frames]; -1 before the first decision."""

    labels: Ints
    votes: Ints


@dataclass(frozen=True, kw_only=True)
class Pins(Part):
    """``frames``: (instant, drive in Hz, levels [rows, columns]) where something changes, instants in units
    of 1 / ``rate_hz``, of which the whole has ``span``; ``bits``: of a level."""

    frames: list[tuple[float, float, Ints]]
    bits: int


@dataclass(frozen=True, kw_only=True)
class Loop(Part):
    """A hand in closed loop: ``begin(turn)`` is meissner.scenes.hand.loop.steps, whose reflexes may be set
    until the next cycles are asked for."""

    begin: Callable[[int], Iterator[Any]]
    config: SlipConfig
    grip: Any  # GripConfig


def played(scene: Any) -> list[Callable[[int], Part]]:
    """What gives each of the scene's parts."""
    found: list[Callable[[int], Part]] = import_module(f"meissner.scenes.{scene.sensor}.play").played(scene)
    return found


def parts(scene: Any, seed: int) -> tuple[list[Part], float]:
    """(the scene's parts, how many times more slowly than in truth they are played); ValueError in one
    sentence if there are none."""
    makers = played(scene)
    if not makers:
        from meissner import scenes

        without = [name for name in scenes.names() if not played(scenes.load(name))]
        raise ValueError(
            f"scene {scene.name} has nothing to show: it ends before a core's packets and registers; every "
            f"scene of `meissner scenes` but {', '.join(without)} has"
        )
    found = [make(seed) for make in makers]
    slow = 1.0
    if (seconds := max(part.span / part.rate_hz for part in found)) < SHORT_S:
        slow = max(1.0, min(2 * SHORT_S / seconds, max(part.rate_hz for part in found) / LEAST_HZ))
    return [replace(part, rate_hz=part.rate_hz / slow) for part in found], slow
