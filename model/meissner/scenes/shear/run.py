"""Running a scene of sheared rubber: each case and seed through the converter and an engine's detector."""

from meissner import interval, scenes
from meissner.fit_rubber import STEPS
from meissner.scenes.results import Result, head, numbered, table
from meissner.scenes.rubber.judge import judge
from meissner.scenes.shear import pictures
from meissner.scenes.shear.judge import ANSWERS, answer, measured, sloped
from meissner.scenes.shear.scene import check_supply as check
from meissner.scenes.slip_rates import rates
from meissner.scenes.timed import each

__all__ = ["TABLES", "WAVES", "answer", "check", "run", "tell"]

TABLES = {"Conditions": "conditions", "Constants": "constants"}
WAVES = False
RECOVERIES = {
    "restored": "is restored",
    "converged": "converges",
    "converged_table_1": "converges, of Table 1's lot",
}
KEPT = ("time_s", "codes", "normal_n", "speed_mm_s", "tension_n", "slip_mm", "slips_s")


def _one(scene, core, place, number, shown):
    """(figures, samples, samples over range, what is shown) of a case's run with a seed.

    The figures: the slip detector's verdict, what the scene's kind measures, and what the estimator finds.
    """
    recording, config = scenes.simulate(scene, scene.cases[place], number), scene.slip_config()
    state = core.watch(recording.codes[None], config).state[0]
    of_kind = sloped if scene.kind == "stick_slip" else measured
    figures = judge(recording, state, config) | of_kind(recording)
    if "shear_speed" in scene.features:
        from meissner.scenes.shear import estimate  # here: other kinds need no estimator

        figures |= estimate.Estimator(scene, core).of(recording)
    over_range = int(recording.over_range.sum())
    return figures, len(recording.codes), over_range, recording if shown else None


def run(scene, engine, seed, waves, spread):
    """The Result of every case with its seeds."""
    seeds, found = range(seed, seed + scene.seeds), {case: [] for case in scene.cases}
    tasks = [(at, number, number == seed) for at in range(len(found)) for number in seeds]
    core, of_all = each(scene, engine, _one, tasks, spread)
    for (at, *_), (figures, *_) in zip(tasks, of_all):
        found[scene.cases[at]].append(figures)
    _, samples, over_range, seen = zip(*of_all)
    shown = dict(zip(scene.cases, filter(None, seen)))
    every = [one for runs in found.values() for one in runs]
    rows, of_kind = ANSWERS[scene.kind](scene, found)
    constants = of_kind.pop("constants", None)
    if "shear_speed" in scene.features:
        from meissner.scenes.shear import estimate

        estimate.join(rows, of_kind, found)
    summary = {
        **head(scene, core, seed, sum(samples) / scene.rate_hz, shown[scene.cases[0]].modelled),
        "over_range": sum(over_range),
        "false_alarms": sum(one["false_alarms"] for one in every),
        "false_alarm_rate": rates(every)["false_alarm_rate"],
        **of_kind,
        "runs": len(every),
        "seeds": [seeds[0], seeds[-1]],
        "conditions": rows,
        **({"constants": constants} if constants else {}),
    }
    arrays = {
        f"c{place}_{name}": getattr(recording, name)
        for place, recording in enumerate(shown.values())
        for name in KEPT
    }
    drawn = numbered(pictures.drawings(scene, shown, rows, constants))
    files = {"steps.csv": _steps(found)} if scene.kind == "speed" else {}
    return Result(summary, arrays, drawn, files)


def _steps(found):
    """Every measured step, as ``meissner fit-rubber`` reads them."""
    lines = [",".join(STEPS)]
    for case, runs in found.items():
        lines += [f"{one['rest_v']:.9g},{one['step_v']:.9g},{case.speed_mm_s:g}" for one in runs]
    return ("\r\n".join(lines) + "\r\n").encode("ascii")


def _amount(summary):
    line = f"dV {summary['step_v']['mean']:.3f} V in the mean; straight line through it "
    return [f"{line}{summary['slope_v_mm']:+.2f} ± {summary['slope_error_v_mm']:.2f} V/mm"]


def _speed(summary):
    from meissner.scenes.shear import estimate

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
