"""Judging runs of sheared rubber: steps and recovery as an experimenter reads them off the codes, the
constants that follow, and the derivative of Vc as a detector. ``ANSWERS``: the report of each kind."""

import numpy as np

from meissner import fit_rubber, interval
from meissner.interval import CONFIDENCE
from meissner.physics import rubber
from meissner.report.words import fact, number
from meissner.scenes.errors import summarise
from meissner.scenes.rubber.judge import contact_share
from meissner.scenes.shear import published
from meissner.scenes.slip_rates import rates
from meissner.scenes.verdict import count

AFTER_S = 5.0  # published: about the time until Vc is stable
MEAN_S = 0.1  # averaging time of Vc after the shear
SETTLED = 0.05  # share of the fall that is left when it has settled
SLIDING_S = 0.1  # after the slip, when its ringing has ended


def slope(volts, rate_hz, width_s=1e-3):
    """dVc/dt in V/s over ``width_s``, at the first sample of each interval; 0 at the end."""
    width = round(width_s * rate_hz)
    return np.append((volts[width:] - volts[:-width]) * (rate_hz / width), np.zeros(width))


def measured(recording):
    """Of one run ``rest_v``, ``step_v`` and, if held long enough, ``after_v``, ``end_v``, ``settled_s``."""
    scene = recording.scene
    volts = scene.adc.volts_of(recording.codes)
    steps = fit_rubber.steps_of(recording.time_s, volts, recording.speed_mm_s)
    found = {"rest_v": float(steps.rest_v[0]), "step_v": float(steps.step_v[0])}
    if recording.time_s[-1] < recording.stop_s + AFTER_S + MEAN_S:
        return found
    mean, rate_hz = round(MEAN_S * scene.rate_hz), scene.rate_hz
    stop, after = round(recording.stop_s * rate_hz), round((recording.stop_s + AFTER_S) * rate_hz)
    end_v = float(volts[-mean:].mean())
    fall_v = found["rest_v"] + found["step_v"] - end_v
    # The converter's noise is less than a twentieth of every fall judged here.
    settled = int(np.argmax(volts[stop:] <= end_v + SETTLED * fall_v))
    return found | {
        "after_v": float(volts[after - mean // 2 : after + mean // 2].mean()),
        "end_v": end_v,
        "settled_s": settled / rate_hz,
    }


def sloped(recording):
    """The derivative of Vc as a detector of one slip; a value counts from its last sample on.

    ``slope_pressing``, ``slope_quiet``: over the threshold while pressing, and at rest or in even shear;
    ``change_s``: first time over it after the stage's start; ``slope_flag_s``: the same between the first
    event and the slip; ``found`` of ``stick_slips``: those with a value over it within near_s; ``elsewhere``:
    other rises above it, in ``slid_s`` seconds of sliding.
    """
    scene, time_s = recording.scene, recording.time_s
    rate_hz, settings = scene.rate_hz, scene.slope
    width_s, near = settings["slope_s"], round(settings["near_s"] * rate_hz)
    width = round(width_s * rate_hz)
    # In codes, so that a change equal to the threshold does not depend on the rounding of volts.
    codes = np.abs(recording.codes[width:] - recording.codes[:-width])
    most = settings["slope_v_s"] * width / rate_hz / scene.adc.lsb_v
    over = np.concatenate([np.zeros(width, dtype=bool), codes > most])
    change = slope(scene.adc.volts_of(recording.codes), rate_hz, width_s)

    def of(first_s, last_s):
        return slice(int(np.ceil(first_s * rate_hz - 1e-6)), int(np.ceil(last_s * rate_hz - 1e-6)))

    def first(part):
        hits = np.flatnonzero(over[part])
        return None if not len(hits) else float(time_s[part.start + hits[0]])

    start_s, onset_s, gross_s = recording.start_s, recording.onset_s, recording.gross_s
    pressed_s = float(time_s[np.flatnonzero(recording.moving)[-1]])
    # The step itself ends within twice the distance that completes it.
    even_s = start_s + 2 * rubber.SHEAR_FULL_MM / recording.condition.speed_mm_s + width_s
    quiet = over[of(pressed_s + 2 * width_s, start_s)].any() or over[of(even_s, onset_s)].any()
    sliding = of(gross_s + SLIDING_S, time_s[-1])
    slips = np.ceil(recording.slips_s * rate_hz - 1e-6).astype(int)
    slips = slips[(slips >= sliding.start) & (slips < sliding.stop - near)]
    hits = np.concatenate([[0], np.cumsum(over)])
    found = hits[slips + near + 1] > hits[slips]
    rises = np.flatnonzero(over[1:] & ~over[:-1]) + 1
    rises = rises[(rises >= sliding.start) & (rises < sliding.stop)]
    places = np.searchsorted(slips, rises, "right") - 1
    last_slip = slips[np.maximum(places, 0)] if len(slips) else np.full(len(rises), -near - 1)
    own = (places >= 0) & (rises - last_slip <= near)
    rms = [float(np.sqrt(np.mean(change[part] ** 2))) for part in (of(onset_s, gross_s - width_s), sliding)]
    return {
        "slope_pressing": bool(over[recording.moving].any()),
        "slope_quiet": bool(quiet),
        "change_s": first(of(start_s, gross_s)),
        "slope_flag_s": first(of(onset_s, gross_s)),
        "stick_slips": len(slips),
        "found": int(found.sum()),
        "elsewhere": int((~own).sum()),
        "slid_s": (sliding.stop - sliding.start) / rate_hz,
        "rms_before": rms[0],
        "rms_sliding": rms[1],
    }


def _deviation(values):
    """Standard deviation of measurements; None for a single one."""
    return float(np.std(values, ddof=1)) if len(values) > 1 else None


def _digits(row, digits=5):
    return {key: round(value, digits) if isinstance(value, float) else value for key, value in row.items()}


def _of(runs, key):
    return np.array([run[key] for run in runs])


def _row(case, runs, **more):
    """The keys common to rows of held rubber, with ``more`` among them."""
    steps = _of(runs, "step_v")
    return _digits(
        {
            "condition": case.name,
            "runs": len(runs),
            "rest_v": float(_of(runs, "rest_v").mean()),
            "step_v": float(steps.mean()),
            "deviation_v": _deviation(steps),
            **more,
            "false_alarms": sum(run["false_alarms"] for run in runs),
        }
    )


def _spread(rows):
    """Mean and maximum of the rows' deviations; None with a single measurement each."""
    return summarise(np.array([row["deviation_v"] for row in rows if row["deviation_v"] is not None]))


def amount(scene, found):
    """dV over the distance, and the slope of the straight line through it with its standard error."""
    from scipy.stats import linregress

    rows = [_row(case, runs, moved_mm=case.moved_mm) for case, runs in found.items()]
    moved = [case.moved_mm for case, runs in found.items() for _ in runs]
    steps = np.concatenate([_of(runs, "step_v") for runs in found.values()])
    line = linregress(moved, steps)
    return rows, {
        "step_v": summarise(steps),
        "deviation_v": _spread(rows),
        "slope_v_mm": float(line.slope),
        "slope_error_v_mm": float(line.stderr),
    }


def _rate(flags):
    return interval.rate(int(sum(flags)), len(flags)) if len(flags) else None


def power_law(speed_mm_s, step_v):
    """(k, n) of dV = k·v^n by a straight line through the logs, each as (value, low, high)."""
    from scipy.stats import linregress, t

    line = linregress(np.log(speed_mm_s), np.log(step_v))
    width = float(t.ppf(0.5 + CONFIDENCE / 2, len(step_v) - 2))
    ends = width * np.array([line.intercept_stderr, line.stderr])
    k = tuple(float(np.exp(line.intercept + end)) for end in (0.0, -ends[0], ends[0]))
    return k, tuple(float(line.slope + end) for end in (0.0, -ends[1], ends[1]))


def _constant(name, found, printed):
    return _digits({"constant": name, **dict(zip(("value", "low", "high"), found)), "published": printed})


def speed(scene, found):
    """k and n for each rest, the joint line, and its error in recovering the speed of a single step."""
    every = [(one["rest_v"], one["step_v"], case.speed_mm_s) for case, runs in found.items() for one in runs]
    every = np.array(every).T
    within = every[2] <= published.LIMIT_MM_S
    steps, fast = (fit_rubber.Steps(*every[:, part]) for part in (within, ~within))
    joint = fit_rubber.fit(steps)
    constants, rows, off = [], [], {1: [], 2: []}
    for rest, printed in published.FIT.items():
        part = np.abs(steps.rest_v - rest) < 0.1
        if np.count_nonzero(part) > 2:
            law = power_law(steps.speed_mm_s[part], steps.step_v[part])
            constants += [
                _constant(f"{name} from {rest} V", *both) for name, *both in zip("kn", law, printed)
            ]
    constants += [
        _constant(name, (joint.value[place], joint.low[place], joint.high[place]), published.LINE[name])
        for place, name in enumerate(fit_rubber.NAMES)
    ]
    for case, runs in found.items():
        rest, mean_v = round(case.rest_v), float(_of(runs, "step_v").mean())
        table_2 = float(published.table_2(rest, case.speed_mm_s)) if rest in published.FIT else None
        table_1 = published.STEP_V.get(case.speed_mm_s) if rest == 2 else None
        for which, printed in ((1, table_1), (2, table_2)):
            if printed is not None:
                off[which].append(mean_v / printed - 1.0)
        back = float(published.joint_speed(_of(runs, "rest_v").mean(), mean_v))
        rows.append(
            _row(case, runs, table_2_v=table_2, table_1_v=table_1, speed_mm_s=case.speed_mm_s, back_mm_s=back)
        )
    single = joint.speed_mm_s(steps.rest_v, steps.step_v)
    beyond = joint.speed_mm_s(fast.rest_v, fast.step_v) > published.LIMIT_MM_S
    return rows, {
        **{name: float(value) for name, value in zip(fit_rubber.NAMES, joint.value)},
        "residual": float(np.sqrt((joint.residual**2).sum() / (len(steps.step_v) - 3))),
        "deviation_v": _spread(rows),
        "off_table_1": summarise(np.abs(off[1])),
        "off_table_2": summarise(np.abs(off[2])),
        "speed_error": summarise(np.abs(single / steps.speed_mm_s - 1.0)),
        "beyond_found": _rate(beyond),
        "beyond_falsely": _rate(single > published.LIMIT_MM_S),
        "constants": constants,
    }


def recover(scene, found):
    """Vc some seconds after the shear, beside the published values."""
    rows = []
    for case, runs in found.items():
        after_v = float(_of(runs, "after_v").mean())
        rows.append(
            _row(
                case,
                runs,
                after_v=after_v,
                end_v=float(_of(runs, "end_v").mean()),
                settled_s=float(_of(runs, "settled_s").mean()),
                published_v=case.published_v,
                off_v=after_v - case.published_v,
            )
        )
    every = [run for runs in found.values() for run in runs]
    by = {"restored": [], "converged": [], "converged_table_1": []}
    for case, runs in found.items():
        way = "converged" if case.lot == 1.0 else "converged_table_1"
        by["restored" if case.recovers == rubber.RESTORED else way] += [run["after_v"] for run in runs]
    return rows, {
        **{f"{name}_after_v": summarise(np.array(values)) for name, values in by.items()},
        "settled_s": summarise(_of(every, "settled_s")),
        "deviation_v": _spread(rows),
    }


def _lead_ms(runs, key):
    """The shortest time in ms from ``key`` to the slip, among runs that have it."""
    leads = [1e3 * (run["gross_s"] - run[key]) for run in runs if run[key] is not None]
    return round(min(leads), 3) if leads else None


def _stick(runs):
    """Figures of runs of a slipping plate, for a row and for the summary."""
    counts = {key: sum(run[key] for run in runs) for key in ("stick_slips", "found", "elsewhere", "slid_s")}
    return {
        **{key: sum(run[key] for run in runs) for key in ("missed", "late")},
        "lead_ms_min": rates(runs)["lead_ms_min"],
        "change_lead_ms_min": _lead_ms(runs, "change_s"),
        "slope_lead_ms_min": _lead_ms(runs, "slope_flag_s"),
        "slope_missed": sum(run["slope_flag_s"] is None for run in runs),
        "stick_slips_found_share": counts["found"] / counts["stick_slips"] if counts["stick_slips"] else None,
        "elsewhere_per_s": counts["elsewhere"] / counts["slid_s"],
        "rms_before_v_s": float(_of(runs, "rms_before").mean()),
        "rms_sliding_v_s": float(_of(runs, "rms_sliding").mean()),
    }


def stick_slip(scene, found):
    """The slip detector and the derivative of Vc on the same slips."""
    rows = [
        _digits(
            {
                "condition": case.name,
                "runs": len(runs),
                "stick_slips_mean": float(_of(runs, "stick_slips").mean()),
                **_stick(runs),
                "false_alarms": sum(run["false_alarms"] for run in runs),
            }
        )
        for case, runs in found.items()
    ]
    every = [run for runs in found.values() for run in runs]
    whole = _stick(every)
    slips, hits = (int(_of(every, key).sum()) for key in ("stick_slips", "found"))
    return rows, {
        **{key: whole[key] for key in ("missed", "late", "change_lead_ms_min", "slope_lead_ms_min")},
        **{key: rates(every)[key] for key in ("missed_rate", "lead_ms_min")},
        "slope_missed_rate": _rate([run["slope_flag_s"] is None for run in every]),
        "slope_quiet_rate": _rate([run["slope_quiet"] for run in every]),
        "slope_pressing_rate": _rate([run["slope_pressing"] for run in every]),
        "stick_slips": summarise(_of(every, "stick_slips").astype(float)),
        "stick_slips_found": interval.rate(hits, slips) if slips else None,
        "elsewhere_per_s": whole["elsewhere_per_s"],
        "rms_before_v_s": whole["rms_before_v_s"],
        "rms_sliding_v_s": whole["rms_sliding_v_s"],
        "contact_share_of_sliding": contact_share(every),
    }


ANSWERS = {"amount": amount, "speed": speed, "recover": recover, "stick_slip": stick_slip}


def _of_stick_slip(summary):
    """The derivative of Vc compared with the slip detector."""
    missed, slips = summary["slope_missed_rate"]["count"], summary["slope_missed_rate"]["runs"]
    text = (
        f"The derivative of Vc misses {number(missed)} of {count(slips, 'slip')}, the slip detector "
        f"{number(summary['missed'])}"
    )
    pressing = summary["slope_pressing_rate"]["count"]
    text += f"; pressing alone crosses its threshold in {count(pressing, 'run')}"
    if summary["stick_slips_found"]:
        text += f", and it shows {100 * summary['stick_slips_found']['rate']:.3g} % of the stick-slips"
    return text + "."


def _of_sheared(summary):
    """Results for rubber that shears and does not slip."""

    def of(key, which="mean"):
        return fact(key, summary[key][which])

    alarms = f"; the slip detector raises its flag in {count(summary['false_alarm_rate']['count'], 'run')}"
    if "slope_v_mm" in summary:
        text = f"Vc rises by {of('step_v')} in the mean, by {fact('slope_v_mm', summary['slope_v_mm'])} more"
    elif "k0" in summary:
        values = [f"{name} = {summary[name]:.3f}" for name in ("k0", "k1", "n")]
        text = (
            f"The steps fit {', '.join(values)}; the speed from one step is {of('speed_error')} "
            "off in the mean"
        )
    else:
        ways = [
            f"{of(key)} where it {word}"
            for key, word in (("restored_after_v", "is restored"), ("converged_after_v", "converges"))
            if summary[key]
        ]
        text = f"5 s after the shear Vc is {' and '.join(ways)}"
    return text + alarms + "."


def answer(summary):
    """The sentence about a run."""
    return _of_stick_slip(summary) if "stick_slips" in summary else _of_sheared(summary)
