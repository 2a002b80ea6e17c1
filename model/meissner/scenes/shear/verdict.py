"""The sentence about a run of sheared rubber."""

from meissner.report.words import fact, number
from meissner.scenes.verdict import count


def _stick_slip(summary):
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


def _sheared(summary):
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
    return _stick_slip(summary) if "stick_slips" in summary else _sheared(summary)
