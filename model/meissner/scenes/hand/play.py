"""The first condition of a hand's scene, as a page plays it: in closed loop, each turn with the next seed."""

from dataclasses import replace
from functools import partial

import msgspec

from meissner.builds.units import Units
from meissner.scenes.hand import loop
from meissner.scenes.played import Loop
from meissner.twins.actuate.grip import Grip

LONGEST_S, AHEAD = 60.0, 4  # of a turn; cycles


def _hand(scene, seed):
    first = scene.conditions[0]
    seconds = min(LONGEST_S, scene.duration_s(first))
    condition = msgspec.structs.replace(first, duration_s=seconds)
    scene, adc = replace(scene, conditions=(condition,)), scene.adc
    config = scene.slip_config(condition)
    units = Units(
        volts_per_code=adc.lsb_v,
        low_v=adc.low_v,
        min_code=adc.min_code,
        codes=(adc.min_code, adc.max_code),
        level=config.level,
        rate_hz=scene.rate_hz,
    )

    def begin(turn):
        return loop.steps(scene, condition, [seed + turn], (loop.FixedSlip, Grip), AHEAD)

    return Loop(
        rate_hz=scene.rate_hz,
        units=units,
        begin=begin,
        config=config,
        grip=scene.grip_config(condition),
        span=seconds * scene.rate_hz,
    )


def played(scene):
    return [partial(_hand, scene)]
