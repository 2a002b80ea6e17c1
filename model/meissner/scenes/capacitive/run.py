"""Running a scene of the capacitive pad: demodulate carriers, calibrate, compare with the paper."""

from functools import partial

from meissner import scenes
from meissner.pool import Spread
from meissner.scenes.capacitive.judge import ANSWERS, answer, calibrations
from meissner.scenes.errors import percent
from meissner.scenes.results import Result, head, numbered, table
from meissner.scenes.timed import TimedEngine

__all__ = ["TABLES", "WAVES", "answer", "run", "tell"]

TABLES = {"Results": "conditions"}
WAVES = False
ALONE = Spread()
# What each picture shows, by the function that draws it.
SHOWN = {
    "draw_crosstalk": "output over the amplifier's gain, eq. 18 and demodulated; error over the carrier",
    "draw_cell": "loading and unloading, a held force and its release, and repeated presses of one cell",
    "draw_select": "reading of each cell over the place of the probe, before and after calibration",
    "draw_shapes": "each object's outline over its calibrated image, and the image as bars",
    "draw_even": "an even press before and after calibration, each cell's distance from the mean",
}


def run(scene, engine, seed, waves=None, spread=ALONE):
    """The Result of the scene, which runs once."""
    recording, core = scenes.simulate(scene, seed), TimedEngine(engine, scene.features)
    codes = {}
    for name, part in spread.progress(list(recording.parts.items())):
        codes[name] = core.demodulate(part.samples, scene.carrier)
    fits = calibrations(recording, codes)
    found, arrays, drawings = ANSWERS[scene.kind](scene, codes, recording, fits, core)
    parts = recording.parts.values()
    seconds = sum(len(part.samples) / part.rate_hz for part in parts)
    summary = head(scene, core, seed, seconds, recording.modelled) | {
        "over_range": recording.over_range,
        "runs": 1,
        "seeds": [seed, seed],
        "frames": sum(len(part.samples) for part in parts),
    }
    drawn = [(partial(draw, scene, **what), scene.title, SHOWN[draw.__name__]) for draw, what in drawings]
    return Result(summary | found, arrays, numbered(drawn))


def tell(summary):
    lines = [f"1 run, seed {summary['seed']}"]
    if "difference_from_eq18_v" in summary:
        apart_mv = 1e3 * summary["difference_from_eq18_v"]
        lines.append(f"demodulated output and eq. 18 differ by at most {apart_mv:.2g} mV")
    if "sag_of_hold" in summary:
        lines += [
            f"unloading reads {summary['unloading_above_loading_g']:.2g} g above loading, "
            f"noise {summary['noise_g']:.2g} g rms",
            f"0 to full and back in a second: within {summary['off_the_line_g']:.2g} g of a straight line; "
            f"calibrated, {summary['low_at_full_g']:.3g} g low at full force, "
            f"{summary['low_settled_g']:.2g} g once it has settled",
            f"settled presses: at most {summary['settled_off_g']:.2g} g off, with the second-order term "
            f"{summary['settled_off_second_order_g']:.2g} g ({summary['low_at_full_second_order_g']:.2g} g "
            f"low at the top of a cycle); forces below {summary['reads_0_below_g']:.2g} g read 0",
            f"a constant force rises by {100 * summary['sag_of_hold']:.2g} % while it is held, and leaves "
            f"{summary['left_after_release_g']:.2g} g at its release, "
            f"{summary['left_after_rest_g']:.2g} g after the rest",
        ]
    if "peaks_apart_mm" in summary:
        lines.append(
            f"peaks {summary['peaks_apart_mm']:.3g} mm apart; "
            f"a neighbour reads {100 * summary['neighbour_at_a_centre']:.2g} % with the probe "
            "over a cell's centre"
        )
    if "unevenness_after" in summary:
        lines += [
            f"even press: no cell off the mean by more than {100 * summary['unevenness_before']:.3g} % "
            f"before and {100 * summary['unevenness_after']:.2g} % after calibration "
            f"({100 * summary['unevenness_calibrated_by_probe']:.2g} % calibrated by a probe)",
            f"position error, of the range -1 to 1: {percent(summary['position_error'])}",
            f"load error: {percent(summary['load_error'])}; with the second-order term "
            f"{percent(summary['load_error_second_order'])}",
        ]
    return [*lines, "", *table(summary["conditions"])]
