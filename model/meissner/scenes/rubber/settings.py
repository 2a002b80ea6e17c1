"""A scene's settings of the slip detector: its table [slip] in volts and seconds, and the same in codes."""

from dataclasses import dataclass

import numpy as np

from meissner.check import fields, shown
from meissner.twins.slip.config import SWITCHES, SlipConfig

_SLIP = dict.fromkeys(("window", "hop", "level"), int) | dict.fromkeys(
    (
        "threshold_v",
        "gross_threshold_v",
        "keep_threshold_v",
        "contact_v",
        "release_v",
        "hold_s",
        "refractory_s",
        "blank_s",
    ),
    float,
)


@dataclass(frozen=True)
class Slip:
    """The detector's settings in physical units; ``threshold_v`` is on the Haar coefficient."""

    threshold_v: float
    gross_threshold_v: float
    keep_threshold_v: float
    window: int
    hop: int
    level: int
    contact_v: float
    release_v: float
    hold_s: float
    refractory_s: float
    blank_s: float
    switches: dict  # switches of SlipConfig that the sensor does not determine


def _switches(where, table):
    """({name: value} of the switches in [slip], the other keys); a missing switch has its default."""
    switches = {key: table.pop(key, SWITCHES[key]) for key in SWITCHES if key != "contact_rises"}
    for key, value in switches.items():
        if not isinstance(value, bool):
            raise ValueError(f"{where}: {key} = {shown(value)} must be true or false")
    return switches, table


def settings(where, table):
    """The Slip of a scene's table; ValueError with one sentence if it is invalid."""
    switches, slip = _switches(where, dict(table))
    slip = Slip(**fields(where, slip, _SLIP), switches=switches)
    if not slip.contact_v < slip.release_v:
        raise ValueError(f"{where}: contact_v = {slip.contact_v} must be below release_v")
    if slip.keep_threshold_v > slip.threshold_v:
        raise ValueError(f"{where}: keep_threshold_v = {slip.keep_threshold_v} must not be above threshold_v")
    return slip


def threshold_code(volts, level, lsb_v):
    """The threshold on peak to peak in codes for ``volts`` on the Haar coefficient of ``level``.

    The unnormalised detail is sqrt(2)^level times the coefficient, so p2p in codes, an integer,
    exceeds floor(2·volts·sqrt(2)^level / lsb) exactly when the real comparison holds.
    """
    return int(np.floor(2.0 * volts * 2.0 ** (level / 2) / lsb_v))


def codes(slip, adc, rate_hz) -> SlipConfig:
    """The settings in codes of a converter and in details."""
    step = 1 << slip.level

    def threshold(volts):
        return threshold_code(volts, slip.level, adc.lsb_v)

    def level(volts):
        return round(step * adc.code_of(volts))

    def details(seconds):
        return round(seconds * rate_hz / step)

    return SlipConfig(
        window=slip.window,
        hop=slip.hop,
        level=slip.level,
        threshold=threshold(slip.threshold_v),
        gross_threshold=threshold(slip.gross_threshold_v),
        keep_threshold=threshold(slip.keep_threshold_v),
        contact_level=level(slip.contact_v),
        release_level=level(slip.release_v),
        contact_rises=False,
        **slip.switches,
        hold=details(slip.hold_s),
        refractory=details(slip.refractory_s),
        blank=details(slip.blank_s),
    )
