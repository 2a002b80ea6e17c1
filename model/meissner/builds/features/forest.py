"""[forest] of a build: sizes of the forest that classifies windows of frames, or features in registers."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from msgspec import Meta

from meissner.forest import cost, file, words
from meissner.tables import Table

if TYPE_CHECKING:
    from meissner.builds.build import Config

PARAMETERS = {"Forest": 1}
TAKES = "a decision"
SDRAM_KHZ = 100_000  # docs/sdram.md: with four clocks from a command to its data
SLIPS = 32  # classes that forest.slip has a bit for
LARGEST = "ulx3s 85F", "ecp5", 208  # the device with the most block RAM


class Keys(Table, frozen=True):
    """The table; sizes that it leaves out are those that ``file`` needs."""

    file: str | None = None
    source: Literal["frames", "host"] = "frames"
    window: Annotated[int, Meta(ge=1, le=256)] | None = None
    slip: tuple[int | str | bool | float, ...] = ()
    grip: bool = True
    engines: Annotated[int, Meta(ge=1, le=64)] = 1
    banks: Literal[1, 2] = 2
    lanes: Literal[1, 2, 4, 8, 16, 32, 64] = 4
    memory: Literal["block_ram", "sdram"] = "block_ram"
    features: Annotated[int, Meta(ge=1, le=256)] | None = None
    classes: Annotated[int, Meta(ge=1, le=65535)] | None = None
    trees: Annotated[int, Meta(ge=1, le=65535)] | None = None
    nodes: Annotated[int, Meta(ge=1, le=1 << 22)] | None = None
    leaves: Annotated[int, Meta(ge=1, le=65536)] | None = None
    bits: Annotated[int, Meta(ge=2, le=22)] | None = None

    def __post_init__(self) -> None:
        frames = self.source == "frames"
        if frames == (self.window is None):
            given = "be given" if frames else "not be given"
            raise ValueError(f"window must {given} with source = '{self.source}'")
        if frames and self.features is not None:
            raise ValueError("features = channels times window with source = 'frames': leave it out")
        if self.memory == "sdram" and self.engines != 1:
            raise ValueError(f"engines = {self.engines} must be 1 with memory = 'sdram'")


@dataclass(frozen=True)
class Forest:
    """The feature of a build. ``model``: what its file holds, or None; ``slip``: indices of classes."""

    size: cost.Size
    frames: bool
    engines: int
    banks: int
    lanes: int
    sdram: bool
    slip: tuple[int, ...] = ()
    grip: bool = True
    model: file.Model | None = None

    @property
    def settings(self) -> dict[str, int]:
        return {"slip": sum(1 << label for label in self.slip), "grip": int(self.grip)}

    @property
    def parameters(self) -> dict[str, int]:
        """Parameters of rtl/msn_core.sv."""
        size = {f"Forest{key.capitalize()}": value for key, value in vars(self.size).items()}
        found = {"ForestFrames": int(self.frames), "ForestEngines": self.engines, "ForestBanks": self.banks}
        return size | found | {"ForestLanes": self.lanes, "ForestSdram": int(self.sdram)}

    def rams(self, cells: str) -> int:
        """Block RAMs of the forest on a family of devices."""
        return cost.block_rams(self.size, cells, self.engines, self.banks, self.lanes, self.sdram)

    def check_room(self, where: str, cells: str, rams: int) -> None:
        """ValueError, with its budget, if the forest does not fit the block RAMs of a device."""
        need, there = self.rams(cells), rams - cost.RESERVE
        if need > there:
            what = f"{self.size.leaves} leaves of {self.size.classes} classes", "fewer banks or leaves"
            if not self.sdram:
                what = f"{self.size.nodes} nodes", "fewer banks or nodes, memory = 'sdram'"
            raise ValueError(
                f"[forest]: {what[0]} for each of {self.engines} engines in {self.banks} banks "
                f"need {need} block RAMs but the {where} has {there} for them: {what[1]}, "
                f"or `meissner forest-budget F.json --fit {where.replace(' ', ':')}`"
            )


def clocks(base: "Config") -> int:
    """The longest decision of its file; 1 of rows from a host, who waits."""
    forest: Forest = base.features["forest"]
    if not forest.frames or forest.model is None:
        return 1
    longest = np.array([[max(cost.depths(tree), 1) for tree in forest.model.trees]])
    worst = cost.clocks(forest.model, (longest, longest), forest.engines, forest.lanes)
    return int(worst["SDRAM" if forest.sdram else "block RAM"][1])


def check(base: "Config") -> None:
    if base.serial or not base.link.registers:
        raise ValueError("[forest] must go with serial = false and registers = true, which load it")
    from meissner.twins.forest.sdram import BANK_WORDS, BANKS  # here: builds without a forest do not load it

    forest: Forest = base.features["forest"]
    if forest.frames and base.kind not in ("channels", "array"):
        raise ValueError(f"[forest]: source = 'frames' must be 'host' with kind = '{base.kind}'")
    if forest.sdram and base.clk_khz != SDRAM_KHZ:
        raise ValueError(
            f"[clock]: mhz = {base.clk_khz / 1000:g} must be 100 with memory = 'sdram' (docs/sdram.md)"
        )
    forest.check_room(*LARGEST)
    if forest.sdram and forest.size.nodes > BANKS * BANK_WORDS // forest.banks:
        raise ValueError(f"[forest]: {forest.size.nodes} nodes in {forest.banks} banks do not fit the SDRAM")


def config(keys: Keys, base: "Config") -> Forest:
    """The forest's sizes; ``base``: the rest of the build."""
    rows, columns = base.shape
    model = None if keys.file is None else file.read(Path(keys.file))
    need = None
    if model is not None:
        model = words.without_missing(model, 0 if keys.source == "frames" else keys.features)[0]
        words.check(model)
        need = cost.size_of(model, keys.engines)
    frames = keys.source == "frames"
    features = rows * columns * (keys.window or 0) if frames else keys.features
    if features is None:
        if need is None:
            raise ValueError("features must be given, or a file")
        features = need.features
    if features > words.FEATURES:
        raise ValueError(f"{features} features, channels times window, are more than {words.FEATURES}")
    if need is not None and need.features != features:
        raise ValueError(f"the forest in {keys.file} has {need.features} features but a row has {features}")
    ranked = [each.name for each in model.features if each.thresholds is not None] if model else []
    if frames and ranked:
        raise ValueError(
            f"the forest in {keys.file} compares ranks of {ranked[0]}, and frames are integers: "
            "export it with --integer all"
        )
    room = {"classes": 2, "trees": 64, "nodes": 1024, "leaves": 256}
    room["bits"] = min(base.sample_bits + 1, words.THRESHOLD_BITS) if frames else words.THRESHOLD_BITS
    for key, value in room.items():
        least, given = getattr(need, key, None), getattr(keys, key)
        if (
            given is not None
            and least is not None
            and (given < least or (key == "classes" and given > least))
        ):
            many = "" if key == "classes" else "at least "
            raise ValueError(f"{key} = {given} must be {many}{least} for {keys.file}")
        room[key] = given if given is not None else value if least is None else least
    size = cost.Size(features=features, **room)
    labels = model.classes if model is not None else list(range(size.classes))
    for label in keys.slip:
        if not any(label == each and type(label) is type(each) for each in labels[:SLIPS]):
            shown = ", ".join(map(repr, labels[:8])) + (" .." if len(labels) > 8 else "")
            raise ValueError(f"slip = {label!r} must be one of the first {SLIPS} classes: {shown}")
    return Forest(
        size=size,
        frames=frames,
        engines=keys.engines,
        banks=keys.banks,
        lanes=keys.lanes,
        sdram=keys.memory == "sdram",
        slip=tuple(labels.index(label) for label in keys.slip),
        grip=keys.grip,
        model=model,
    )
