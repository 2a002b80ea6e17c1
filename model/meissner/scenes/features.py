"""The features of the core that scenes use, and the blocks that engines rtl and gate build for each."""

from typing import NamedTuple

from meissner.engines.features import FEATURES as FOUND
from meissner.scenes.sensor import used
from meissner.tables import shown


class Feature(NamedTuple):
    """``top``: the module of rtl/ that engines rtl and gate build for it; ``blocks``: modules inside it."""

    top: str
    blocks: tuple
    function: str  # its name in meissner.engines.protocol


FEATURES = {
    "slip": Feature("msn_slip_chain", ("msn_haar", "msn_peak_to_peak", "msn_slip"), "watch"),
    "cop": Feature("msn_cop", ("msn_cop_accumulate", "msn_cop_divide"), "cop"),
    "cop4": Feature("msn_cop4", ("msn_electrodes", "msn_ratio", "msn_cop4_correct"), "cop4"),
    "cop_slip": Feature("msn_cop_slip", ("msn_delay",), "cop_slip"),
    "demod": Feature("msn_am_demod", (), "demodulate"),
    "calibrate": Feature("msn_calibrate", (), "calibrate"),
    "grip": Feature("msn_grip", (), ""),
    **{name: Feature(found.TOP, found.BLOCKS, name) for name, found in FOUND.items()},
}
# Further parts of the core, which no scene uses.
BESIDES = {
    "scan": "msn_scan",
    "health": "msn_health",
    "tare": "msn_tare",
    "pulses": "msn_pwm",
    "link": "msn_link",
    "registers": "msn_registers",
}


def _plain(name):
    return name.replace("_", " ")


def built(features):
    """The names of the features of a core with ``features``, in the order of FEATURES."""
    return [_plain(name) for name in FEATURES if name in features]


def not_built(features):
    """The names of the parts left out of it, including BESIDES."""
    return [_plain(name) for name in (*FEATURES, *BESIDES) if name not in features]


def with_modules(names):
    """Features as a text, each with its module of rtl/."""
    tops = {_plain(name): feature.top for name, feature in FEATURES.items()} | BESIDES
    return ", ".join(f"{_plain(name)} ({tops[_plain(name)]})" for name in names)


def check_line(scene, line):
    """ValueError if ``line``, the optional key ``features`` of a scene's file, is not what the scene uses."""
    where, uses = f"scene {scene.name}", used(scene)
    if not isinstance(line, list):
        raise ValueError(f"{where}: features = {shown(line)} must be a list")
    for name in line:
        if name not in uses:
            raise ValueError(
                f"{where}: features names {shown(name)}, which the scene does not use; leave the line out"
            )
    for name, why in uses.items():
        if name not in line:
            raise ValueError(f"{where}: features omits '{name}', which the scene uses: {why}")
