"""The outcome of a run, as the one sentence that its report begins with."""

from meissner.report.words import fact, number


def _count(count, one, many=None):
    return f"{number(count)} {one if count == 1 else many or one + 's'}"


def _slip(summary):
    """Slips detected, missed and falsely reported, of all runs; without delays and misses nothing slips."""
    rows = summary["conditions"]
    slipping = [row for row in rows if row["missed"] or row.get("delay_ms_median") is not None]
    slips, missed, false = sum(row["runs"] for row in slipping), summary["missed"], summary["false_alarms"]
    alarms = f"with {_count(false, 'false alarm')}" if false else "without a false alarm"
    if not slips:
        reported = f"{_count(false, 'false alarm')} rose" if false else "no slip was reported"
        return f"Nothing slips in {_count(summary['runs'], 'run')}, and {reported}."
    grip = "direction_error_deg" in summary
    found = [row for row in slipping if row.get("delay_ms_median") is not None]
    if missed == slips:
        text = f"{'The slip was' if slips == 1 else f'All {number(slips)} slips were'} missed"
        if not found:
            return f"{text}, {alarms}."
        text += "; the flag rose"
    elif any(row["lead_ms_min"] <= 0 for row in found):
        text = f"{number(missed)} of {_count(slips, 'slip')} were missed; the flags rose"
    elif missed:
        text = f"{number(missed)} of {_count(slips, 'slip')} were missed; the others were detected"
    else:
        text = "The slip was detected" if slips == 1 else f"All {number(slips)} slips were detected"
    delay_ms, lead_ms = max(row["delay_ms_max"] for row in found), min(row["lead_ms_min"] for row in found)
    began, moved = (
        ("the pull began", "the object moved")
        if grip
        else ("the first partial slip", "the whole contact slipped")
    )
    text += f" at most {number(delay_ms)} ms after {began}"
    if lead_ms > 0:
        text += f" and at least {number(lead_ms)} ms before {moved}"
    else:
        text += f", the latest {number(abs(lead_ms))} ms after {moved}"
    text += f", {alarms}"
    if grip and summary["direction_error_deg"] is not None:
        worst = fact("direction_error_deg", summary["direction_error_deg"]["maximum"])
        text += f"; the reported direction is at most {worst} off"
    return text + "."


def _errors(summary):
    """How far position and load are off."""
    place, load = summary["position_error"], summary["load_error"]
    if place is None or load is None:
        return "No frame has a position."

    def of(key, which):
        return fact(key, summary[key][which])

    text = (
        f"The position is at most {of('position_error', 'maximum')} of the range off and the load "
        f"{of('load_error', 'maximum')}; in the mean {of('position_error', 'mean')} and "
        f"{of('load_error', 'mean')}"
    )
    if "response_s" in summary:
        text += f"; 95 % of the load is reported after {fact('response_s', summary['response_s'])}"
    if "locus" in summary:
        locus = summary["locus"]
        text += f"; the locus is a circle of radius {number(locus['radius'])}"
        text += f", {fact('roundness', locus['roundness'])} out of round"
    if "dead" in summary:
        as_injected = "those injected" if summary["dead_as_injected"] else "not all as injected"
        if summary["dead"] or not summary["dead_as_injected"]:
            text += f"; {_count(summary['dead'], 'cell was', 'cells were')} found dead, {as_injected}"
    return text + "."


def _stick_slip(summary):
    """The derivative of Vc beside the slip detector."""
    missed, slips = summary["slope_missed_rate"]["count"], summary["slope_missed_rate"]["runs"]
    text = (
        f"The derivative of Vc misses {number(missed)} of {_count(slips, 'slip')}, the slip detector "
        f"{number(summary['missed'])}"
    )
    pressing = summary["slope_pressing_rate"]["count"]
    text += f"; pressing alone crosses its threshold in {_count(pressing, 'run')}"
    if summary["stick_slips_found"]:
        text += f", and it shows {100 * summary['stick_slips_found']['rate']:.3g} % of the stick-slips"
    return text + "."


def _sheared(summary):
    """Rubber that shears and does not slip."""

    def of(key, which="mean"):
        return fact(key, summary[key][which])

    alarms = f"; the slip detector raises its flag in {_count(summary['false_alarm_rate']['count'], 'run')}"
    if "slope_v_mm" in summary:
        text = f"Vc rises by {of('step_v')} in the mean, by {fact('slope_v_mm', summary['slope_v_mm'])} more"
    elif "k0" in summary:
        values = [f"{name} = {summary[name]:.3f}" for name in ("k0", "k1", "n")]
        text = (
            f"The steps fit {', '.join(values)}; one step gives its speed to {of('speed_error')} in the mean"
        )
    else:
        ways = [
            f"{of(key)} where it {word}"
            for key, word in (("restored_after_v", "is restored"), ("converged_after_v", "converges"))
            if summary[key]
        ]
        text = f"5 s after the shear Vc is {' and '.join(ways)}"
    return text + alarms + "."


def _hand(summary):
    """What fell, and how hard the rest was held."""
    rate, runs = summary["dropped_rate"], _count(summary["runs"], "run")
    if rate["count"] == rate["runs"]:
        return f"The object was dropped in every one of {runs}."
    text = (
        "Nothing was dropped" if not rate["count"] else f"The object was dropped in {number(rate['count'])}"
    )
    return (
        f"{text} {'in' if not rate['count'] else 'of'} {runs} (95 % interval up to "
        f"{number(100 * rate['high'])} %); held with at most {number(summary['grip_ratio_mean'])} times the "
        f"least grip that friction allows, in the mean of a condition, while the object slipped by at most "
        f"{number(summary['slip_mm_max'])} mm."
    )


def _answer(summary):
    def of(key):
        return fact(key, summary[key])

    if "stick_slips" in summary:
        return _stick_slip(summary)
    if "deviation_v" in summary:
        return _sheared(summary)
    if "missed" in summary:
        return _slip(summary)
    if "dropped_rate" in summary:
        return _hand(summary)
    if "difference_from_eq18_v" in summary:
        return f"The demodulated output is at most {of('difference_from_eq18_v')} off eq. 18."
    if "sag_of_hold" in summary:
        worst = max(row["of_the_mean"] for row in summary["conditions"])
        return (
            f"The reading of a held force rises by {of('sag_of_hold')} and leaves "
            f"{of('left_after_release_g')} at its release; the same press repeats within "
            f"{fact('of_the_mean', worst)} (standard deviation)."
        )
    if "peaks_apart_mm" in summary:
        return (
            f"Neighbouring cells peak {of('peaks_apart_mm')} apart; over a cell's centre its neighbour reads "
            f"{of('neighbour_at_a_centre')} of it."
        )
    if "position_error" in summary:
        text = _errors(summary)
        if "unevenness_after" in summary and "dead" not in summary:
            return (
                f"Calibration brings the cells of an even press from {of('unevenness_before')} to "
                f"{of('unevenness_after')} of their mean; t{text[1:]}"
            )
        return text
    return f"{_count(summary['runs'], 'run')} done."


def verdict(summary):
    """The sentence; a core that differs from its twin comes before anything else."""
    wrong = summary.get("twin_mismatches")
    text = _answer(summary)
    if wrong:
        return f"The core differs from its integer twin in {_count(wrong, 'value')}: do not trust it. {text}"
    if wrong == 0:
        return f"{text[:-1]}; the core equals its integer twin in every value."
    return text
