"""Running a scene of the capacitive pad: demodulate carriers, calibrate, compare with the paper."""

import time

from meissner import scenes
from meissner.scenes import chain
from meissner.scenes.capacitive.judge import ANSWERS, calibrations
from meissner.scenes.chain import check  # noqa: F401 - as of every array
from meissner.scenes.results import finish, table
from meissner.scenes.truth import percent

# What each picture shows, by the function that draws it.
SHOWN = {
    "draw_crosstalk": "output over the amplifier's gain, eq. 18 and demodulated; error over the carrier",
    "draw_cell": "loading and unloading, a held force and its release, and repeated presses of one cell",
    "draw_select": "reading of each cell over the place of the probe, before and after calibration",
    "draw_shapes": "each object's outline over its calibrated image, and the image as bars",
    "draw_even": "an even press before and after calibration, each cell's distance from the mean",
}


def measure(scene, engine, seed, progress=list):
    """Run the scene once: summary, arrays of the result, and [(drawing function, its arguments)]."""
    recording = scenes.simulate(scene, seed)
    stage = chain.Chain(engine, scene.features)
    codes = {}
    for name, part in progress(list(recording.parts.items())):
        codes[name] = stage.demodulate(part.samples, scene.carrier)
    fits = calibrations(recording, codes)
    answer, arrays, drawings = ANSWERS[scene.kind](scene, codes, recording, fits, stage)
    parts = recording.parts.values()
    seconds = sum(len(part.samples) / part.rate_hz for part in parts)
    summary = stage.summary(scene, recording, seconds, sum(len(part.samples) for part in parts))
    return summary | answer, arrays, drawings


def run(scene, engine, out, seed, waves, progress):
    """Run the scene once; write results to ``out``; return the summary."""
    began = time.perf_counter()
    summary, arrays, drawings = measure(scene, engine, seed, progress)
    pictures = []
    for k, (draw, what) in enumerate(drawings):
        path = out / f"{scene.name}{f'_{k + 1}' if k else ''}.png"
        pictures.append((draw(path, scene, **what), scene.title, SHOWN[draw.__name__]))
    return finish(
        scene, summary, out, arrays, pictures, {"Results": summary["conditions"]}, began, ("conditions",)
    )


def tell(summary):
    """The lines to print of a summary."""
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
