"""The parts of a scene: features of the core that it names, and physics that its tables ask for.

A sensor's module ``parts`` lists them with the reason why a scene needs each. A scene is refused if it names
a feature that nothing uses, omits one that is used, or needs more memory than the machine has.
"""

from importlib import import_module
from pathlib import Path
from typing import NamedTuple

from meissner.engines.features import FEATURES as FOUND


class Feature(NamedTuple):
    """``top``: its module of rtl/, which engines rtl and gate run; ``blocks``: modules inside it."""

    top: str
    blocks: tuple
    function: str  # its name in meissner.engines.protocol


FEATURES = {
    "slip": Feature("msn_slip_chain", ("msn_haar", "msn_peak_to_peak", "msn_slip"), "watch"),
    "cop": Feature("msn_cop", ("msn_cop_accumulate", "msn_cop_divide"), "cop"),
    "cop4": Feature("msn_cop4", ("msn_electrodes", "msn_ratio", "msn_cop4_correct"), "cop4"),
    "cop_slip": Feature("msn_cop_slip", ("msn_delay",), "cop_slip"),
    "demod": Feature("msn_am_demod", (), "demodulate"),
    "calibrate": Feature("msn_calibrate_taxels", (), "calibrate"),
    "grip": Feature("msn_grip", (), ""),
    **{name: Feature(found.TOP, found.BLOCKS, name) for name, found in FOUND.items()},
}
# Further parts of the core, which no scene can name.
BESIDES = {
    "scan": "msn_scan",
    "health": "msn_health",
    "tare": "msn_tare",
    "pulses": "msn_pwm",
    "link": "msn_core_link",
    "registers": "msn_registers",
}
ROOM = 0.8  # share of the free memory that a scene may need


def of(scene):
    return import_module(f"meissner.scenes.{scene.sensor}.parts")


def _plain(name):
    return name.replace("_", " ")


def built(features):
    """The names of the features of a core with ``features``, in the order of FEATURES."""
    return [_plain(name) for name in FEATURES if name in features]


def not_built(features):
    """The names of the parts left out of it, including BESIDES."""
    return [_plain(name) for name in (*FEATURES, *BESIDES) if name not in features]


def shown(names):
    """Features as a text, each with its module of rtl/."""
    tops = {_plain(name): feature.top for name, feature in FEATURES.items()} | BESIDES
    return ", ".join(f"{_plain(name)} ({tops[_plain(name)]})" for name in names)


def check_features(scene):
    """ValueError unless ``features`` names exactly those that the scene uses, each once."""
    where, used = f"scene {scene.name}", of(scene).uses(scene)
    for name in scene.features:
        if scene.features.count(name) > 1:
            raise ValueError(f"{where}: features names '{name}' twice: once is enough")
        if name not in used:
            kind = f" of kind {scene.kind}" if hasattr(scene, "kind") else ""
            raise ValueError(f"{where}: features names '{name}', which a scene{kind} does not use: remove it")
    for name, why in used.items():
        if name not in scene.features:
            raise ValueError(f"{where}: features must name '{name}': {why}")


def free_bytes():
    """Memory that this machine can give without swapping; None if unknown."""
    try:
        for line in Path("/proc/meminfo").read_text("ascii").splitlines():
            if line.startswith("MemAvailable:"):
                return int(line.split()[1]) * 1024
    except OSError:
        pass
    return None


def check_memory(scene):
    """ValueError if the scene's largest arrays do not fit the machine, judged by their shapes alone."""
    needs, what = of(scene).memory(scene)
    free = free_bytes()
    if free is not None and needs > ROOM * free:
        raise ValueError(
            f"scene {scene.name}: {what} need about {needs / 1e9:.3g} GB, but this machine has "
            f"{free / 1e9:.1f} GB free: reduce them, or use a larger machine"
        )


def reasons(scene):
    """{part of the physics: why the scene needs it}, in the order of the sensor's COMPONENTS."""
    own = of(scene)
    return {name: own.WHY[name] for name in own.modelled(scene)}
