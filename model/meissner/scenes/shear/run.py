"""Running a scene of sheared rubber: each case and seed through the converter and an engine's detector."""

import time

import numpy as np

from meissner import engines, interval, scenes
from meissner.engines.stages import Stages
from meissner.files import written
from meissner.fit_rubber import STEPS
from meissner.scenes import chain
from meissner.scenes.rates import rates
from meissner.scenes.results import finish, head, table
from meissner.scenes.rubber.judge import judge
from meissner.scenes.rubber.run import _mismatches
from meissner.scenes.shear import estimate, pictures
from meissner.scenes.shear.judge import ANSWERS, measured, sloped
from meissner.scenes.shear.scene import check_supply

RECOVERIES = {
    "restored": "is restored",
    "converged": "converges",
    "converged_table_1": "converges, of Table 1's lot",
}
KEPT = ("time_s", "codes", "normal_n", "speed_mm_s", "tension_n", "slip_mm", "slips_s")


def check(scene, engine, waves):
    """ValueError with one sentence if this engine cannot run the scene. No --waves here."""
    chain.check(scene, engine, waves)
    check_supply(scene)


def _run(recording, state, config):
    """The figures of one run: the slip detector's verdict, and what its kind measures."""
    of_kind = sloped if recording.scene.kind == "stick_slip" else measured
    return judge(recording, state, config) | of_kind(recording)


def run(scene, engine, out, seed, waves, progress):
    """Run every case with its seeds; write results to ``out``; return the summary."""
    began = time.perf_counter()
    module, twin = (Stages(name, scene.features) for name in (engine, "fixed"))
    config, seeds = scene.slip_config(), range(seed, seed + scene.seeds)
    module.watch(np.zeros((1, config.window), dtype=np.int64), config)  # built and warm before it is timed
    estimator = estimate.Estimator(scene, engine) if "shear_speed" in scene.features else None
    found, shown = {case: [] for case in scene.cases}, {}
    wrong, samples, over_range, engine_s = 0, 0, 0, 0.0
    for case, number in progress([(case, number) for case in scene.cases for number in seeds]):
        recording = scenes.simulate(scene, case, number)
        started = time.perf_counter()
        watched = module.watch(recording.codes[None], config)
        engine_s += time.perf_counter() - started
        if engine in engines.VERILATED:
            wrong += _mismatches(watched, twin.watch(recording.codes[None], config))
        samples += len(recording.codes)
        over_range += int(recording.over_range.sum())
        estimated = estimator.of(recording) if estimator else {}
        found[case].append(_run(recording, watched.state[0], config) | estimated)
        if number == seed:
            shown[case] = recording
    every = [one for runs in found.values() for one in runs]
    rows, answer = ANSWERS[scene.kind](scene, found)
    constants = answer.pop("constants", None)
    if estimator:
        estimate.join(rows, answer, found)
        wrong += estimator.differences
    first = shown[scene.cases[0]]
    summary = {
        **head(scene, engine, seed, samples / scene.rate_hz, samples, engine_s, wrong, first),
        "over_range": over_range,
        "false_alarms": sum(one["false_alarms"] for one in every),
        "false_alarm_rate": rates(every)["false_alarm_rate"],
        **answer,
        "runs": len(every),
        "seeds": [seeds[0], seeds[-1]],
        "conditions": rows,
        **({"constants": constants} if constants else {}),
    }
    drawn = pictures.draw(out, scene, shown, rows, constants)
    arrays = {
        f"c{place}_{name}": getattr(recording, name)
        for place, recording in enumerate(shown.values())
        for name in KEPT
    }
    if scene.kind == "speed":
        _write_steps(out / "steps.csv", found)
    tables = {"Conditions": rows, **({"Constants": constants} if constants else {})}
    return finish(scene, summary, out, arrays, drawn, tables, began, ("conditions", "constants"))


def _write_steps(path, found):
    """Every measured step, as ``meissner fit-rubber`` reads them."""
    lines = [",".join(STEPS)]
    for case, runs in found.items():
        lines += [f"{one['rest_v']:.9g},{one['step_v']:.9g},{case.speed_mm_s:g}" for one in runs]
    with written(path) as file:
        file.write(("\r\n".join(lines) + "\r\n").encode("ascii"))


def _amount(summary):
    line = f"dV {summary['step_v']['mean']:.3f} V in the mean; straight line through it "
    return [f"{line}{summary['slope_v_mm']:+.2f} ± {summary['slope_error_v_mm']:.2f} V/mm"]


def _speed(summary):
    lines = table(summary["constants"])
    error = 100 * summary["speed_error"]["mean"]
    return [
        *lines,
        f"dV beside Table 2: {100 * summary['off_table_2']['mean']:.2g} % off in the mean; beside Table 1: "
        f"{100 * summary['off_table_1']['mean']:.2g} %",
        f"the speed computed from one step is {error:.2g} % off in the mean",
        f"above the limit and found above it: {interval.words(summary['beyond_found'], 'steps')}"
        if summary["beyond_found"]
        else "no step is above the limit",
        f"below it and found above: {interval.words(summary['beyond_falsely'], 'steps')}",
        *estimate.tell(summary),
    ]


def _recover(summary):
    return [
        f"5 s after the shear Vc is {summary[f'{name}_after_v']['mean']:.2f} V in the mean where it {verb}"
        for name, verb in RECOVERIES.items()
        if summary[f"{name}_after_v"]
    ]


def _stick_slip(summary):
    lines = [
        f"slips missed: {interval.words(summary['missed_rate'])}; of these late: {summary['late']}",
        f"missed by the derivative: {interval.words(summary['slope_missed_rate'])}; it crosses at rest in "
        f"{interval.words(summary['slope_quiet_rate'])}, while pressing in "
        f"{interval.words(summary['slope_pressing_rate'])}",
    ]
    if summary["lead_ms_min"] is not None and summary["slope_lead_ms_min"] is not None:
        lines.append(
            f"shortest lead before the slip: flag {summary['lead_ms_min']:.1f} ms, derivative "
            f"{summary['slope_lead_ms_min']:.1f} ms"
        )
    if summary["stick_slips_found"]:
        lines.append(
            "stick-slips detected by the derivative: "
            f"{interval.words(summary['stick_slips_found'], 'stick-slips')}; "
            f"{summary['elsewhere_per_s']:.2g} false crossings per second"
        )
    return lines


_TELL = {"step_v": _amount, "k0": _speed, "restored_after_v": _recover, "stick_slips": _stick_slip}


def tell(summary):
    """The lines to print of a summary."""
    of_kind = next(lines for key, lines in _TELL.items() if key in summary)
    first, last = summary["seeds"]
    what = "before a slip" if "stick_slips" in summary else "where nothing slips"
    return [
        f"{summary['runs']} runs, seeds {first} to {last} of each case",
        *of_kind(summary),
        f"the slip detector raises its flag {what} in {interval.words(summary['false_alarm_rate'])}",
        "",
        *table(summary["conditions"]),
    ]
