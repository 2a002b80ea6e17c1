"""Slip of one rubber sensor: converter and detector, against missed slips, false alarms and delay."""

from dataclasses import dataclass
from functools import cache, lru_cache

import numpy as np
from msgspec.structs import replace

from meissner import interval, scenes
from meissner.engines import fixed
from meissner.physics.adc import Adc
from meissner.scenes.rubber.judge import flagged, risen
from meissner.scenes.rubber.scene import Scene
from meissner.tradeoff.axis import Axis, Figure
from meissner.twins.slip.peak_to_peak import latency

SLIPS, PRESSES = "acrylic_slip", "normal_force"
HOPS = {"tumbling": lambda window, step: window, "half": lambda window, step: window // 2}
HOPS |= {"sliding": lambda window, step: step}
PART_MV = 0.198  # the MCP3208's own, physics.adc


@dataclass(frozen=True)
class Converted(Scene):
    """A scene with another converter."""

    converter: Adc = None

    @property
    def adc(self):
        return self.converter


_loaded = cache(scenes.load)


def scene_of(name, point):
    """The scene with a point's converter, sampling rate and detector."""
    scene, level = _loaded(name), point["level"]
    hop = HOPS[point["kind"]](point["window"], 1 << level)
    slip = replace(scene.slip, window=point["window"], hop=hop, level=level)
    adc = Adc(point["bits"], 0.0, 5.0, point["noise_mv"] / 1000)
    given = vars(scene) | {"rate_hz": point["rate_hz"], "slip": slip}
    return Converted(**given, converter=adc)


def recorded(name, point):
    """([samples] codes, (onset, gross)) of each run; these do not depend on the detector's settings."""
    scene, found = scene_of(name, point | SHIPPED_DETECTOR), []
    kinds = len(scene.conditions)
    for number in range(point["runs"]):
        one = scenes.simulate(scene, number % kinds, 1 + number // kinds)
        found.append((one.codes.astype(np.int32), (one.onset_s, one.gross_s)))
    return found


@lru_cache(maxsize=4)
def _kept(name, **given):
    return recorded(name, given)


def verdicts(name, point, recordings):
    """meissner.scenes.rubber.judge.flagged for every run, of a core that does not know its own motion."""
    config = scene_of(name, point).slip_config()
    for codes, (onset, gross) in recordings:
        state = fixed.watch(codes[None].astype(np.int64), config).state[0]
        yield flagged(risen(state, 1 << config.level, point["rate_hz"]), onset, gross)


def error(point):
    given = {key: point[key] for key in ("bits", "noise_mv", "rate_hz", "runs")}
    return figures(*(list(verdicts(name, point, _kept(name, **given))) for name in (SLIPS, PRESSES)))


def figures(slips, presses):
    """The errors of a point, from the verdicts of runs with and without a slip."""
    flags = [one for one in slips if one["delay_s"] is not None]
    delays, leads = (1e3 * np.array([one[key] for one in flags]) for key in ("delay_s", "lead_s"))
    alarmed = sum(one["false_alarms"] > 0 for one in slips + presses)
    missed = interval.rate(sum(one["missed"] for one in slips), len(slips))
    alarms = interval.rate(alarmed, len(slips) + len(presses))
    return {
        "missed": missed,
        "late": sum(one["late"] for one in slips),
        "false_alarm": alarms,
        "wrong": 100 * (missed["rate"] + alarms["rate"]),
        "delay_ms": float(np.median(delays)) if len(flags) else None,
        "delay_ms_mean": float(delays.mean()) if len(flags) else None,
        "lead_ms_median": float(np.median(leads)) if len(flags) else None,
        "lead_ms_min": float(leads.min()) if len(flags) else None,
    }


def state_bits(point):
    """State bits of a channel between details: the two extremes of each open window; for a sliding window
    those of all its details except the newest (docs/slip.md). The detail's own open sum is not counted."""
    span = point["window"] >> point["level"]
    windows = {"tumbling": 1, "half": 2, "sliding": span - 1}[point["kind"]]
    word = point["bits"] + 1 + point["level"]  # bits of a detail; an extreme needs no more
    return 2 * windows * word


def cost(point):
    level, window = point["level"], point["window"]
    clocks = level + 3 + latency(window >> level, HOPS[point["kind"]](window, 1 << level) >> level)
    rate = point["rate_hz"] * (16 if point["bits"] == 15 else point["bits"]) / 1e3
    return {"kbit_s": rate, "state_bits": state_bits(point), "clocks": clocks}


def placed(point):
    """The placed block for the point's kind of window: 64 channels, the widest samples."""
    if (point["window"], point["level"]) == (64, 1):
        kind = {"tumbling": "slip-64", "half": "slip-64-half", "sliding": "slip-64-sliding"}[point["kind"]]
        return kind, "ecp5"
    return None


def legal(point):
    if not 1000 <= point["rate_hz"] <= 100_000:
        return False
    try:
        scene_of(SLIPS, point).slip_config()
    except (KeyError, ValueError):
        return False
    return True


SHIPPED_DETECTOR = {"level": 1, "window": 64, "kind": "tumbling"}
SHIPPED = {"rate_hz": 10000, "bits": 12, "noise_mv": PART_MV} | SHIPPED_DETECTOR  # of slip1 and of the scenes
AXES = (
    Axis(
        name="slip",
        title="Slip: converter, sampling rate, Haar level and window",
        about="a window is a power of two, 4 samples or more and two details at least, of 1000 to 100000 "
        "samples a second; 0.198 mV is the MCP3208's own noise; 15 bits over 0 to 5 V are the "
        "AD7606's 16 bits over ±5 V",
        values={
            "rate_hz": (2500, 5000, 10000, 20000),
            "bits": (8, 10, 12, 15),
            "noise_mv": (PART_MV, 2.0),
            "level": (1, 2, 3),
            "window": (16, 32, 64, 128),
            "kind": ("tumbling", "half", "sliding"),
        },
        near=1,
        runs={"runs": (100, 40)},
        shipped=SHIPPED,
        group=("rate_hz", "bits", "noise_mv"),
        apart=("noise_mv",),
        cost=cost,
        error=error,
        legal=legal,
        placed=placed,
        figures=(
            Figure("kbit_s", "converter's data", "kbit/s", judged=True),
            Figure("state_bits", "state of a channel", "bits", judged=True),
            Figure("wrong", "missed rate + false-alarm rate", "%", judged=True),
            Figure("delay_ms", "onset to flag, median", "ms", judged=True),
            Figure("delay_ms_mean", "the same, mean", "ms"),
            Figure("lead_ms_median", "flag to slip of the whole contact, median", "ms"),
            Figure("lead_ms_min", "the same, least", "ms"),
            Figure("missed", "missed, late ones too"),
            Figure("late", "of these late", "runs"),
            Figure("false_alarm", "with a false alarm"),
            Figure("clocks", "sample pair to decision", "clocks"),
        ),
        panels=(("kbit_s", "wrong"), ("kbit_s", "delay_ms"), ("state_bits", "delay_ms")),
    ),
)
