"""The sentence about a hand's runs: drops, and the grip of the runs that held."""

from meissner.report.words import number
from meissner.scenes.verdict import count


def answer(summary):
    rate, runs = summary["dropped_rate"], count(summary["runs"], "run")
    if rate["count"] == rate["runs"]:
        return f"The object was dropped in every one of {runs}."
    text = (
        "Nothing was dropped" if not rate["count"] else f"The object was dropped in {number(rate['count'])}"
    )
    return (
        f"{text} {'in' if not rate['count'] else 'of'} {runs} (95 % interval up to "
        f"{number(100 * rate['high'])} %); the grip was at most {number(summary['grip_ratio_mean'])} times "
        f"the least grip that friction allows, in the mean of a condition, while the object slipped by at "
        f"most {number(summary['slip_mm_max'])} mm."
    )
